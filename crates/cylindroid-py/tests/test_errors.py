"""Every error is a CylindroidError, is what Python users catch, and says what to do."""

import numpy as np
import pytest

import cylindroid as cy

panda = cy.load("panda")
q = panda.home


def test_classes():
    for name in cy.__all__:
        thing = getattr(cy, name)
        if isinstance(thing, type) and issubclass(thing, BaseException):
            assert issubclass(thing, cy.CylindroidError)
            assert issubclass(
                thing, (ValueError, KeyError, OSError, TypeError, RuntimeError)
            ) or thing is cy.CylindroidError


@pytest.mark.parametrize(
    ("call", "kind", "python", "words"),
    [
        (lambda: cy.load("pnda"), cy.UnknownNameError, KeyError, "nearest: panda"),
        (lambda: cy.load("none.urdf"), cy.MissingFileError, FileNotFoundError, "none.urdf"),
        (lambda: cy.parse("<robot"), cy.ModelFileError, ValueError, "1:"),
        (lambda: cy.parse("", "obj"), cy.UnknownNameError, KeyError, "no format named 'obj'"),
        (lambda: panda.fk(q, "hand"), cy.UnknownNameError, KeyError, "no frame named 'hand'"),
        (lambda: panda.fk(q[:6]), cy.DimensionError, ValueError, "expected 7"),
        (lambda: panda.fk(np.zeros((5, 6))), cy.DimensionError, ValueError, "panda_joint7"),
        (lambda: panda.fk([]), cy.DimensionError, ValueError, "expected 7"),
        (lambda: panda.fk(np.zeros((2, 2, 7))), cy.InvalidOptionError, ValueError, "(N, 7)"),
        (lambda: panda.fk(0.0), cy.InvalidOptionError, ValueError, "shape ()"),
        (lambda: panda.fk(q * np.nan), cy.NotFiniteError, ValueError, "panda_joint1"),
        (lambda: panda.fk([q, q + np.inf]), cy.NotFiniteError, ValueError, "q[1]"),
        (lambda: panda.jacobian(q, reference="base"), cy.UnknownNameError, KeyError, "reference"),
        (lambda: panda.fk(q, tool=np.ones((4, 4))), cy.InvalidOptionError, ValueError, "0 0 0 1"),
        (lambda: panda.fk(q, tool=np.eye(3)), cy.InvalidOptionError, ValueError, "4 x 4"),
        (lambda: panda.jacobian_dot(q, [q]), cy.InvalidOptionError, ValueError, "as many"),
        (lambda: panda.with_actuated(["x"]), cy.UnknownNameError, KeyError, "no joint"),
        (lambda: cy.pinv(np.ones(3)), cy.InvalidOptionError, ValueError, "two axes"),
        (lambda: cy.pinv([[np.nan]]), cy.NotFiniteError, ValueError, "(0, 0)"),
        (lambda: cy.pinv(np.eye(2), 1.0), cy.InvalidOptionError, ValueError, "eps"),
        (lambda: cy.damped(np.eye(2), 0.0), cy.InvalidOptionError, ValueError, "damping"),
        (lambda: cy.inverse(np.eye(2), "moore"), cy.UnknownNameError, KeyError, "inverse"),
        (lambda: cy.inverse(np.eye(2), damping=1), cy.InvalidOptionError, ValueError, "eps"),
        (lambda: cy.hyperbolic(np.eye(3), 0.1), cy.DimensionError, ValueError, "expected 6"),
        (lambda: cy.hyperbolic(np.eye(6), np.nan), cy.NotFiniteError, ValueError, "pitch"),
    ],
)
def test_errors(call, kind, python, words):
    with pytest.raises(kind) as caught:
        call()
    assert isinstance(caught.value, python)
    assert isinstance(caught.value, cy.CylindroidError)
    assert words in str(caught.value)


@pytest.mark.parametrize(
    "value", [None, "0", 1j * np.zeros(7), object(), {1.0}, np.array([None] * 7)]
)
def test_what_is_no_number(value):
    with pytest.raises(TypeError, match="real numbers"):
        panda.fk(value)
    with pytest.raises((TypeError, ValueError)):
        panda.fk([[1.0], [1.0, 2.0]])


def test_fields():
    with pytest.raises(cy.UnknownNameError) as caught:
        cy.load("pnda")
    assert caught.value.name == "pnda" and caught.value.similar[0] == "panda"
    with pytest.raises(cy.DimensionError) as caught:
        panda.fk(q[:6])
    assert (caught.value.expected, caught.value.got) == (7, 6)
    with pytest.raises(cy.ModelFileError) as caught:
        cy.parse('<robot name="r">\n<link/></robot>', path="r.urdf")
    assert caught.value.line == 2 and caught.value.path == "r.urdf"
    with pytest.raises(cy.MissingFileError) as caught:
        cy.load("none.urdf")
    assert caught.value.filename == "none.urdf"


def test_memory_that_is_not_there():
    many = np.broadcast_to(q, (1, 7))
    assert panda.hessian(many).shape == (1, 7, 6, 7)
    huge = np.lib.stride_tricks.as_strided(q, (1 << 45, 7), (0, 8))
    with pytest.raises((MemoryError, ValueError)):
        panda.fk(huge)


def test_an_infinite_jacobian_is_named():
    J = np.full((6, 3), np.inf)
    for call in (lambda: cy.hyperbolic_svd(J, 0.1), lambda: cy.ScrewSystem(J), lambda: cy.gram(J, 0.1)):
        with pytest.raises(cy.NotFiniteError, match=r"^J\[0\] is not finite"):
            call()
