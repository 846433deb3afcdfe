//! `--state`: what the node has learned, from one run to the next.

use crate::link::Request;
use crate::message::Time;
use crate::parameters::{Navigator, Parameters};
use crate::pilot::LivePilot;
use anyhow::{Context, anyhow};
use interfaces::{GridFrame, LaserReading, PoseMode};
use localizer::LocalizerSettings;
use robot::state::{Facts, LearnedFacts, State, StateFile};
use robot::{Pilot, Robot, Settings};
use std::path::Path;

/// The names of the sections of the node, beside those of every robot.
const CLOCK: &str = "clock";
const PILOT: &str = "pilot";

/// The state file of a node.
pub(crate) struct NodeStateFile {
    pub(crate) file: StateFile,
    facts: LearnedFacts,
    pilot: Facts,
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
    pub(crate) fn new(
        path: &Path,
        settings: &Settings,
        frame: &GridFrame,
        parameters: &Parameters,
    ) -> anyhow::Result<Self> {
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
            facts: LearnedFacts::new(&settings.mapper, frame, pose, localizer),
            pilot,
            askers: Vec::new(),
            must_save: false,
        })
    }

    /// Lets the robot go on from the file: the time of the last reading in it. `None` if there is no such file.
    ///
    /// # Errors
    ///
    /// When the file is no state, or that of another node.
    pub(crate) fn restore(&self, robot: &mut Robot<LaserReading, LivePilot>) -> anyhow::Result<Option<Time>> {
        let name = self.name();
        let Some(state) = self.file.load().with_context(|| name.clone())? else { return Ok(None) };
        self.facts.restore(&state, robot).with_context(|| name.clone())?;
        let clock = state.section(CLOCK, &Facts::default()).with_context(|| name.clone())?;
        let clock = clock.try_into().map_err(|_| anyhow!("{name}: the part `{CLOCK}` has another length"))?;
        // Another strategy, or none, has learned nothing that this one could use.
        if let Ok(learned) = state.section(PILOT, &self.pilot)
            && !learned.is_empty()
        {
            let restored = interfaces::restore(robot.pilot.values(&robot.mapper), learned);
            restored.map_err(|_| anyhow!("{name}: the part `{PILOT}` does not fit this program"))?;
        }
        Ok(Some(Time::from_ns(i64::from_le_bytes(clock))))
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
        self.file.save(move || {
            let state = learned.added_to(State::default()).with(CLOCK, Facts::default(), clock);
            state.with(PILOT, facts, pilot).with_build()
        })
    }

    /// The name of the file.
    pub(crate) fn name(&self) -> String {
        self.file.path().display().to_string()
    }
}
