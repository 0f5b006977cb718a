// Orocos KDL: kinematics of a chain, and its Levenberg-Marquardt solver with restarts.
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "common.hpp"

namespace {

KDL::Frame frame(const double* x) {
  return {KDL::Rotation(x[0], x[1], x[2], x[4], x[5], x[6], x[8], x[9], x[10]), KDL::Vector(x[3], x[7], x[11])};
}

// KDL puts a fixed placement behind a joint, the robot files one before it.
KDL::Chain chain_of(const Robot& robot) {
  KDL::Chain chain;
  for (size_t i = 0; i < robot.n(); ++i) {
    const Joint& j = robot.joints[i];
    const double* next = i + 1 < robot.n() ? robot.joints[i + 1].pose : robot.tips[0].pose;
    // The axis and the origin in the frame before the joint; the first placement goes in by hand.
    const KDL::Frame before = i == 0 ? frame(j.pose) : KDL::Frame::Identity();
    const KDL::Vector axis = before.M * KDL::Vector(j.axis[0], j.axis[1], j.axis[2]);
    chain.addSegment(KDL::Segment(j.name, KDL::Joint(j.name, before.p, axis, KDL::Joint::RotAxis), before * frame(next)));
  }
  return chain;
}

struct Arm {
  KDL::Chain chain;
  KDL::ChainFkSolverPos_recursive forward;
  KDL::ChainJntToJacSolver jacobian;
  KDL::JntArray q, start, found;
  KDL::Frame pose;
  KDL::Jacobian j;

  explicit Arm(const Robot& robot)
      : chain(chain_of(robot)), forward(chain), jacobian(chain), q(robot.n()), start(robot.n()), found(robot.n()), j(robot.n()) {}

  void set(const double* x) {
    q.data = Eigen::Map<const Eigen::VectorXd>(x, q.rows());
    forward.JntToCart(q, pose);
    jacobian.JntToJac(q, j);
  }
};

}  // namespace

int main(int argc, char** argv) {
  std::map<std::string, std::unique_ptr<Arm>> arms;
  Draw draw;
  return serve(argc, argv, [&](const Words& words, const Robot& robot, const std::string& path) -> std::string {
    auto& slot = arms[words[1]];
    if (!slot) slot = std::make_unique<Arm>(robot);
    Arm& arm = *slot;
    const size_t n = robot.n();
    if (words[0] == "check") {
      std::vector<double> out;
      for (size_t i = 0; i < BLOCK; ++i) {
        arm.set(robot.configuration(i));
        out.insert(out.end(), arm.pose.M.data, arm.pose.M.data + 9);
        out.insert(out.end(), arm.pose.p.data, arm.pose.p.data + 3);
        for (int r = 0; r < 6; ++r)
          for (size_t c = 0; c < n; ++c) out.push_back(arm.j(r, c));
      }
      return write(path, out);
    }
    if (words[0] == "single") {
      return single(robot, std::stod(words[2]), [&](const double* q) {
        arm.set(q);
        keep(arm.pose);
        keep(*arm.j.data.data());
      });
    }
    if (words[0] == "ik" || words[0] == "far") {
      const double tolerance = std::stod(words[2]);
      Eigen::Matrix<double, 6, 1> weights = Eigen::Matrix<double, 6, 1>::Ones();
      KDL::ChainIkSolverPos_LMA solver(arm.chain, weights, tolerance, 500, 1e-15);
      const auto& targets = words[0] == "ik" ? robot.targets : robot.far;
      return ik(robot, targets, std::stoul(words[3]), std::stoul(words[4]), path, [&](const double* x, double* q) {
        const KDL::Frame target(KDL::Rotation(x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], x[8]), KDL::Vector(x[9], x[10], x[11]));
        // It knows no limits: an answer outside, whole turns apart, is drawn again.
        for (int attempt = 0; attempt < 100; ++attempt) {
          if (attempt > 0) draw(robot, q);
          arm.start.data = Eigen::Map<const Eigen::VectorXd>(q, n);
          if (solver.CartToJnt(arm.start, target, arm.found) < 0) continue;
          bool within = true;
          for (size_t i = 0; i < n; ++i) {
            double x = arm.found(i);
            const double lower = robot.joints[i].lower, upper = robot.joints[i].upper;
            if (x < lower || x > upper) x = std::remainder(x, 2 * M_PI);
            within = within && lower <= x && x <= upper;
            q[i] = x;
          }
          if (within) return true;
        }
        return false;
      });
    }
    return "error no task " + words[0];
  });
}
