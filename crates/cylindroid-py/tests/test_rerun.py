"""What is logged to Rerun, read back from its file."""

import numpy as np
import pytest
import rerun as rr
from calls import FIVE_BAR, PANDA
from rerun.chunk import RrdReader

import cylindroid as cy
import cylindroid.rerun

Q = np.random.default_rng(5).uniform(PANDA.lower, PANDA.upper, (4, 7))


@pytest.fixture
def recorded(tmp_path):
    """Logs and gives the columns of each entity."""

    def record(*arguments, **options):
        path = tmp_path / "robot.rrd"
        recording = rr.RecordingStream("cylindroid_test")
        recording.save(path)
        cylindroid.rerun.log(*arguments, recording=recording, **options)
        recording.flush()
        recording.disconnect()
        chunks = [chunk for chunk in RrdReader(path).stream() if "/__properties" not in chunk.entity_path]
        assert len({chunk.entity_path for chunk in chunks}) == len(chunks)
        return {chunk.entity_path: (chunk.timeline_names, chunk.to_record_batch().to_pydict()) for chunk in chunks}

    return record


def poses(columns):
    """Matrices, which Rerun has by columns."""
    T = np.tile(np.eye(4), (len(columns["Transform3D:translation"]), 1, 1))
    T[:, :3, 3] = np.squeeze(columns["Transform3D:translation"], 1)
    T[:, :3, :3] = np.reshape(columns["Transform3D:mat3x3"], (-1, 3, 3)).transpose(0, 2, 1)
    return T


def test_many_configurations_have_a_timeline(recorded):
    time = np.array([0.0, 0.5, 1.0, 2.0])
    entities = recorded(PANDA, {name: Q[:, i] for i, name in enumerate(PANDA.joint_names)}, time=time)
    for name in PANDA.frames:
        timelines, columns = entities[f"/panda/frames/{name}"]
        assert timelines == ["time"]
        assert [t.total_seconds() for t in columns["time"]] == list(time)
        np.testing.assert_allclose(poses(columns), PANDA.fk(Q, name), atol=1e-6)
    for i, name in enumerate(PANDA.joint_names):
        np.testing.assert_array_equal(np.squeeze(entities[f"/panda/q/{name}"][1]["Scalars:scalars"], 1), Q[:, i])
    strips = entities["/panda/links"][1]["LineStrips3D:strips"]
    assert len(strips) == 4
    flange = PANDA.joint_axes(Q)[:, 6, 0]
    ends = [min(np.linalg.norm(np.concatenate(of_one) - p, axis=1)) for of_one, p in zip(strips, flange)]
    assert max(ends) < 1e-6
    points = np.array(entities["/panda/joints"][1]["Points3D:positions"])
    np.testing.assert_allclose(points[:, :7], PANDA.joint_axes(Q)[:, :7, 0], atol=1e-6)
    steps = recorded(PANDA, Q, "cell/arm")["/cell/arm/links"]
    assert steps[0] == ["step"] and steps[1]["step"] == [0, 1, 2, 3]


def test_one_configuration_is_of_now(recorded):
    entities = recorded(FIVE_BAR, FIVE_BAR.home)
    timelines, columns = entities[f"/{FIVE_BAR.name}/frames/{FIVE_BAR.tool}"]
    assert "step" not in timelines and "time" not in timelines
    np.testing.assert_allclose(poses(columns)[0], FIVE_BAR.fk(FIVE_BAR.home), atol=1e-6)
    # Passive joints are white.
    colors = entities[f"/{FIVE_BAR.name}/joints"][1]["Points3D:colors"][0]
    assert len(set(colors)) == 2 and len(colors) == len(FIVE_BAR.joints)
    at = recorded(FIVE_BAR, FIVE_BAR.home, time=1.5)[f"/{FIVE_BAR.name}/links"][1]["time"]
    assert [t.total_seconds() for t in at] == [1.5]


def test_bodies_between_contacts(recorded):
    two = cy.load("two-arm")
    strips = recorded(two, two.home)[f"/{two.name}/links"][1]["LineStrips3D:strips"][0]
    near = [np.linalg.norm(np.array(strip)[:, None] - two.contact_points(two.home)[:, 1], axis=2) for strip in strips]
    assert any((distances.min(0) < 1e-6).all() for distances in near)


def test_times_are_as_many(recorded):
    with pytest.raises(cy.InvalidOptionError, match=r"time has shape \(3,\).*\(4, 7\)"):
        recorded(PANDA, Q, time=[0, 1, 2])
    with pytest.raises(cy.InvalidOptionError, match="no column 'panda_joint1'"):
        recorded(PANDA, {"a": 1.0})
