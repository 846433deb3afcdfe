"""A robot of rclpy drives around a block and back to its start, with odometry that drifts: the node closes the loop. Measures
the longest time between two transforms from then on; CycloneDDS hears them in another program.

Arguments: a folder for files, the program curious_node, the program sim_node (not used), the number of scans of the way around
and of their beams (1200 61: as fast as a robot drives), and parameters as NAME:=VALUE. The scans before the loop are sent faster
than a robot measures them, those from there on at 10 Hz.
"""

import os
import subprocess
import sys
import time
import tomllib

import numpy as np
from drive_ros2 import CURIOUS, DISCOVERY_S, WORK, Program, Robot, check, parameter

HERE = os.path.dirname(os.path.abspath(__file__))
WORLD = os.path.join(HERE, "../ros2/src/node/tests/block.toml")
LOW, LENGTH, DEPTH, BEND = 8.3, 22.0, 14.0, 0.8
REACH = 8.0
FAST_HZ, SLOW_HZ = 100.0, 10.0


def rounded(way):
    """The pose after a way along the middle of the corridors, from the lower left corner on."""
    sides = [LENGTH - 2 * BEND, DEPTH - 2 * BEND] * 2
    at, heading = np.array([LOW + BEND, LOW]), 0.0
    for straight in sides * 3:
        along = np.array([np.cos(heading), np.sin(heading)])
        if way <= straight:
            return *(at + along * way), heading
        way, at = way - straight, at + along * straight
        turn = min(way / BEND, np.pi / 2)
        left = np.array([-along[1], along[0]])
        at, heading = at + BEND * (np.sin(turn) * along + (1 - np.cos(turn)) * left), heading + turn
        if turn < np.pi / 2:
            return *at, heading
        way -= BEND * np.pi / 2
    raise ValueError("the way is too long")


class Driver(Robot):
    """Drives around the block; its time is that of the scans, not that of the sending."""

    def __init__(self, step_m, beams, view=np.pi / 2):
        super().__init__("driver", beams)
        self.angle_min = -view / 2
        walls = tomllib.load(open(WORLD, "rb"))["wall"]
        corners = [(*wall["min_m"], *wall["max_m"]) for wall in walls]
        edges = [e for x, y, u, v in corners for e in [(x, y, u, y), (u, y, u, v), (u, v, x, v), (x, v, x, y)]]
        self.walls, self.step_m, self.way = np.array(edges), step_m, 0.0
        self.angles = (np.arange(beams) / beams - 0.5) * view
        self.at, self.odometry_pose = rounded(0.0), (0.0, 0.0, 0.0)

    def stamp(self):
        return 1_700_000_000 + self.sent // 10, self.sent % 10 * 100_000_000

    def pose(self):
        """The pose by odometry: 5 % off in distance and turn, 3 degrees and 5 cm of noise per meter."""
        (x, y, heading), (u, v, turned) = self.at, rounded(self.way)
        way, turn = np.hypot(u - x, v - y), (turned - heading + np.pi) % (2 * np.pi) - np.pi
        a, b, c = self.odometry_pose
        c += 0.95 * turn + np.radians(3) * way
        self.at, way = (u, v, turned), 1.05 * way + self.noise.normal(0, 0.05 * np.sqrt(way))
        self.odometry_pose = (a + way * np.cos(c), b + way * np.sin(c), c)
        return self.odometry_pose

    def ranges(self, *_):
        x, y, heading = self.at
        dx, dy = np.cos(heading + self.angles)[:, None], np.sin(heading + self.angles)[:, None]
        ax, ay, bx, by = self.walls.T
        ex, ey = bx - ax, by - ay
        with np.errstate(divide="ignore", invalid="ignore"):
            cross = dx * ey - dy * ex
            along = ((ax - x) * ey - (ay - y) * ex) / cross
            at = ((ax - x) * dy - (ay - y) * dx) / cross
        along[~((along > 0) & (at >= 0) & (at <= 1))] = np.inf
        nearest = along.min(axis=1)
        noisy = nearest + self.noise.normal(0, 0.01, len(nearest))
        return np.where(nearest > REACH, np.inf, noisy).astype(np.float32)

    def step(self):
        super().step()
        if self.sent > 20:
            self.way += self.step_m


def gaps_ms(times, begin):
    """The times between two transforms since a time, the longest last, ms."""
    return np.sort(np.diff([at for at in times if at >= begin])) * 1e3


def main():
    scans, beams = [int(number) for number in sys.argv[4:6]] or [1000, 61]
    around = 2 * (LENGTH + DEPTH) - 8 * BEND + 2 * np.pi * BEND
    settings = [part for setting in sys.argv[6:] for part in ("-p", setting)]
    heard = os.path.join(WORK, "transforms.txt")
    hear = subprocess.Popen([sys.executable, os.path.join(HERE, "drive_cyclonedds.py"), *sys.argv[1:4], "hear"],
                            stdout=open(heard, "w"))
    node = Program(CURIOUS, "--ros-args", *parameter("map_update_interval", 0.5), *settings,
                   *parameter("qos_overrides./scan.subscription.reliability", "reliable"))
    robot = Driver(around / scans, beams)
    check("the node subscribes", robot.spin(DISCOVERY_S, lambda: robot.scans.get_subscription_count() > 0))
    robot.spin(1)
    robot.drive(1e9, FAST_HZ, until=lambda: robot.way > around - 1.0)
    robot.spin(2)
    robot.step_m = 0.05
    robot.drive(600, SLOW_HZ, until=lambda: "a loop is found" in node.text())
    begin = time.monotonic() - 0.5
    closed = robot.drive(600, SLOW_HZ, until=lambda: "a loop was closed" in node.text())
    took = time.monotonic() - begin - 0.5
    robot.drive(3, SLOW_HZ)
    hear.terminate()
    check("a loop is closed beside the robot", closed)
    check("the node ends", node.end() == 0)
    found = gaps_ms([float(line) for line in open(heard)], begin)
    most, nearly = found[-1], found[int(len(found) * 0.99)]
    print(f"     {robot.sent} scans, learned again in {took:.1f} s; from then on, between two transforms at most {most:.0f} ms, "
          f"99 % {nearly:.0f} ms", flush=True)
    print("\n".join(f"     {line}" for line in node.text().splitlines()), flush=True)
    robot.close()


if __name__ == "__main__":
    try:
        main()
    finally:
        for left in Program.running:
            left.process.kill()
