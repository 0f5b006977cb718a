"""`show`: pages follow the program, the program learns what is dragged, and nobody else comes in."""

import gc
import os
import queue
import shlex
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.parse
import urllib.request
import warnings
from pathlib import Path

import numpy as np
import pytest
from websocket import Page

import cylindroid as cy

PANDA, FIVE_BAR = cy.load("panda"), cy.load("five-bar")
#: Generous: another program may have the processor.
PATIENCE = 60


@pytest.fixture
def view():
    with cy.show(PANDA, open=False) as view:
        yield view


def state_with(page, q):
    return page.until(lambda m: m["type"] == "state" and np.array_equal(m["q"], q))


def position(pose):
    return pose["position"]


def test_pages_follow_the_program(view):
    pages = [Page(view.url), Page(view.url)]
    for k in range(1, 6):
        q = PANDA.home + 0.01 * k
        view.q = q
        np.testing.assert_array_equal(view.q, q)
        for page in pages:
            state = state_with(page, q)
            assert state["servo"]["sentence"] == "A program sets the configuration."
            # Nobody has placed the target.
            np.testing.assert_allclose(position(state["target"]), PANDA.fk(q)[:3, 3], atol=1e-12)
    assert view.pages == 2 and not view.playing
    columns = {name: [x] for name, x in zip(PANDA.joint_names, PANDA.home)}
    view.q = {name: x[0] for name, x in reversed(columns.items())}
    np.testing.assert_array_equal(view.q, PANDA.home)


def test_one_page_drives(view):
    driver = Page(view.url)
    about = driver.next("session")
    assert about["driver"] == "you" and about["program"] and about["name"] is None
    observer = Page(view.url)
    assert observer.next("session")["driver"] == "another"
    observer.say(type="joint", name="panda_joint1", value=0.1)
    assert observer.next("error")["place"] == "session"
    observer.say(type="drive", on=True)
    assert driver.until(lambda m: m["type"] == "session" and m["driver"] == "another")


def test_the_target_is_dragged_there_and_here(view):
    page = Page(view.url)
    found = queue.Queue()

    @view.on_target
    def follow(target):
        found.put(target)
        view.q = PANDA.home + 0.1

    page.say(type="target", position=[0.4, 0.1, 0.5], quaternion=[0, 1, 0, 0])
    target = found.get(timeout=PATIENCE)
    np.testing.assert_allclose(target[:3, 3], [0.4, 0.1, 0.5], atol=0)
    np.testing.assert_allclose(target, view.target, atol=0)
    # The target stays where it was put while the program moves the robot.
    state = state_with(page, PANDA.home + 0.1)
    np.testing.assert_allclose(position(state["target"]), [0.4, 0.1, 0.5], atol=0)

    goal = PANDA.fk(PANDA.home)
    goal[:3, 3] += [0.0, 0.1, 0.05]
    view.target = goal
    page.until(lambda m: m["type"] == "state" and abs(m["target"]["position"][1] - goal[1, 3]) < 1e-12)
    assert found.empty(), "the program is not told what it does itself"
    # The servo of the page goes there if it plays.
    view.playing = True
    state = page.until(lambda m: m["type"] == "state" and m["servo"]["status"] == "reached")
    np.testing.assert_allclose(PANDA.fk(view.q), goal, atol=2e-3)


def test_joints_and_obstacles_are_dragged(view):
    view.add_obstacle("ball", "sphere", [0.5, 0, 0.5], radius=0.1)
    page, found = Page(view.url), queue.Queue()
    assert page.next("scene")["obstacles"] == [{"name": "ball", "kind": "sphere", "radius": 0.1}]
    view.on_configuration(lambda q: found.put(("q", q)))
    view.on_obstacle(lambda name, pose: found.put((name, pose)))
    page.say(type="joint", name="panda_joint1", value=0.25)
    what, q = found.get(timeout=PATIENCE)
    assert what == "q" and q[0] == 0.25
    page.say(type="move_obstacle", name="ball", position=[0.5, 0.2, 0.5], quaternion=[1, 0, 0, 0])
    what, pose = found.get(timeout=PATIENCE)
    assert what == "ball" and pose[1, 3] == 0.2
    view.move_obstacle("ball", [0, 0, 1])
    page.until(lambda m: m["type"] == "state" and m["obstacles"][0]["position"] == [0, 0, 1])
    view.remove("ball")
    page.until(lambda m: m["type"] == "scene" and m["obstacles"] == [])


def test_what_is_held_moves_the_target_and_self_motions_the_joints(view):
    targets, joints = queue.Queue(), queue.Queue()
    view.on_target(targets.put)
    view.on_configuration(joints.put)
    page = Page(view.url)
    page.say(type="twist", linear=[0, 0.1, 0], angular=[0, 0, 0])
    # The first states, before the twist is heard, are of a robot at rest as well.
    begin = PANDA.fk(PANDA.home)[1, 3]
    rested = page.until(
        lambda m: m["type"] == "state"
        and m["servo"]["status"] == "reached"
        and position(m["tool"])[1] > begin + 0.01
    )
    target = targets.get(timeout=PATIENCE)
    while abs(target[1, 3] - position(rested["tool"])[1]) > 1e-12:
        last, target = target, targets.get(timeout=PATIENCE)
        assert target[1, 3] > last[1, 3] - 1e-9
    assert joints.empty()
    page.say(type="null_space", rate=0.5)
    q = joints.get(timeout=PATIENCE)
    # The last steps of braking moved it by less than is seen above.
    while not targets.empty():
        np.testing.assert_allclose(targets.get()[:3, 3], target[:3, 3], atol=1e-9)
    while abs(q[0] - PANDA.home[0]) < 0.05:
        q = joints.get(timeout=PATIENCE)
    assert targets.empty()


def test_an_error_of_a_function_ends_nothing(view, monkeypatch):
    told, found = queue.Queue(), queue.Queue()
    monkeypatch.setattr("sys.unraisablehook", told.put)
    view.on_target(lambda target: 1 / 0)
    view.on_target(found.put)
    page = Page(view.url)
    for _ in range(2):
        page.say(type="target", position=[0.4, 0.1, 0.5], quaternion=[0, 1, 0, 0])
        assert told.get(timeout=PATIENCE).exc_type is ZeroDivisionError
        assert found.get(timeout=PATIENCE).shape == (4, 4)


def test_drawings(view):
    view.add_line("path", [[0, 0, 0], [0, 0, 1]], rgba=[1, 0, 0, 1])
    page = Page(view.url)
    line = {"name": "path", "kind": "line", "points": [[0, 0, 0], [0, 0, 1]], "rgba": [1, 0, 0, 1]}
    assert page.next("drawings")["drawings"] == [line]
    view.add_frame("grasp", PANDA.fk(PANDA.home), size=0.1)
    view.add_points("cloud", np.zeros((2, 3)))
    drawn = page.until(lambda m: m["type"] == "drawings" and len(m["drawings"]) == 3)["drawings"]
    assert [d["name"] for d in drawn] == ["cloud", "grasp", "path"]
    assert drawn[1]["kind"] == "frame" and drawn[1]["size"] == 0.1
    # One of the same name takes its place.
    view.add_frame("path", [0, 0, 1])
    view.remove("cloud")
    page.until(lambda m: m["type"] == "drawings" and [d["kind"] for d in m["drawings"]] == ["frame"] * 2)


@pytest.mark.parametrize(
    ("error", "word", "call"),
    [
        (cy.UnknownNameError, "pth", lambda view: view.remove("pth")),
        (cy.InvalidOptionError, "points", lambda view: view.add_line("a", np.zeros((2, 2)))),
        (cy.NotFiniteError, "points", lambda view: view.add_points("a", [[0, 0, np.nan]])),
        (cy.InvalidOptionError, "100000", lambda view: view.add_points("a", np.zeros((100_001, 3)))),
        (cy.InvalidOptionError, "rgba", lambda view: view.add_line("a", np.zeros((2, 3)), [2, 0, 0, 1])),
        (cy.InvalidOptionError, "name", lambda view: view.add_frame("", [0, 0, 0])),
        (cy.DimensionError, "q", lambda view: setattr(view, "q", [0.0])),
        (cy.NotFiniteError, "q", lambda view: setattr(view, "q", PANDA.home * np.nan)),
        (cy.UnknownNameError, "sphere", lambda view: view.add_obstacle("a", "spere", radius=1.0)),
        (cy.InvalidOptionError, "convex_hull",
         lambda view: view.add_obstacle("a", "convex_hull", [0, 0, 0])),
    ],
)
def test_errors_name_what_is_wrong(view, error, word, call):
    view.add_line("path", np.zeros((2, 3)))
    with pytest.raises(error, match=word):
        call(view)
    np.testing.assert_array_equal(view.q, PANDA.home)


def answer(url):
    try:
        with urllib.request.urlopen(url, timeout=PATIENCE) as found:
            return found.status, found.headers
    except urllib.error.HTTPError as error:
        return error.code, error.headers


def test_only_who_knows_the_address_comes_in(view):
    root, token = view.url.rstrip("/").rsplit("/", 1)
    assert len(token) == 32 and root.startswith("http://127.0.0.1:")
    status, headers = answer(view.url)
    assert status == 200 and headers["Content-Type"].startswith("text/html")
    assert headers["X-Frame-Options"] == "DENY"
    assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]
    for path in ("/", "/index.html", "/ws", "/mesh/0/a.stl", f"/{token}x/", f"/{token[:-1]}/"):
        assert answer(root + path)[0] == 404, path
    for other in (f"{root}/", f"{root}/{'a' * 32}/"):
        assert Page(other).status == 404
    assert view.pages == 0


def test_a_notebook_may_frame_the_page():
    with cy.show(PANDA, open=False, frame_ancestors="http://localhost:8888") as view:
        headers = answer(view.url)[1]
        assert "X-Frame-Options" not in headers
        assert headers["Content-Security-Policy"].endswith("frame-ancestors http://localhost:8888")
    for evil in ("*; script-src *", "http://a, http://b", "a\nb"):
        with pytest.raises(cy.InvalidOptionError, match="frame_ancestors"):
            cy.show(PANDA, open=False, frame_ancestors=evil)


def test_a_closed_view_is_over(view):
    page = Page(view.url)
    page.next("state")
    assert not view.wait(timeout=0.01)
    view.close()
    view.close()
    assert view.closed and view.pages == 0 and view.wait()
    with pytest.raises(OSError):
        Page(view.url)
    with pytest.raises(cy.InUseError, match="closed"):
        view.q = PANDA.home


def test_one_waits_for_the_pages():
    with cy.show(PANDA, open=False) as view:
        page = Page(view.url)
        page.next("state")
        waited = threading.Thread(target=view.wait)
        waited.start()
        page.close()
        waited.join(PATIENCE)
        assert not waited.is_alive()


def test_one_waits_for_each_page_once():
    with cy.show(PANDA, open=False) as view:
        assert not view.wait(timeout=0.0)
        page = Page(view.url)
        page.next("state")
        assert not view.wait(timeout=0.0)
        page.close()
        deadline = time.monotonic() + PATIENCE
        while view.pages and time.monotonic() < deadline:
            time.sleep(0.01)
        # It has come and gone before.
        assert view.wait(timeout=0.0)
        assert not view.wait(timeout=0.0)


def test_a_view_that_nobody_holds_stays_open():
    url = cy.show(PANDA, open=False).url
    gc.collect()
    assert answer(url)[0] == 200


def test_threads_share_a_view(view):
    page = Page(view.url)

    def work(i):
        for k in range(200):
            view.q = PANDA.home + 1e-3 * (k + i)
            view.add_frame(f"f{i}", [0, 0, 0.01 * k])

    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    view.q = PANDA.home
    state_with(page, PANDA.home)


def test_loops_may_be_open():
    q = FIVE_BAR.home + 0.1
    with cy.show(FIVE_BAR, open=False) as view:
        page = Page(view.url)
        view.q = q
        assert not state_with(page, q)["closure_error"]["closed"]


def test_who_lets_others_in_is_warned_and_told_their_address():
    with pytest.warns(UserWarning, match="everyone on the network") as told:
        view = cy.show(PANDA, open=False, host="0.0.0.0")
    with view:
        token = urllib.parse.urlsplit(view.url).path
        assert urllib.parse.urlsplit(view.url_for_others).path == token
        assert view.url.startswith("http://127.0.0.1:") and view.url_for_others in str(told[0].message)
        assert told[0].filename == __file__
        assert answer(view.url_for_others)[0] == 200
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with cy.show(PANDA, open=False) as view:
            assert view.url_for_others is None


#: A program with a view, which says its address and then does this.
PROGRAM = """
import sys, threading, time
import cylindroid as cy
view = cy.show(cy.load("panda"), open=False)
view.on_target(lambda target: print("moved", flush=True))
print(view.url, flush=True)
"""


@pytest.mark.parametrize(
    ("end", "code"),
    [
        ("", 0),
        ("sys.exit(3)", 3),
        ("1 / 0", 1),
        # The function still runs.
        ("view.on_target(lambda target: time.sleep(1000)); sys.stdin.readline()", 0),
        ("time.sleep(1000)", -signal.SIGTERM),
    ],
)
def test_a_view_ends_with_its_program(end, code):
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    # What the program does at the end waits until it is told to.
    command = [sys.executable, "-c", f"{PROGRAM}sys.stdin.readline()\n{end}"]
    with subprocess.Popen(command, **pipes) as program:
        url = program.stdout.readline().strip()
        page = Page(url)
        page.say(type="target", position=[0.4, 0.1, 0.5], quaternion=[0, 1, 0, 0])
        assert program.stdout.readline() == "moved\n"
        begin = time.monotonic()
        program.stdin.write("\n")
        program.stdin.flush()
        if "readline" in end:
            page.say(type="target", position=[0.4, 0.2, 0.5], quaternion=[0, 1, 0, 0])
            assert program.stdout.readline() == "moved\n"
            program.stdin.write("\n")
            program.stdin.flush()
        if code < 0:
            program.terminate()
        assert program.wait(PATIENCE) == code, program.stderr.read()
        assert ("<lambda> of a view is cut off" in program.stderr.read()) == ("readline" in end)
        # One that waits for something, such as its function or a page, waits for more than this.
        assert time.monotonic() - begin < 20
    address = urllib.parse.urlsplit(url)
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection((address.hostname, address.port), timeout=PATIENCE)


def test_a_thread_may_show_a_robot():
    views = queue.Queue()
    thread = threading.Thread(target=lambda: views.put(cy.show(PANDA, open=False)))
    thread.start()
    thread.join(PATIENCE)
    # It outlives the thread.
    with views.get(timeout=PATIENCE) as view:
        page = Page(view.url)
        view.q = PANDA.home + 0.1
        state_with(page, PANDA.home + 0.1)


def test_the_browser_opens_the_address(tmp_path):
    browser, opened = tmp_path / "browser.py", tmp_path / "opened"
    browser.write_text('import sys\nopen(sys.argv[2], "a").write(sys.argv[1] + "\\n")\n')
    # A command line with the place of the address, as `webbrowser` takes it on every system.
    words = [shlex.quote(Path(word).as_posix()) for word in (sys.executable, browser, opened)]
    command = f"{words[0]} {words[1]} %s {words[2]}"
    program = """
import threading
import cylindroid as cy
views = [cy.show(cy.load("panda"))]
thread = threading.Thread(target=lambda: views.append(cy.show(cy.load("ur5e"), open=True)))
thread.start()
thread.join()
views[0].open()
print(*[view.url for view in [*views, views[0]]], sep="\\n")
"""
    done = subprocess.run(
        [sys.executable, "-c", program], env={**os.environ, "BROWSER": command},
        capture_output=True, text=True, check=True, timeout=PATIENCE,
    )
    assert done.stdout.splitlines() == opened.read_text().splitlines()
