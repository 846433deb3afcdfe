//! `--state`: what was learned from earlier logs, and what this run leaves for the next one.

use crate::args::Args;
use cli::program::{Failure, open_state, state_failure};
use cli::terminal::say;
use robot::state::{Facts, State, StateError, StateFile};
use std::io::stderr;
use survey::{SavedLogs, SavedSurvey, Survey, SurveySettings, SurveyedLog};

/// The state file of a run, or none.
pub(crate) struct SurveyStateFile {
    file: Option<StateFile>,
    /// The number of logs in the file, if all are learned: before another one is added, the file is kept.
    learned: Option<usize>,
    facts: Facts,
    /// Whether everything could be written.
    pub(crate) is_written: bool,
}

/// A state that was loaded, and the logs in it.
pub(crate) struct Loaded {
    state: State,
    pub(crate) logs: SavedLogs,
}

impl SurveyStateFile {
    /// The file of `--state`, and the state in it. Nothing is written yet.
    pub(crate) fn open(args: &Args) -> Result<(Self, Option<Loaded>), Failure> {
        let mut state_file = Self { file: None, learned: None, facts: Facts::default(), is_written: true };
        let Some(path) = &args.state else { return Ok((state_file, None)) };
        let (file, state) = open_state(path, args.state_every)?;
        let loaded = state.map(Loaded::of).transpose().map_err(|why| state_failure(path, why))?;
        if loaded.as_ref().is_some_and(|loaded| loaded.state.check_build().is_err()) {
            let note = "another build of this program has written it, whose results can differ in details";
            say(stderr(), format_args!("note: {}: {note}", path.display()));
        }
        let logs = loaded.as_ref().map(|loaded| loaded.logs.logs());
        state_file.learned = logs.filter(|logs| logs.iter().all(SurveyedLog::is_finished)).map(<[_]>::len);
        state_file.file = Some(file);
        Ok((state_file, loaded))
    }

    /// Whether there is a state file.
    pub(crate) fn is_kept(&self) -> bool {
        self.file.is_some()
    }

    /// The survey in a state, or a new one.
    pub(crate) fn survey(
        &mut self,
        loaded: Option<Loaded>,
        settings: &SurveySettings,
        noise_m: Option<f64>,
    ) -> Result<Survey, Failure> {
        let noise = noise_m.map_or_else(|| "learned".to_owned(), |noise_m| noise_m.to_string());
        let default = SurveySettings::of(settings.pose);
        let facts = Facts::default().with("--pose", default.pose.name()).with("--noise", &noise);
        self.facts = facts.with_learned_settings("survey", settings, Some(&default));
        let (settings, learns_noise) = (settings.clone(), noise_m.is_none());
        let (Some(Loaded { state, .. }), Some(file)) = (loaded, &self.file) else {
            return Ok(Survey::new(settings, learns_noise));
        };
        let restored = Survey::restored(settings, learns_noise, &state, &self.facts);
        let (survey, note) = restored.map_err(|why| state_failure(file.path(), why))?;
        note.iter().for_each(|note| say(stderr(), format_args!("note: {}: {note}", file.path().display())));
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
        if self.learned.is_some_and(|learned| survey.logs().len() > learned)
            && let Err(problem) = file.keep_earlier()
        {
            say(stderr(), format_args!("note: the state before this run cannot be kept: {problem}"));
        }
        self.learned = self.learned.filter(|learned| survey.logs().len() == *learned);
        let (survey, facts) = (survey.saved(), self.facts.clone());
        let saved = file.save(move || survey.into_state(facts));
        if let Err(problem) = saved {
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
        Some(SavedSurvey::facts(&self.state)?.get("survey.mapper.time_zone")?.to_owned())
    }

    fn of(state: State) -> Result<Self, StateError> {
        Ok(Self { logs: SavedLogs::read(&state)?, state })
    }
}
