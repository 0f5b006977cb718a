"""Statistics of sweeps against Pinocchio and MuJoCo over the same samples."""

import pathlib
import sys

import mujoco
import numpy as np
import pinocchio as pin
import pytest

import cylindroid as cy

sys.path.insert(0, str(pathlib.Path(__file__).parents[3] / "benches/control"))

import plant_models  # noqa: E402

INDICES = ["yoshikawa", "smallest_singular_value", "condition"]


def statistics(values):
    """Mean, standard deviation, extremes and quartiles."""
    return [values.mean(), values.std(), *np.quantile(values, [0, 0.25, 0.5, 0.75, 1])]


def reachable(places, reach):
    """Share of the cells of a cube around the base, 16 along an edge, in which a sample lies."""
    cells = np.floor((places / reach + 1.0) * 8).astype(int)
    inside = ((cells >= 0) & (cells < 16)).all(1)
    return len(np.unique(cells[inside], axis=0)) / 16**3


@pytest.mark.parametrize(
    ("file", "frame"),
    [
        ("ur_description/urdf/ur5_joint_limited_robot.urdf", "tool0"),
        ("panda_description/urdf/panda.urdf", "panda_link8"),
    ],
)
def test_an_arm_agrees_with_pinocchio(file, frame, robot_files):
    path = str(robot_files / file)
    robot, model = cy.load(path), pin.buildModelFromUrdf(path)
    data, length = model.createData(), 0.7
    found = cy.sweep(
        robot, samples=5000, seed=2, frame=frame, length=length, quantities=["pose", *INDICES]
    )
    places, values = [], []
    order = [model.joints[model.getJointId(name)].idx_v for name in robot.joint_names]
    for q in np.stack([found[name] for name in robot.joint_names], axis=1):
        there = pin.neutral(model)
        there[order] = q
        jacobian = pin.computeFrameJacobian(
            model, data, there, model.getFrameId(frame), pin.LOCAL_WORLD_ALIGNED
        )[:, order]
        pin.updateFramePlacements(model, data)
        places.append(data.oMf[model.getFrameId(frame)].translation.copy())
        volume = np.linalg.svd(jacobian, compute_uv=False)[: min(6, robot.n)].prod()
        jacobian[:3] /= length
        singular = np.linalg.svd(jacobian, compute_uv=False)
        values.append([volume, singular[-1], singular[0] / singular[-1]])
    places = np.array(places)
    own = np.stack([found[axis] for axis in "xyz"], axis=1)
    assert np.abs(own - places).max() < 1e-9
    share = reachable(own, 1.2)
    assert share == reachable(places, 1.2) and 0.1 < share < 0.6
    for name, column in zip(INDICES, np.transpose(values)):
        # The condition is unbounded near singularities, where rounding counts.
        own, theirs = (1 / x if name == "condition" else x for x in (found[name], column))
        np.testing.assert_allclose(statistics(own), statistics(theirs), rtol=1e-9, atol=1e-12)


class Platform:
    """The Stewart platform of the catalogue in MuJoCo."""

    def __init__(self):
        self.robot = plant_models.Stewart()
        self.model, self.data = self.robot.compile("velocity", 0.01, 0.05)
        self.model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
        legs = [self.model.joint(name) for name in self.robot.actuated]
        self.places = [leg.qposadr[0] for leg in legs]
        self.drives = np.zeros((6, self.model.nv))
        self.drives[range(6), [leg.dofadr[0] for leg in legs]] = 1

    def constraint(self):
        """The Jacobian and the error of the loops, here."""
        mujoco.mj_fwdPosition(self.model, self.data)
        count = self.data.nefc
        rows = self.data.efc_J.reshape(-1, self.model.nv)[:count]
        return rows.copy(), self.data.efc_pos[:count].copy()

    def put(self, row):
        mujoco.mj_resetData(self.model, self.data)
        for i in range(self.model.njnt):
            if (name := self.model.joint(i).name) != "platform":
                self.data.joint(name).qpos[0] = row[name]
        turn, quaternion = np.zeros(9), np.zeros(4)
        mujoco.mju_quat2Mat(turn, np.array([row[name] for name in ("qw", "qx", "qy", "qz")]))
        turn = turn.reshape(3, 3) @ self.robot.home_pose[:3, :3].T
        mujoco.mju_mat2Quat(quaternion, turn.flatten())
        self.data.joint("platform").qpos[:] = [*(row[axis] for axis in "xyz"), *quaternion]

    def efficiencies(self):
        """Squared singular values of the map from velocities of the legs to the twist of the platform,
        and how far the loops are open (m)."""
        rows, error = self.constraint()
        motions = np.linalg.svd(rows)[2][-6:].T
        linear, angular = np.zeros((3, self.model.nv)), np.zeros((3, self.model.nv))
        mujoco.mj_jacSite(self.model, self.data, linear, angular, 0)
        velocities = np.vstack([linear, angular]) @ motions @ np.linalg.inv(self.drives @ motions)
        return np.linalg.svd(velocities, compute_uv=False) ** 2, np.abs(error).max()

    def arrives(self, lengths, steps=60):
        """True if the legs move straight from home to these lengths and meet no singularity."""
        mujoco.mj_resetData(self.model, self.data)
        signs = set()
        for step in range(1, steps + 1):
            for _ in range(8):
                rows, error = self.constraint()
                whole = np.vstack([rows, self.drives])
                left = np.concatenate([error, self.data.qpos[self.places] - lengths * step / steps])
                if np.abs(left).max() < 1e-12:
                    break
                mujoco.mj_integratePos(self.model, self.data.qpos, -np.linalg.solve(whole, left), 1)
            else:
                return False
            signs.add(np.sign(np.linalg.det(whole)))
            if len(signs) > 1:
                return False
        return True


def sliders(lower, upper):
    """Six slides in a row with the strokes of the legs: a sweep of them draws the same lengths."""
    links = ["ground", *(f"link{i}" for i in range(6))]
    tables = [
        f"[[joint]]\nname = 'leg{i + 1}'\ntype = 'prismatic'\nbetween = ['{links[i]}', '{links[i + 1]}']\n"
        f"origin = [0, 0, 0]\naxis = [0, 0, 1]\nactuated = true\n"
        f"limits = {{ lower = {lower[i]!r}, upper = {upper[i]!r} }}\n"
        for i in range(6)
    ]
    return cy.parse("".join(tables), "toml")


def test_a_platform_agrees_with_mujoco():
    platform = Platform()
    robot, legs = platform.robot.mechanism, platform.robot.actuated
    found = cy.sweep(robot, samples=200, seed=1, quantities=["pose", "measures"])
    closed = found["closed"] == 1
    own = {name: found[name][closed] for name in ("largest", "smallest", "volume")}
    theirs = {name: [] for name in own}
    for i in np.flatnonzero(closed):
        platform.put({name: column[i] for name, column in found.items()})
        efficiencies, error = platform.efficiencies()
        assert error < 1e-12
        for name, value in zip(theirs, (efficiencies[0], efficiencies[-1], efficiencies.prod() ** 0.5)):
            theirs[name].append(value)
    for name, values in own.items():
        np.testing.assert_allclose(
            statistics(values), statistics(np.array(theirs[name])), rtol=1e-9, err_msg=name
        )
    # What is not reached is not reached there: the legs meet a singularity on their way.
    lower, upper = (bounds.tolist() for bounds in platform.robot.limits[:2])
    drawn = cy.sweep(sliders(lower, upper), samples=200, seed=1, quantities=["pose"])
    lengths = np.stack([drawn[name] for name in legs], axis=1)
    np.testing.assert_array_equal(lengths[closed], np.stack([found[n][closed] for n in legs], 1))
    reached = np.array([platform.arrives(row) for row in lengths])
    np.testing.assert_array_equal(reached, closed)
    assert 0.5 < reached.mean() < 0.95
