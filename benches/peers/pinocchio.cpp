// Pinocchio in C++, its headers compiled for this processor: kinematics, a servo step with Eigen's
// SVD, and a damped loop with restarts.
#include <Eigen/SVD>

#include "pinocchio_model.hpp"

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic>;
using Rows = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor>;
using Q = Eigen::Map<const Eigen::VectorXd>;

struct Arm {
  pinocchio::Model model;
  pinocchio::Data data;
  size_t tip;
  Jacobian jacobian;

  explicit Arm(const Robot& robot)
      : model(model_of(robot)), data(model), tip(model.frames.size() - robot.tips.size()),
        jacobian(Jacobian::Zero(6, model.nv)) {}

  template <class Configuration> const pinocchio::SE3& set(const Configuration& q, pinocchio::ReferenceFrame frame) {
    pinocchio::computeJointJacobians(model, data, q);
    pinocchio::updateFramePlacement(model, data, tip);
    pinocchio::getFrameJacobian(model, data, tip, frame, jacobian);
    return data.oMf[tip];
  }

  void rows(const double* q, double* pose, double* out) {
    const auto& at = set(Q(q, model.nq), pinocchio::LOCAL_WORLD_ALIGNED);
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(pose, 3, 3) = at.rotation();
    Eigen::Map<Eigen::Vector3d>(pose + 9, 3) = at.translation();
    Eigen::Map<Rows>(out, 6, model.nv) = jacobian;
  }
};

pinocchio::SE3 target_of(const double* x) {
  return {Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(x), Eigen::Vector3d(x[9], x[10], x[11])};
}

// The loop that one writes first: damped steps, clamped to the limits, from the middle of the
// limits and then from configurations drawn within them.
bool damped_loop(Arm& arm, const Robot& robot, Draw& draw, const double* desired, double tolerance, double* out) {
  const int n = arm.model.nv;
  const pinocchio::SE3 target = target_of(desired);
  Eigen::VectorXd q = Eigen::Map<Eigen::VectorXd>(out, n), lower(n), upper(n);
  for (int i = 0; i < n; ++i) lower[i] = robot.joints[i].lower, upper[i] = robot.joints[i].upper;
  for (int attempt = 0; attempt < 200; ++attempt) {
    if (attempt > 0) draw(robot, q.data());
    for (int step = 0; step < 50; ++step) {
      const auto& pose = arm.set(q, pinocchio::LOCAL);
      Vector6 error;
      error << pose.rotation().transpose() * (target.translation() - pose.translation()),
          pinocchio::log3(Eigen::Matrix3d(pose.rotation().transpose() * target.rotation()));
      if (error.head<3>().norm() <= tolerance && error.tail<3>().norm() <= tolerance) {
        Eigen::Map<Eigen::VectorXd>(out, n) = q;
        return true;
      }
      Matrix6 square = arm.jacobian * arm.jacobian.transpose();
      square.diagonal().array() += 1e-9 + 0.1 * error.squaredNorm();
      q += arm.jacobian.transpose() * square.llt().solve(error);
      q = q.cwiseMax(lower).cwiseMin(upper);
    }
  }
  Eigen::Map<Eigen::VectorXd>(out, n) = q;
  return false;
}

// One step for seven joints: pose, Jacobian, truncated inverse, posture in the null space, limits.
struct Servo {
  static constexpr double DT = 1e-3, GAIN = 5.0, POSTURE = 1.0, CUT = 1e-3;
  using Vector7 = Eigen::Matrix<double, 7, 1>;
  Eigen::JacobiSVD<Eigen::Matrix<double, 6, 7>> svd{6, 7, Eigen::ComputeFullU | Eigen::ComputeFullV};
  Vector7 home, lower, upper, speed, rates = Vector7::Zero();
  double length;

  void step(Arm& arm, const Vector7& q, const pinocchio::SE3& target, const Vector6& feed_forward) {
    const auto& pose = arm.set(q, pinocchio::LOCAL_WORLD_ALIGNED);
    Vector6 x;
    x << target.translation() - pose.translation(),
        pinocchio::log3(Eigen::Matrix3d(target.rotation() * pose.rotation().transpose()));
    x = GAIN * x + feed_forward;
    Eigen::Matrix<double, 6, 7> jacobian = arm.jacobian;
    jacobian.topRows<3>() /= length;
    x.head<3>() /= length;
    svd.compute(jacobian);
    const auto& s = svd.singularValues();
    const auto v = svd.matrixV().leftCols<6>();
    Vector6 gains;
    for (int i = 0; i < 6; ++i) gains[i] = s[i] > CUT * s[0] ? 1.0 / s[i] : 0.0;
    const Vector7 secondary = POSTURE * (home - q);
    rates = v * (gains.asDiagonal() * (svd.matrixU().transpose() * x)) + secondary - v * (v.transpose() * secondary);
    double scale = 1.0;
    for (int i = 0; i < 7; ++i) {
      const double most = std::min(speed[i], (upper[i] - q[i]) / DT), least = std::max(-speed[i], (lower[i] - q[i]) / DT);
      if (rates[i] > most) scale = std::min(scale, std::max(most, 0.0) / rates[i]);
      if (rates[i] < least) scale = std::min(scale, std::min(least, 0.0) / rates[i]);
    }
    rates *= scale;
  }
};

// A circle of 10 cm in 4 s from home, followed for some steps; the last q behind the times.
std::string servo(Arm& arm, const Robot& robot, size_t steps, const std::string& path) {
  Servo servo;
  servo.home << 0.0, -M_PI / 4, 0.0, -3 * M_PI / 4, 0.0, M_PI / 2, M_PI / 4;
  for (int i = 0; i < 7; ++i) {
    servo.lower[i] = robot.joints[i].lower;
    servo.upper[i] = robot.joints[i].upper;
    servo.speed[i] = robot.joints[i].velocity;
  }
  servo.length = 1.0;
  Servo::Vector7 q = servo.home;
  const pinocchio::SE3 start = arm.set(q, pinocchio::LOCAL_WORLD_ALIGNED);
  std::vector<double> out;
  for (size_t i = 0; i < steps; ++i) {
    const double w = 2 * M_PI / 4.0, a = w * i * Servo::DT, r = 0.1;
    pinocchio::SE3 target = start;
    target.translation() += Eigen::Vector3d(0.0, r * std::sin(a), r * (std::cos(a) - 1.0));
    Vector6 feed_forward = Vector6::Zero();
    feed_forward[1] = r * w * std::cos(a);
    feed_forward[2] = -r * w * std::sin(a);
    const double begin = now();
    servo.step(arm, q, target, feed_forward);
    out.push_back(now() - begin);
    q += Servo::DT * servo.rates;
  }
  out.insert(out.end(), q.data(), q.data() + 7);
  return write(path, out);
}

}  // namespace

int main(int argc, char** argv) {
  std::map<std::string, Arm> arms;
  Draw draw;
  return serve(argc, argv, [&](const Words& words, const Robot& robot, const std::string& path) -> std::string {
    auto& arm = arms.try_emplace(words[1], robot).first->second;
    const int n = arm.model.nv;
    if (words[0] == "check") {
      std::vector<double> out(BLOCK * (12 + 6 * n));
      for (size_t i = 0; i < BLOCK; ++i) arm.rows(robot.configuration(i), &out[i * (12 + 6 * n)], &out[i * (12 + 6 * n) + 12]);
      return write(path, out);
    }
    if (words[0] == "single") {
      return single(robot, std::stod(words[2]), [&](const double* q) {
        keep(arm.set(Q(q, n), pinocchio::LOCAL_WORLD_ALIGNED));
        keep(*arm.jacobian.data());
      });
    }
    if (words[0] == "batch")
      return batch(robot, std::stoul(words[2]), [&](const double* q, double* pose, double* j) { arm.rows(q, pose, j); });
    if (words[0] == "tree") {
      return single(robot, std::stod(words[2]), [&](const double* q) {
        pinocchio::computeJointJacobians(arm.model, arm.data, Q(q, n));
        keep(*arm.data.J.data());
      });
    }
    if (words[0] == "treecheck") {
      std::vector<double> out(BLOCK * 6 * n);
      for (size_t i = 0; i < BLOCK; ++i) {
        pinocchio::computeJointJacobians(arm.model, arm.data, Q(robot.configuration(i), n));
        Eigen::Map<Rows>(&out[i * 6 * n], 6, n) = arm.data.J;
      }
      return write(path, out);
    }
    if (words[0] == "servo") return servo(arm, robot, std::stoul(words[2]), path);
    if (words[0] == "ik" || words[0] == "far") {
      const double tolerance = std::stod(words[2]);
      const auto& targets = words[0] == "ik" ? robot.targets : robot.far;
      return ik(robot, targets, std::stoul(words[3]), std::stoul(words[4]), path,
                [&](const double* target, double* q) { return damped_loop(arm, robot, draw, target, tolerance, q); });
    }
    return "error no task " + words[0];
  });
}
