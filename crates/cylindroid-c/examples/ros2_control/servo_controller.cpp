// A controller of ros2_control around the servo: it follows twists in the real-time loop of the
// controller manager, where a node on its own, cylindroid-ros2, is one message behind.
//
// Written for the interfaces of Jazzy. The tests compile and run it with the headers in stubs/,
// which declare what it uses of them; it was not compiled with those of ROS 2.
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "controller_interface/controller_interface.hpp"
#include "cylindroid.hpp"
#include "geometry_msgs/msg/twist_stamped.hpp"
#include "pluginlib/class_list_macros.hpp"
#include "realtime_tools/realtime_buffer.hpp"

namespace cylindroid_ros2_control {

using controller_interface::CallbackReturn;
using controller_interface::InterfaceConfiguration;
using controller_interface::interface_configuration_type;
using controller_interface::return_type;
using geometry_msgs::msg::TwistStamped;

class ServoController : public controller_interface::ControllerInterface {
   public:
    CallbackReturn on_init() override {
        auto_declare<std::vector<std::string>>("joints", {});
        auto_declare<std::string>("frame", "");
        auto_declare<double>("command_timeout", 0.1);
        return CallbackReturn::SUCCESS;
    }

    InterfaceConfiguration command_interface_configuration() const override {
        return all("velocity");
    }
    InterfaceConfiguration state_interface_configuration() const override {
        return all("position");
    }

    // Everything is allocated here; errors have the text of the library.
    CallbackReturn on_configure(const rclcpp_lifecycle::State &) override {
        joints_ = get_node()->get_parameter("joints").as_string_array();
        const auto frame = get_node()->get_parameter("frame").as_string();
        timeout_ = get_node()->get_parameter("command_timeout").as_double();
        try {
            robot_ = std::make_unique<cylindroid::Mechanism>(
                cylindroid::Mechanism::parse(get_robot_description(), "robot_description.urdf"));
            options_ = cylindroid::Servo::defaults(*robot_);
            if (!frame.empty()) options_.frame = robot_->frame(frame);
            // With fewer than six joints the rotation follows from the position.
            if (joints_.size() < 6)
                for (int i = 3; i < 6; i++) options_.components[i] = false;
            q_ = robot_->home();
            places_.clear();
            for (const auto &joint : joints_) places_.push_back(place(joint));
        } catch (const cylindroid::Error &error) {
            return refuse(error.what());
        }
        options_.dt = 1.0 / get_update_rate();
        options_.command_timeout = timeout_;
        velocities_.assign(robot_->n(), 0.0);
        twists_.writeFromNonRT(nullptr);
        subscription_ = get_node()->create_subscription<TwistStamped>(
            "~/delta_twist_cmds", rclcpp::SystemDefaultsQoS(),
            [this](std::shared_ptr<TwistStamped> twist) { twists_.writeFromNonRT(twist); });
        return CallbackReturn::SUCCESS;
    }

    CallbackReturn on_activate(const rclcpp_lifecycle::State &) override {
        try {
            servo_ = std::make_unique<cylindroid::Servo>(*robot_, options_);
        } catch (const cylindroid::Error &error) {
            return refuse(error.what());
        }
        last_ = *twists_.readFromRT();  // what came before is not followed
        return CallbackReturn::SUCCESS;
    }

    CallbackReturn on_deactivate(const rclcpp_lifecycle::State &) override {
        stop();
        return CallbackReturn::SUCCESS;
    }

    // No allocation, no lock.
    return_type update(const rclcpp::Time &, const rclcpp::Duration &) override {
        for (std::size_t i = 0; i < places_.size(); i++)
            q_[places_[i]] = state_interfaces_[i].get_value();
        const auto &newest = *twists_.readFromRT();
        const double *command = nullptr;
        double twist[6];
        if (newest && newest != last_) {
            const auto &[linear, angular] = newest->twist;
            const double all[6] = {linear.x, linear.y, linear.z, angular.x, angular.y, angular.z};
            for (int k = 0; k < 6; k++) twist[k] = std::isfinite(all[k]) ? all[k] : 0.0;
            command = twist;
            last_ = newest;
        }
        try {
            servo_->step_twist(q_, command, velocities_);
        } catch (const cylindroid::Error &) {
            stop();  // a position that is no number: the error of the loop is the manager's
            return return_type::ERROR;
        }
        for (std::size_t i = 0; i < places_.size(); i++)
            command_interfaces_[i].set_value(velocities_[places_[i]]);
        return return_type::OK;
    }

   private:
    InterfaceConfiguration all(const std::string &kind) const {
        InterfaceConfiguration out{interface_configuration_type::INDIVIDUAL, {}};
        for (const auto &joint : joints_) out.names.push_back(joint + "/" + kind);
        return out;
    }

    std::size_t place(const std::string &joint) const {
        for (std::size_t i = 0; i < robot_->n(); i++)
            if (joint == cyl_coordinate_name(robot_->get(), i)) return i;
        throw cylindroid::Error(CYL_UNKNOWN_NAME, ("no joint named '" + joint + "'").c_str());
    }

    CallbackReturn refuse(const char *reason) {
        RCLCPP_ERROR(get_node()->get_logger(), "%s", reason);
        return CallbackReturn::ERROR;
    }

    void stop() {
        for (auto &command : command_interfaces_) command.set_value(0.0);
    }

    std::vector<std::string> joints_;
    std::vector<std::size_t> places_;
    std::vector<double> q_, velocities_;
    double timeout_ = 0.1;
    cyl_servo_options options_{};
    std::unique_ptr<cylindroid::Mechanism> robot_;
    std::unique_ptr<cylindroid::Servo> servo_;
    std::shared_ptr<TwistStamped> last_;
    realtime_tools::RealtimeBuffer<std::shared_ptr<TwistStamped>> twists_;
    std::shared_ptr<rclcpp::Subscription<TwistStamped>> subscription_;
};

}  // namespace cylindroid_ros2_control

PLUGINLIB_EXPORT_CLASS(cylindroid_ros2_control::ServoController,
                       controller_interface::ControllerInterface)
