//! The world file as it is written: every key with its place in the text.

use crate::reader::{OneOrMore, Sound, Tables};
use serde::Deserialize;
use serde_spanned::Spanned;
use std::ops::Range;

pub(super) type Number = Spanned<f64>;
pub(super) type Pair = Spanned<[f64; 2]>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WorldFile {
    pub(super) name: Sound<String>,
    pub(super) description: Option<String>,
    pub(super) map: Sound<MapFile>,
    pub(super) physics: Sound<PhysicsFile>,
    #[serde(rename = "wall")]
    pub(super) walls: Tables<WallFile>,
    #[serde(rename = "floor_plan")]
    pub(super) floor_plans: Tables<FloorPlanFile>,
    #[serde(rename = "obstacle")]
    pub(super) obstacles: Tables<ObstacleFile>,
    #[serde(rename = "robot")]
    pub(super) robots: Tables<RobotFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MapFile {
    pub(super) size_m: Pair,
    pub(super) cell_m: Number,
    pub(super) turn_deg: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PhysicsFile {
    pub(super) step_s: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WallFile {
    pub(super) from_m: Option<Pair>,
    pub(super) to_m: Option<Pair>,
    pub(super) thickness_m: Option<Number>,
    pub(super) min_m: Option<Pair>,
    pub(super) max_m: Option<Pair>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FloorPlanFile {
    pub(super) image: Option<Spanned<String>>,
    pub(super) map: Option<Spanned<String>>,
    pub(super) pixel_m: Option<Number>,
    pub(super) corner_m: Option<Pair>,
    pub(super) heading_deg: Option<Number>,
    pub(super) blocked_below: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ObstacleFile {
    pub(super) name: Spanned<String>,
    pub(super) tag: Option<Spanned<u32>>,
    pub(super) kind: Option<Spanned<String>>,
    pub(super) min_m: Option<Pair>,
    pub(super) max_m: Option<Pair>,
    pub(super) center_m: Option<Pair>,
    pub(super) size_m: Option<Pair>,
    pub(super) heading_deg: Option<Number>,
    pub(super) appears_s: Option<Number>,
    pub(super) disappears_s: Option<Number>,
    pub(super) mass_kg: Option<Number>,
    pub(super) friction: Option<Number>,
    pub(super) path_m: Option<Spanned<Vec<Pair>>>,
    pub(super) dwell_s: Option<Number>,
    pub(super) speed_mps: Option<Number>,
    pub(super) times_s: Option<Spanned<Vec<Number>>>,
    pub(super) repeat: Option<Spanned<String>>,
    pub(super) from_m: Option<Pair>,
    pub(super) to_m: Option<Pair>,
    pub(super) thickness_m: Option<Number>,
    pub(super) open_deg: Option<Number>,
    pub(super) slide_m: Option<Number>,
    pub(super) opening: Option<Spanned<String>>,
    pub(super) closed_s: Option<Number>,
    pub(super) open_s: Option<Number>,
    pub(super) switches_s: Option<Spanned<Vec<Number>>>,
    pub(super) move_s: Option<Number>,
    pub(super) starts_open: Option<Spanned<bool>>,
}

impl ObstacleFile {
    /// The keys that are there, besides the name and the kind, with their places.
    pub(super) fn keys(&self) -> Vec<(&'static str, Range<usize>)> {
        fn place<T>(key: &'static str, value: &Option<Spanned<T>>) -> Option<(&'static str, Range<usize>)> {
            value.as_ref().map(|value| (key, value.span()))
        }
        let found = [
            place("min_m", &self.min_m),
            place("max_m", &self.max_m),
            place("center_m", &self.center_m),
            place("size_m", &self.size_m),
            place("heading_deg", &self.heading_deg),
            place("appears_s", &self.appears_s),
            place("disappears_s", &self.disappears_s),
            place("mass_kg", &self.mass_kg),
            place("friction", &self.friction),
            place("path_m", &self.path_m),
            place("dwell_s", &self.dwell_s),
            place("speed_mps", &self.speed_mps),
            place("times_s", &self.times_s),
            place("repeat", &self.repeat),
            place("from_m", &self.from_m),
            place("to_m", &self.to_m),
            place("thickness_m", &self.thickness_m),
            place("open_deg", &self.open_deg),
            place("slide_m", &self.slide_m),
            place("opening", &self.opening),
            place("closed_s", &self.closed_s),
            place("open_s", &self.open_s),
            place("switches_s", &self.switches_s),
            place("move_s", &self.move_s),
            place("starts_open", &self.starts_open),
        ];
        found.into_iter().flatten().collect()
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RobotFile {
    pub(super) name: Spanned<String>,
    pub(super) radius_m: Option<Number>,
    pub(super) footprint_m: Option<Spanned<Vec<Pair>>>,
    pub(super) mass_kg: Option<Number>,
    pub(super) pose_m: Pair,
    pub(super) heading_deg: Option<Number>,
    pub(super) drive: DriveFile,
    pub(super) odometry: OdometryFile,
    #[serde(rename = "laser")]
    pub(super) lasers: Spanned<OneOrMore<LaserFile>>,
    pub(super) bumper: Option<BumperFile>,
    #[serde(rename = "sonar")]
    pub(super) sonars: Option<Vec<Spanned<SonarFile>>>,
    pub(super) fiducial: Option<FiducialFile>,
    pub(super) tag: Option<Spanned<u32>>,
    pub(super) behaviour: Spanned<BehaviourFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DriveFile {
    pub(super) kind: Option<Spanned<String>>,
    pub(super) max_linear_mps: Number,
    pub(super) max_angular_degps: Number,
    pub(super) max_linear_acceleration_mps2: Number,
    pub(super) max_angular_acceleration_degps2: Number,
    pub(super) max_left_mps: Option<Number>,
    pub(super) max_left_acceleration_mps2: Option<Number>,
    pub(super) wheelbase_m: Option<Number>,
    pub(super) max_steer_deg: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OdometryFile {
    pub(super) distance_gain: Option<Number>,
    pub(super) turn_gain: Option<Number>,
    pub(super) turn_per_m_deg: Option<Number>,
    pub(super) distance_noise_m: Option<Number>,
    pub(super) turn_noise_deg: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LaserFile {
    pub(super) beams: Spanned<u32>,
    pub(super) fov_deg: Option<Number>,
    pub(super) range_min_m: Option<Number>,
    pub(super) range_max_m: Number,
    pub(super) rate_hz: Number,
    pub(super) mount_m: Option<Pair>,
    pub(super) mount_deg: Option<Number>,
    pub(super) noise_std_m: Option<Number>,
    pub(super) dropout: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BehaviourFile {
    pub(super) kind: Spanned<String>,
    pub(super) from_m: Option<Pair>,
    pub(super) to_m: Option<Pair>,
    pub(super) speed_mps: Option<Number>,
    pub(super) wall_side: Option<Spanned<String>>,
    pub(super) clearance_m: Option<Number>,
    pub(super) turn_radius_m: Option<Number>,
    pub(super) direction: Option<Spanned<String>>,
    pub(super) points_m: Option<Spanned<Vec<Pair>>>,
    pub(super) repeat: Option<Spanned<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BumperFile {
    pub(super) sectors: Spanned<u32>,
    pub(super) fov_deg: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SonarFile {
    pub(super) cone_deg: Number,
    pub(super) range_min_m: Option<Number>,
    pub(super) range_max_m: Number,
    pub(super) rate_hz: Number,
    pub(super) mount_m: Option<Pair>,
    pub(super) mount_deg: Option<Number>,
    pub(super) noise_std_m: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FiducialFile {
    pub(super) fov_deg: Option<Number>,
    pub(super) range_max_m: Number,
    pub(super) rate_hz: Number,
    pub(super) mount_m: Option<Pair>,
    pub(super) mount_deg: Option<Number>,
}
