// C code generated from Pinocchio's algorithms for one robot at a time (generate.cpp).
#include "common.hpp"

extern "C" {
void panda(const double*, double*);
void ur5(const double*, double*);
void iiwa14(const double*, double*);
void g1_arm(const double*, double*);
}

int main(int argc, char** argv) {
  const std::map<std::string, void (*)(const double*, double*)> codes{
      {"panda", panda}, {"ur5", ur5}, {"iiwa14", iiwa14}, {"g1_arm", g1_arm}};
  return serve(argc, argv, [&](const Words& words, const Robot& robot, const std::string& path) -> std::string {
    const auto code = codes.at(words[1]);
    const size_t row = 12 + 6 * robot.n();
    std::vector<double> out(BLOCK * row);
    if (words[0] == "check") {
      for (size_t i = 0; i < BLOCK; ++i) code(robot.configuration(i), &out[i * row]);
      return write(path, out);
    }
    if (words[0] == "single") {
      return single(robot, std::stod(words[2]), [&](const double* q) {
        code(q, out.data());
        keep(*out.data());
      });
    }
    if (words[0] == "batch")
      return batch(robot, std::stoul(words[2]), [&](const double* q, double* pose, double*) { code(q, pose); });
    return "error no task " + words[0];
  });
}
