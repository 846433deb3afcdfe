//! The services by which `slam_toolbox` saves and loads: the map as an image, and all that was learned.

use super::CuriousNode;
use super::setup::Parts;
use crate::link::Link;
use crate::service::Reply;
use crate::service::wire::Deserialize;
use interfaces::PoseMode;
use nalgebra::{Isometry2, Matrix3};
use robot::state::StateFile;
use ros::flat;
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
        let name = if name.is_empty() { "map" } else { name };
        let path = saved_in(&self.parameters.map_folder, name).map_err(|why| (FAILURE, why))?;
        if self.robot.mapper.readings() == 0 {
            return Err((NO_MAP, "there is no map to save before the first reading".to_owned()));
        }
        let (folder, file) = (path.parent().unwrap_or(&path), path.file_name().unwrap_or_default());
        results::ros_map::write(folder, &file.to_string_lossy(), self.robot.mapper.states())
            .map_err(|why| (FAILURE, format!("cannot save the map: {why}")))?;
        Ok(format!("the map is saved in {0}.yaml and {0}.pgm", path.display()))
    }

    /// Goes on from the state in a file.
    pub(super) fn deserialize(&mut self, asked: &Deserialize) -> Coded {
        let path = with_ending(asked.filename.clone().into());
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
        let Parts { robot, state_file, continued } = StateFile::to_load(&path)
            .map_err(anyhow::Error::from)
            .and_then(|file| Parts::new(&self.parameters, Some(file), &mut self.notes))
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

/// The file that a service writes: `name` is its path below the folder for maps, or an absolute path in or
/// below it.
///
/// # Errors
///
/// When the file would be elsewhere, or its name is not plain: one sentence. Everybody in the network can
/// call a service.
pub(super) fn saved_in(map_folder: &str, name: &str) -> Result<PathBuf, String> {
    let maps = Path::new(if map_folder.is_empty() { "." } else { map_folder });
    files::make_folder(maps).map_err(|why| why.to_string())?;
    let path = maps.join(name);
    let is_plain = name.chars().all(|letter| letter.is_alphanumeric() || "-_. /".contains(letter));
    let inside = path.parent().zip(path.file_name()).filter(|_| is_plain && !name.ends_with('/'));
    let inside = inside.and_then(|(folder, file)| {
        let folder = folder.canonicalize().ok()?;
        folder.starts_with(maps.canonicalize().ok()?).then(|| folder.join(file))
    });
    let name = interfaces::printable(name);
    inside.ok_or_else(|| {
        format!(
            "`{name}` is not a valid name: it has letters, digits, `-`, `_`, `.` and spaces, and is in an existing folder in or \
             below `{map_folder}` (the parameter `map_folder`)"
        )
    })
}

/// The file of a state: `slam_toolbox` adds the endings of its files as well.
pub(super) fn with_ending(path: PathBuf) -> PathBuf {
    if path.extension().is_some() { path } else { path.with_extension(ENDING) }
}
