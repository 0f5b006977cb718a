#pragma once

namespace geometry_msgs::msg {
struct Vector3 {
    double x = 0.0, y = 0.0, z = 0.0;
};
struct Twist {
    Vector3 linear, angular;
};
struct TwistStamped {
    Twist twist;
};
}  // namespace geometry_msgs::msg
