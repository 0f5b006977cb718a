"""Groups, states and end effectors of an SRDF; mechanisms with fixed joints and other tools."""

import pickle

import numpy as np
import pytest
from calls import GROUPS, SRDF

import cylindroid as cy

PANDA = cy.load("panda")


def test_a_group_moves_alone():
    q = GROUPS.configuration("up", PANDA)
    assert q[5] == 1.0
    np.testing.assert_array_equal(GROUPS.configuration("forearm/up", PANDA), q)
    forearm = GROUPS.group("forearm", PANDA, q)
    assert forearm.joint_names == GROUPS.joints("forearm", PANDA)
    assert (forearm.n, forearm.tool) == (3, "link7")
    np.testing.assert_allclose(forearm.fk(q[4:]), PANDA.fk(q, frame="link7"), atol=1e-15)
    np.testing.assert_allclose(
        forearm.jacobian(q[4:]), PANDA.jacobian(q, frame="link7")[:, 4:], atol=1e-15
    )
    again = pickle.loads(pickle.dumps(forearm))
    assert again.tool == "link7"
    np.testing.assert_array_equal(again.home, forearm.home)


def test_what_an_srdf_says(tmp_path, monkeypatch):
    assert (GROUPS.groups, GROUPS.states) == (["forearm"], [("forearm", "up")])
    assert GROUPS.end_effectors == [("grip", "link7")]
    assert GROUPS.disabled_collisions == [("link1", "link2")]
    assert repr(GROUPS) == "<Srdf: 1 groups, 1 states, 1 end effectors>"
    (tmp_path / "panda.srdf").write_text(SRDF)
    monkeypatch.chdir(tmp_path)
    kept = pickle.dumps(cy.Srdf("panda.srdf"))
    monkeypatch.chdir("/")
    assert pickle.loads(kept).groups == GROUPS.groups
    with pytest.raises(cy.UnreadableFileError, match="none.srdf"):
        cy.Srdf("none.srdf")
    with pytest.raises(cy.ModelFileError, match="<group> has no name"):
        cy.Srdf("r.srdf", "<robot><group/></robot>")
    with pytest.raises(cy.UnknownNameError, match="nearest: forearm"):
        GROUPS.group("forarm", PANDA)
    with pytest.raises(cy.UnknownNameError, match="no state named 'down'"):
        GROUPS.configuration("down", PANDA)


def test_fixed_joints_and_tools():
    q = PANDA.home + 0.1
    fixed = PANDA.with_fixed_joints(["panda_joint3", "panda_joint5"], q)
    keep = [0, 1, 3, 5, 6]
    np.testing.assert_array_equal(fixed.home, q[keep])
    np.testing.assert_allclose(fixed.fk(q[keep]), PANDA.fk(q), atol=1e-15)
    elbow = fixed.with_tool("link4")
    assert (elbow.tool, elbow.tool_choice) == ("link4", "named by the model")
    again = pickle.loads(pickle.dumps(elbow))
    assert (again.joint_names, again.tool) == (fixed.joint_names, "link4")
    with pytest.raises(cy.InvalidOptionError, match="closes a loop"):
        cy.load("five-bar").with_fixed_joints(["q5"])


def test_what_an_srdf_ignores():
    text = "<robot name='r'>\n<virtual_joint name='v'/>\n<group name='g' rank='2'/>\n</robot>"
    report = cy.Srdf("r.srdf", text).report
    assert report.format == "SRDF"
    found = [(line, what) for line, what, _ in report.ignored]
    assert found == [(2, "<virtual_joint>"), (3, "attribute 'rank' of <group> (g)")]
    assert not GROUPS.report.ignored
