// What the programs in C++ share: the robot as plain numbers, and the commands of compare.py.
//
//   check ROBOT            pose and Jacobian of the first configurations, into OUT
//   single ROBOT MS        ns of a call, least and median over blocks of 256 calls
//   batch ROBOT CHUNK      ns a configuration for 100 000, results of CHUNK kept at a time
//   tree ROBOT MS          as single, of the whole tree;  treecheck ROBOT: its columns
//   servo ROBOT STEPS      ns of each step, into OUT
//   ik|far ROBOT TOL FROM TO   ns, success, q of each target, into OUT
#pragma once
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <vector>

struct Joint { std::string name; int parent; double pose[12]; double axis[3]; double lower, upper, velocity; };
struct Tip { std::string name; int parent; double pose[12]; };

struct Robot {
  std::vector<Joint> joints;
  std::vector<Tip> tips;
  std::vector<double> q, targets, far;
  size_t n() const { return joints.size(); }
  size_t count() const { return q.size() / n(); }
  const double* configuration(size_t i) const { return &q[i * n()]; }
};

inline std::vector<double> doubles(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return {};
  std::vector<double> out(file.tellg() / sizeof(double));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(out.data()), out.size() * sizeof(double));
  return out;
}

inline Robot load(const std::string& folder, const std::string& name) {
  std::ifstream file(folder + "/" + name + ".chain");
  size_t n = 0, tips = 0;
  file >> n >> tips;
  Robot robot;
  robot.joints.resize(n);
  robot.tips.resize(tips);
  for (auto& j : robot.joints) {
    file >> j.name >> j.parent;
    for (double& x : j.pose) file >> x;
    for (double& x : j.axis) file >> x;
    file >> j.lower >> j.upper >> j.velocity;
  }
  for (auto& t : robot.tips) {
    file >> t.name >> t.parent;
    for (double& x : t.pose) file >> x;
  }
  if (!file || n == 0) throw std::runtime_error("cannot read " + name + ".chain");
  robot.q = doubles(folder + "/" + name + ".q");
  robot.targets = doubles(folder + "/" + name + ".targets");
  robot.far = doubles(folder + "/" + name + ".far");
  return robot;
}

inline double now() {
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Processor time, of all threads: a solver that is interrupted is not charged for it.
inline double spent() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e9 * t.tv_sec + t.tv_nsec;
}

template <class T> inline void keep(const T& x) { asm volatile("" : : "r"(&x) : "memory"); }

const size_t BLOCK = 256;

// `call(q)` for 256 configurations in turn, until the time is over.
template <class F> std::string single(const Robot& robot, double ms, F call) {
  std::vector<double> blocks;
  for (double end = now() + ms * 1e6; now() < end;) {
    const double begin = now();
    for (size_t i = 0; i < BLOCK; ++i) call(robot.configuration(i));
    blocks.push_back((now() - begin) / BLOCK);
  }
  std::sort(blocks.begin(), blocks.end());
  std::ostringstream out;
  out << blocks.front() << " " << blocks[blocks.size() / 2];
  return out.str();
}

// `call(q, pose, jacobian)` for all configurations; pose: R by rows, p; Jacobian by rows.
template <class F> std::string batch(const Robot& robot, size_t chunk, F call) {
  static std::map<size_t, std::vector<double>> memory;
  const size_t n = robot.n(), row = 12 + 6 * n;
  auto& out = memory[chunk * row];
  out.resize(chunk * row, 1.0);
  const double begin = now();
  for (size_t i = 0; i < robot.count(); ++i) {
    double* at = &out[(i % chunk) * row];
    call(robot.configuration(i), at, at + 12);
    if (i % chunk == chunk - 1) keep(*out.data());
  }
  std::ostringstream text;
  text << (now() - begin) / robot.count();
  return text.str();
}

inline std::string write(const std::string& path, const std::vector<double>& numbers) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double));
  return file ? "ok" : "error cannot write " + path;
}

// `solve(target, q)` is asked for targets [from, to); q comes as the middle of the limits.
template <class F>
std::string ik(const Robot& robot, const std::vector<double>& targets, size_t from, size_t to, const std::string& path, F solve) {
  std::vector<double> out;
  for (size_t i = from; i < to; ++i) {
    std::vector<double> q(robot.n());
    for (size_t j = 0; j < q.size(); ++j) q[j] = 0.5 * (robot.joints[j].lower + robot.joints[j].upper);
    const double begin = spent();
    const bool success = solve(&targets[12 * i], q.data());
    out.push_back(spent() - begin);
    out.push_back(success);
    out.insert(out.end(), q.begin(), q.end());
  }
  return write(path, out);
}

// Configurations drawn within the limits.
struct Draw {
  std::mt19937_64 random{6};
  void operator()(const Robot& robot, double* q) {
    for (size_t j = 0; j < robot.n(); ++j)
      q[j] = std::uniform_real_distribution<double>(robot.joints[j].lower, robot.joints[j].upper)(random);
  }
};

using Words = std::vector<std::string>;

// Reads commands until the end; the first argument is the folder of the robots.
inline int serve(int argc, char** argv, const std::function<std::string(const Words&, const Robot&, const std::string&)>& answer) {
  if (argc < 2) return 2;
  std::map<std::string, Robot> robots;
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream in(line);
    std::string path, word;
    Words words;
    in >> path;
    while (in >> word) words.push_back(word);
    try {
      if (!robots.count(words.at(1))) robots[words[1]] = load(argv[1], words[1]);
      std::cout << answer(words, robots[words[1]], path) << std::endl;
    } catch (const std::exception& error) {
      std::cout << "error " << error.what() << std::endl;
    }
  }
  return 0;
}
