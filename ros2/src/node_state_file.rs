//! `--state`: what the node has learned, from one run to the next.

use crate::link::Request;
use crate::message::Time;
use crate::notes::Notes;
use crate::parameters::{Navigator, Parameters};
use crate::pilot::LivePilot;
use anyhow::{Context, anyhow};
use interfaces::{LaserReading, PoseMode};
use localizer::LocalizerSettings;
use robot::state::{Facts, LearnedFacts, Sessions, State, StateFile, with_sessions};
use robot::{Pilot, Robot, Settings};
use std::path::Path;
use survey::SURVEY_PARTS;

/// The names of the sections of the node, beside those of every robot.
const CLOCK: &str = "clock";
const PILOT: &str = "pilot";
/// The name of the program, for its sessions.
const PROGRAM: &str = "curious_node";

/// The state file of a node.
pub(crate) struct NodeStateFile {
    pub(crate) file: StateFile,
    facts: LearnedFacts,
    pilot: Facts,
    sessions: Sessions,
    /// The state that was loaded.
    state: State,
    /// Those who wait until the state is saved, and whether that has not begun.
    pub(crate) askers: Vec<Asker>,
    pub(crate) must_save: bool,
}

/// Who has asked to save the state: a request, or a signal.
pub(crate) type Asker = Option<Request>;

impl NodeStateFile {
    /// The file, and what it belongs to.
    ///
    /// # Errors
    ///
    /// When the file cannot be written, or another run uses it.
    pub(crate) fn new(path: &Path, settings: &Settings, parameters: &Parameters) -> anyhow::Result<Self> {
        // What was learned does not depend on when the robot counts as lost.
        let lost_after_s = LocalizerSettings::default().lost_after_s;
        let localizer = LocalizerSettings { lost_after_s, ..settings.localizer.clone() };
        let (pose, localizer) = match settings.pose {
            PoseMode::Localized => ("localized", Some(&localizer)),
            PoseMode::Exact | PoseMode::Odometry | PoseMode::Corrected => ("given", None),
        };
        let pilot = Facts::default().with("strategy", parameters.policy()?.name());
        let pilot = match parameters.navigator {
            Navigator::CmdVel => pilot,
            Navigator::Nav2 | Navigator::GoalPose => pilot.with("navigator", "another"),
        };
        Ok(Self {
            file: StateFile::open(path).with_context(|| format!("{}: cannot use it", path.display()))?,
            facts: LearnedFacts::new(pose, localizer, Some(&settings.filter)),
            pilot,
            sessions: Sessions::of(PROGRAM),
            state: State::default(),
            askers: Vec::new(),
            must_save: false,
        })
    }

    /// The state in the file; `None` if there is no such file.
    ///
    /// # Errors
    ///
    /// When the file is no state.
    pub(crate) fn load(&self) -> anyhow::Result<Option<State>> {
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
        let note = self.facts.restore(&state, robot).with_context(|| name.clone())?;
        note.iter().for_each(|note| notes.say(&format!("{name}: {note}")));
        // Another strategy, or none, has learned nothing that this one could use.
        if let Ok(learned) = state.section(PILOT, &self.pilot)
            && !learned.is_empty()
        {
            let restored = interfaces::restore(robot.pilot.values(&robot.mapper), learned);
            restored.map_err(|_| anyhow!("{name}: the part `{PILOT}` does not fit this program"))?;
        }
        let last = match state.section(CLOCK, &Facts::default()) {
            Ok(clock) => clock.try_into().map_or(0, i64::from_le_bytes),
            // The state of another program: by its dates, or 0.
            Err(_) => (1e9 * (robot.mapper.epoch_s() + robot.mapper.time())) as i64,
        };
        self.sessions = Sessions::after(Some(&state), PROGRAM, &robot.mapper);
        self.file.keep_before_save();
        self.state = state;
        Ok(Time::from_ns(last))
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
        let learned = self.facts.snapshot(robot);
        let (facts, pilot) = (self.pilot.clone(), interfaces::snapshot(robot.pilot.values(&robot.mapper)));
        let clock = last.ns().to_le_bytes().to_vec();
        let sessions = self.sessions.now(&robot.mapper);
        // What only a survey of logs uses stays in the file.
        let state = State::default().with_parts_of(&self.state, &SURVEY_PARTS);
        self.file.save(move || {
            let state = learned.added_to(state).with(CLOCK, Facts::default(), clock);
            with_sessions(state, &sessions).with(PILOT, facts, pilot).with_build()
        })
    }

    /// The name of the file.
    pub(crate) fn name(&self) -> String {
        self.file.path().display().to_string()
    }
}
