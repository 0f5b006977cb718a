"""Random arguments of every public call, several at once: a result, or an error of the package that
names an argument; no panic, and no error that NumPy or PyO3 raise.

Without ``CYLINDROID_FUZZ_SECONDS`` a few thousand calls; with it as many as the time allows, from
the seed ``CYLINDROID_FUZZ_SEED`` on. ``cargo xtask fuzz`` sets both.
"""

import os
import time

import hypothesis.strategies as st
import numpy as np
from calls import calls
from hypothesis import HealthCheck, Phase, given, seed, settings
from test_arguments import is_named

import cylindroid as cy

#: Examples of one seed.
EXAMPLES = 2000

EDGES = [0.0, -0.0, 1.0, -1.0, 5e-324, 1e-160, 1e-9, 1e9, 1e120, 1e154, 1.7e308, np.nan, np.inf]
reals = st.one_of(st.floats(-2, 2), st.sampled_from(EDGES), st.floats())
shapes = st.lists(st.integers(0, 7), min_size=0, max_size=4).map(tuple)
integers = st.sampled_from([*range(-2, 8), -(2**63), 2**63 - 1, 2**63, 2**64, 10**40])
texts = st.one_of(
    st.sampled_from(["", "x", "x,y", "pose", "q1", "flange", "none of them", "\ud800", "\0"]),
    st.text(max_size=30),
)


@st.composite
def arrays(draw, shape=None):
    """An array of any shape, order and kind of numbers; entries are drawn from a few."""
    shape = draw(shapes) if shape is None else shape
    few = draw(st.lists(reals, min_size=1, max_size=4))
    pick = np.random.default_rng(draw(st.integers(0, 99)))
    with np.errstate(all="ignore"):
        array = pick.choice(few, shape).astype(
            draw(st.sampled_from(["f8", "f8", "f4", "i8", "c16", "O", "U", ">f8", "f2", "bool"]))
        )
    turned = draw(st.sampled_from(["as it is", "transposed", "reversed", "read only"]))
    if turned == "transposed":
        array = array.T
    elif turned == "reversed" and array.ndim:
        array = array[::-1]
    elif turned == "read only":
        array.setflags(write=False)
    return array


anything = st.recursive(
    st.one_of(st.none(), st.booleans(), integers, reals, texts, st.binary(max_size=5), arrays()),
    lambda inner: st.one_of(
        st.lists(inner, max_size=7),
        st.tuples(inner, inner),
        st.dictionaries(texts, inner, max_size=2),
    ),
    max_leaves=8,
)


def near(value):
    """Values of the kind of an argument that is accepted, and any other."""
    if isinstance(value, np.ndarray):
        same = arrays(value.shape)
        moved = st.floats(-1e-3, 1e-3).map(lambda x: value + x)
        rows = st.integers(0, 3).map(lambda n: np.stack([value] * n) if n else value[:0])
        return st.one_of(same, moved, rows, arrays(), anything)
    if isinstance(value, str):
        return st.one_of(texts, anything)
    if isinstance(value, bool) or not isinstance(value, (int, float, list, tuple)):
        return anything
    if isinstance(value, int):
        return st.one_of(integers, anything)
    if isinstance(value, float):
        return st.one_of(reals, anything)
    return st.one_of(st.lists(reals, min_size=len(value), max_size=len(value)), anything)


TABLE = list(calls())


def fuzz(number, examples, seen):
    @seed(number)
    @settings(
        max_examples=examples,
        deadline=None,
        database=None,
        suppress_health_check=list(HealthCheck),
        phases=[Phase.generate, Phase.shrink],
        print_blob=False,
    )
    @given(st.data())
    def body(data):
        name, call, arguments = data.draw(st.sampled_from(TABLE))
        chosen = data.draw(st.sets(st.sampled_from(sorted(arguments)), min_size=1, max_size=3))
        changed = {key: data.draw(near(arguments[key]), label=key) for key in sorted(chosen)}
        try:
            call(**arguments | changed)
            seen.append(name)
        except cy.CylindroidError as error:
            message = f"{type(error).__name__}: {error}"
            if isinstance(error, (cy.UnknownNameError, OSError, cy.ModelFileError)):
                return
            assert any(is_named(key, message) for key in arguments), f"{name}: {message}"
        except TypeError as error:
            # A function of the caller that cannot be called.
            assert "function" in changed, f"{name}: {error}"

    body()


def test_random_arguments():
    seconds = float(os.environ.get("CYLINDROID_FUZZ_SECONDS") or 0)
    first = int(os.environ.get("CYLINDROID_FUZZ_SEED") or 0)
    start, rounds, seen = time.monotonic(), 0, []
    while rounds == 0 or time.monotonic() - start < seconds:
        fuzz(first + rounds, EXAMPLES, seen)
        rounds += 1
    # Both ways were taken.
    assert EXAMPLES * rounds / 20 < len(seen) < EXAMPLES * rounds
