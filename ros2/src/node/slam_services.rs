//! The services by which `slam_toolbox` saves and loads: the map as an image, and all that was learned.

use super::CuriousNode;
use super::setup::Parts;
use crate::link::Link;
use crate::service::Reply;
use crate::service::wire::Deserialize;
use interfaces::PoseMode;
use nalgebra::{Isometry2, Matrix3};
use ros::flat;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The codes of `slam_toolbox/SaveMap` and `DeserializePoseGraph`.
const SUCCESS: u8 = 0;
const INVALID_FILENAME: u8 = 1;
const NO_MAP: u8 = 2;
const UNREADABLE: u8 = 3;
pub(super) const FAILURE: u8 = 255;
/// The ending of a state whose name has none.
const ENDING: &str = "state";

/// What was done, or a code and why not.
type Coded = Result<String, (u8, String)>;

impl<L: Link> CuriousNode<L> {
    /// The answer to a call, whose outcome is said.
    pub(super) fn coded(&mut self, outcome: Coded) -> Reply {
        Reply::Code(match outcome {
            Ok(text) => {
                self.notes.say(&text);
                SUCCESS
            }
            Err((code, why)) => {
                self.notes.warn(&why);
                code
            }
        })
    }

    /// Writes `NAME.pgm` and `NAME.yaml` for the map server.
    pub(super) fn save_map(&mut self, name: &str) -> Coded {
        let path = Path::new(if name.is_empty() { "map" } else { name });
        let no_name = || (FAILURE, format!("`{name}` is not a valid name for a map"));
        let file = path.file_name().and_then(OsStr::to_str).ok_or_else(no_name)?;
        if self.robot.mapper.readings() == 0 {
            return Err((NO_MAP, "there is no map to save before the first reading".to_owned()));
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        results::ros_map::write(folder, file, self.robot.mapper.states())
            .map_err(|why| (FAILURE, format!("cannot save the map: {why}")))?;
        Ok(format!("the map is saved in {0}.yaml and {0}.pgm", path.display()))
    }

    /// Goes on from the state in a file.
    pub(super) fn deserialize(&mut self, asked: &Deserialize) -> Coded {
        let path = with_ending(&asked.filename);
        let seat = match asked.match_type {
            Deserialize::START_AT_FIRST_NODE => Some(Isometry2::identity()),
            Deserialize::START_AT_GIVEN_POSE | Deserialize::LOCALIZE_AT_POSE => {
                let invalid = "the pose in the state is not valid: the state is not loaded";
                let pose = asked.initial_pose.isometry().ok_or((FAILURE, invalid.to_owned()))?;
                Some(flat(&pose))
            }
            _ => None,
        };
        if !path.is_file() {
            return Err((INVALID_FILENAME, format!("{}: there is no such state", path.display())));
        }
        let Parts { robot, state_file, continued } =
            Parts::new(&self.parameters, Some(&path), &mut self.notes)
                .map_err(|why| (UNREADABLE, format!("the state is not loaded: {why:#}")))?;
        self.stop_robot();
        if let (Some(own), Some(loaded)) = (&mut self.state_file, state_file) {
            own.go_on_from(&loaded);
        }
        (self.robot, self.continued, self.last) = (robot, continued, None);
        self.published = super::publishing::Published::default();
        if self.is_active() {
            self.activate();
        }
        self.next_silence = Instant::now() + super::SILENCE;
        if let Some(pose) = seat.filter(|_| self.parameters.pose == PoseMode::Localized) {
            self.seat_at((pose, Matrix3::zeros()));
        }
        Ok(format!("the state {} is loaded", path.display()))
    }
}

/// The file of a state: `slam_toolbox` adds the endings of its files as well.
pub(super) fn with_ending(name: &str) -> PathBuf {
    let path = PathBuf::from(name);
    if path.extension().is_some() { path } else { path.with_extension(ENDING) }
}
