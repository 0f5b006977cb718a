// A robot as Pinocchio's model: the joints its URDF reader would choose, from the same numbers.
#pragma once
#include <pinocchio/multibody.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>

#include "common.hpp"

inline pinocchio::SE3 se3(const double* x) {
  Eigen::Matrix3d r;
  r << x[0], x[1], x[2], x[4], x[5], x[6], x[8], x[9], x[10];
  return {r, Eigen::Vector3d(x[3], x[7], x[11])};
}

inline pinocchio::Model model_of(const Robot& robot) {
  using namespace pinocchio;
  Model model;
  for (const auto& j : robot.joints) {
    const Eigen::Vector3d axis(j.axis[0], j.axis[1], j.axis[2]);
    const auto add = [&](const JointModel& joint) {
      model.addJoint(j.parent + 1, joint, se3(j.pose), j.name);
    };
    if (axis == Eigen::Vector3d::UnitX()) add(JointModelRX());
    else if (axis == Eigen::Vector3d::UnitY()) add(JointModelRY());
    else if (axis == Eigen::Vector3d::UnitZ()) add(JointModelRZ());
    else add(JointModelRevoluteUnaligned(axis));
  }
  for (const auto& t : robot.tips)
    model.addFrame(Frame(t.name, t.parent + 1, 0, se3(t.pose), OP_FRAME));
  return model;
}
