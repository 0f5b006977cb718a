// A loop of fixed period in C++17: a panda follows a circle, and the times of the steps are printed.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "cylindroid.hpp"

int main(int argc, char **argv) {
    const int steps = argc > 1 ? std::atoi(argv[1]) : 5000;
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
    double worst = 0.0, twist[6] = {};
    for (int k = 0; k < steps; k++) {
        const double t = k * options.dt, w = 2.0, r = 0.05;
        const double ramp = std::min(1.0, t);  // its radius grows, so that it begins at rest
        target[12] = start[12] + ramp * r * (std::cos(w * t) - 1.0);
        target[13] = start[13] + ramp * r * std::sin(w * t);
        twist[0] = -ramp * r * w * std::sin(w * t) + (t < 1.0 ? r * (std::cos(w * t) - 1.0) : 0.0);
        twist[1] = ramp * r * w * std::cos(w * t) + (t < 1.0 ? r * std::sin(w * t) : 0.0);
        const auto before = std::chrono::steady_clock::now();
        const cyl_step step = servo.step(q, target, velocities, twist);
        const auto after = std::chrono::steady_clock::now();
        times[static_cast<std::size_t>(k)] =
            std::chrono::duration<double, std::micro>(after - before).count();
        servo.advance(q);
        if (t > 2.0) worst = std::max(worst, step.position_error);
    }
    std::sort(times.begin(), times.end());
    std::printf("median %.2f us, 99.9 %% %.2f us, largest error %.1e m\n", times[times.size() / 2],
                times[times.size() - 1 - times.size() / 1000], worst);

    cylindroid::InverseKinematics ik(robot);
    const auto found = ik.solve(start, q);
    if (!found.result.success || !(worst < 1e-4)) return 1;
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
