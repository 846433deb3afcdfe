"""How fast the worlds are on this machine, per second of CPU time: `python speed.py`.

One thread for fleets; the environments use `--threads` (0: all). With `--ir-sim`, the simulator ir-sim (`pip install ir-sim`)
drives one robot with the same laser through the same walls in the same run. With `--rust PROGRAM`, the example `speed` of the
crate `environments` (`cargo build --release -p curious-environments --example speed`) does the same without Python, in turns.
"""

import argparse
import subprocess
import tempfile
import time
from typing import Callable

import curious
import numpy as np


def measure(name: str, per_call: int, call: Callable[[], object], seconds: float = 2.0) -> float:
    """Calls per CPU second, times `per_call`."""
    call()
    # The clock is read rarely: that takes as long as the call itself takes without the simulation.
    block, calls = 1, 0
    wall, cpu = time.perf_counter(), time.process_time()
    while (before := time.process_time() - cpu) < seconds:
        for _ in range(block):
            call()
        calls += block
        if time.process_time() - cpu - before < 0.01:
            block *= 2
    cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    print(f"{name:<52} {calls * per_call / cpu:>12,.0f} per CPU second {calls * per_call / wall:>12,.0f} per second")
    return calls * per_call / cpu


def compare(speed: float, command: list[str]) -> None:
    """Runs the same in Rust, and prints the share that Python reaches."""
    line = subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()
    print(f"{'  Rust alone':<52} {line}: Python reaches {speed / float(line.split()[0]):.0%}")


def rooms(robots: int) -> curious.Spec:
    """The four rooms with driven robots on a grid, each with 360 beams at 10 Hz."""
    text = curious.Spec.load("four_rooms").to_toml()
    text = text[: text.index("[[robot]]")]
    side = int(np.ceil(np.sqrt(robots)))
    for robot in range(robots):
        x, y = (0.55 + 10.9 * (place + 0.5) / side for place in divmod(robot, side))
        x, y = (value + (0.6 if abs(value - 6.0) < 0.35 else 0.0) for value in (x, y))
        text += f"""
[[robot]]
name = "r{robot}"
radius_m = 0.2
pose_m = [{x:.3f}, {y:.3f}]
heading_deg = {robot * 77 % 360}.0
drive = {{ max_linear_mps = 0.5, max_angular_degps = 120.0, max_linear_acceleration_mps2 = 1.0, max_angular_acceleration_degps2 = 360.0 }}
laser = {{ beams = 360, range_max_m = 10.0, rate_hz = 10.0 }}
behavior = {{ kind = "driven" }}
"""
    return curious.Spec.from_toml(text)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--ir-sim", action="store_true")
    parser.add_argument("--rust", metavar="PROGRAM", help="the example `speed` of the crate `environments`")
    parser.add_argument("--seconds", type=int, default=2, help="CPU seconds per line")
    parser.add_argument("--threads", type=int, default=0, help="of the environments; 0: all")
    args = parser.parse_args()
    for robots in (1, 10, 100):
        spec = rooms(robots)
        fleet = curious.Fleet(spec, seed=1)
        commands = np.tile([0.4, 0.3], (robots, 1))
        scans, poses = np.empty((robots, 360), np.float32), np.empty((robots, 3))

        def step() -> None:
            # A tenth of a second: two physics steps, then a fresh scan and the pose of every robot.
            fleet.step(commands, steps=2, scans=scans, poses=poses)

        for _ in range(3 if args.rust else 1):
            speed = measure(f"robot steps of 0.1 s, 360 beams, {robots} robots", robots, step, args.seconds)
            if args.rust:
                with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
                    file.write(spec.to_toml())
                    file.flush()
                    compare(speed, [args.rust, "fleet", file.name, str(args.seconds)])
    fleet = curious.Fleet("house")
    measure("resets of the house", 1, lambda: fleet.reset(1), args.seconds)

    try:
        from curious.envs import DriveVectorEnv
    except ImportError:
        print("the environments need `pip install gymnasium`")
        return
    env = DriveVectorEnv(64, threads=args.threads)
    env.reset(seed=1)
    actions = np.random.default_rng(0).uniform(-1.0, 1.0, (100, 64, 2)).astype(np.float32)
    actions[:, :, 0] = np.abs(actions[:, :, 0])
    count = iter(range(10**9))
    speed = measure("steps of the driving task, 64 worlds", 64, lambda: env.step(actions[next(count) % 100]), args.seconds)
    if args.rust:
        compare(speed, [args.rust, "drive", "64", str(args.threads or 2), "4000"])
    if args.ir_sim:
        ir_sim(args.seconds)


def ir_sim(seconds: float) -> None:
    """One robot of ir-sim with a laser of 360 beams in the four rooms."""
    import irsim

    walls = "".join(
        f"  - shape: {{name: rectangle, length: {length:.3f}, width: {width:.3f}}}\n    state: [{x:.3f}, {y:.3f}, 0]\n"
        for x, y, length, width in (
            (*corners.mean(axis=0), *(corners.max(axis=0) - corners.min(axis=0)))
            for corners in curious.Spec.load("four_rooms").walls
        )
    )
    text = f"""
world: {{height: 12, width: 12, step_time: 0.1, sample_time: 0.1, collision_mode: stop}}
robot:
  - kinematics: {{name: diff}}
    shape: {{name: circle, radius: 0.2}}
    state: [2, 2, 0]
    sensors:
      - {{name: lidar2d, range_min: 0, range_max: 10, angle_range: 6.28318, number: 360}}
obstacle:
{walls}"""
    with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
        file.write(text)
        file.flush()
        env = irsim.make(file.name, display=False)

        def step() -> None:
            env.step(np.array([[0.4], [0.3]]))
            env.get_lidar_scan()

        measure("ir-sim: robot steps of 0.1 s, 360 beams, 1 robot", 1, step, seconds)
        env.end()


if __name__ == "__main__":
    main()
