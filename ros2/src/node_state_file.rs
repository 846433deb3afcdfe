//! `--state`: what the node has learned, from one run to the next.

use crate::link::Request;
use crate::message::Time;
use crate::notes::Notes;
use crate::parameters::{Navigator, Parameters};
use crate::pilot::LivePilot;
use anyhow::Context;
use interfaces::LaserReading;
use localizer::LocalizerSettings;
use robot::state::{Part, SavedSettings, Sessions, State, StateError, StateFile, learned, restore};
use robot::{Pilot, Robot, Settings};
use std::path::Path;

/// The name of the program, for its sessions.
const PROGRAM: &str = "curious_node";

/// The state file of a node.
pub(crate) struct NodeStateFile {
    pub(crate) file: StateFile,
    settings: Settings,
    /// What the pilot in the file belongs to.
    pilot: SavedSettings,
    sessions: Sessions,
    /// The survey of logs in the state that was loaded: it stays in the file.
    survey: Option<Part>,
    /// Those who wait until the state is saved, and whether that has not begun.
    askers: Vec<Asker>,
    pub(crate) must_save: bool,
}

/// Who has asked to save the state.
#[derive(Clone, Copy)]
pub(crate) enum Asker {
    Signal,
    /// A call of `save_state`.
    Save(Request),
    /// A call of `serialize_map`.
    Serialize(Request),
}

/// What is said of a state that is saved, or why it is not.
pub(crate) type Saved = Result<String, String>;

/// Locks a file to load and to save it.
///
/// # Errors
///
/// When the file cannot be written, or another run uses it.
pub(crate) fn open(path: &Path) -> anyhow::Result<StateFile> {
    StateFile::open(path).with_context(|| format!("{}: cannot use it", path.display()))
}

impl NodeStateFile {
    /// The file, and what it belongs to.
    ///
    /// # Errors
    ///
    /// When the parameters name no strategy.
    pub(crate) fn new(file: StateFile, settings: &Settings, parameters: &Parameters) -> anyhow::Result<Self> {
        let mut settings = settings.clone();
        // What was learned does not depend on when the robot counts as lost.
        settings.localizer.lost_after_s = LocalizerSettings::default().lost_after_s;
        let is_driver = parameters.navigator == Navigator::CmdVel;
        let pilot = SavedSettings::default()
            .with("strategy", &parameters.policy()?.name())
            .with("drives", &is_driver);
        let (sessions, survey) = (Sessions::of(PROGRAM), None);
        Ok(Self { file, settings, pilot, sessions, survey, askers: Vec::new(), must_save: false })
    }

    /// The state in the file; `None` if there is no such file.
    ///
    /// # Errors
    ///
    /// When the file is no state.
    pub(crate) fn load(&mut self) -> anyhow::Result<Option<State>> {
        self.file.load().with_context(|| self.name())
    }

    /// Lets the robot go on from a state of any program: the time of the last reading in it.
    ///
    /// # Errors
    ///
    /// When the map in the state has other cells or another estimator.
    pub(crate) fn restore(
        &mut self,
        state: State,
        robot: &mut Robot<LaserReading, LivePilot>,
        notes: &mut Notes,
    ) -> anyhow::Result<Time> {
        let name = self.name();
        let note = restore(&state, robot, &self.settings).with_context(|| name.clone())?;
        note.iter().for_each(|note| notes.say(&format!("{name}: {note}")));
        // Another strategy, or none, has learned nothing that this one could use.
        if let Some(pilot) = state.run.as_ref().filter(|run| run.settings == self.pilot) {
            interfaces::restore(robot.pilot.values(&robot.mapper), &pilot.bytes)
                .map_err(StateError::from)
                .with_context(|| name.clone())?;
        }
        // The state of another program has dates, or no time.
        let by_date_ns = || (1e9 * (robot.mapper.epoch_s() + robot.mapper.time())) as i64;
        let last_ns = state.clock_ns.unwrap_or_else(by_date_ns);
        self.sessions.go_on(&state, &robot.mapper);
        self.survey = state.survey;
        Ok(Time::from_ns(last_ns))
    }

    /// The map is that of another file from now on.
    pub(crate) fn go_on_from(&mut self, other: &Self) {
        (self.sessions, self.survey) = (other.sessions.clone(), other.survey.clone());
    }

    /// Saves the state for someone as soon as the robot is settled.
    pub(crate) fn ask(&mut self, asker: Asker) {
        self.must_save = true;
        self.askers.push(asker);
    }

    /// Whether someone waits, and the file is written.
    pub(crate) fn is_answer_due(&self) -> bool {
        !self.askers.is_empty() && !self.must_save && !self.file.is_writing()
    }

    /// Waits until the file is written: those who have asked, and what they are told.
    pub(crate) fn wait(&mut self) -> (Vec<Asker>, Saved) {
        let (name, written) = (self.name(), self.file.wait());
        let saved = match written {
            Ok(()) => Ok(format!("the state is saved in {name}")),
            Err(why) => Err(format!("{name}: cannot save the state: {why}")),
        };
        (std::mem::take(&mut self.askers), saved)
    }

    pub(crate) fn is_due(&self) -> bool {
        self.must_save || self.file.is_due()
    }

    /// Begins to write the file. An error is that of the writing before.
    pub(crate) fn save(
        &mut self,
        last: Time,
        robot: &mut Robot<LaserReading, LivePilot>,
    ) -> std::io::Result<()> {
        self.must_save = false;
        let learned = learned(robot, &self.settings, &self.sessions);
        let (settings, survey) = (self.pilot.clone(), self.survey.clone());
        let pilot = Part { settings, bytes: interfaces::snapshot(robot.pilot.values(&robot.mapper)) };
        let clock_ns = Some(last.ns());
        self.file.save(move || State { clock_ns, survey, run: Some(pilot), ..learned() })
    }

    /// The name of the file.
    pub(crate) fn name(&self) -> String {
        self.file.path().display().to_string()
    }
}
