/* A panda moves its hand by 10 cm, in C: every function of the header is called once, errors as well. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cylindroid.h"

#define CHECK(call)                                                        \
    do {                                                                   \
        if ((call) != CYL_OK) {                                            \
            fprintf(stderr, "line %d: %s\n", __LINE__, cyl_last_error()); \
            exit(1);                                                       \
        }                                                                  \
    } while (0)

#define EXPECT(truth)                                             \
    do {                                                          \
        if (!(truth)) {                                           \
            fprintf(stderr, "line %d: %s\n", __LINE__, #truth); \
            exit(1);                                              \
        }                                                         \
    } while (0)

static void errors(const cyl_mechanism *robot) {
    cyl_mechanism *none = NULL;
    EXPECT(cyl_load("pandaa", &none) != CYL_OK && none == NULL);
    EXPECT(strstr(cyl_last_error(), "panda") != NULL);
    EXPECT(cyl_load(NULL, &none) == CYL_NULL_OR_TEXT);
    EXPECT(cyl_load("panda", NULL) == CYL_NULL_OR_TEXT);
    EXPECT(cyl_load("\xff\xfe", &none) == CYL_NULL_OR_TEXT);
    size_t index = 7;
    EXPECT(cyl_frame(robot, "hand_tpc", &index) == CYL_UNKNOWN_NAME && index == 7);
    EXPECT(strstr(cyl_last_error(), "hand_tcp") != NULL);
    cyl_state *state = NULL;
    CHECK(cyl_state_new(robot, &state));
    double q[7] = {0.0}, pose[16];
    EXPECT(cyl_state_set(state, q, 6) == CYL_DIMENSION);
    EXPECT(cyl_state_set(state, q, SIZE_MAX) == CYL_DIMENSION);
    q[3] = NAN;
    EXPECT(cyl_state_set(state, q, 7) == CYL_NOT_FINITE);
    EXPECT(cyl_state_pose(state, 100000, pose) == CYL_UNKNOWN_NAME);
    double jacobian[42];
    EXPECT(cyl_state_jacobian(state, CYL_DEFAULT_FRAME, 9, jacobian) == CYL_INVALID_OPTION);
    EXPECT(cyl_state_pose(NULL, CYL_DEFAULT_FRAME, pose) == CYL_NULL_OR_TEXT);
    cyl_state_free(state);
    cyl_servo_options options;
    CHECK(cyl_servo_defaults(robot, &options));
    options.dt = -1.0;
    cyl_servo *servo = NULL;
    EXPECT(cyl_servo_new(robot, &options, &servo) == CYL_INVALID_OPTION && servo == NULL);
    options.dt = 1e-3;
    options.inverse = "hyperboolic";
    EXPECT(cyl_servo_new(robot, &options, &servo) == CYL_UNKNOWN_NAME);
    cyl_mechanism_free(NULL);
    cyl_state_free(NULL);
    cyl_servo_free(NULL);
    cyl_ik_free(NULL);
    cyl_batch_free(NULL);
    EXPECT(cyl_name(NULL) == NULL && cyl_n(NULL) == 0);
}

static void closed_chain(void) {
    cyl_mechanism *stewart = NULL;
    CHECK(cyl_load("stewart", &stewart));
    size_t n = cyl_n(stewart), drives = cyl_actuated_count(stewart);
    double *q = malloc(n * sizeof *q), *velocities = malloc(n * sizeof *q), legs[6], target[16];
    EXPECT(drives == 6);
    CHECK(cyl_home(stewart, q));
    cyl_mobility mobility;
    CHECK(cyl_mobility_at(stewart, q, n, &mobility));
    EXPECT(mobility.dof == 6 && mobility.redundancy == 0 && mobility.indeterminacy == 0);
    cyl_state *state = NULL;
    CHECK(cyl_state_new(stewart, &state));
    CHECK(cyl_state_pose(state, CYL_DEFAULT_FRAME, target));
    target[14] += 0.02;
    cyl_servo *servo = NULL;
    CHECK(cyl_servo_new(stewart, NULL, &servo));
    for (size_t i = 0; i < drives; i++) legs[i] = q[cyl_actuated_index(stewart, i)];
    cyl_step step = {0};
    int steps = 0;
    do {
        CHECK(cyl_servo_step_actuated(servo, legs, drives, target, NULL, velocities, &step));
        for (size_t i = 0; i < drives; i++)
            legs[i] += 1e-3 * velocities[cyl_actuated_index(stewart, i)];
    } while (step.status == CYL_MOVING && ++steps < 5000);
    EXPECT(step.status == CYL_REACHED);
    printf("stewart: reached after %d steps, %.1e m\n", steps, step.position_error);
    double twist[6] = {0.0, 0.0, -0.02, 0.0, 0.0, 0.1};
    CHECK(cyl_servo_reset(servo));
    for (int k = 0; k < 2300 && (k < 300 || step.status != CYL_REACHED); k++) {
        const double *command = k < 300 ? twist : NULL;
        CHECK(cyl_servo_step_twist_actuated(servo, legs, drives, command, velocities, &step));
        EXPECT(k >= 300 || step.status == CYL_MOVING);
        for (size_t i = 0; i < drives; i++)
            legs[i] += 1e-3 * velocities[cyl_actuated_index(stewart, i)];
    }
    EXPECT(step.status == CYL_REACHED && step.pose[14] < target[14] - 0.005);
    EXPECT(cyl_servo_step_twist_actuated(servo, legs, 3, twist, velocities, &step) != CYL_OK);
    double open[2] = {1.0, 1.0};
    CHECK(cyl_servo_closure_error(servo, &open[0], &open[1]));
    EXPECT(open[0] < 1e-9 && open[1] < 1e-9);
    CHECK(cyl_servo_closure_error(servo, NULL, NULL));
    cyl_servo_free(servo);
    cyl_state_free(state);
    free(velocities);
    free(q);
    cyl_mechanism_free(stewart);
}

int main(void) {
    cyl_mechanism *robot = NULL;
    CHECK(cyl_load("panda", &robot));
    printf("cylindroid %s: %s, n = %zu, tool %s\n", cyl_version(), cyl_name(robot), cyl_n(robot),
           cyl_frame_name(robot, CYL_DEFAULT_FRAME));
    EXPECT(cyl_n(robot) == 7 && strcmp(cyl_coordinate_name(robot, 0), "panda_joint1") == 0);
    EXPECT(cyl_coordinate_name(robot, 7) == NULL && cyl_frame_name(robot, 100000) == NULL);
    size_t hand = 0;
    CHECK(cyl_frame(robot, "hand_tcp", &hand));
    EXPECT(strcmp(cyl_frame_name(robot, hand), "hand_tcp") == 0 && hand < cyl_frame_count(robot));
    cyl_limits limits;
    CHECK(cyl_coordinate_limits(robot, 3, &limits));
    EXPECT(limits.lower < limits.upper && limits.upper < 0.0 && isinf(limits.jerk));

    double q[7] = {0.3, -0.4, 0.1, -2.0, 0.2, 1.7, 0.5}, target[16], jacobian[42], velocities[7];
    cyl_state *state = NULL;
    CHECK(cyl_state_new(robot, &state));
    CHECK(cyl_state_set(state, q, 7));
    CHECK(cyl_state_pose(state, CYL_DEFAULT_FRAME, target));
    CHECK(cyl_state_jacobian(state, CYL_DEFAULT_FRAME, CYL_LOCAL_WORLD_ALIGNED, jacobian));
    /* The first joint turns about the vertical through the origin: v = z x p. */
    EXPECT(fabs(jacobian[0] + target[13]) < 1e-12 && fabs(jacobian[1] - target[12]) < 1e-12);
    EXPECT(fabs(jacobian[5] - 1.0) < 1e-12);

    double inverse[42];
    size_t rank = 0;
    CHECK(cyl_inverse(jacobian, 6, 7, "truncated", inverse, &rank));
    double in_place[42];
    memcpy(in_place, jacobian, sizeof in_place);
    CHECK(cyl_inverse(in_place, 6, 7, "truncated", in_place, NULL));
    EXPECT(memcmp(in_place, inverse, sizeof in_place) == 0);
    EXPECT(rank == 6);
    double one = 0.0; /* (J J+)[0, 0] */
    for (int k = 0; k < 7; k++) one += jacobian[6 * k] * inverse[k];
    EXPECT(fabs(one - 1.0) < 1e-10);
    bool exists = false;
    CHECK(cyl_hyperbolic(jacobian, 3, 0.2, &exists, inverse));
    EXPECT(exists);

    cyl_batch *batch = NULL;
    CHECK(cyl_batch_new(robot, CYL_DEFAULT_FRAME, &batch));
    double rows[14], poses[32], jacobians[84];
    memcpy(rows, q, sizeof q);
    memcpy(rows + 7, q, sizeof q);
    CHECK(cyl_batch_poses(batch, rows, 2, poses));
    CHECK(cyl_batch_jacobians(batch, rows, 2, CYL_LOCAL_WORLD_ALIGNED, jacobians));
    for (int i = 0; i < 16; i++) EXPECT(fabs(poses[16 + i] - target[i]) < 1e-12);
    for (int i = 0; i < 42; i++) EXPECT(fabs(jacobians[42 + i] - jacobian[i]) < 1e-12);
    double *measures = malloc(2 * cyl_measure_count() * sizeof *measures);
    size_t dof = 0;
    CHECK(cyl_measure_index("dof", &dof));
    CHECK(cyl_batch_measures(batch, rows, 2, measures));
    EXPECT(measures[dof] == 7.0);
    EXPECT(cyl_batch_poses(batch, rows, SIZE_MAX / 4, poses) == CYL_DIMENSION);
    EXPECT(cyl_batch_jacobians(batch, rows, SIZE_MAX / 32, 0, jacobians) == CYL_DIMENSION);
    EXPECT(cyl_inverse(jacobian, SIZE_MAX, 2, "truncated", inverse, NULL) == CYL_DIMENSION);
    EXPECT(cyl_measure_index("doff", &dof) == CYL_UNKNOWN_NAME);
    free(measures);
    cyl_batch_free(batch);

    target[12] += 0.06;
    target[14] += 0.08;
    cyl_ik *ik = NULL;
    cyl_ik_result result;
    double solution[7];
    CHECK(cyl_ik_new(robot, CYL_DEFAULT_FRAME, &ik));
    CHECK(cyl_ik_solve(ik, target, q, solution, &result));
    EXPECT(result.success && result.position_error < 1e-5 && *cyl_ik_reason(ik) == '\0');
    double far[16];
    memcpy(far, target, sizeof far);
    far[12] += 10.0;
    CHECK(cyl_ik_solve(ik, target, solution, solution, &result)); /* in place */
    EXPECT(cyl_ik_solve(ik, target, q, NULL, &result) == CYL_NULL_OR_TEXT);
    CHECK(cyl_ik_solve(ik, far, q, solution, &result));
    EXPECT(!result.success && *cyl_ik_reason(ik) != '\0');
    printf("far target: %s\n", cyl_ik_reason(ik));
    cyl_ik_free(ik);

    cyl_servo_options options;
    CHECK(cyl_servo_defaults(robot, &options));
    options.jerk = 500.0;
    options.inverse = "damped";
    cyl_servo *servo = NULL;
    CHECK(cyl_servo_new(robot, &options, &servo));
    cyl_step step = {0};
    int steps = 0;
    do {
        CHECK(cyl_servo_step(servo, q, 7, target, NULL, velocities, &step));
        CHECK(cyl_servo_advance(servo, q, 7)); /* a robot would be commanded the velocities */
    } while (step.status == CYL_MOVING && ++steps < 20000);
    EXPECT(step.status == CYL_REACHED);
    printf("panda: reached after %d steps, %.1e m\n", steps, step.position_error);
    double twist[6] = {0.05, 0.0, 0.0, 0.0, 0.0, 0.0};
    CHECK(cyl_servo_reset(servo));
    for (int i = 0; i < 200; i++) {
        CHECK(cyl_servo_step_twist(servo, q, 7, twist, velocities, &step));
        CHECK(cyl_servo_advance(servo, q, 7));
    }
    EXPECT(step.status == CYL_MOVING);
    for (int i = 0; i < 2000 && step.status != CYL_REACHED; i++) {
        CHECK(cyl_servo_step_twist(servo, q, 7, NULL, velocities, &step));
        CHECK(cyl_servo_advance(servo, q, 7));
    }
    EXPECT(step.status == CYL_REACHED); /* the watchdog stopped it */
    CHECK(cyl_servo_step(servo, q, 7, far, NULL, velocities, &step));
    EXPECT(cyl_servo_stall(servo) != NULL);
    cyl_servo_free(servo);
    cyl_state_free(state);

    errors(robot);
    closed_chain();
    const char *drive = "q1";
    cyl_mechanism *five_bar = NULL, *driven = NULL;
    CHECK(cyl_load("five-bar", &five_bar));
    CHECK(cyl_with_actuated(five_bar, &drive, 1, &driven));
    EXPECT(cyl_actuated_count(driven) == 1);
    cyl_mechanism_free(driven);
    cyl_mechanism_free(five_bar);
    CHECK(cyl_load_text("name = \"slider\"\n[[joint]]\nname = \"s\"\ntype = \"prismatic\"\n"
                        "between = [\"ground\", \"a\"]\naxis = [1, 0, 0]\n",
                        "slider.toml", &five_bar));
    EXPECT(cyl_n(five_bar) == 1);
    cyl_mechanism_free(five_bar);
    cyl_mechanism_free(robot);
    return 0;
}
