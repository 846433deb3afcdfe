use interfaces::ValueError;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::io;

/// The settings that must be the same in a state and in the program that goes on with it, if they were set at all. All others are
/// those of the program.
const MUST_AGREE: [&str; 6] = [
    "survey.pose",
    "resolution_m",
    "mapper.estimator",
    "mapper.occupancy",
    "mapper.time_zone",
    "filter.min_shadow_angle_rad",
];

/// Settings with their names, as JSON.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
pub struct SavedSettings(Vec<(String, String)>);

impl SavedSettings {
    /// Adds a setting, or all settings of a part.
    #[must_use]
    pub fn with(mut self, name: &str, settings: &impl Serialize) -> Self {
        self.0.push((name.to_owned(), serde_json::to_string(settings).unwrap_or_default()));
        self
    }

    /// The settings that were added with this name; `None` if they are not those of this program.
    pub fn get<S: DeserializeOwned>(&self, name: &str) -> Option<S> {
        let (_, text) = self.0.iter().find(|(other, _)| other == name)?;
        serde_json::from_str(text).ok()
    }

    /// Every single setting with its value: `mapper.max_gap`, `8.0`.
    pub fn fields(&self) -> Vec<(String, String)> {
        let mut fields = Vec::new();
        for (name, text) in &self.0 {
            add_fields(name, &serde_json::from_str(text).unwrap_or_default(), &mut fields);
        }
        fields
    }

    /// Checks that all settings are those of the present run.
    ///
    /// # Errors
    ///
    /// When one differs.
    pub fn check(&self, present: &Self) -> Result<(), StateError> {
        self.differences(present).into_iter().next().map_or(Ok(()), Err)
    }

    /// Checks the settings that must agree with those of the present run; returns a note if others differ.
    ///
    /// # Errors
    ///
    /// When one differs that must agree.
    pub fn agree(&self, present: &Self) -> Result<Option<String>, StateError> {
        let mut others = Vec::new();
        for difference in self.differences(present) {
            match &difference {
                StateError::OtherSettings { name, saved, .. }
                    if saved == "not set" || !MUST_AGREE.iter().any(|end| name.ends_with(end)) =>
                {
                    others.push(format!("{name} = {saved}"));
                }
                _ => return Err(difference),
            }
        }
        let note =
            || format!("other settings were used so far, those of this run count: {}", others.join(", "));
        Ok((!others.is_empty()).then(note))
    }

    /// All settings that differ, in the order of the present ones.
    fn differences(&self, present: &Self) -> Vec<StateError> {
        let [saved, present] = [self, present].map(Self::fields);
        let value = |fields: &[(String, String)], name| {
            let field = fields.iter().find(|(other, _)| other == name);
            field.map_or("not set".to_owned(), |(_, value)| format!("`{value}`"))
        };
        let is_new = |(name, _): &&(String, String)| present.iter().all(|(other, _)| other != name);
        let names = present.iter().chain(saved.iter().filter(is_new)).map(|(name, _)| name);
        names
            .map(|name| (name, value(&saved, name), value(&present, name)))
            .filter(|(_, saved, expected)| saved != expected)
            .map(|(name, saved, expected)| StateError::OtherSettings { name: name.clone(), saved, expected })
            .collect()
    }
}

fn add_fields(name: &str, value: &Value, fields: &mut Vec<(String, String)>) {
    match value {
        Value::Object(parts) => parts.iter().for_each(|(part, value)| {
            add_fields(format!("{name}.{part}").trim_start_matches('.'), value, fields);
        }),
        Value::String(text) => fields.push((name.to_owned(), text.clone())),
        other => fields.push((name.to_owned(), other.to_string())),
    }
}

/// The version of the format.
pub(super) const VERSION: u32 = 1;
/// The largest body, bytes: what a mapper with the largest map can take.
pub(super) const MAX_BODY: usize = 2 << 30;
/// The longest file, bytes: what cannot be compressed takes a little more.
pub(super) const MAX_FILE: u64 = (MAX_BODY + MAX_BODY / 128) as u64;

/// The error for a state that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StateError {
    /// The file cannot be read.
    #[error("cannot read it: {0}")]
    Read(#[from] io::Error),
    /// The bytes do not begin like a state.
    #[error("this is not a state file")]
    OtherKind,
    /// The state was written by another version.
    #[error("this state file has version {0} of the format, and this program reads version {VERSION}")]
    OtherVersion(u32),
    /// The types in the file have changed since it was written.
    #[error(
        "this state file has another layout: until version 0.1.0, only builds with the same layout read it; map the place again"
    )]
    OtherLayout,
    /// Bytes are missing, or were changed.
    #[error("the state file is damaged: its checksum does not fit")]
    Damaged,
    /// The state has no such part.
    #[error("the state was saved by another program: it has no part `{0}`")]
    NoPart(&'static str),
    /// The state is too large for a file.
    #[error(
        "the state has {0} bytes, and a state file holds {MAX_BODY} at most; a map of fewer cells is smaller"
    )]
    TooLarge(usize),
    /// The state was saved by another build, whose results can differ.
    #[error("the state {0}")]
    OtherBuild(String),
    /// The state was saved with other settings.
    #[error("the state is of another run: `{name}` is {saved} there, and {expected} here")]
    OtherSettings {
        /// What differs.
        name: String,
        /// The value of the run that saved the state.
        saved: String,
        /// The value of this run.
        expected: String,
    },
    /// The state was saved by a run in a world of the same name.
    #[error("the state is of another run: its world had another content")]
    OtherWorld,
    /// A run was interrupted or refused before it learned anything.
    #[error(
        "nothing is learned in this state yet: its run ended in the first pass; run map_log again, with logs of this place"
    )]
    NothingLearned,
    /// The bytes of a part are not those of this program.
    #[error("a part of the state does not fit this program: {0}")]
    OtherContent(#[from] ValueError),
}
