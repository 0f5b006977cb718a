// The controller manager of the test: a lever of two joints, whose drives follow their commands.
#include <cmath>
#include <cstdio>

#include "controller_interface/controller_interface.hpp"
#include "geometry_msgs/msg/twist_stamped.hpp"

std::unique_ptr<controller_interface::ControllerInterface> plugin();

namespace {
const char *const URDF = R"(<robot name="arm"><link name="base"/><link name="upper"/>
<link name="lower"/><link name="hand"/>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
<axis xyz="0 0 1"/><limit lower="-3" upper="3" velocity="2" effort="9"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/>
<origin xyz="0.5 0 0"/><axis xyz="0 0 1"/><limit lower="-3" upper="3" velocity="2" effort="9"/>
</joint><joint name="flange" type="fixed"><parent link="lower"/><child link="hand"/>
<origin xyz="0.4 0 0"/></joint></robot>)";

using controller_interface::CallbackReturn;
using Position = hardware_interface::LoanedStateInterface;
using Velocity = hardware_interface::LoanedCommandInterface;
using Twists = rclcpp::Subscription<geometry_msgs::msg::TwistStamped>;

#define EXPECT(truth) \
    if (!(truth)) return std::fprintf(stderr, "line %d: %s\n", __LINE__, #truth), 1
}  // namespace

int main() {
    const auto controller = plugin();
    // The order of the controller, not that of the model.
    const std::vector<std::string> joints{"elbow", "shoulder"};
    double q[2] = {1.2, 0.3}, velocities[2] = {9.0, 9.0};
    EXPECT(controller->on_init() == CallbackReturn::SUCCESS);
    const auto node = controller->get_node();
    const auto configure = [&](const char *frame, std::vector<std::string> names) {
        node->parameters["frame"] = std::string(frame);
        node->parameters["joints"] = std::move(names);
        controller->assign(URDF, {Position(&q[0]), Position(&q[1])},
                           {Velocity(&velocities[0]), Velocity(&velocities[1])});
        return controller->on_configure({});
    };
    EXPECT(configure("hnad", joints) == CallbackReturn::ERROR);
    EXPECT(configure("hand", {"elbow", "wrist"}) == CallbackReturn::ERROR);
    EXPECT(configure("hand", joints) == CallbackReturn::SUCCESS);
    EXPECT(controller->command_interface_configuration().names[0] == "elbow/velocity");
    EXPECT(controller->state_interface_configuration().names[1] == "shoulder/position");
    EXPECT(controller->on_activate({}) == CallbackReturn::SUCCESS);
    const auto twists = std::static_pointer_cast<Twists>(node->subscriptions.back().lock());
    EXPECT(twists && twists->topic == "~/delta_twist_cmds");

    const auto hand = [&](double &x, double &y) {
        x = 0.5 * std::cos(q[1]) + 0.4 * std::cos(q[1] + q[0]);
        y = 0.5 * std::sin(q[1]) + 0.4 * std::sin(q[1] + q[0]);
    };
    const auto cycle = [&] {
        const bool done = controller->update({}, {}) == controller_interface::return_type::OK;
        for (int i = 0; i < 2; i++) q[i] += velocities[i] / controller->get_update_rate();
        return done;
    };
    double x0, y0, x, y;
    hand(x0, y0);
    for (int k = 0; k < 500; k++) {  // a second, a command every 20 ms
        if (k % 10 == 0) {
            auto twist = std::make_shared<geometry_msgs::msg::TwistStamped>();
            twist->twist.linear.y = 0.1;
            twists->callback(twist);
        }
        EXPECT(cycle());
    }
    hand(x, y);
    std::printf("moved by %.4f, %.4f m\n", x - x0, y - y0);
    EXPECT(std::fabs(x - x0) < 2e-3 && std::fabs(y - y0 - 0.1) < 2e-3);
    for (int k = 0; k < 150; k++) EXPECT(cycle());
    EXPECT(velocities[0] == 0.0 && velocities[1] == 0.0);  // the watchdog
    q[0] = std::nan("");
    velocities[0] = 9.0;
    EXPECT(!cycle());
    EXPECT(velocities[0] == 0.0);
    std::printf("stopped\n");
    return 0;
}
