//! `--state`: what the node has learned, from one run to the next.

use crate::message::Time;
use anyhow::{Context, anyhow};
use interfaces::{GridFrame, LaserReading};
use localizer::LocalizerSettings;
use mapper::{Mapper, MapperSettings};
use robot::state::{Facts, LearnedFacts, State, StateFile};
use robot::{Localization, Pilot};
use std::path::Path;

/// The names of the sections of the node, beside those of every robot.
const CLOCK: &str = "clock";
const PILOT: &str = "pilot";

/// The state file of a node.
pub(crate) struct Saves {
    file: StateFile,
    facts: LearnedFacts,
    pilot: Facts,
}

impl Saves {
    /// The file, and what it belongs to. `pose` is the name of the parameter's value.
    ///
    /// # Errors
    ///
    /// When the file cannot be written, or another run uses it.
    pub(crate) fn new(
        path: &Path,
        mapper: &MapperSettings,
        frame: &GridFrame,
        (pose, localizer): (&str, Option<&LocalizerSettings>),
        strategy: &str,
    ) -> anyhow::Result<Self> {
        let facts = LearnedFacts::new(mapper, frame, pose, localizer);
        let file = StateFile::open(path).with_context(|| format!("{}: cannot use it", path.display()))?;
        Ok(Self { file, facts, pilot: Facts::default().with("strategy", strategy) })
    }

    /// Goes on from the file: the time of the last reading in it. `None` if there is no such file.
    ///
    /// # Errors
    ///
    /// When the file is no state, or that of another node.
    pub(crate) fn restore(
        &self,
        mapper: &mut Mapper,
        localization: &mut dyn Localization<LaserReading>,
        pilot: &mut impl Pilot,
    ) -> anyhow::Result<Option<Time>> {
        let name = self.file.path().display().to_string();
        let state = self.file.load().with_context(|| name.clone())?;
        let Some(state) = state else { return Ok(None) };
        self.facts.restore(&state, mapper, localization).with_context(|| name.clone())?;
        let clock = state.section(CLOCK, &Facts::default()).with_context(|| name.clone())?;
        let clock = clock.try_into().map_err(|_| anyhow!("{name}: the part `{CLOCK}` has another length"))?;
        // Another strategy, or none, has learned nothing that this one could use.
        if let Ok(learned) = state.section(PILOT, &self.pilot)
            && !learned.is_empty()
        {
            let restored = interfaces::restore(pilot.values(mapper), learned);
            restored.map_err(|_| anyhow!("{name}: the part `{PILOT}` does not fit this program"))?;
        }
        Ok(Some(Time::from_ns(i64::from_le_bytes(clock))))
    }

    pub(crate) fn is_due(&self) -> bool {
        self.file.is_due()
    }

    /// Begins to write the file. An error is that of the writing before.
    pub(crate) fn save(
        &mut self,
        last: Time,
        mapper: &Mapper,
        localization: &mut dyn Localization<LaserReading>,
        pilot: &mut impl Pilot,
    ) -> std::io::Result<()> {
        let learned = self.facts.snapshot(mapper, localization);
        let (facts, driven) = (self.pilot.clone(), interfaces::snapshot(pilot.values(mapper)));
        let clock = last.ns().to_le_bytes().to_vec();
        self.file.save(move || {
            let state = learned.added_to(State::default()).with(CLOCK, Facts::default(), clock);
            state.with(PILOT, facts, driven).with_build()
        })
    }

    /// Whether the file is being written now.
    pub(crate) fn is_writing(&self) -> bool {
        self.file.is_writing()
    }

    /// Waits until the file is written.
    pub(crate) fn wait(&mut self) -> std::io::Result<()> {
        self.file.wait()
    }

    /// The name of the file.
    pub(crate) fn name(&self) -> String {
        self.file.path().display().to_string()
    }
}
