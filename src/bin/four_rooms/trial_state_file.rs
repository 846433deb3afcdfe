//! `--state`: where a run goes on from, and what it leaves for the next one.

use crate::args::Args;
use crate::parts::Parts;
use cli::program::{Failure, open_state, state_failure};
use evaluation::physics_trial::PhysicsTrial;
use evaluation::trial_state::TrialFacts;
use interfaces::Twist;
use robot::Pilot;
use robot::state::{Sessions, StateFile};
use std::io;

/// The state file of a run.
pub(crate) struct TrialStateFile {
    file: StateFile,
    facts: TrialFacts,
    sessions: Sessions,
}

impl TrialStateFile {
    /// The file of `--state`. If there is a state in it, the run goes on from there.
    pub(crate) fn open(
        args: &Args,
        parts: &Parts,
        trial: &mut PhysicsTrial<impl Pilot<Command = Twist>>,
    ) -> Result<Option<Self>, Failure> {
        let Some(path) = &args.state else { return Ok(None) };
        let (file, state) = open_state(path, args.state_every)?;
        let mut facts = TrialFacts::new(&parts.spec, args.seed, &parts.settings, parts.pilot_facts(args));
        facts.allows_other_build = args.allow_other_build;
        let mut sessions = Sessions::of("four_rooms");
        if let Some(state) = state {
            trial.restore(&state, &facts).map_err(|why| state_failure(path, why))?;
            sessions.go_on(&state, &trial.robot.mapper);
        }
        Ok(Some(Self { file, facts, sessions }))
    }

    pub(crate) fn is_due(&self) -> bool {
        self.file.is_due()
    }

    /// Begins to write the state. An error is that of the writing before.
    pub(crate) fn save(&mut self, trial: &mut PhysicsTrial<impl Pilot<Command = Twist>>) -> io::Result<()> {
        self.file.save(trial.snapshot(&self.facts, &self.sessions))
    }

    /// Writes the state, and waits until it is on the disk.
    pub(crate) fn finish(mut self, trial: &mut PhysicsTrial<impl Pilot<Command = Twist>>) -> io::Result<()> {
        // What could not be written before is in this state as well.
        self.save(trial).ok();
        self.file.wait()
    }
}
