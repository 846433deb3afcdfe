#!/usr/bin/env python3
"""gen_rooms.py SEED OUT [laser_m]: a world of rooms with things that come and go (development only)."""
import random, sys
seed, out = int(sys.argv[1]), sys.argv[2]
r = random.Random(seed)
n = r.choice([3, 4, 5, 6]); laser = float(sys.argv[3]) if len(sys.argv) > 3 else r.choice([2.5, 3, 4, 6, 10])
room = 4.0; size = n * room + 0.1
L = [f'name = "r{seed}"', 'description = "rooms"', '[map]', f'size_m = [{size:.2f}, {size:.2f}]', 'cell_m = 0.05']
def wall(a, b, c, d): L.extend(['', '[[wall]]', f'min_m = [{a:.2f}, {b:.2f}]', f'max_m = [{c:.2f}, {d:.2f}]'])
wall(0, 0, size, .1); wall(0, size - .1, size, size); wall(0, .1, .1, size - .1); wall(size - .1, .1, size, size - .1)
for i in range(1, n):
    for j in range(n):
        at = j * room + r.choice([.7, 1.5, 2.3])
        for (a, b) in ((j * room + .1, at), (at + 1.0, (j + 1) * room)):
            if b - a > .05:
                wall(i * room, a, i * room + .1, b)
        at = j * room + r.choice([.7, 1.5, 2.3])
        for (a, b) in ((j * room + .1, at), (at + 1.0, (j + 1) * room)):
            if b - a > .05:
                wall(a, i * room, b, i * room + .1)
share = r.uniform(.2, .6); k = 0
import math
places = []
for i in range(n):
    for j in range(n):
        if r.random() > share or (i == n // 2 and j == n // 2): continue
        for _ in range(r.choice([1, 1, 2, 3])):
            for _try in range(50):
                w, h = round(r.uniform(.2, 1.2) / .05) * .05, round(r.uniform(.2, 1.2) / .05) * .05
                # against the corners, so that doorways stay free
                x = i * room + .1 + (r.choice([.0, 3.9 - w, r.uniform(.1, .4)]))
                y = j * room + .1 + (r.choice([.0, 3.9 - h, r.uniform(.1, .4)]))
                x, y = round(x / .05) * .05, round(y / .05) * .05
                dx = min(x - i * room, (i + 1) * room - x - w); dy = min(y - j * room, (j + 1) * room - y - h)
                if dx > .75 or dy > .75: continue
                if any(abs(x + w / 2 - a) < (w + c) / 2 + .45 and abs(y + h / 2 - b) < (h + d) / 2 + .45 for a, b, c, d in places): continue
                if w > .6 and h > .6: continue
                break
            else: continue
            places.append((x + w / 2, y + h / 2, w, h))
            f = lambda: math.exp(r.uniform(math.log(15), math.log(1800)))
            L.extend(['', '[[obstacle]]', f'name = "thing {k}"', 'kind = "fixed"', f'center_m = [{x + w / 2:.3f}, {y + h / 2:.3f}]', f'size_m = [{w:.2f}, {h:.2f}]',
                      f'schedule = {{ free_s = {f():.1f}, blocked_s = {f():.1f}, starts_blocked = {str(r.random() < .5).lower()} }}']); k += 1
c = (n // 2) * room + 2.05
L.extend(['', '[[robot]]', 'name = "curious"', 'radius_m = 0.2', f'pose_m = [{c:.2f}, {c:.2f}]', '[robot.drive]', 'max_linear_mps = 0.8', 'max_angular_degps = 150.0',
  'max_linear_acceleration_mps2 = 1.5', 'max_angular_acceleration_degps2 = 600.0', '[robot.laser]', f'beams = {r.choice([180, 360, 720])}', 'fov_deg = 360.0', f'range_max_m = {laser}', 'rate_hz = 10.0', '[robot.behavior]', 'kind = "driven"'])
open(out, 'w').write('\n'.join(L) + '\n'); print(out, n, laser, k)
