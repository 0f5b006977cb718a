// cylindroid for C++17: handles that free themselves, errors as exceptions, Eigen where it is there.
//
// Units, layouts and threads: see cylindroid.h. Steps of the servo neither allocate nor throw, except
// for arguments that are refused (cylindroid::Error).
//
//     auto robot = cylindroid::Mechanism::load("panda");
//     cylindroid::Servo servo(robot);
//     std::vector<double> q = robot.home(), velocities(robot.n());
//     cyl_step step = servo.step(q, target, velocities);
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "cylindroid.h"

#if defined(__has_include)
#if __has_include(<Eigen/Core>)
#include <Eigen/Core>
#define CYLINDROID_HAS_EIGEN 1
#endif
#endif

namespace cylindroid {

/// An error of the library: its kind and its text.
class Error : public std::runtime_error {
   public:
    Error(cyl_status status, const char *text) : std::runtime_error(text), status_(status) {}
    cyl_status status() const noexcept { return status_; }

   private:
    cyl_status status_;
};

inline void check(cyl_status status) {
    if (status != CYL_OK) throw Error(status, cyl_last_error());
}

/// Numbers that belong to somebody else: of std::vector, std::array, std::span, Eigen vectors.
class Numbers {
   public:
    Numbers(const double *data, std::size_t size) : data_(data), size_(size) {}
    template <class Container, class = decltype(std::declval<const Container &>().data())>
    Numbers(const Container &c) : data_(c.data()), size_(static_cast<std::size_t>(c.size())) {}
    const double *data() const noexcept { return data_; }
    std::size_t size() const noexcept { return size_; }
    const double *sized(std::size_t expected, const char *what) const {
        if (size_ != expected)
            throw Error(CYL_DIMENSION, (std::string(what) + " has " + std::to_string(size_) +
                                        " entries, expected " + std::to_string(expected))
                                           .c_str());
        return data_;
    }

   private:
    const double *data_;
    std::size_t size_;
};

/// The same, to be written to.
class Out {
   public:
    Out(double *data, std::size_t size) : data_(data), size_(size) {}
    template <class Container, class = decltype(std::declval<Container &>().data())>
    Out(Container &c) : data_(c.data()), size_(static_cast<std::size_t>(c.size())) {}
    double *sized(std::size_t expected, const char *what) const {
        Numbers(data_, size_).sized(expected, what);
        return data_;
    }

   private:
    double *data_;
    std::size_t size_;
};

namespace detail {
template <class T, void (*Free)(T *)>
struct Deleter {
    void operator()(T *p) const noexcept { Free(p); }
};
template <class T, void (*Free)(T *)>
using Handle = std::unique_ptr<T, Deleter<T, Free>>;
}  // namespace detail

/// A pose as 16 numbers by columns.
using Matrix4 = std::array<double, 16>;

/// A robot or mechanism; immutable.
class Mechanism {
   public:
    static Mechanism load(const std::string &name) {
        cyl_mechanism *p = nullptr;
        check(cyl_load(name.c_str(), &p));
        return Mechanism(p);
    }
    static Mechanism parse(const std::string &text, const std::string &path) {
        cyl_mechanism *p = nullptr;
        check(cyl_load_text(text.c_str(), path.c_str(), &p));
        return Mechanism(p);
    }
    const cyl_mechanism *get() const noexcept { return handle_.get(); }
    std::string name() const { return cyl_name(get()); }
    std::size_t n() const noexcept { return cyl_n(get()); }
    std::size_t actuated_count() const noexcept { return cyl_actuated_count(get()); }
    std::size_t actuated_index(std::size_t i) const noexcept {
        return cyl_actuated_index(get(), i);
    }
    std::size_t frame(const std::string &name) const {
        std::size_t index = 0;
        check(cyl_frame(get(), name.c_str(), &index));
        return index;
    }
    std::vector<double> home() const {
        std::vector<double> q(n());
        check(cyl_home(get(), q.data()));
        return q;
    }
    cyl_limits limits(std::size_t i) const {
        cyl_limits out;
        check(cyl_coordinate_limits(get(), i, &out));
        return out;
    }
    cyl_mobility mobility(Numbers q) const {
        cyl_mobility out;
        check(cyl_mobility_at(get(), q.data(), q.size(), &out));
        return out;
    }

   private:
    explicit Mechanism(cyl_mechanism *p) : handle_(p) {}
    detail::Handle<cyl_mechanism, cyl_mechanism_free> handle_;
};

/// A configuration whose forward kinematics was computed.
class State {
   public:
    explicit State(const Mechanism &robot) : n_(robot.n()) {
        cyl_state *p = nullptr;
        check(cyl_state_new(robot.get(), &p));
        handle_.reset(p);
    }
    void set(Numbers q) { check(cyl_state_set(handle_.get(), q.data(), q.size())); }
    Matrix4 pose(std::size_t frame = CYL_DEFAULT_FRAME) const {
        Matrix4 out;
        check(cyl_state_pose(handle_.get(), frame, out.data()));
        return out;
    }
    void jacobian(Out out, std::size_t frame = CYL_DEFAULT_FRAME,
                  cyl_reference reference = CYL_LOCAL_WORLD_ALIGNED) {
        check(cyl_state_jacobian(handle_.get(), frame, reference, out.sized(6 * n_, "jacobian")));
    }
#ifdef CYLINDROID_HAS_EIGEN
    Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(
        std::size_t frame = CYL_DEFAULT_FRAME,
        cyl_reference reference = CYL_LOCAL_WORLD_ALIGNED) {
        Eigen::Matrix<double, 6, Eigen::Dynamic> out(6, static_cast<Eigen::Index>(n_));
        check(cyl_state_jacobian(handle_.get(), frame, reference, out.data()));
        return out;
    }
#endif

   private:
    std::size_t n_;
    detail::Handle<cyl_state, cyl_state_free> handle_;
};

/// Inverse kinematics of one frame.
class InverseKinematics {
   public:
    struct Solution {
        std::vector<double> q;
        cyl_ik_result result;
        std::string reason;
    };
    explicit InverseKinematics(const Mechanism &robot, std::size_t frame = CYL_DEFAULT_FRAME)
        : n_(robot.n()) {
        cyl_ik *p = nullptr;
        check(cyl_ik_new(robot.get(), frame, &p));
        handle_.reset(p);
    }
    Solution solve(const Matrix4 &target, Numbers guess) {
        Solution out{std::vector<double>(n_), {}, {}};
        check(cyl_ik_solve(handle_.get(), target.data(), guess.sized(n_, "guess"), out.q.data(),
                           &out.result));
        out.reason = cyl_ik_reason(handle_.get());
        return out;
    }

   private:
    std::size_t n_;
    detail::Handle<cyl_ik, cyl_ik_free> handle_;
};

/// A Cartesian controller for one frame.
class Servo {
   public:
    explicit Servo(const Mechanism &robot) : Servo(robot, defaults(robot)) {}
    Servo(const Mechanism &robot, const cyl_servo_options &options) : n_(robot.n()) {
        cyl_servo *p = nullptr;
        check(cyl_servo_new(robot.get(), &options, &p));
        handle_.reset(p);
    }
    static cyl_servo_options defaults(const Mechanism &robot) {
        cyl_servo_options out;
        check(cyl_servo_defaults(robot.get(), &out));
        return out;
    }
    cyl_step step(Numbers q, const Matrix4 &target, Out velocities,
                  const double *twist = nullptr) {
        cyl_step out;
        check(cyl_servo_step(handle_.get(), q.data(), q.size(), target.data(), twist,
                             velocities.sized(n_, "velocities"), &out));
        return out;
    }
    cyl_step step_actuated(Numbers actuated, const Matrix4 &target, Out velocities,
                           const double *twist = nullptr) {
        cyl_step out;
        check(cyl_servo_step_actuated(handle_.get(), actuated.data(), actuated.size(),
                                      target.data(), twist, velocities.sized(n_, "velocities"),
                                      &out));
        return out;
    }
    /// A null `command` means that none came in this cycle.
    cyl_step step_twist(Numbers q, const double *command, Out velocities) {
        cyl_step out;
        check(cyl_servo_step_twist(handle_.get(), q.data(), q.size(), command,
                                   velocities.sized(n_, "velocities"), &out));
        return out;
    }
    void advance(Out q) const { check(cyl_servo_advance(handle_.get(), q.sized(n_, "q"), n_)); }
    void reset() { check(cyl_servo_reset(handle_.get())); }
    std::string stall() { return cyl_servo_stall(handle_.get()); }

   private:
    std::size_t n_;
    detail::Handle<cyl_servo, cyl_servo_free> handle_;
};

}  // namespace cylindroid
