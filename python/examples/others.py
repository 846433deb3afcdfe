"""The same robots in other simulators: `python speed.py --beside`.

Robots with lasers drive circles in a hall with pillars, in time steps of 0.1 s: in this package, in irsim-x (`pip install irsim-x`:
its world with robots, and its batch of worlds with one robot each) and in navground (`pip install navground`). Each line has the
robot steps with a scan per second of CPU time, and how far the ranges are from those that follow from the reported poses by exact
geometry, computed here in double precision. What is not installed is left out.
"""

import os
from importlib.metadata import PackageNotFoundError, version
from typing import Any, Callable, Iterator

import curious
import numpy as np

RANGE_M, RADIUS_M, SPACING_M, STEP_S = 5.0, 0.2, 1.1, 0.1
COMMAND = (0.4, 0.3)
#: The robots whose ranges are compared with exact geometry.
COMPARED = 100
# All on one thread: irsim-x would wait for its threads in loops, which counts as CPU time.
os.environ.setdefault("OMP_NUM_THREADS", "1")


class Hall:
    """A square hall with a pillar among every four robots, and the robots on a grid."""

    def __init__(self, robots: int, beams: int) -> None:
        side = int(np.ceil(np.sqrt(robots)))
        places = 1.0 + SPACING_M * np.stack(np.divmod(np.arange(robots), side), axis=1)
        self.poses = np.column_stack([places, np.arange(robots) * 77.0 % 360.0 * np.pi / 180.0])
        self.side, self.beams = 2.0 + SPACING_M * max(side - 1, 4), beams
        self.angles = -np.pi + 2.0 * np.pi * np.arange(beams) / beams
        ends = ((0, 0, 1, 0.1), (0, -0.1, 1, 1), (0, 0.1, 0.1, -0.1), (-0.1, 0.1, 1, -0.1))
        self.boxes = [self._wall(box) for box in ends]
        pillars = 1.0 + SPACING_M * (np.arange(0, max(side - 1, 4), 3) + 0.5)
        self.boxes += [(x - 0.1, y - 0.1, x + 0.1, y + 0.1) for x in pillars for y in pillars]

    def _wall(self, box: tuple[float, ...]) -> tuple[float, ...]:
        """1 is the far side of the hall, and numbers below 0 count from there."""
        return tuple(self.side if value == 1 else value + self.side if value < 0 else float(value) for value in box)

    def toml(self) -> str:
        """The hall as a world of this package."""
        text = f'name = "hall"\n[map]\nsize_m = [{self.side!r}, {self.side!r}]\ncell_m = 0.1\n'
        text += f'[physics]\nstep_s = {STEP_S}\ncontacts = "sliding"\n'
        for x0, y0, x1, y1 in self.boxes:
            text += f"[[wall]]\nmin_m = [{float(x0)!r}, {float(y0)!r}]\nmax_m = [{float(x1)!r}, {float(y1)!r}]\n"
        for number, (x, y, heading) in enumerate(self.poses.tolist()):
            text += f"""
[[robot]]
name = "r{number}"
radius_m = {RADIUS_M}
pose_m = [{x!r}, {y!r}]
heading_deg = {np.degrees(heading):.6f}
drive = {{ max_linear_mps = 0.5, max_angular_degps = 120.0, max_linear_acceleration_mps2 = 1.0, max_angular_acceleration_degps2 = 360.0 }}
laser = {{ beams = {self.beams}, range_max_m = {RANGE_M}, rate_hz = 10.0 }}
behavior = {{ kind = "driven" }}
"""
        return text

    def exact(self, poses: np.ndarray, sees_robots: bool) -> np.ndarray:
        """The ranges of the first robots at these poses of all robots."""
        ranges = np.full((min(COMPARED, len(poses)), self.beams), RANGE_M)
        for robot, (x, y, heading) in enumerate(poses[: len(ranges)]):
            cos, sin = np.cos(heading + self.angles), np.sin(heading + self.angles)
            for x0, y0, x1, y1 in self.boxes:
                if max(x0 - x, x - x1, y0 - y, y - y1) < RANGE_M:
                    ranges[robot] = np.minimum(ranges[robot], to_box(cos, sin, (x0 - x, y0 - y, x1 - x, y1 - y)))
            away = poses[:, :2] - (x, y)
            near = (np.hypot(*away.T) < RANGE_M + RADIUS_M) & (np.arange(len(poses)) != robot)
            for dx, dy in away[near] if sees_robots else ():
                along, across = cos * dx + sin * dy, cos * dy - sin * dx
                half = np.sqrt(np.maximum(RADIUS_M**2 - across**2, 0.0))
                is_hit = (np.abs(across) < RADIUS_M) & (along > half)
                ranges[robot] = np.where(is_hit, np.minimum(ranges[robot], along - half), ranges[robot])
        return ranges


def to_box(cos: np.ndarray, sin: np.ndarray, box: tuple[float, ...]) -> np.ndarray:
    """The ranges from the origin to an upright box; RANGE_M without a hit."""
    with np.errstate(divide="ignore", invalid="ignore"):
        x = np.sort([box[0] / cos, box[2] / cos], axis=0)
        y = np.sort([box[1] / sin, box[3] / sin], axis=0)
    enter, leave = np.fmax(x[0], y[0]), np.fmin(x[1], y[1])
    return np.where((enter <= leave) & (enter > 0.0), enter, RANGE_M)


class Curious:
    """This package: the robots are solid, and see each other."""

    name, sees_robots = "curious", True

    def __init__(self, hall: Hall) -> None:
        self.fleet = curious.Fleet(curious.Spec.from_toml(hall.toml()), seed=1)
        robots = len(hall.poses)
        self.scans, self.places = np.empty((robots, hall.beams), np.float32), np.empty((robots, 3))
        self.commands = np.tile(COMMAND, (robots, 1))

    def step(self) -> None:
        self.fleet.step(self.commands, steps=1, scans=self.scans, poses=self.places)

    def ranges(self) -> np.ndarray:
        return self.scans

    def poses(self) -> np.ndarray:
        return self.places


class _IrSimX:
    """What both worlds of irsim-x share."""

    def _boxes(self, world: Any, hall: Hall) -> None:
        world.set_step_time(STEP_S)
        for x0, y0, x1, y1 in hall.boxes:
            box = {"x": (x0 + x1) / 2, "y": (y0 + y1) / 2, "half_w": (x1 - x0) / 2, "half_h": (y1 - y0) / 2}
            world.add_obstacle({"type": "rect", **box})
        self.world, self.angles = world, hall.angles.astype(np.float32)


class IrSimX(_IrSimX):
    """irsim-x, one world with all robots, whose lasers do not see each other."""

    name, sees_robots = "irsim-x {}, one world", False

    def __init__(self, hall: Hall) -> None:
        from cpp import _core

        self._boxes(_core.SimWorld(), hall)
        corners = RADIUS_M * np.stack([np.cos(np.arange(8) * np.pi / 4), np.sin(np.arange(8) * np.pi / 4)], axis=1)
        for x, y, heading in hall.poses:
            robot = self.world.add_robot(0, x, y, heading)
            self.world.set_robot_vertices(robot, corners.astype(np.float32))
        self.commands, self.robots = np.tile(np.float32(COMMAND), len(hall.poses)), len(hall.poses)
        self.scans = np.empty((self.robots, hall.beams), np.float32)

    def step(self) -> None:
        self.world.step(self.commands, 2)
        for robot in range(self.robots):
            self.scans[robot] = self.world.raycast(robot, self.angles, RANGE_M)

    def ranges(self) -> np.ndarray:
        return self.scans

    def poses(self) -> np.ndarray:
        return np.array([self.world.get_robot_pose(robot) for robot in range(self.robots)], np.float64)


class IrSimXBatch(_IrSimX):
    """irsim-x, a batch of worlds with one robot each."""

    name, sees_robots = "irsim-x {}, batch of worlds", False

    def __init__(self, hall: Hall) -> None:
        from cpp import _core

        config = _core.BatchConfig()
        config.batch_size, config.share_obstacles = len(hall.poses), True
        world = _core.BatchSimWorld(config)
        world.set_robot_kinematics(0)
        corners = RADIUS_M * np.stack([np.cos(np.arange(8) * np.pi / 4), np.sin(np.arange(8) * np.pi / 4)], axis=1)
        world.set_robot_vertices(corners.astype(np.float32))
        limit = np.full(3, 100.0, np.float32)
        world.set_robot_limits(-limit, limit, limit)
        world.set_initial_poses(hall.poses.astype(np.float32))
        self._boxes(world, hall)
        # The batch takes the turn rate from the third place.
        self.commands = np.tile(np.float32([COMMAND[0], 0.0, COMMAND[1]]), len(hall.poses))
        self.scans = np.empty(0, np.float32)

    def step(self) -> None:
        self.world.step(self.commands, 3)
        self.scans = self.world.batch_raycast(self.angles, RANGE_M)

    def ranges(self) -> np.ndarray:
        return self.scans.reshape(len(self.angles), -1).T[: len(self.commands) // 3]

    def poses(self) -> np.ndarray:
        return self.world.get_all_poses().reshape(-1, 3).astype(np.float64)


class Navground:
    """navground: discs that see each other."""

    name, sees_robots = "navground {}", True

    def __init__(self, hall: Hall) -> None:
        from navground import core, sim

        self.world, self.agents = sim.World(), []
        for x0, y0, x1, y1 in hall.boxes:
            corners = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
            for begin, end in zip(corners, np.roll(corners, -1, axis=0)):
                self.world.add_wall(sim.Wall(core.LineSegment(begin, end)))
        for x, y, heading in hall.poses:
            lidar = sim.Sensor.make_type("Lidar")
            lidar.range, lidar.resolution, lidar.start_angle = RANGE_M, hall.beams, -np.pi
            lidar.field_of_view = 2.0 * np.pi * (hall.beams - 1) / hall.beams
            kinematics = core.kinematics.TwoWheelsDifferentialDriveKinematics(max_speed=0.5, wheel_axis=0.3)
            behavior = core.Behavior.make_type("Dummy")
            agent = sim.Agent(radius=RADIUS_M, behavior=behavior, kinematics=kinematics, control_period=STEP_S)
            agent.pose = core.Pose2((x, y), heading)
            self.world.add_agent(agent)
            self.agents.append((agent, lidar, core.SensingState()))
        command = core.Twist2((COMMAND[0], 0.0), COMMAND[1], core.Frame.relative)
        for agent, lidar, state in self.agents:
            agent.controller.follow_manual_cmd(command)
            lidar.prepare(agent, self.world)
            lidar.prepare_state(state)

    def step(self) -> None:
        self.world.update(STEP_S)
        for agent, lidar, state in self.agents:
            lidar.update(agent, self.world, state)

    def ranges(self) -> np.ndarray:
        return np.array([lidar.read_ranges(state) for _, lidar, state in self.agents])

    def poses(self) -> np.ndarray:
        return np.array([(*agent.position, agent.orientation) for agent, _, _ in self.agents], np.float64)


SIMULATORS = {"curious-robot": (Curious,), "irsim-x": (IrSimX, IrSimXBatch), "navground": (Navground,)}


def installed() -> Iterator[tuple[Any, str]]:
    """The simulators that are there, with their versions."""
    for package, simulators in SIMULATORS.items():
        try:
            found = version(package)
        except PackageNotFoundError:
            print(f"{package} is not installed: left out")
            continue
        for simulator in simulators:
            yield simulator, simulator.name.format(found)


def beside(robots: int, beams: int, measure: Callable[..., float], seconds: float) -> None:
    """Prints the speeds and the errors of all simulators."""
    hall = Hall(robots, beams)
    for simulator, name in installed():
        one = simulator(hall)
        before = one.poses() if simulator is not Curious else hall.poses
        for _ in range(50):
            one.step()
        moved_m = np.hypot(*(one.poses() - before)[:, :2].T).mean()
        found = np.minimum(np.nan_to_num(one.ranges()[:COMPARED], posinf=RANGE_M), RANGE_M)
        errors = np.abs(found - hall.exact(one.poses(), simulator.sees_robots))
        blind = "" if simulator.sees_robots or robots == 1 else ", does not see other robots"
        measure(f"{name}: {robots} robots, {beams} beams", robots, one.step, seconds)
        print(f"    ranges off by more than 1 cm: {(errors > 0.01).mean():.2%}, most {errors.max():.1e} m{blind}; moved {moved_m:.2f} m")
