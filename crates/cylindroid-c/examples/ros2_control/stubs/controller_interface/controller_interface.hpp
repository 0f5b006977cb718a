// What servo_controller.cpp uses of controller_interface, rclcpp and hardware_interface: signatures
// as in Jazzy, bodies of a test.
#pragma once

#include <cstdarg>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "rclcpp_lifecycle/state.hpp"

#define RCLCPP_ERROR(logger, ...) ((void)(logger), std::fprintf(stderr, __VA_ARGS__))

namespace rclcpp {
class Time {};
class Duration {};
struct Logger {};
struct SystemDefaultsQoS {};

class Parameter {
   public:
    using Value = std::variant<double, std::string, std::vector<std::string>>;
    explicit Parameter(Value value) : value_(std::move(value)) {}
    double as_double() const { return std::get<double>(value_); }
    const std::string &as_string() const { return std::get<std::string>(value_); }
    const std::vector<std::string> &as_string_array() const {
        return std::get<std::vector<std::string>>(value_);
    }

   private:
    Value value_;
};

template <class Message>
struct Subscription {
    std::string topic;
    std::function<void(std::shared_ptr<Message>)> callback;
};
}  // namespace rclcpp

namespace rclcpp_lifecycle {
class LifecycleNode {
   public:
    rclcpp::Parameter get_parameter(const std::string &name) const {
        return rclcpp::Parameter(parameters.at(name));
    }
    rclcpp::Logger get_logger() const { return {}; }
    template <class Message, class Callback>
    std::shared_ptr<rclcpp::Subscription<Message>> create_subscription(
        const std::string &topic, const rclcpp::SystemDefaultsQoS &, Callback callback) {
        auto made = std::make_shared<rclcpp::Subscription<Message>>();
        *made = {topic, callback};
        subscriptions.push_back(made);
        return made;
    }
    std::map<std::string, rclcpp::Parameter::Value> parameters;
    std::vector<std::weak_ptr<void>> subscriptions;
};
}  // namespace rclcpp_lifecycle

namespace hardware_interface {
class LoanedStateInterface {
   public:
    explicit LoanedStateInterface(const double *value) : value_(value) {}
    double get_value() const { return *value_; }

   private:
    const double *value_;
};

class LoanedCommandInterface {
   public:
    explicit LoanedCommandInterface(double *value) : value_(value) {}
    void set_value(double value) { *value_ = value; }

   private:
    double *value_;
};
}  // namespace hardware_interface

namespace controller_interface {
enum class CallbackReturn { SUCCESS, FAILURE, ERROR };
enum class return_type { OK, ERROR };
enum class interface_configuration_type { ALL, INDIVIDUAL, NONE };

struct InterfaceConfiguration {
    interface_configuration_type type;
    std::vector<std::string> names;
};

class ControllerInterface {
   public:
    virtual ~ControllerInterface() = default;
    virtual CallbackReturn on_init() = 0;
    virtual InterfaceConfiguration command_interface_configuration() const = 0;
    virtual InterfaceConfiguration state_interface_configuration() const = 0;
    virtual CallbackReturn on_configure(const rclcpp_lifecycle::State &) = 0;
    virtual CallbackReturn on_activate(const rclcpp_lifecycle::State &) = 0;
    virtual CallbackReturn on_deactivate(const rclcpp_lifecycle::State &) = 0;
    virtual return_type update(const rclcpp::Time &, const rclcpp::Duration &) = 0;

    std::shared_ptr<rclcpp_lifecycle::LifecycleNode> get_node() const { return node_; }
    const std::string &get_robot_description() const { return description_; }
    unsigned get_update_rate() const { return 500; }
    template <class T>
    T auto_declare(const std::string &name, const T &value) {
        node_->parameters.emplace(name, value);
        return value;
    }

    // Of the test: what the controller manager gives and takes.
    void assign(std::string description,
                std::vector<hardware_interface::LoanedStateInterface> states,
                std::vector<hardware_interface::LoanedCommandInterface> commands) {
        description_ = std::move(description);
        state_interfaces_ = std::move(states);
        command_interfaces_ = std::move(commands);
    }

   protected:
    std::vector<hardware_interface::LoanedCommandInterface> command_interfaces_;
    std::vector<hardware_interface::LoanedStateInterface> state_interfaces_;

   private:
    std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node_ =
        std::make_shared<rclcpp_lifecycle::LifecycleNode>();
    std::string description_;
};
}  // namespace controller_interface
