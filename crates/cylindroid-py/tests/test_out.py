"""Results that are written into an array of the caller."""

import numpy as np
import pytest
from calls import PANDA

import cylindroid as cy

rng = np.random.default_rng(6)


@pytest.mark.parametrize("name", ["panda", "five-bar", "two-arm", "stewart"])
@pytest.mark.parametrize("count", [None, 0, 1, 9, 5000])
def test_every_number_is_written(name, count):
    robot = cy.load(name)
    shape = (robot.n,) if count is None else (count, robot.n)
    q = rng.uniform(-1.0, 1.0, shape)
    for frame in (robot.tool, robot.frames[0], robot.frames[len(robot.frames) // 2]):
        for call in (robot.fk, robot.jacobian):
            expected = call(q, frame)
            out = np.full_like(expected, np.nan)
            assert call(q, frame, out=out) is out
            np.testing.assert_array_equal(out, expected)


def test_parts_of_arrays_are_places():
    q, all = rng.uniform(-1.0, 1.0, (4, 7)), np.full((6, 6, 7), np.nan)
    PANDA.jacobian(q, out=all[1:5])
    np.testing.assert_array_equal(all[1:5], PANDA.jacobian(q))
    assert np.isnan(all[[0, 5]]).all()


def test_arrays_that_cannot_hold_the_result_are_refused():
    q = rng.uniform(-1.0, 1.0, (4, 7))
    read_only = np.zeros((4, 6, 7))
    read_only.flags.writeable = False
    of_all = np.zeros((4, 6, 7))
    for out, error, match in [
        (np.zeros((4, 7, 6)), cy.InvalidOptionError, r"out = \(4, 7, 6\).*\(4, 6, 7\)"),
        (np.zeros((6, 7)), cy.InvalidOptionError, "out"),
        (np.zeros((4, 6, 7), "f4"), cy.ArgumentTypeError, "out.*float64"),
        ([[0.0]], cy.ArgumentTypeError, "out.*float64.*list"),
        (np.zeros((4, 6, 14))[..., ::2], cy.InvalidOptionError, "out.*C order"),
        (read_only, cy.InvalidOptionError, "out"),
    ]:
        with pytest.raises(error, match=match):
            PANDA.jacobian(q, out=out)
    of_all[:] = 1.0
    with pytest.raises(cy.InvalidOptionError, match="out.*reads it"):
        PANDA.jacobian(of_all.reshape(-1)[:28].reshape(4, 7), out=of_all)
    assert (of_all == 1.0).all()
    q[2, 3] = np.nan
    with pytest.raises(cy.NotFiniteError, match="panda_joint4"):
        PANDA.jacobian(q, out=of_all)
    assert (of_all == 1.0).all()
