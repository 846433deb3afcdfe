//! A world, two robots, a controller: `cargo run -p curious-worldfile --example hello`. `worldfile/hello.md` explains it
//! line by line.

use interfaces::{LaserReading, Twist};
use sim::physics::{Fleet, RobotView};

const PLACE: &str = r#"
name = "hello"
wall = [
    { from_m = [0.0, 0.05], to_m = [6.0, 0.05], thickness_m = 0.1 },
    { from_m = [0.0, 3.95], to_m = [6.0, 3.95], thickness_m = 0.1 },
    { from_m = [0.05, 0.0], to_m = [0.05, 4.0], thickness_m = 0.1 },
    { from_m = [5.95, 0.0], to_m = [5.95, 4.0], thickness_m = 0.1 },
    { from_m = [4.0, 1.0], to_m = [4.0, 3.0], thickness_m = 0.1 },
]
[map]
size_m = [6.0, 4.0]
cell_m = 0.05
[[robot]]
name = "driven"
pose_m = [1.0, 2.0]
behavior = { kind = "driven" }
radius_m = 0.2
drive = { max_linear_mps = 0.5, max_angular_degps = 90.0, max_linear_acceleration_mps2 = 1.0, max_angular_acceleration_degps2 = 360.0 }
laser = { beams = 181, fov_deg = 180.0, range_max_m = 5.0, rate_hz = 10.0 }
[[robot]]
name = "wanderer"
pose_m = [5.0, 2.0]
behavior = { kind = "wander", speed_mps = 0.3 }
radius_m = 0.2
drive = { max_linear_mps = 0.5, max_angular_degps = 90.0, max_linear_acceleration_mps2 = 1.0, max_angular_acceleration_degps2 = 360.0 }
laser = { beams = 180, range_max_m = 5.0, rate_hz = 10.0 }
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let spec = worldfile::physics::parse_fleet("hello.toml", PLACE)?;
    let mut fleet = Fleet::new(&spec, 7);
    let mut controller = |_robot: &RobotView<'_>, reading: &LaserReading| {
        let ahead_m = reading.scan.ranges_m[90];
        let linear_mps = if ahead_m > 1.0 { 0.5 } else { 0.0 };
        Twist { linear_mps, angular_radps: 0.0 }
    };
    fleet.run_until(10.0, &mut controller);
    let snapshot = fleet.snapshot();
    fleet.run_until(20.0, &mut controller);
    let mut again = Fleet::restored(&spec, &snapshot)?;
    again.run_until(20.0, &mut controller);
    assert_eq!(again.snapshot(), fleet.snapshot());
    for robot in fleet.robots() {
        let at = robot.pose.translation;
        println!("{} is at ({:.3}, {:.3}) m after {} s", robot.name, at.x, at.y, fleet.time_s());
    }
    Ok(())
}
