//! The services by which `slam_toolbox` saves and loads: the map as an image, and all that was learned.

use super::CuriousNode;
use super::setup::Parts;
use crate::link::{Link, Request};
use crate::node_state_file::NodeStateFile;
use crate::service::Reply;
use crate::service::wire::Deserialize;
use interfaces::PoseMode;
use nalgebra::{Isometry2, Matrix3};
use ros::flat;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The codes of `slam_toolbox/SaveMap`, `SerializePoseGraph` and `DeserializePoseGraph`.
const SUCCESS: u8 = 0;
const INVALID_FILENAME: u8 = 1;
const NO_MAP: u8 = 2;
const UNREADABLE: u8 = 3;
const FAILURE: u8 = 255;
/// The ending of a state whose name has none.
const ENDING: &str = "state";

/// States that are written for those who have asked.
#[derive(Default)]
pub(super) struct Serializing {
    wanted: Vec<(PathBuf, Request)>,
    written: Vec<(NodeStateFile, Request)>,
}

impl<L: Link> CuriousNode<L> {
    /// Writes `NAME.pgm` and `NAME.yaml` for the map server.
    pub(super) fn save_map(&mut self, name: &str) -> u8 {
        let path = Path::new(if name.is_empty() { "map" } else { name });
        let Some(file) = path.file_name().and_then(OsStr::to_str) else {
            self.notes.warn(&format!("`{name}` is not a valid name for a map"));
            return FAILURE;
        };
        if self.robot.mapper.readings() == 0 {
            self.notes.warn("there is no map to save before the first reading");
            return NO_MAP;
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        match results::ros_map::write(folder, file, self.robot.mapper.states()) {
            Ok(()) => {
                self.notes.say(&format!("the map is saved in {0}.yaml and {0}.pgm", path.display()));
                SUCCESS
            }
            Err(why) => {
                self.notes.warn(&format!("cannot save the map: {why}"));
                FAILURE
            }
        }
    }

    /// Writes the state to a file, and answers when it is written.
    pub(super) fn serialize(&mut self, name: &str, request: Request) {
        let path = with_ending(name);
        if self.state_file.as_ref().is_some_and(|own| own.file.path() == path) {
            self.notes.warn("this is the state file of the node: the service `save_state` saves to it");
            return self.link.answer(request, Reply::Code(FAILURE));
        }
        if name.is_empty() || self.last.is_none() {
            self.notes.warn("a state has a name, and there is nothing to save before the first reading");
            return self.link.answer(request, Reply::Code(FAILURE));
        }
        self.serializing.wanted.push((path, request));
    }

    /// Goes on with states that others have asked for. While a map is being learned again, they wait.
    pub(super) fn go_on_serializing(&mut self) {
        if self.robot.is_settled() {
            for (path, request) in std::mem::take(&mut self.serializing.wanted) {
                match self.begin_writing(&path) {
                    Ok(file) => self.serializing.written.push((file, request)),
                    Err(why) => {
                        self.notes.warn(&format!("{why:#}"));
                        self.link.answer(request, Reply::Code(FAILURE));
                    }
                }
            }
        }
        let is_ready = |(file, _): &mut (NodeStateFile, Request)| !file.file.is_writing();
        for (mut file, request) in self.serializing.written.extract_if(.., is_ready) {
            let name = file.name();
            let code = match file.file.wait() {
                Ok(()) => {
                    self.notes.say(&format!("the state is saved in {name}"));
                    SUCCESS
                }
                Err(why) => {
                    self.notes.warn(&format!("{name}: cannot save the state: {why}"));
                    FAILURE
                }
            };
            self.link.answer(request, Reply::Code(code));
        }
    }

    fn begin_writing(&mut self, path: &Path) -> anyhow::Result<NodeStateFile> {
        let settings = super::setup::settings(&self.parameters);
        let mut file = NodeStateFile::new(path, &settings, &self.parameters)?;
        self.state_file.iter().for_each(|own| file.go_on_from(own));
        let last = self.last.map_or(crate::message::Time::default(), |(last, _)| last);
        file.save(last, &mut self.robot)?;
        Ok(file)
    }

    /// Goes on from the state in a file.
    pub(super) fn deserialize(&mut self, asked: &Deserialize) -> u8 {
        let path = with_ending(&asked.filename);
        let seat = match asked.match_type {
            Deserialize::START_AT_FIRST_NODE => Some(Isometry2::identity()),
            Deserialize::START_AT_GIVEN_POSE | Deserialize::LOCALIZE_AT_POSE => {
                match asked.initial_pose.isometry() {
                    Some(pose) => Some(flat(&pose)),
                    None => {
                        self.notes.warn("the pose in the state is not valid: the state is not loaded");
                        return FAILURE;
                    }
                }
            }
            _ => None,
        };
        if !path.is_file() {
            self.notes.warn(&format!("{}: there is no such state", path.display()));
            return INVALID_FILENAME;
        }
        match Parts::new(&self.parameters, Some(&path), &mut self.notes) {
            Ok(Parts { robot, state_file, continued }) => {
                self.stop_robot();
                if let (Some(own), Some(loaded)) = (&mut self.state_file, state_file) {
                    own.go_on_from(&loaded);
                }
                (self.robot, self.continued, self.last) = (robot, continued, None);
                self.published = super::outputs::Published::default();
                self.activate_map();
                if let Some(pose) = seat.filter(|_| self.parameters.pose == PoseMode::Localized) {
                    self.seat_at((pose, Matrix3::zeros()));
                }
                SUCCESS
            }
            Err(why) => {
                self.notes.warn(&format!("the state is not loaded: {why:#}"));
                UNREADABLE
            }
        }
    }

    fn activate_map(&mut self) {
        if self.is_active() {
            self.activate();
        }
        self.next_silence = Instant::now() + super::SILENCE;
    }
}

/// The file of a state: `slam_toolbox` adds the endings of its files as well.
fn with_ending(name: &str) -> PathBuf {
    let path = PathBuf::from(name);
    if path.extension().is_some() { path } else { path.with_extension(ENDING) }
}
