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
#include <type_traits>
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

namespace detail {
template <class T>
using RemoveConstReference = std::remove_const_t<std::remove_reference_t<T>>;

template <class C, class = void>
struct HasStrides : std::false_type {};
template <class C>
struct HasStrides<C, std::void_t<decltype(std::declval<const C &>().innerStride())>>
    : std::true_type {};

/// Containers whose elements follow each other; matrices by columns. Of Eigen, blocks and rows of
/// matrices may leave gaps: they are refused, as matrices by rows are by the compiler.
template <class C>
std::size_t contiguous_size(const C &c) {
    if constexpr (HasStrides<C>::value) {
        static_assert(C::IsVectorAtCompileTime || !C::IsRowMajor,
                      "matrices of cylindroid lie by columns: use Eigen::ColMajor");
        const bool follows = c.innerStride() == 1 && (C::IsVectorAtCompileTime || c.cols() <= 1 ||
                                                      c.outerStride() == c.rows());
        if (!follows && c.size() > 1)
            throw Error(CYL_DIMENSION, "the numbers do not lie one after the other: copy the block");
    }
    return static_cast<std::size_t>(c.size());
}

/// The rows of a matrix of Eigen; 0 of what has no shape.
template <class C>
std::size_t rows_of(const C &c) {
    if constexpr (HasStrides<C>::value) {
        if constexpr (!C::IsVectorAtCompileTime) return static_cast<std::size_t>(c.rows());
    }
    return 0;
}

/// Refuses matrices of another size or shape.
inline void check_shape(std::size_t size, std::size_t own_rows, std::size_t rows, std::size_t cols,
                        const char *what) {
    if (size == rows * cols && (own_rows == 0 || own_rows == rows)) return;
    const std::string found =
        own_rows == 0 || size == 0
            ? std::to_string(size) + " entries"
            : std::to_string(own_rows) + " x " + std::to_string(size / own_rows) + " entries";
    throw Error(CYL_DIMENSION, (std::string(what) + " has " + found + ", expected " +
                                std::to_string(rows) + " x " + std::to_string(cols))
                                   .c_str());
}

template <class C>
using Data = decltype(std::declval<C &>().data());

/// A view may be passed as it is made; a container that would be gone with its numbers may not.
template <class C, class = void>
struct IsView : std::false_type {};
template <class C>
struct IsView<C, std::enable_if_t<!HasStrides<C>::value &&
                                  std::is_same_v<decltype(std::declval<const C &>().data()),
                                                 double *>>> : std::true_type {};
#ifdef CYLINDROID_HAS_EIGEN
template <class M, int Options, class Stride>
struct IsView<Eigen::Map<M, Options, Stride>> : std::true_type {};
template <class M, int Options, class Stride>
struct IsView<Eigen::Ref<M, Options, Stride>> : std::true_type {};
template <class M, int Rows, int Cols, bool Inner>
struct IsView<Eigen::Block<M, Rows, Cols, Inner>> : std::true_type {};
template <class V, int Size>
struct IsView<Eigen::VectorBlock<V, Size>> : std::true_type {};
#endif
}  // namespace detail

/// Numbers that belong to somebody else: of std::vector, std::array, std::span, Eigen.
class Numbers {
   public:
    Numbers(const double *data, std::size_t size) : data_(data), size_(size) {}
    template <class Container,
              class = std::enable_if_t<
                  std::is_convertible_v<detail::Data<const Container>, const double *>>>
    Numbers(const Container &c)
        : data_(c.data()), size_(detail::contiguous_size(c)), rows_(detail::rows_of(c)) {}
    const double *data() const noexcept { return data_; }
    std::size_t size() const noexcept { return size_; }
    const double *sized(std::size_t expected, const char *what) const {
        if (size_ != expected)
            throw Error(CYL_DIMENSION, (std::string(what) + " has " + std::to_string(size_) +
                                        " entries, expected " + std::to_string(expected))
                                           .c_str());
        return data_;
    }
    /// Of a matrix by columns.
    const double *shaped(std::size_t rows, std::size_t cols, const char *what) const {
        detail::check_shape(size_, rows_, rows, cols, what);
        return data_;
    }

   private:
    const double *data_;
    std::size_t size_;
    std::size_t rows_ = 0;
};

/// The same, to be written to: containers that have a name, and views.
class Out {
   public:
    Out(double *data, std::size_t size) : data_(data), size_(size) {}
    template <class Container, class C = detail::RemoveConstReference<Container>,
              class = std::enable_if_t<
                  !std::is_same_v<C, Out> &&
                  (std::is_lvalue_reference_v<Container> || detail::IsView<C>::value) &&
                  std::is_same_v<detail::Data<std::remove_reference_t<Container>>, double *>>>
    Out(Container &&c)
        : data_(c.data()), size_(detail::contiguous_size(c)), rows_(detail::rows_of(c)) {}
    double *sized(std::size_t expected, const char *what) const {
        Numbers(data_, size_).sized(expected, what);
        return data_;
    }
    /// Of a matrix by columns.
    double *shaped(std::size_t rows, std::size_t cols, const char *what) const {
        detail::check_shape(size_, rows_, rows, cols, what);
        return data_;
    }

   private:
    double *data_;
    std::size_t size_;
    std::size_t rows_ = 0;
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

#ifdef CYLINDROID_HAS_EIGEN
/// A pose as a matrix of Eigen, without a copy.
inline Eigen::Map<Eigen::Matrix4d> as_eigen(Matrix4 &pose) {
    return Eigen::Map<Eigen::Matrix4d>(pose.data());
}
inline Eigen::Map<const Eigen::Matrix4d> as_eigen(const Matrix4 &pose) {
    return Eigen::Map<const Eigen::Matrix4d>(pose.data());
}
#endif

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
        check(cyl_state_jacobian(handle_.get(), frame, reference, out.shaped(6, n_, "jacobian")));
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
    cyl_step step_twist_actuated(Numbers actuated, const double *command, Out velocities) {
        cyl_step out;
        check(cyl_servo_step_twist_actuated(handle_.get(), actuated.data(), actuated.size(),
                                            command, velocities.sized(n_, "velocities"), &out));
        return out;
    }
    void advance(Out q) const { check(cyl_servo_advance(handle_.get(), q.sized(n_, "q"), n_)); }
    void reset() { check(cyl_servo_reset(handle_.get())); }
    std::string stall() { return cyl_servo_stall(handle_.get()); }
    /// How far the loops are open at the configuration of the last step: distance (m), angle (rad).
    std::array<double, 2> closure_error() const {
        std::array<double, 2> out;
        check(cyl_servo_closure_error(handle_.get(), &out[0], &out[1]));
        return out;
    }

   private:
    std::size_t n_;
    detail::Handle<cyl_servo, cyl_servo_free> handle_;
};

/// Many configurations of one frame at once.
class Batch {
   public:
    explicit Batch(const Mechanism &robot, std::size_t frame = CYL_DEFAULT_FRAME) : n_(robot.n()) {
        cyl_batch *p = nullptr;
        check(cyl_batch_new(robot.get(), frame, &p));
        handle_.reset(p);
    }
    /// Numbers of a configuration that `measures` writes.
    static std::size_t measure_count() noexcept { return cyl_measure_count(); }
    /// The place of a measure among them, by its name ("dof", "volume", ...).
    static std::size_t measure(const std::string &name) {
        std::size_t index = 0;
        check(cyl_measure_index(name.c_str(), &index));
        return index;
    }
    /// Poses of N configurations of n numbers each: 16 numbers by columns for each.
    void poses(Numbers q, Out out) const {
        const std::size_t count = count_of(q);
        check(cyl_batch_poses(handle_.get(), q.data(), count, out.sized(16 * count, "poses")));
    }
    /// Jacobians, 6 x n by columns for each.
    void jacobians(Numbers q, Out out, cyl_reference reference = CYL_LOCAL_WORLD_ALIGNED) const {
        const std::size_t count = count_of(q);
        check(cyl_batch_jacobians(handle_.get(), q.data(), count, reference,
                                  out.sized(6 * n_ * count, "jacobians")));
    }
    void measures(Numbers q, Out out) const {
        const std::size_t count = count_of(q);
        check(cyl_batch_measures(handle_.get(), q.data(), count,
                                 out.sized(measure_count() * count, "measures")));
    }

   private:
    /// Robots without joints have no configurations to count.
    std::size_t count_of(Numbers q) const {
        const std::size_t count = n_ == 0 ? 0 : q.size() / n_;
        q.sized(count * n_, "q");
        return count;
    }
    std::size_t n_;
    detail::Handle<cyl_batch, cyl_batch_free> handle_;
};

/// An inverse of a matrix by columns, by a method of the command line ("truncated", "damped", ...):
/// n x m numbers by columns. Returns the rank.
inline std::size_t inverse(Numbers matrix, std::size_t rows, std::size_t cols,
                           const std::string &method, Out out) {
    std::size_t rank = 0;
    check(cyl_inverse(matrix.shaped(rows, cols, "matrix"), rows, cols, method.c_str(),
                      out.shaped(cols, rows, "inverse"), &rank));
    return rank;
}

/// The hyperbolic pseudoinverse of a 6 x n matrix of twists (linear rows first) for the pitch h
/// [m/rad]: n x 6 numbers by columns. False if it does not exist.
inline bool hyperbolic_pseudoinverse(Numbers jacobian, double h, Out out) {
    const std::size_t cols = jacobian.size() / 6;
    bool exists = false;
    check(cyl_hyperbolic(jacobian.shaped(6, cols, "jacobian"), cols, h, &exists,
                         out.shaped(cols, 6, "inverse")));
    return exists;
}

}  // namespace cylindroid
