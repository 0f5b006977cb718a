/* The C ABI of cylindroid. Generated from crates/cylindroid-c/src; do not edit.
 *
 * Units: m, rad, s, N. Matrices are stored by columns (as Eigen and BLAS do): a pose is the 4 x 4
 * matrix world_from_tool, a Jacobian is 6 x n with the linear rows first, a twist is [v; w].
 * Errors: every function that can fail returns a cyl_status; cyl_last_error() says what happened in
 * words, on the same thread. Results are written only on success. Arrays that are written do not
 * overlap those that are read, unless a function allows it.
 * Threads: a handle is used by one thread at a time; different handles are independent, and a
 * cyl_mechanism may be read by several threads at once.
 * Loop: functions marked "no allocation" neither allocate nor lock on success. */

#ifndef CYLINDROID_H
#define CYLINDROID_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Stands for the tool of a mechanism, or the reference of a closed chain.
#define CYL_DEFAULT_FRAME SIZE_MAX



// The outcome of a call. Numbers never change their meaning; new ones may be added.
typedef enum cyl_status {
  // Done.
  CYL_OK = 0,
  // A null pointer where a value is required, or text that is not UTF-8.
  CYL_NULL_OR_TEXT = 1,
  // A file that cannot be read, or with an error in it.
  CYL_FILE = 2,
  // A joint, frame, method or quantity of this name does not exist; the text has the nearest.
  CYL_UNKNOWN_NAME = 3,
  // An array of another size than expected.
  CYL_DIMENSION = 4,
  // A number that is not finite, or out of range.
  CYL_NOT_FINITE = 5,
  // An option that cannot be used.
  CYL_INVALID_OPTION = 6,
  // A mechanism for which the call makes no sense.
  CYL_MODEL = 7,
  // Another error of the library.
  CYL_OTHER = 8,
  // A defect of the library: please report it. The handle must not be used any more.
  CYL_INTERNAL = 9,
} cyl_status;

// The status of a servo after a step.
typedef enum cyl_servo_status {
  // Moving towards the target, or along the twist.
  CYL_MOVING = 0,
  // The target is reached within tolerance; of a twist: all joints rest, and none is commanded.
  CYL_REACHED = 1,
  // The error no longer falls, or the frame does not move along the twist: cyl_servo_stall().
  CYL_STALLED = 2,
  // No twist is commanded, or the last command is too old: the joints brake.
  CYL_BRAKING = 3,
} cyl_servo_status;

// The axes and the point of a Jacobian.
typedef enum cyl_reference {
  // Axes and origin of the frame.
  CYL_LOCAL = 0,
  // World axes, twist at the world's origin.
  CYL_WORLD = 1,
  // World axes, at the frame's origin.
  CYL_LOCAL_WORLD_ALIGNED = 2,
} cyl_reference;

// Poses, Jacobians and measures of many configurations for one frame.
typedef struct cyl_batch cyl_batch;

// A solver of inverse kinematics for one frame of a tree.
typedef struct cyl_ik cyl_ik;

// A robot or mechanism; immutable.
typedef struct cyl_mechanism cyl_mechanism;

// A Cartesian controller for one frame.
typedef struct cyl_servo cyl_servo;

// A configuration whose forward kinematics was computed.
typedef struct cyl_state cyl_state;

// Limits of coordinates: position, velocity, acceleration, jerk, effort. Infinite if unknown.
typedef struct cyl_limits {
  // Smallest position [rad or m].
  double lower;
  // Largest position [rad or m].
  double upper;
  // Largest speed [rad/s or m/s].
  double velocity;
  // Largest acceleration [rad/s^2 or m/s^2].
  double acceleration;
  // Largest jerk [rad/s^3 or m/s^3].
  double jerk;
  // Largest torque or force [N m or N].
  double effort;
} cyl_limits;

// The result of a solution besides its configuration.
typedef struct cyl_ik_result {
  // True if the target is reached within tolerance, inside all limits.
  bool success;
  // Distance to the target (m).
  double position_error;
  // Angle to the target (rad).
  double orientation_error;
  // Iterations over all restarts.
  size_t iterations;
  // Number of restarts.
  size_t restarts;
} cyl_ik_result;

// Options of a servo; cyl_servo_defaults() fills them in.
typedef struct cyl_servo_options {
  // The frame, an index or CYL_DEFAULT_FRAME.
  size_t frame;
  // The components of the task: x, y, z and the three rotations, in world axes.
  bool components[6];
  // Time between steps (s).
  double dt;
  // Gain of the position error [1/s].
  double gain_position;
  // Gain of the orientation error [1/s].
  double gain_orientation;
  // Position tolerance of a target that is reached (m).
  double tolerance_position;
  // Orientation tolerance (rad).
  double tolerance_orientation;
  // Largest speed of the frame [m/s]; infinite for none.
  double speed_linear;
  // Largest angular speed [rad/s]; infinite for none.
  double speed_angular;
  // Acceleration limit of coordinates without one in the model [rad/s^2 or m/s^2]; 0 for the default
  // ramp (20 rad/s^2, or lengths of the mechanism/s^2), infinite for none.
  double acceleration;
  // Jerk limit of coordinates without one in the model [rad/s^3 or m/s^3]; infinite for none.
  double jerk;
  // Time from a measurement until the drives receive the command computed from it (s).
  double delay;
  // Time constant with which the drives follow their commands (s).
  double time_constant;
  // Largest error of measured positions [rad or m]: joints keep this distance from their position
  // limits, wherever the measurements may place them.
  double noise;
  // Time for which a commanded twist holds without a new one (s); infinite for no watchdog.
  double command_timeout;
  // Characteristic length that scales the linear rows of the Jacobian (m).
  double length;
  // Name of the inverse, as `--inverse` of the command line; null for the default.
  const char *inverse;
} cyl_servo_options;

// The result of a step.
typedef struct cyl_step {
  // Status.
  enum cyl_servo_status status;
  // Distance to the target, in the components of the task (m).
  double position_error;
  // Angle to the target (rad).
  double orientation_error;
  // Time that the frame is behind a moving target (s).
  double lag;
  // Ratio of the smallest to the largest singular value.
  double singular_ratio;
  // The share of the task that the limits permit.
  double scale;
  // The pose of the frame before the step, by columns.
  double pose[16];
} cyl_step;

// The counts of a configuration.
typedef struct cyl_mobility {
  // Degrees of freedom to first order.
  size_t dof;
  // Motions of drives without motion of the reference.
  size_t redundancy;
  // Motions of the reference that the drives do not determine.
  size_t indeterminacy;
  // Zero-torque wrenches.
  size_t zero_torque;
  // Hyperstatic wrenches.
  size_t hyperstatic;
  // Motions of passive joints alone.
  size_t idle;
  // The count of Gruebler and Kutzbach, which may be negative.
  int64_t gruebler_kutzbach;
} cyl_mobility;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The text of the last error of this thread; empty without one. Valid until the next call on this
// thread that fails.
const char *cyl_last_error(void);

// The version of the library, as "0.1.0".
const char *cyl_version(void);

// Loads a model: a file (URDF, MJCF, SDF, mechanism file) or a name of the catalogue.
enum cyl_status cyl_load(const char *name, struct cyl_mechanism **out);

// Loads the text of a model. The path stands for the file: its extension gives the format, and files
// that the text names are looked for beside it.
enum cyl_status cyl_load_text(const char *model,
                              const char *path,
                              struct cyl_mechanism **out);

// The mechanism with the drives of these coordinates or loop joints only.
enum cyl_status cyl_with_actuated(const struct cyl_mechanism *mechanism,
                                  const char *const *names,
                                  size_t count,
                                  struct cyl_mechanism **out);

// Frees a mechanism; null is nothing. States, solvers and servos made of it stay valid.
void cyl_mechanism_free(struct cyl_mechanism *mechanism);

// The name of a mechanism, valid as long as the mechanism; null for null.
const char *cyl_name(const struct cyl_mechanism *mechanism);

// Number of coordinates n; 0 for null.
size_t cyl_n(const struct cyl_mechanism *mechanism);

// Number of actuated coordinates, for `cyl_servo_step_actuated`; 0 for null.
size_t cyl_actuated_count(const struct cyl_mechanism *mechanism);

// Index in q of the i-th actuated coordinate; SIZE_MAX if there is none.
size_t cyl_actuated_index(const struct cyl_mechanism *mechanism, size_t i);

// The name of coordinate i, valid as long as the mechanism; null beyond the last.
const char *cyl_coordinate_name(const struct cyl_mechanism *mechanism, size_t i);

// Number of frames; 0 for null.
size_t cyl_frame_count(const struct cyl_mechanism *mechanism);

// The name of a frame, valid as long as the mechanism; null for an index that does not exist.
const char *cyl_frame_name(const struct cyl_mechanism *mechanism, size_t index);

// The index of the frame of this name.
enum cyl_status cyl_frame(const struct cyl_mechanism *mechanism, const char *name, size_t *index);

// The home configuration, n numbers.
enum cyl_status cyl_home(const struct cyl_mechanism *mechanism, double *q);

// The limits of coordinate i.
enum cyl_status cyl_coordinate_limits(const struct cyl_mechanism *mechanism,
                                      size_t i,
                                      struct cyl_limits *out);

// A state at the home configuration.
enum cyl_status cyl_state_new(const struct cyl_mechanism *mechanism, struct cyl_state **out);

// Frees a state; null is nothing.
void cyl_state_free(struct cyl_state *state);

// Moves a state to a configuration of n coordinates. No allocation.
enum cyl_status cyl_state_set(struct cyl_state *state, const double *q, size_t n);

// world_from_frame as 16 numbers by columns. `frame` is an index or CYL_DEFAULT_FRAME. No allocation.
enum cyl_status cyl_state_pose(const struct cyl_state *state,
                               size_t frame,
                               double *pose);

// The Jacobian of a frame, 6 x n numbers by columns, linear rows first. `reference` is a
// cyl_reference. No allocation.
enum cyl_status cyl_state_jacobian(struct cyl_state *state,
                                   size_t frame,
                                   int32_t reference_number,
                                   double *jacobian);

// A solver for whole poses of a frame, an index or CYL_DEFAULT_FRAME.
enum cyl_status cyl_ik_new(const struct cyl_mechanism *mechanism,
                           size_t frame,
                           struct cyl_ik **out);

// Frees a solver; null is nothing.
void cyl_ik_free(struct cyl_ik *ik);

// The configuration nearest to `guess` (n numbers, or null for the last guess, home at first) at which
// the frame has this pose; without success the closest one found, which is CYL_OK as well:
// `result->success` says it. `q` has n numbers and may be `guess`, `result` may be null.
enum cyl_status cyl_ik_solve(struct cyl_ik *ik,
                             const double *target,
                             const double *guess,
                             double *q,
                             struct cyl_ik_result *result);

// Why the last solution missed its target; empty after success. Valid until the next solution.
const char *cyl_ik_reason(const struct cyl_ik *ik);

// The default options for a mechanism: 1 kHz, gains of 5/s, its tool or reference.
enum cyl_status cyl_servo_defaults(const struct cyl_mechanism *mechanism,
                                   struct cyl_servo_options *options);

// A servo at rest. `options` may be null for the defaults.
enum cyl_status cyl_servo_new(const struct cyl_mechanism *mechanism,
                              const struct cyl_servo_options *options,
                              struct cyl_servo **out);

// Frees a servo; null is nothing.
void cyl_servo_free(struct cyl_servo *servo);

// One step towards a pose: `q` has n numbers, `target` 16, `target_twist` six (world axes, at the
// frame) or is null for a target at rest; `velocities` takes the n joint velocities to command until the
// next step; `step` may be null. No allocation (closed chains: away from type II singularities).
enum cyl_status cyl_servo_step(struct cyl_servo *servo,
                               const double *q,
                               size_t n,
                               const double *target,
                               const double *target_twist,
                               double *velocities,
                               struct cyl_step *step);

// One step of a closed chain whose drives alone are measured: `actuated` has
// cyl_actuated_count() positions; the passive coordinates are tracked. The rest as cyl_servo_step().
enum cyl_status cyl_servo_step_actuated(struct cyl_servo *servo,
                                        const double *actuated,
                                        size_t count,
                                        const double *target,
                                        const double *target_twist,
                                        double *velocities,
                                        struct cyl_step *step);

// One step along a twist (six numbers, world axes, at the frame), or null if no command came in this
// cycle: after the time `command_timeout` the joints brake. The rest as cyl_servo_step().
enum cyl_status cyl_servo_step_twist(struct cyl_servo *servo,
                                     const double *q,
                                     size_t n,
                                     const double *command,
                                     double *velocities,
                                     struct cyl_step *step);

// cyl_servo_step_twist() of a closed chain whose drives alone are measured, as
// cyl_servo_step_actuated() takes them.
enum cyl_status cyl_servo_step_twist_actuated(struct cyl_servo *servo,
                                              const double *actuated,
                                              size_t count,
                                              const double *command,
                                              double *velocities,
                                              struct cyl_step *step);

// Resets a servo to rest.
enum cyl_status cyl_servo_reset(struct cyl_servo *servo);

// Integrates `q` (n numbers) by the velocities of the last step, for the simulation of an ideal robot.
enum cyl_status cyl_servo_advance(const struct cyl_servo *servo,
                                  double *q,
                                  size_t n);

// How far the loops of a closed chain are open at the configuration of the last step: `distance` (m)
// and `angle` (rad), zero without loops; near a type II singularity they are not closed. Either may be
// null. Allocates.
enum cyl_status cyl_servo_closure_error(const struct cyl_servo *servo,
                                        double *distance,
                                        double *angle);

// The kind of reason why the last step made no progress: "singular", "limits", "out of reach", ...
// Valid until the next call with this servo. Allocates.
const char *cyl_servo_stall(struct cyl_servo *servo);

// A batch for a frame, an index or CYL_DEFAULT_FRAME.
enum cyl_status cyl_batch_new(const struct cyl_mechanism *mechanism,
                              size_t frame,
                              struct cyl_batch **out);

// Frees a batch; null is nothing.
void cyl_batch_free(struct cyl_batch *batch);

// Number of measures of a configuration.
size_t cyl_measure_count(void);

// The place of a measure ("dof", "volume", ...) in those of a configuration.
enum cyl_status cyl_measure_index(const char *name, size_t *index);

// Poses of N configurations (N x n numbers in `q`): 16 numbers by columns for each in `poses`.
enum cyl_status cyl_batch_poses(const struct cyl_batch *batch,
                                const double *q,
                                size_t count,
                                double *poses);

// Jacobians of N configurations: 6 x n numbers by columns for each. `reference` is a cyl_reference.
enum cyl_status cyl_batch_jacobians(const struct cyl_batch *batch,
                                    const double *q,
                                    size_t count,
                                    int32_t reference_number,
                                    double *jacobians);

// Counts of mobility, distances to singularities and kinematic manipulability of N configurations:
// cyl_measure_count() numbers for each.
enum cyl_status cyl_batch_measures(const struct cyl_batch *batch,
                                   const double *q,
                                   size_t count,
                                   double *measures);

// The mobility at a configuration of n coordinates, at which all loops are closed.
enum cyl_status cyl_mobility_at(const struct cyl_mechanism *mechanism,
                                const double *q,
                                size_t n,
                                struct cyl_mobility *out);

// An inverse of an m x n matrix by columns, by a method of the command line ("truncated", "damped",
// ...) with its default parameters: n x m numbers by columns in `out`, which may be `matrix`; the rank
// in `rank`, which may be null.
enum cyl_status cyl_inverse(const double *matrix,
                            size_t rows,
                            size_t cols,
                            const char *method,
                            double *out,
                            size_t *rank);

// The hyperbolic pseudoinverse of a 6 x n matrix of twists (linear rows first) for the pitch h
// [m/rad]: n x 6 numbers by columns in `out`, which may be `jacobian`, if it exists.
enum cyl_status cyl_hyperbolic(const double *jacobian,
                               size_t cols,
                               double h,
                               bool *exists,
                               double *out);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* CYLINDROID_H */
