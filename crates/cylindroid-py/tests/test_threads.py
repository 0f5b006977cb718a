"""What is long leaves the interpreter to other threads; what is shared gives the same answers."""

import os
import sys
import threading

import numpy as np
import pytest

import cylindroid as cy

panda, stewart, linkage = cy.load("panda"), cy.load("stewart"), cy.load("four-bar")
Q = np.random.default_rng(1).uniform(panda.lower, panda.upper, (20_000, 7))
FAR = np.eye(4)
FAR[0, 3] = 5.0


def beside(call):
    """Whether another thread came to its turn while `call` ran.

    Python itself takes no thread its turn away within the interval, which is longer than any call
    here: only one that gives it up lets the other on.
    """
    began, over, seen = threading.Event(), [], []

    def work():
        began.set()
        call()
        over.append(True)

    interval = sys.getswitchinterval()
    sys.setswitchinterval(1000.0)
    try:
        thread = threading.Thread(target=work)
        thread.start()
        began.wait()
        seen.append(not over)
    finally:
        sys.setswitchinterval(interval)
        thread.join()
    return seen[0]


@pytest.mark.parametrize(
    "call",
    [
        lambda: panda.fk(Q),
        lambda: panda.fk_all(Q),
        lambda: panda.jacobian(Q),
        lambda: panda.jacobian_dot(Q, Q),
        lambda: panda.hessian(Q),
        lambda: panda.analytical_jacobian(Q),
        lambda: panda.relative_jacobian(Q, "link4"),
        lambda: panda.integrate(Q, Q, 0.1),
        lambda: panda.ik(FAR, iterations=2000),
        lambda: panda.ik_all(FAR, iterations=2000),
        lambda: cy.pinv(np.ones((5000, 6, 7))),
        lambda: cy.Servo(panda).simulate(panda.home, FAR, duration=5.0),
        lambda: cy.Servo(panda).find_reachable_configuration(panda.home, FAR, max_restarts=3),
        lambda: panda.constraint(Q[:500]),
        lambda: panda.mobility(Q[:500]),
        lambda: panda.manipulability(Q[:500]),
        lambda: stewart.mobility().singularity,
        lambda: linkage.assembly_modes(hold=linkage.joint_names[:1]),
        lambda: linkage.track_path(linkage.home, {linkage.joint_names[0]: 0.5}, step=1e-3),
        lambda: stewart.constraint().velocity_polytope(np.ones(6)),
    ],
)
def test_long_calls_leave_the_interpreter(call):
    # A busy machine may be slow to wake the other thread, so once in many times is enough; a call
    # that kept the interpreter would be seen never.
    assert any(beside(call) for _ in range(20))


def test_a_call_that_keeps_the_interpreter_is_seen():
    assert not any(beside(lambda: [panda.fk(q) for q in Q[:2000]]) for _ in range(5))


def test_threads_run_side_by_side():
    expected = panda.jacobian(Q)
    found = [None] * 4

    def work(i):
        found[i] = panda.jacobian(Q)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    for J in found:
        np.testing.assert_array_equal(J, expected)


def test_batches_in_forked_processes():
    """A child has none of its parent's threads: it makes its own."""
    expected = panda.jacobian(Q)
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        same = np.array_equal(panda.jacobian(Q), expected)
        os.write(write, b"y" if same else b"n")
        os._exit(0)
    os.waitpid(child, 0)
    assert os.read(read, 1) == b"y"


def test_batches_are_single_calls_whatever_their_size():
    for robot in (panda, stewart, linkage):
        rng = np.random.default_rng(2)
        for count in (1, 2, 5, 9000):
            q = rng.uniform(-1.0, 1.0, (count, robot.n))
            poses, jacobians = robot.fk(q), robot.jacobian(q)
            for i in (0, count // 2, count - 1):
                np.testing.assert_allclose(poses[i], robot.fk(q[i]), rtol=0, atol=1e-13)
                np.testing.assert_allclose(jacobians[i], robot.jacobian(q[i]), rtol=0, atol=1e-13)
