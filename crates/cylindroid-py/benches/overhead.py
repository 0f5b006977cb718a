"""What a call from Python costs beyond the library, and what a batch costs.

    cargo xtask bench             # the library's own times first, then these

Minima of many runs, one core.
"""

import itertools
import timeit

import numpy as np

import cylindroid as cy


def nanoseconds(call, number=20_000, repeat=9):
    return min(timeit.repeat(call, number=number, repeat=repeat)) / number * 1e9


def fresh(shape):
    """Memory that numpy has not touched yet, every page of it written once."""
    np.empty(shape).reshape(-1)[::512] = 0.0


def main():
    title = f"{'':28}{'one call':>12}{'in a batch':>14}{'with out=':>12}"
    print(f"{title}  (ns for each configuration)")
    rng, seeds = np.random.default_rng(0), itertools.count(1)
    for name in ("panda", "ur5e"):
        robot = cy.load(name)
        q, Q = robot.home, rng.uniform(-1, 1, (100_000, robot.n))
        J = robot.jacobian(q)
        for what, call, out in [
            ("fk", robot.fk, np.empty((len(Q), 4, 4))),
            ("jacobian", robot.jacobian, np.empty((len(Q), 6, robot.n))),
        ]:
            single = nanoseconds(lambda: call(q))
            batch = nanoseconds(lambda: call(Q), number=1) / len(Q)
            written = nanoseconds(lambda: call(Q, out=out), number=1) / len(Q)
            print(f"{name + ' ' + what:28}{single:12.0f}{batch:14.1f}{written:12.1f}")
        batch = nanoseconds(lambda: fresh((len(Q), 6, robot.n)), number=1) / len(Q)
        print(f"{'  its memory alone':28}{'':12}{batch:14.1f}")
        stack = robot.jacobian(Q[:1000])
        batch = nanoseconds(lambda: cy.pinv(stack), number=100) / len(stack)
        print(f"{name + ' pinv':28}{nanoseconds(lambda: cy.pinv(J)):12.0f}{batch:14.1f}")
        near = robot.fk(q + 0.1)
        single = nanoseconds(lambda: robot.ik(near), number=2000)
        fresh_solver = nanoseconds(lambda: robot.ik(near, seed=next(seeds)), number=200)
        print(f"{name + ' ik':28}{single:12.0f}    ({fresh_solver:.0f} with a new solver)")
        servo, target = cy.Servo(robot), robot.fk(q)
        target[2, 3] -= 0.05
        print(f"{name + ' servo step':28}{nanoseconds(lambda: servo.step(q, target)):12.0f}")
    print(f"{'an attribute':28}{nanoseconds(lambda: robot.n):12.0f}")


if __name__ == "__main__":
    main()
