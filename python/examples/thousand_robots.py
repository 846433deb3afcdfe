"""A thousand robots with lasers wander through a hall, and all of their scans are one array."""

import time

import curious
import numpy as np

SIDE = 34.0
text = f"""
name = "a thousand robots"
[map]
size_m = [{SIDE}, {SIDE}]
cell_m = 0.1
"""
for low, high in (([0, 0], [SIDE, 0.1]), ([0, SIDE - 0.1], [SIDE, SIDE]), ([0, 0.1], [0.1, SIDE - 0.1]), ([SIDE - 0.1, 0.1], [SIDE, SIDE - 0.1])):
    text += f"[[wall]]\nmin_m = {[float(value) for value in low]}\nmax_m = {[float(value) for value in high]}\n"
for robot in range(1000):
    x, y = 1.0 + robot % 32 * 1.03, 1.0 + robot // 32 * 1.03
    text += f"""
[[robot]]
name = "r{robot}"
radius_m = 0.2
pose_m = [{x:.3f}, {y:.3f}]
heading_deg = {robot * 77 % 360}.0
drive = {{ max_linear_mps = 0.5, max_angular_degps = 120.0, max_linear_acceleration_mps2 = 1.0, max_angular_acceleration_degps2 = 360.0 }}
laser = {{ beams = 180, range_max_m = 5.0, rate_hz = 10.0 }}
behavior = {{ kind = "driven" }}
"""
fleet = curious.Fleet(curious.Spec.from_toml(text), seed=1, threads=True)
scans = np.empty((1000, 180), np.float32)
begin = time.perf_counter()
for _ in range(100):
    fleet.scans(out=scans)
    near = np.nan_to_num(scans, posinf=5.0)
    left, right, ahead = near[:, 100:140].mean(axis=1), near[:, 40:80].mean(axis=1), near[:, 80:100].min(axis=1)
    commands = np.stack([np.where(ahead > 0.6, 0.4, 0.0), np.clip(left - right, -1.5, 1.5)], axis=1)
    fleet.step(commands, steps=2)
seconds = time.perf_counter() - begin
print(f"10 s of 1000 robots in {seconds:.1f} s: {1000 * 100 / seconds:,.0f} robot steps and scans per second")
