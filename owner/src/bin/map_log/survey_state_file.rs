//! `--state`: what was learned from earlier logs, and what this run leaves for the next one.

use cli::program::{Failure, open_state, state_failure};
use cli::terminal::{note, say};
use mapper::MapperSettings;
use robot::state::{State, StateError, StateFile};
use std::io::stderr;
use std::path::Path;
use survey::{Survey, SurveySettings, SurveyedLog, saved_logs, saved_settings};

/// The state file of a run, or none.
pub(crate) struct SurveyStateFile {
    file: Option<StateFile>,
    /// Whether everything could be written.
    pub(crate) is_written: bool,
}

/// A state that was loaded, and the logs in it.
pub(crate) struct Loaded {
    pub(crate) state: State,
    pub(crate) logs: Vec<SurveyedLog>,
}

impl SurveyStateFile {
    /// The file of `--state`, saved once in `every_s`, and the state in it. Nothing is written yet.
    pub(crate) fn open(path: Option<&Path>, every_s: f64) -> Result<(Self, Option<Loaded>), Failure> {
        let Some(path) = path else { return Ok((Self { file: None, is_written: true }, None)) };
        let (file, state) = open_state(path, every_s)?;
        let of_state = |state| Ok(Loaded { logs: saved_logs(&state)?, state });
        let loaded = state.map(of_state).transpose().map_err(|why: StateError| state_failure(path, why))?;
        if loaded.as_ref().is_some_and(|loaded| loaded.state.check_build().is_err()) {
            let what = "another build of this program has written it, whose results can differ in details";
            note(format_args!("{}: {what}", path.display()));
        }
        Ok((Self { file: Some(file), is_written: true }, loaded))
    }

    /// Whether there is a state file.
    pub(crate) fn is_kept(&self) -> bool {
        self.file.is_some()
    }

    /// The survey in a state, or a new one.
    pub(crate) fn survey(
        &self,
        loaded: Option<Loaded>,
        settings: &SurveySettings,
        learns_noise: bool,
    ) -> Result<Survey, Failure> {
        let (Some(Loaded { state, .. }), Some(file)) = (loaded, &self.file) else {
            return Ok(Survey::new(settings.clone(), learns_noise));
        };
        let restored = Survey::restored(settings.clone(), learns_noise, &state);
        let (survey, what) = restored.map_err(|why| state_failure(file.path(), why))?;
        what.iter().for_each(|what| note(format_args!("{}: {what}", file.path().display())));
        Ok(survey)
    }

    /// Leaves the file as it is from now on.
    pub(crate) fn leave(&mut self) {
        self.file = None;
    }

    /// Whether it is time to save.
    pub(crate) fn is_due(&self) -> bool {
        self.file.as_ref().is_some_and(StateFile::is_due)
    }

    /// Begins to write the survey. What cannot be written is reported, and the run goes on.
    pub(crate) fn save(&mut self, survey: &Survey) {
        let Some(file) = &mut self.file else { return };
        if let Err(problem) = file.save(survey.saved()) {
            self.is_written = false;
            say(stderr(), format_args!("error: cannot save the state: {problem}; the run goes on"));
        }
    }

    /// Writes the survey, and waits until it is on the disk.
    pub(crate) fn finish(&mut self, survey: &Survey) {
        self.save(survey);
        let Some(Err(problem)) = self.file.as_mut().map(StateFile::wait) else { return };
        self.is_written = false;
        say(stderr(), format_args!("error: cannot save the state: {problem}"));
    }
}

impl Loaded {
    /// The time zone of the place.
    pub(crate) fn time_zone(&self) -> Option<String> {
        let of_map = self.state.map.as_ref().and_then(|map| map.settings.get::<MapperSettings>("mapper"));
        of_map.or_else(|| Some(saved_settings(&self.state)?.mapper))?.time_zone
    }
}
