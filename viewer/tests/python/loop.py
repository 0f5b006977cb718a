"""Moves a robot at 100 Hz once two pages see it; prints when each configuration was set."""

import json
import sys
import time

import cylindroid as cy

robot = cy.load("panda")
times = []
with cy.show(robot, open=False) as view:
    print(view.url, flush=True)
    while view.pages < 2:
        time.sleep(0.01)
    sys.stdin.readline()
    begin = time.perf_counter()
    for k in range(500):
        while time.perf_counter() - begin < 0.01 * k:
            time.sleep(0.001)
        q = robot.home
        q[0] = 1e-3 * k  # its number
        view.q = q
        times.append(1e3 * time.time())
        view.add_frame("hand", robot.fk(q))
    print(json.dumps(times), flush=True)
    sys.stdin.readline()
