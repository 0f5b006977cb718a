# %% [markdown]
# # A five-bar
#
# A mechanism with a loop, two drives and a tool between them.

# %%
import numpy as np

import cylindroid as cy

linkage = cy.load("five-bar")
print(linkage)

# %% [markdown]
# Loops are constraints on `q`, so a configuration is assembled from a guess ...

# %%
guess = linkage.home + [0.2, -0.1, 0.0, 0.0]
assembly = linkage.assemble(guess, hold=linkage.actuated[:1])
print(assembly)
assert assembly.closed
q = assembly.q

# %% [markdown]
# ... and can be assembled in more than one way.

# %%
modes = linkage.assembly_modes(q, hold=linkage.joint_names[:1])
print(modes)

# %% [markdown]
# Its motions, and the wrenches that its structure resists. Counts are ranks, printed with those of
# Grübler's formula.

# %%
report = linkage.mobility(q)
print(report)
assert report.dof == 2 and report.redundancy == 0 and report.indeterminacy == 0

# %% [markdown]
# With one drive instead of two, one motion of the tool is nobody's.

# %%
single = linkage.mobility(q, actuated=linkage.actuated[:1])
print("one drive:", single.indeterminacy, "motion that it does not hold")
assert single.indeterminacy >= 1

# %% [markdown]
# Motion and force: efficiencies of the same directions are inverse to each other.

# %%
can = linkage.manipulability(q, task="x,y")
print(can)
np.testing.assert_allclose(can.kinematic.finite * can.active_force.finite[::-1], 1)

# %% [markdown]
# Which torques hold ten newtons on the tool?

# %%
constraint = linkage.constraint(q)
found = constraint.joint_torques([10.0, 0.0, 0.0])
print(found)

# %% [markdown]
# Driving the tool: the passive joints follow, the loop stays closed.

# %%
servo = cy.Servo(linkage, task="position")
target = linkage.fk(q, linkage.reference)
target[:2, 3] += [0.1, 0.1]
outcome = servo.simulate(q, target, record=True)
print(outcome)
assert outcome.reached and linkage.constraint(outcome.q).closure_error.distance < 1e-9

# %% [markdown]
# The way of the first crank, until a singularity is near or the goal is reached.

# %%
way = linkage.track_path(q, {linkage.joint_names[0]: q[0] + 1.5})
print(way, "nearest to a singularity by", f"{way.distances.min():.2f}")
