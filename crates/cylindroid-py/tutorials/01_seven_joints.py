# %% [markdown]
# # A 7-joint arm
#
# Where it is, how it moves, what it can do, and why it stops.

# %%
import numpy as np

import cylindroid as cy

# %% [markdown]
# A catalogue model; a URDF, MJCF or SDF file works the same: `cy.load("path/to/robot.urdf")`.

# %%
robot = cy.load("panda")
print(robot)

# %% [markdown]
# Every function takes one configuration or many, and names the frame of a Jacobian.

# %%
q = robot.home
print("tool at", robot.fk(q)[:3, 3].round(4), "m")
J = robot.jacobian(q)  # twist of the tool (linear first, world axes) = J @ rates
many = robot.jacobian(np.tile(q, (1000, 1)), reference="local")
print("Jacobians of 1000 configurations:", many.shape)

# %% [markdown]
# What the arm can do here. The efficiencies are squared singular values; of a seventh joint one
# motion leaves the tool at rest.

# %%
report = robot.manipulability(q, task="x,y,z")
print(report)
print("most speed along", report.kinematic.directions[0].object.round(3))

# %% [markdown]
# Inverse kinematics: any configuration within the limits, or the nearest one.

# %%
target = robot.fk(q)
target[:3, 3] += [0.1, 0.15, -0.1]
found = robot.ik(target, q0=q, nearest=True)
print(found)

# %% [markdown]
# The servo goes there in small steps, as in a control loop on a robot. Here the robot is ideal:
# `q` follows the rates.

# %%
servo = cy.Servo(robot, gain=5.0, dt=0.002)
while servo.status not in ("reached", "stalled"):
    rates = servo.step(q, target)
    q = q + servo.dt * rates
print(servo, "off by", f"{servo.position_error:.1e} m")
assert servo.status == "reached"

# %% [markdown]
# The same in one call, with every step kept.

# %%
outcome = servo.simulate(robot.home, target, record=True)
print(outcome)
fastest = np.abs(outcome.trajectory.joint_velocities).max(axis=0)
assert (fastest <= robot.velocity_limit * (1 + 1e-9)).all(), "limits hold by construction"

# %% [markdown]
# A target that nobody can reach ends in a report.

# %%
far = target.copy()
far[0, 3] = 2.0
stall = servo.simulate(robot.home, far).stall
print("far away:", stall)
assert stall.name == "out-of-reach"

# %% [markdown]
# The elbow moves while the tool stays: joint velocities of ours, as far as the task allows.

# %%
still = robot.fk(robot.home)
elbow = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
rates = cy.Servo(robot, secondary="none").step(robot.home, still, secondary=elbow)
assert np.abs(robot.jacobian(robot.home) @ rates).max() < 1e-12

# %% [markdown]
# Pictures, which need matplotlib (`pip install matplotlib`). Outside of a notebook, `plt.show()`
# opens them.

# %%
from cylindroid import plot

ax = plot.mechanism(robot)
plot.ellipsoid(report.kinematic, robot.fk(robot.home)[:3, 3], ax, scale=0.2)
axes = plot.trajectory(outcome.trajectory, robot.joint_names)
