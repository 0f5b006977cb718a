"""A simulated robot on the other side of DDS: it publishes joint states, and its drives follow the
commands with a lag."""

import math
import threading
import time

import ros_messages as ros
from cyclonedds.core import Listener

RATE = 250.0


class Robot(threading.Thread):
    """Joints with drives of first order, at a rate of its own."""

    def __init__(self, participant, names, start, time_constant=0.01):
        super().__init__(daemon=True)
        self.names, self.q, self.velocities = list(names), list(start), [0.0] * len(names)
        self.time_constant = time_constant
        self.is_silent = False
        self.is_stuck = False
        self.arrivals = []  # of commands: time, largest velocity
        self.goal, self.goal_velocities = list(start), None
        self.lock = threading.Lock()
        self.states = ros.writer(participant, "/joint_states", ros.JointState, depth=1)
        topic = "/joint_trajectory_controller/joint_trajectory"
        self.trajectories = ros.reader(
            participant, topic, ros.JointTrajectory, Arrival(self.follow), depth=50
        )
        topic = "/forward_velocity_controller/commands"
        self.arrays = ros.reader(
            participant, topic, ros.Float64MultiArray, Arrival(self.drive), depth=50
        )
        self.is_running = True

    def follow(self, message):
        """A trajectory's point."""
        assert message.header.stamp == ros.Time() and list(message.joint_names) == self.names
        (point,) = message.points
        assert point.time_from_start == ros.Duration(0, int(1e9 / RATE))
        with self.lock:
            self.goal, self.goal_velocities = list(point.positions), None
            self.note(point.velocities)

    def drive(self, message):
        """Velocities."""
        with self.lock:
            self.goal_velocities = list(message.data)
            self.note(message.data)

    def note(self, velocities):
        assert len(velocities) == len(self.names) and all(map(math.isfinite, velocities))
        self.arrivals.append((time.monotonic(), max(map(abs, velocities))))

    def run(self):
        dt = 1.0 / RATE
        share = dt / (dt + self.time_constant)
        due = time.monotonic()
        while self.is_running:
            with self.lock:
                for i, q in enumerate(self.q):
                    if self.goal_velocities is None:
                        wanted = (self.goal[i] - q) / dt * share
                    else:
                        before = self.velocities[i]
                        wanted = before + (self.goal_velocities[i] - before) * share
                    self.velocities[i] = 0.0 if self.is_stuck else wanted
                    self.q[i] = q + dt * self.velocities[i]
                # Joints of others are in joint states too, and the order is not that of the model.
                names = ["gripper", *reversed(self.names)]
                positions = [0.04, *reversed(self.q)]
            if not self.is_silent:
                state = ros.JointState(ros.Header(ros.Time(), ""), names, positions, [], [])
                self.states.write(state)
            due += dt
            time.sleep(max(0.0, due - time.monotonic()))

    def speed(self):
        """The largest velocity of a joint."""
        with self.lock:
            return max(map(abs, self.velocities))

    def taken(self):
        """The arrivals since the last call."""
        with self.lock:
            arrivals, self.arrivals = self.arrivals, []
        return arrivals


class Arrival(Listener):
    """Hands every message to a function, in the thread of its arrival."""

    def __init__(self, take):
        super().__init__()
        self.take = take

    def on_data_available(self, reader):
        if reader is None:
            return  # on its way
        for message in reader.take(N=50):
            # Others say that a writer has left.
            if message.sample_info.valid_data:
                self.take(message)
