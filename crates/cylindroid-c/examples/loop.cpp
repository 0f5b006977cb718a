// A loop of fixed period in C++17: a panda follows a circle, and the times of the steps are printed.
//
//     loop [STEPS] [PERIOD]      PERIOD in ms: waits for each step; otherwise as fast as it can
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <thread>

#if __has_include(<span>) && __cplusplus >= 202002L
#include <span>
#endif

#include "cylindroid.hpp"

namespace {

double largest_difference(const std::vector<double> &a, const std::vector<double> &b) {
    double most = a.size() == b.size() ? 0.0 : INFINITY;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); i++) {
        const double difference = std::abs(a[i] - b[i]);
        if (!(difference <= most)) most = difference;  // NaN as well
    }
    return most;
}

/// True if batches, inverses and views agree with what one state gives.
bool agree(const cylindroid::Mechanism &robot, cylindroid::State &state,
           const std::vector<double> &q) {
    const std::size_t n = robot.n();
    const cylindroid::Batch batch(robot);
    std::vector<double> poses(16), jacobian(6 * n), jacobians(6 * n), inverse(6 * n), back(6 * n);
    std::vector<double> measures(cylindroid::Batch::measure_count());
    batch.poses(q, poses);
    batch.jacobians(q, jacobians);
    batch.measures(q, measures);
    state.set(q);
    state.jacobian(jacobian);
    const cylindroid::Matrix4 pose = state.pose();
    if (!(largest_difference(jacobians, jacobian) <= 1e-14)) return false;
    if (!(largest_difference(poses, {pose.begin(), pose.end()}) <= 1e-14)) return false;
    if (measures[cylindroid::Batch::measure("dof")] != static_cast<double>(n)) return false;
    // The inverse of the inverse is the Jacobian.
    if (cylindroid::inverse(jacobian, 6, n, "truncated", inverse) != 6) return false;
    if (cylindroid::inverse(inverse, n, 6, "truncated", back) != 6) return false;
    if (!(largest_difference(back, jacobian) <= 1e-12)) return false;
    if (!cylindroid::hyperbolic_pseudoinverse(jacobian, 0.3, inverse)) return false;
#ifdef __cpp_lib_span
    state.jacobian(std::span(back));
    batch.jacobians(std::span<const double>(q), std::span(back).first(6 * n));
    if (back != jacobians) return false;
#endif
#ifdef CYLINDROID_HAS_EIGEN
    Eigen::Matrix<double, 6, Eigen::Dynamic> own = state.jacobian();
    Eigen::MatrixXd whole(8, n);
    try {
        state.jacobian(whole.topRows<6>());  // other numbers lie between its columns
        return false;
    } catch (const cylindroid::Error &) {
    }
    try {
        Eigen::MatrixXd turned(static_cast<Eigen::Index>(n), 6);
        state.jacobian(turned);  // of the same size
        return false;
    } catch (const cylindroid::Error &) {
    }
    state.jacobian(Eigen::Map<Eigen::MatrixXd>(back.data(), 6, static_cast<Eigen::Index>(n)));
    if (back != jacobian || largest_difference({own.data(), own.data() + own.size()}, back) != 0.0)
        return false;
    if (cylindroid::as_eigen(pose)(2, 3) != pose[14]) return false;
    const Eigen::VectorXd place = Eigen::Map<const Eigen::VectorXd>(q.data(), q.size());
    state.set(place);
#endif
    return true;
}

}  // namespace

int main(int argc, char **argv) {
    const int steps = argc > 1 ? std::atoi(argv[1]) : 5000;
    const std::chrono::duration<double, std::milli> period(argc > 2 ? std::atof(argv[2]) : 0.0);
    auto robot = cylindroid::Mechanism::load("panda");
    cylindroid::State state(robot);
    std::vector<double> q{0.3, -0.4, 0.1, -2.0, 0.2, 1.7, 0.5}, velocities(robot.n());
    state.set(q);
    cylindroid::Matrix4 target = state.pose();
    const cylindroid::Matrix4 start = target;
    auto options = cylindroid::Servo::defaults(robot);
    options.gain_position = options.gain_orientation = 20.0;
    cylindroid::Servo servo(robot, options);

    std::vector<double> times(static_cast<std::size_t>(steps));
    double worst = 0.0, latest = 0.0, twist[6] = {};
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    for (int k = 0; k < steps; k++) {
        if (period.count() > 0.0) {
            const auto due = begin + std::chrono::duration_cast<Clock::duration>(k * period);
            std::this_thread::sleep_until(due);
            const std::chrono::duration<double, std::micro> late = Clock::now() - due;
            latest = std::max(latest, late.count());
        }
        const double t = k * options.dt, w = 2.0, r = 0.05;
        const double ramp = std::min(1.0, t);  // its radius grows, so that it begins at rest
        target[12] = start[12] + ramp * r * (std::cos(w * t) - 1.0);
        target[13] = start[13] + ramp * r * std::sin(w * t);
        twist[0] = -ramp * r * w * std::sin(w * t) + (t < 1.0 ? r * (std::cos(w * t) - 1.0) : 0.0);
        twist[1] = ramp * r * w * std::cos(w * t) + (t < 1.0 ? r * std::sin(w * t) : 0.0);
        const auto before = Clock::now();
        const cyl_step step = servo.step(q, target, velocities, twist);
        const auto after = Clock::now();
        times[static_cast<std::size_t>(k)] =
            std::chrono::duration<double, std::micro>(after - before).count();
        servo.advance(q);
        if (t > 2.0 && !(step.position_error <= worst)) worst = step.position_error;
    }
    std::sort(times.begin(), times.end());
    std::printf("median %.3f us, 99.9 %% %.2f us, largest error %.1e m\n", times[times.size() / 2],
                times[times.size() - 1 - times.size() / 1000], worst);

    if (period.count() > 0.0)
        std::printf("every %.3g ms: largest step %.1f us, begun %.1f us late at most\n",
                    period.count(), times.back(), latest);

    cylindroid::InverseKinematics ik(robot);
    const auto found = ik.solve(start, q);
    if (!found.result.success || !(worst < 1e-4)) return 1;
    if (!agree(robot, state, q)) return 1;
    try {
        servo.step(std::vector<double>(6), target, velocities);
        return 1;
    } catch (const cylindroid::Error &error) {
        if (error.status() != CYL_DIMENSION) return 1;
        std::printf("refused: %s\n", error.what());
    }
    try {
        cylindroid::Mechanism::load("nothing.urdf");
        return 1;
    } catch (const cylindroid::Error &error) {
        std::printf("refused: %s\n", error.what());
    }
    return 0;
}
