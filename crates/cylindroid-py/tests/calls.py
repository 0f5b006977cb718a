"""Every public call of the package with arguments that it accepts; tests change one at a time."""

import contextlib
import inspect
import os
import tempfile

import numpy as np

import cylindroid as cy

PANDA, FIVE_BAR, TWO_ARM = (cy.load(name) for name in ("panda", "five-bar", "two-arm"))
HAND = """
name = "hand"
reference = "ball"
""" + "".join(
    f"""
[[joint]]
name = "push{i}"
type = "prismatic"
between = ["ground", "finger{i}"]
origin = [{2 * x}, {2 * y}, 0]
axis = [{-x}, {-y}, 0]
actuated = true
[[contact]]
name = "tip{i}"
type = "soft_finger"
between = ["finger{i}", "ball"]
point = [{x}, {y}, 0]
normal = [{-x}, {-y}, 0]
friction = 0.5
curvature = [20, 10]
"""
    for i, (x, y) in enumerate([(1.0, 0.0), (-0.5, 0.8), (-0.5, -0.8)])
)
SLIDER = cy.parse(
    """<robot name="slider"><link name="base"/><link name="cart"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <joint name="slide" type="prismatic"><parent link="base"/><child link="cart"/>
    <axis xyz="1 0 0"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>"""
)
SRDF = """<robot name="panda">
<group name="forearm"><chain base_link="link4" tip_link="link7"/></group>
<group_state name="up" group="forearm"><joint name="panda_joint6" value="1.0"/></group_state>
<end_effector name="grip" parent_link="link7" group="hand" parent_group="forearm"/>
<disable_collisions link1="link1" link2="link2" reason="Adjacent"/></robot>"""
PLANAR, GRID = cy.load("3rrr"), {"x": (-0.01, 0, 2), "y": (0, 0.01, 2), "rz": (0.1, 0.2, 2)}
DESIGN = cy.parse("""
dimension = 2
reference = "hand"
reference_point = ["1 + b", 0]
parameters = { b = 0.9 }
[[joint]]
name = "shoulder"
type = "revolute"
between = ["ground", "arm"]
origin = [0, 0]
limits = { lower = -1, upper = 1 }
[[joint]]
name = "elbow"
type = "revolute"
between = ["arm", "hand"]
origin = [1, 0]
limits = { lower = 0.2, upper = 2 }
""", "toml")
GROUPS = cy.Srdf("panda.srdf", SRDF)
POSE = PANDA.fk(PANDA.home)
NEAR = PANDA.fk(PANDA.home + 0.05)
J = PANDA.jacobian(PANDA.home + 0.1)
ARM = J[:, :3]
TWIST = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
LINES = [[0, 0, 0, 0, 0, 1], [0, -1, 0, 1, 0, 0]]
FINGERS = [cy.FingerContact([x, 0, 0], [-x, 0, 0], mu=0.5, torsion=0.01) for x in (1.0, -1.0)]

VIEW, CLOSED = cy.show(PANDA, open=False), cy.show(PANDA, open=False)
VIEW.add_obstacle("ball", "sphere", [0.5, 0, 0.5], radius=0.1)
CLOSED.close()

#: No page opens.
os.environ["BROWSER"] = "true"


def shown(**arguments):
    cy.show(**arguments).close()


def copied(folder):
    leads_out = isinstance(folder, str) and (folder.startswith("/") or ".." in folder)
    with tempfile.TemporaryDirectory() as inside, contextlib.chdir(inside):
        cy.tutorials("new" if leads_out else folder)


def obstructed(**arguments):
    VIEW.add_obstacle(**arguments)
    VIEW.remove(arguments["name"])


def removed(**arguments):
    VIEW.add_points("dot", [[0.0, 0, 0]])
    VIEW.remove(**arguments)


def seen(*_):
    pass


def total(q, names):
    return q.sum(1)


def line():
    return cy.CartesianPath.line(POSE, NEAR)


def system():
    return cy.ScrewSystem(ARM)


def two_system():
    return cy.ScrewSystem(LINES_AS_COLUMNS)


LINES_AS_COLUMNS = np.transpose(LINES)
SPACE = {"length": 0.5, "center": [0.0, 0, 0], "noise": 1e-9}
REFERENCE = {"frame": "flange", "reference": "local", "tool": np.eye(4)}
BARS = {"q": FIVE_BAR.home, "actuated": ["q1", "q2"], "reference": "reference"}
WEIGHTS = {"Wu": [1.0, 2, 3], "Wq": [1.0, 2]}
FORCES = {"Ww": [1.0, 2, 3], "Wtau": [1.0, 2], "Wt": np.ones(6)}
GOAL = {"tool": np.eye(4), "task": "pose", "task_axes": "world", "fixed": ["panda_joint1"]}
GOALS = {
    "tasks": [cy.GazeTask("hand_tcp", [0.6, 0.2, 0.0])],
    "half_spaces": [cy.HalfSpace("link4", [0.0, 0, -1], [0.0, 0, 1])],
    "posture": [0.0] * 7,
    "maximise": None,
}
TOLERANCES = {"tolerance_position": 1e-5, "tolerance_orientation": 1e-5, "seed": 1, "iterations": 99}
SPEEDS = {"speed": 1.0, "acceleration": [1.0, 2], "jerk": 9.0}


def constraint():
    return FIVE_BAR.constraint(actuated=["q1", "q2"])


def with_ball():
    model = cy.CollisionModel(PANDA)
    model.add_obstacle("ball", "sphere", POSE, radius=0.1)
    return model


def add_obstacle(name, shape, pose, radius):
    return cy.CollisionModel(PANDA).add_obstacle(name, shape, pose, radius=radius)


def servo(**options):
    return cy.Servo(PANDA, **options)


def task_servo():
    return cy.TaskServo(PANDA, [cy.FrameTask("flange", POSE), cy.PostureTask(PANDA.home)])


def tasks():
    """The same of tasks."""
    common = {"name": "task", "weight": 2.0}
    ranked = {**common, "level": 1, "gain": 4.0}
    ranks = {"tolerance_position": 1e-4, "tolerance_orientation": 1e-3}
    frame = {"frame": "flange", "tool": np.eye(4)}
    yield from [
        ("FrameTask", cy.FrameTask,
         {**frame, "target": POSE, "components": "pose", "axes": "world", **ranked, **ranks}),
        ("RelativeFrameTask", cy.RelativeFrameTask,
         {**frame, "reference": "link4", "target": POSE, "reference_tool": np.eye(4),
          "components": "x,y", **ranked, **ranks}),
        ("CenterOfMassTask", cy.CenterOfMassTask,
         {"target": [0.0, 0, 1], "velocity": [0.1, 0, 0], "axes": "xy", **ranked,
          "tolerance_position": 1e-4}),
        ("GazeTask", cy.GazeTask,
         {**frame, "point": [0.0, 0, 1], **ranked, "tolerance_orientation": 1e-3}),
        ("PostureTask", cy.PostureTask, {"q": PANDA.home, **common, "gain": 4.0, **ranks}),
        ("JointVelocitiesTask", cy.JointVelocitiesTask,
         {"velocities": np.zeros(7), **common, **ranks}),
        ("ManipulabilityTask", cy.ManipulabilityTask,
         {**frame, "components": "position", **common, "gain": 2.0}),
        ("LimitAvoidanceTask", cy.LimitAvoidanceTask, {"margin": 0.2, **common, "gain": 2.0}),
        ("CustomTask", cy.CustomTask,
         {"function": lambda q: ([0.0], np.zeros((1, 7))), "rows": 1, **ranked,
          "tolerance_orientation": 1e-3}),
    ]


def calls():
    """(name, callable, arguments) of every public callable with parameters."""
    projector = cy.Projector(ARM, J[:, 3:6])
    admittance = cy.Admittance(2.0, 1.0)
    grip, arms = cy.parse(HAND, "toml"), TWO_ARM.constraint()
    moving = servo()
    moving.step(PANDA.home, NEAR)
    stiff = cy.load("stewart").stiffness(stiffness=1e6)
    yield from [
        ("Admittance", cy.Admittance, {"force": 1.0, "moment": 2.0, "point": [0.0, 0, 0]}),
        ("Admittance.from_matrix", cy.Admittance.from_matrix, {"matrix": np.eye(6)}),
        ("Admittance.seen_from", admittance.seen_from, {"a_from_b": POSE}),
        ("CartesianMove", cy.CartesianMove, {"path": line(), **SPEEDS, "duration": 9.0}),
        ("CartesianMove.at", cy.CartesianMove(line(), speed=1.0).at, {"t": 0.1}),
        ("CartesianMove.target", cy.CartesianMove(line(), speed=1.0).target, {"t": 0.1, "dt": 0.01}),
        ("CartesianPath.line", cy.CartesianPath.line, {"start": POSE, "end": NEAR}),
        ("CartesianPath.circle", cy.CartesianPath.circle,
         {"start": POSE, "via": [0.1, 0.2, 0.3], "end": NEAR}),
        ("CartesianPath.rotation", cy.CartesianPath.rotation,
         {"start": POSE, "centre": [0.0, 0, 0], "axis": [0.0, 0, 1], "angle": 1.0}),
        ("CartesianPath.pose", line().pose, {"s": 0.5}),
        ("CartesianPath.deviation", line().deviation, {"pose": POSE}),
        ("sweep", cy.sweep,
         {"mechanism": PANDA, "samples": 4, "seed": 1, "quantities": ["yoshikawa"], "frame": "flange",
          "tool": np.eye(4), "task": "x,y", "relative_to": "link4", "length": 0.5, "threads": 1}),
        ("sweep", cy.sweep,
         {"mechanism": PANDA, "over": {"panda_joint1": (0.0, 1.0, 3)}, "q": PANDA.home,
          "quantities": ["payload"], "direction": [0.0, 0, 1], "metric": "length"}),
        ("sweep", cy.sweep,
         {"mechanism": PANDA, "configurations": [PANDA.home], "columns": {"sum": total}}),
        ("SweepColumn", cy.SweepColumn, {"function": total, "unit": "rad", "version": "1"}),
        ("CollisionAvoidance", cy.CollisionAvoidance,
         {"model": with_ball(), "gap": 0.02, "margin": 0.2}),
        ("CollisionModel", cy.CollisionModel,
         {"mechanism": PANDA, "disabled": [("link1", "link2")], "srdf": None,
          "meshes": "convex_hull", "samples": 3, "seed": 1}),
        ("CollisionModel.near", cy.CollisionModel(PANDA).near, {"q": PANDA.home, "margin": 0.2}),
        ("CollisionModel.add_obstacle", add_obstacle,
         {"name": "ball", "shape": "sphere", "pose": POSE, "radius": 0.1}),
        ("CollisionModel.move_obstacle", with_ball().move_obstacle, {"name": "ball", "pose": POSE}),
        ("CollisionModel.remove_obstacle", lambda name: with_ball().remove_obstacle(name),
         {"name": "ball"}),
        ("Constraint", cy.Constraint,
         {"Ja": np.eye(2), "Jp": np.ones((2, 1)), "G": np.eye(2), "length": 1.0,
          "units": ("mr", "rr", "m", "mr")}),
        ("Constraint.manipulability", constraint().manipulability,
         {"task": "x,y", **WEIGHTS, "Wu": [1.0, 2], "Ww": [1.0, 2], "Wtau": [1.0, 2], "Wt": None,
          "metric": "unit"}),
        ("Constraint.transmitted_wrenches", arms.transmitted_wrenches, {"forces": np.ones(18)}),
        ("Constraint.velocity_polytope", constraint().velocity_polytope,
         {"limits": [1.0, 2], "task": "x,y"}),
        ("Constraint.force_polytope", constraint().force_polytope,
         {"limits": [1.0, 2], "task": "x,y"}),
        ("Constraint.joint_torques", constraint().joint_torques,
         {"wrench": [1.0, 2, 3], "metric": [1.0, 2]}),
        ("Constraint.contact_forces", constraint().contact_forces,
         {"torques": [0.0, 0], "wrench": [0.0, 0, 0], "compliance": np.ones(6)}),
        ("FingerContact", cy.FingerContact,
         {"point": [0.0, 0, 0], "normal": [0.0, 0, 1], "mu": 0.5, "torsion": 0.1, "strength": 2.0,
          "finger_curvature": 1.0, "object_curvature": ([1.0, 2], [1.0, 0, 0])}),
        ("HalfSpace", cy.HalfSpace,
         {"frame": "flange", "point": [0.0, 0, 1], "normal": [0.0, 0, -1], "tool": np.eye(4),
          "name": "wall"}),
        ("HalfSpace.inside_box", cy.HalfSpace.inside_box,
         {"frame": "flange", "center": POSE, "size": [1.0, 1, 1], "tool": np.eye(4),
          "name": "cell"}),
        ("HybridController", cy.HybridController, {"gain": 1.0, "admittance": admittance}),
        ("HybridController.command", cy.HybridController(1.0, admittance).command,
         {"projector": projector, "error": TWIST, "desired": TWIST, "measured": TWIST,
          "feed_forward": TWIST}),
        ("HybridController.seen_from", cy.HybridController(1.0, admittance).seen_from,
         {"a_from_b": POSE}),
        ("InternalForceController", cy.InternalForceController,
         {"gain": 1.0, "stiffness": np.ones(14)}),
        ("InternalForceController.command", cy.InternalForceController(1.0, np.ones(14)).command,
         {"constraint": arms, "desired": np.ones(14), "measured": np.zeros(14)}),
        ("JointMove", cy.JointMove,
         {"mechanism": PANDA, "q": PANDA.home, "to": PANDA.home + 0.1, "speed": 1.0,
          "acceleration": 1.0, "jerk": 9.0, "duration": 9.0}),
        ("JointMove.at", cy.JointMove(PANDA, PANDA.home, PANDA.home + 0.1).at, {"t": 0.1}),
        ("Manipulability.index", FIVE_BAR.manipulability().index, {"name": "force"}),
        ("OperatorAuthority", cy.OperatorAuthority, {"dt": 0.01, "fall": 0.1, "rise": 1.0}),
        ("OperatorAuthority.update", cy.OperatorAuthority(0.01, 0.1, 1.0).update, {"servo": moving}),
        ("PitchConics.kind", system().pitch_conics().kind, {"h": 0.1}),
        ("PitchConics.points", system().pitch_conics().points, {"h": 0.1, "count": 9}),
        ("PitchConics.coordinates", system().pitch_conics().coordinates, {"twist": ARM[:, 0]}),
        ("Projector", cy.Projector, {"motions": ARM, "along": J[:, 3:6], **SPACE}),
        ("Projector.motion", projector.motion, {"twist": TWIST}),
        ("Projector.rest", projector.rest, {"twist": TWIST}),
        ("Projector.constraint", projector.constraint, {"wrench": TWIST}),
        ("Screw", cy.Screw, {"twist": TWIST}),
        ("ScrewSystem", cy.ScrewSystem, {"J": ARM, **SPACE}),
        *[(f"ScrewSystem.{name}", getattr(system(), name), {"h": 0.1})
          for name in ("existence", "signature", "projector", "projector_norm", "h_reciprocal")],
        *[(f"ScrewSystem.{name}", getattr(system(), name), {"other": cy.ScrewSystem(J[:, 3:6])})
          for name in ("projector_along", "sum", "intersection", "sine_to_system")],
        *[(f"ScrewSystem.{name}", getattr(system(), name), {"twist": TWIST})
          for name in ("sine_to", "contains", "error_form_zeros")],
        ("ScrewSystem.error_form", system().error_form, {"twist": TWIST, "h": 0.1}),
        ("ScrewSystem.pencil", two_system().pencil, {"count": 5}),
        ("Servo", cy.Servo,
         {"mechanism": PANDA, "frame": "flange", "gain": [5.0, 4], "tool": np.eye(4), "dt": 0.01,
          "tolerance_position": 1e-4, "tolerance_orientation": 1e-3, "speed": 1.0,
          "acceleration": 4.0, "jerk": 90.0, "delay": 0.02, "time_constant": 0.01, "noise": 1e-4,
          "command_timeout": 0.2, "limits": {"panda_joint1": {"velocity": 1.0}}, "length": 0.5,
          "joint_weights": np.ones(7), "secondary": "posture", "posture": PANDA.home,
          "null_space": "exact", "task": "pose", "task_axes": "world", "inverse": "damped",
          "give_up": None, "fallback": None, "tasks": None, "collisions": None, "damping": 0.1}),
        ("Servo.step", servo().step,
         {"q": PANDA.home, "target": NEAR, "secondary": np.zeros(7), "feed_forward": TWIST}),
        ("Servo.step_twist", servo().step_twist, {"q": PANDA.home, "twist": TWIST}),
        ("Servo.step_actuated", servo().step_actuated,
         {"actuated": PANDA.home, "target": NEAR, "feed_forward": TWIST, "sensors": {}}),
        ("Servo.step_twist_actuated", servo().step_twist_actuated,
         {"actuated": PANDA.home, "twist": TWIST, "sensors": {}}),
        ("Servo.start_from", servo().start_from, {"q": PANDA.home}),
        ("Servo.advance", servo().advance, {"q": PANDA.home}),
        ("Servo.simulate", servo().simulate,
         {"q": PANDA.home, "target": NEAR, "duration": 0.01, "record": True}),
        ("Servo.find_reachable_configuration", servo().find_reachable_configuration,
         {"q": PANDA.home, "target": NEAR, "max_restarts": 2}),
        ("WaypointMove", cy.WaypointMove,
         {"poses": [POSE, NEAR], "times": None, "speed": 0.1, "acceleration": 0.5, "speeds": [1.0]}),
        ("WaypointMove.at", cy.WaypointMove([POSE, NEAR]).at, {"t": 0.1}),
        ("WaypointMove.target", cy.WaypointMove([POSE, NEAR]).target, {"t": 0.1, "dt": 0.01}),
        ("SharedController", cy.SharedController, {"gain": 1.0}),
        ("SharedController.command", cy.SharedController(1.0).command,
         {"projector": projector, "error": TWIST, "operator": TWIST, "feed_forward": TWIST}),
        ("Spectrum.ellipsoid", FIVE_BAR.manipulability().kinematic.ellipsoid,
         {"components": "x,y", "view": "section"}),
        ("Stiffness.at", stiff.at, {"frame": np.eye(4)}),
        ("Stiffness.compliance_at", stiff.compliance_at, {"frame": np.eye(4)}),
        ("Stiffness.deflection", stiff.deflection, {"wrench": TWIST}),
        ("TaskServo", cy.TaskServo,
         {"mechanism": PANDA, "tasks": [cy.FrameTask("link4", POSE)],
          "collisions": cy.CollisionAvoidance(with_ball()),
          "half_spaces": [cy.HalfSpace("link4", [0.0, 0, -1], [0.0, 0, 1])],
          "limits": {"panda_joint1": {"velocity": 1.0}}, "dt": 0.01, "length": 0.5,
          "joint_weights": np.ones(7), "acceleration": 4.0, "jerk": 90.0, "delay": 0.02,
          "time_constant": 0.01, "noise": 1e-4, "eps": 0.01}),
        ("TaskServo.step", task_servo().step,
         {"q": PANDA.home, "targets": {"flange": (NEAR, TWIST), "posture": PANDA.home}}),
        ("TaskServo.command_twist", task_servo().command_twist,
         {"task": "flange", "twist": TWIST, "timeout": 0.1}),
        ("TaskServo.commanded_twist", task_servo().commanded_twist, {"task": "flange"}),
        ("TaskServo.advance", task_servo().advance, {"q": PANDA.home}),
        ("TimeLaw", cy.TimeLaw,
         {"distance": 1.0, "velocity": 1.0, "acceleration": 2.0, "jerk": 9.0, "duration": 9.0}),
        ("TimeLaw.at", cy.TimeLaw(1.0, 1.0, 2.0).at, {"t": 0.5}),
        *[(name, getattr(cy, name), {"a_from_b": POSE}) for name in ("adjoint", "coadjoint")],
        *[(name, getattr(cy, name), {"a": TWIST, "b": TWIST})
          for name in ("bracket", "killing", "klein")],
        *[(name, getattr(cy, name), {"a": TWIST, "b": TWIST, "h": 0.1})
          for name in ("pitch_form", "wrench_pitch_form")],
        ("damped", cy.damped, {"J": J, "damping": 0.1}),
        *[(name, getattr(cy, name), {"pose": POSE, "target": NEAR})
          for name in ("error_to", "screw_to")],
        *[(name, getattr(cy, name), {"twist": TWIST}) for name in ("exp", "exp_derivative")],
        *[(name, getattr(cy, name), {"J": ARM, "h": 0.1}) for name in ("gram", "gram_determinant")],
        ("grasp_mobility", cy.grasp_mobility,
         {"contacts": FINGERS, "point": [0.0, 0, 0], "planar": False}),
        ("eigenscrews", cy.eigenscrews, {"K": np.eye(6), "h": 0.1}),
        ("grasp_quality", cy.grasp_quality,
         {"contacts": FINGERS, "point": [0.0, 0, 0], "length": 1.0, "planar": False, "metric": "l1"}),
        ("hyperbolic", cy.hyperbolic,
         {"J": ARM, "h": 0.1, "joint_metric": [1.0, 2, 3], **SPACE, "mu": 0.01, "lam": None}),
        ("hyperbolic_svd", cy.hyperbolic_svd,
         {"J": ARM, "h": 0.1, "joint_metric": [1.0, 2, 3], **SPACE}),
        ("inverse", cy.inverse,
         {"J": J, "method": "damped", "joint_weights": np.ones(7), "task_weights": np.ones(6),
          "damping": 0.1}),
        ("involution", cy.involution, {"lines": LINES_AS_COLUMNS, **SPACE}),
        ("load", cy.load, {"model": "panda"}),
        ("log", cy.log, {"pose": POSE}),
        ("log_derivative", cy.log_derivative, {"twist": TWIST}),
        ("lowered", cy.lowered, {"twist": TWIST, "h": 0.1}),
        ("oblique", cy.oblique,
         {"J": ARM, "complement": J[:, 3:6], "joint_metric": [1.0, 2, 3], **SPACE}),
        ("parse", cy.parse, {"text": HAND, "format": "toml", "path": "hand.toml"}),
        ("pinv", cy.pinv, {"J": J, "eps": 1e-3}),
        ("point_direction", cy.point_direction,
         {"J": J, "point": [0.0, 0, 0], "direction": [1.0, 0, 0]}),
        ("projector", cy.projector, {"motions": ARM, "along": J[:, 3:6], **SPACE}),
        ("raised", cy.raised, {"wrench": TWIST, "h": 0.1}),
        *[(name, getattr(cy, name), {"vector": [0.1, 0.2, 0.3]})
          for name in ("rotation_exp_derivative", "rotation_log_derivative")],
        ("selectively_damped", cy.selectively_damped,
         {"J": J, "task": TWIST, "max_joint_velocity": 0.5}),
        ("transversals", cy.transversals, {"lines": LINES_AS_COLUMNS, **SPACE}),
        ("velocity_conversion", cy.velocity_conversion, {"b_from_a": POSE}),
        ("optimise", cy.optimise,
         {"mechanism": DESIGN, "vary": {"b": (0.5, 1.0)}, "minimise": ["condition:mean"],
          "maximise": "x", "designs": 3, "starts": 1, "evaluations": 9, "seed": 1, "samples": 2,
          "frame": "hand", "tool": np.eye(4), "task": "x,y", "metric": "length", "length": 0.5,
          "threads": 1}),
        ("optimise", cy.optimise,
         {"mechanism": DESIGN, "vary": {"b": (0.5, 1.0)}, "minimise": "condition", "designs": 3,
          "over": {"elbow": (0.5, 1.0, 2)}, "q": DESIGN.home}),
        ("optimise", cy.optimise,
         {"mechanism": DESIGN, "vary": {"b": (0.5, 1.0)}, "minimise": "condition", "designs": 3,
          "configurations": [[0.0, 1.0]]}),
        ("workspace_map", cy.workspace_map,
         {"mechanism": PLANAR, "over": {"x": (-0.05, 0.05, 2)}, "at": {"rz": 0.1}, "free": ["y"],
          "frame": PLANAR.reference, "tool": np.eye(4), "q": PLANAR.home, "starts": 2, "seed": 1,
          "loci": False, "threads": 1}),
        ("WorkspaceMap.workspace", cy.workspace_map(PLANAR, GRID).workspace, {"mode": 0}),
        ("WorkspaceMap.section", cy.workspace_map(PLANAR, GRID).section, {"mode": 0, "place": 0}),
        ("singularity_free_zone", cy.singularity_free_zone,
         {"mechanism": PLANAR, "components": ["x", "y"], "shape": "box", "scales": [1.0, 0.5],
          "at": {"rz": 0.1}, "free": None, "frame": PLANAR.reference, "tool": np.eye(4),
          "q": PLANAR.home, "limits": False, "rays": 4, "seed": 1}),
        ("tutorials", copied, {"folder": "new"}),
        ("show", shown,
         {"mechanism": PANDA, "q": PANDA.home, "frame": "flange", "tool": np.eye(4),
          "open": False, "height": 600, "host": "127.0.0.1", "port": 0, "meshes": (),
          "frame_ancestors": "http://localhost:8888"}),
        ("View.add_frame", VIEW.add_frame, {"name": "f", "pose": POSE, "size": 0.1}),
        *[(f"View.{name}", getattr(VIEW, name),
           {"name": name, "points": [[0.0, 0, 0], [0, 0, 1.0]], "rgba": [1.0, 0, 0, 1]})
          for name in ("add_line", "add_points")],
        ("View.add_obstacle", obstructed,
         {"name": "egg", "shape": "ellipsoid", "pose": POSE, "radius": None, "length": None,
          "size": [0.1, 0.1, 0.2], "file": None}),
        ("View.move_obstacle", VIEW.move_obstacle, {"name": "ball", "pose": POSE}),
        ("View.remove", removed, {"name": "dot"}),
        ("View.open", VIEW.open, {"height": 600}),
        *[(f"View.{name}", getattr(VIEW, name), {"function": seen})
          for name in ("on_target", "on_configuration", "on_obstacle")],
        ("View.wait", CLOSED.wait, {"timeout": 0.0}),
        ("Srdf", cy.Srdf, {"path": "panda.srdf", "text": SRDF}),
        ("Srdf.joints", GROUPS.joints, {"group": "forearm", "robot": PANDA}),
        ("Srdf.group", GROUPS.group, {"name": "forearm", "robot": PANDA, "q": PANDA.home}),
        ("Srdf.configuration", GROUPS.configuration,
         {"state": "up", "robot": PANDA, "q": PANDA.home}),
        *tasks(),
        *[(f"Mechanism.{name}", getattr(robot, name), arguments)
          for name, robot, arguments in methods(grip)],
    ]


def methods(grip):
    """The same of mechanisms."""
    q, n = PANDA.home, {"q": PANDA.home}
    yield from [
        ("mobility", FIVE_BAR, {**BARS, "length": 1.0}),
        ("grasp_quality", grip,
         {"q": grip.home, "reference": "ball", "mu": 0.5, "torsion": 0.1, "strength": 1.0,
          "metric": "l1"}),
        ("operation_modes", FIVE_BAR,
         {"q": FIVE_BAR.home, "starts": 2, "seed": 1, "reference": "reference"}),
        ("grasp_mobility", grip, {"q": grip.home, "reference": "ball"}),
        ("manipulability", FIVE_BAR,
         {**BARS, "task": None, **WEIGHTS, **FORCES, "metric": "unit", "length": 1.0}),
        ("manipulability_gradient", FIVE_BAR,
         {**BARS, "measure": "volume", "task": None, **WEIGHTS, "metric": "unit"}),
        ("constraint", FIVE_BAR, {**BARS, "length": 1.0}),
        ("ik", PANDA, {"target": POSE, "frame": "flange", "q0": q, **GOAL, "nearest": False,
          "weights": None, **GOALS, "collisions": None, **TOLERANCES}),
        ("ik_all", PANDA, {"target": POSE, "count": 2, "frame": "flange", "q0": q, **GOAL,
          "weights": None, **GOALS, "collisions": None, **TOLERANCES}),
        ("assembly_modes", FIVE_BAR,
         {"guess": FIVE_BAR.home, "hold": ["q1", "q2"], "starts": 2, "seed": 1}),
        ("inverse", PANDA,
         {**n, "method": "damped", "twist": TWIST, **REFERENCE, "length": 0.5, "give_up": None,
          "damping": 0.1}),
        ("mass_matrix", SLIDER, {"q": [0.0]}),
        ("actuated_inertia", SLIDER, {"q": [0.0]}),
        ("stiffness", FIVE_BAR,
         {**BARS, "length": 1.0, "stiffness": {"q1": 1e3, "q2": 1e3}, "compliance": None}),
        ("assemble", FIVE_BAR, {"guess": FIVE_BAR.home, "hold": ["q1", "q2"]}),
        ("screw_system", PANDA, {**n, "frame": "flange", **SPACE}),
        ("fk", PANDA, {**n, "frame": "flange", "tool": np.eye(4), "out": None}),
        ("fk_all", PANDA, n),
        ("joint_axes", PANDA, {**n, "side": "child"}),
        ("contact_points", TWO_ARM, {"q": TWO_ARM.home}),
        ("jacobian", PANDA, {**n, **REFERENCE, "out": None}),
        ("relative_jacobian", PANDA, {**n, "base": "link4", "frame": "flange", "tool": np.eye(4)}),
        ("hessian", PANDA, {**n, **REFERENCE}),
        ("jacobian_dot", PANDA, {**n, "qd": q, **REFERENCE}),
        ("analytical_jacobian", PANDA,
         {**n, "angles": "zyz", "frame": "flange", "tool": np.eye(4)}),
        ("integrate", PANDA, {**n, "qd": q, "dt": 0.1}),
        ("with_actuated", FIVE_BAR, {"names": ["q1"]}),
        ("with_limits", FIVE_BAR, {"limits": {"q1": {"velocity": 1.0}}}),
        ("with_fixed_joints", PANDA, {"names": ["panda_joint3"], **n}),
        ("with_tool", PANDA, {"frame": "link4"}),
        ("track_path", FIVE_BAR,
         {"start": FIVE_BAR.home, "goal": {"q1": 0.1}, "step": 0.1, "least_distance": 0.01}),
        ("columns", PANDA, n),
        ("ordered", PANDA, n),
        ("outside_limits", PANDA, n),
        ("distances", PANDA, {**n, "margin": 0.2, "srdf": None, "meshes": "convex_hull"}),
        ("measures", FIVE_BAR, {**BARS, **WEIGHTS, "metric": "unit", "length": 1.0, "task": "x,y,rz"}),
    ]


def public():
    """The names of all public callables that have parameters."""
    for name in cy.__all__:
        thing = getattr(cy, name)
        if inspect.isclass(thing) and issubclass(thing, BaseException) or not callable(thing):
            continue
        members = [m for m in vars(thing) if not m.startswith("_")] if inspect.isclass(thing) else []
        for path, function in [(name, thing)] + [(f"{name}.{m}", getattr(thing, m)) for m in members]:
            try:
                parameters = inspect.signature(function).parameters if callable(function) else ()
            except ValueError:
                continue  # a class whose objects come from elsewhere
            if [p for p in parameters if p != "self"]:
                yield path
