"""A robot drives through four rooms and stops before walls."""

import curious
import numpy as np

fleet = curious.Fleet("four_rooms", seed=7)
for _ in range(600):
    reading = fleet.look(0)  # scan and pose of the same instant
    ahead = reading.ranges[len(reading.ranges) // 2 - 60 : len(reading.ranges) // 2 + 60].min()
    forward, turn = (0.6, 0.0) if ahead > 0.6 else (0.0, 1.0)
    fleet.command(0, forward, turn)
    fleet.step(steps=2)  # 0.1 s
x, y, heading = fleet.poses()[0]
print(f"after {fleet.time:.0f} s the robot is at ({x:.2f}, {y:.2f}), heading {np.degrees(heading):.0f}°")
