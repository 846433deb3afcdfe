import pytest

FLEET = """
name = "two learners"
[map]
size_m = [6.0, 4.0]
cell_m = 0.1
[physics]
step_s = 0.05
[[wall]]
min_m = [0.0, 0.0]
max_m = [6.0, 0.1]
[[wall]]
min_m = [0.0, 3.9]
max_m = [6.0, 4.0]
[[wall]]
min_m = [0.0, 0.1]
max_m = [0.1, 3.9]
[[wall]]
min_m = [5.9, 0.1]
max_m = [6.0, 3.9]
"""

ROBOT = """
[[robot]]
name = "{name}"
radius_m = 0.2
pose_m = [{x}, {y}]
[robot.drive]
max_linear_mps = 0.5
max_angular_degps = 120.0
max_linear_acceleration_mps2 = 1.0
max_angular_acceleration_degps2 = 360.0
[robot.laser]
beams = 32
range_max_m = 5.0
rate_hz = 10.0
noise_std_m = 0.01
[robot.behavior]
kind = "{kind}"
"""


@pytest.fixture
def fleet_toml() -> str:
    """Two driven robots and one that wanders."""
    driven = [ROBOT.format(name=name, x=x, y=y, kind="driven") for name, x, y in (("a", 1.0, 1.0), ("b", 5.0, 3.0))]
    wander = ROBOT.format(name="c", x=3.0, y=2.0, kind='wander"\nspeed_mps = 0.3\n#"')
    return FLEET + "".join(driven) + wander
