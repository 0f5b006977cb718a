# %% [markdown]
# # A 5-joint arm
#
# Where code written for six joints breaks.
#
# Its Jacobian is 6 x 5: it has no inverse, and the pseudoinverse of a matrix that mixes metres and
# radians gives other rates in other units. Here is what to do instead.

# %%
import numpy as np

import cylindroid as cy

robot = cy.load("youbot")
q = robot.home + [0.1, 0.4, -0.8, 0.6, 0.2]
J = robot.jacobian(q)
print("Jacobian", J.shape, "of rank", np.linalg.matrix_rank(J))
try:
    np.linalg.inv(J)
except np.linalg.LinAlgError as error:
    print("numpy:", error)

# %% [markdown]
# A desired twist that five joints cannot realise: sideways translation and rotation.

# %%
twist = np.array([0.05, 0.02, 0.0, 0.2, 0.1, 0.1])
millimetres = np.diag([1000.0, 1000.0, 1000.0, 1.0, 1.0, 1.0])

# %% [markdown]
# The pseudoinverse answers with other joint velocities when metres become millimetres ...

# %%
in_m = cy.pinv(J, 1e-9).matrix @ twist
in_mm = cy.pinv(millimetres @ J, 1e-9).matrix @ (millimetres @ twist)
print("pseudoinverse, m: ", in_m.round(4))
print("pseudoinverse, mm:", in_mm.round(4))
assert np.abs(in_m - in_mm).max() > 1e-2

# %% [markdown]
# ... the hyperbolic one does not: nor when the frame changes. Its pitch `h` is a length.

# %%
h = 0.1
same = cy.hyperbolic(J, h).matrix @ twist
also = cy.hyperbolic(millimetres @ J, 1000 * h).matrix @ (millimetres @ twist)
print("hyperbolic:       ", same.round(4))
assert np.abs(same - also).max() < 1e-9
A = cy.adjoint(np.linalg.inv(robot.fk(q)))  # the same twists seen from another frame
assert np.abs(cy.hyperbolic(A @ J, h).matrix @ (A @ twist) - same).max() < 1e-9

# %% [markdown]
# It does not exist for every pitch, and says why.

# %%
system = cy.ScrewSystem(J, length=robot.reach)
print(system)
for pitch in system.principal_pitches:
    inverse = cy.hyperbolic(J, pitch, length=robot.reach)
    print(f"h = {pitch:.4f}:", inverse.reason)
    assert not inverse.exists
best, size = system.choose_pitch()
print(f"advice: h = {best:.4g} m/rad, where the projector enlarges a motion {size:.2f} times at most")

# %% [markdown]
# For a pose that five joints cannot reach, the arm gets as near as it can, position and
# orientation each a little off, and says that it has too few joints.

# %%
target = robot.fk(q)
target[:3, 3] += [0.02, 0.02, -0.03]

def off(outcome):
    pose = robot.fk(outcome.q)
    R = pose[:3, :3].T @ target[:3, :3]
    turn = 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    distance = np.linalg.norm(pose[:3, 3] - target[:3, 3])
    return f"{1000 * distance:6.2f} mm, turned by {np.degrees(turn).round(2)} deg in tool axes"

strict = cy.Servo(robot).simulate(q, target)
print("whole pose:     ", off(strict), "|", strict.stall)
assert strict.reason == "too-few-joints"

# %% [markdown]
# Better to say which motion does not matter: here turns about the tool's own x axis. As a task with
# five components the target is reached, in the servo and in inverse kinematics ...

# %%
task = {"task": "x,y,z,ry,rz", "task_axes": "local"}
free = cy.Servo(robot, **task).simulate(q, target)
print("five components:", off(free), "|", free.reason)
assert free.reached and robot.ik(target, q0=q, **task).success

# %% [markdown]
# ... or as an inverse that leaves out exactly these turns and nothing else.

# %%
given_up = cy.Servo(robot, inverse="oblique", give_up=["rx"]).simulate(q, target)
print("rx given up:    ", off(given_up), "|", given_up.stall)
assert given_up.reason == "projected"
