use super::Shard;
use robot::BUILD;
use serde::{Deserialize, Serialize};
use std::fmt::Debug;
use std::io::Write;
use xxhash_rust::xxh3::{Xxh3, xxh3_64};

/// The version of the format of the files of shards.
const SCHEMA: u32 = 3;

/// The first line of the file of a shard: what all shards of an experiment have in common, and the shard.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    pub(super) schema: u32,
    /// The name of the program.
    pub program: String,
    /// The version of the program.
    pub version: String,
    /// The build of the program: another build need not compute the same.
    pub build: String,
    /// The arguments that describe the experiment, without those on output, threads and shards.
    pub arguments: Vec<String>,
    /// A hash of all settings, of the worlds as well.
    pub(super) settings: String,
    /// The number of trials of the experiment.
    pub trials: u64,
    /// The shard.
    #[serde(flatten)]
    pub shard: Shard,
}

impl Header {
    /// The header of a shard of an experiment. `settings` are all settings: two experiments are the same if their
    /// settings are printed the same.
    pub fn new(
        program: &str,
        version: &str,
        arguments: Vec<String>,
        settings: &impl Debug,
        trials: u64,
        shard: Shard,
    ) -> Self {
        let mut hash = Xxh3::new(); // the text is never in memory as a whole
        let _ = write!(hash, "{settings:?}"); // hashing does not fail
        Self {
            schema: SCHEMA,
            program: program.to_owned(),
            version: version.to_owned(),
            build: BUILD.to_owned(),
            arguments,
            settings: format!("{:032x}", hash.digest128()),
            trials,
            shard,
        }
    }

    /// The key of the hashes of the lines: a line of another experiment does not match.
    pub(super) fn key(&self) -> u64 {
        xxh3_64(format!("{} {} {}", self.program, self.version, self.settings).as_bytes())
    }

    /// What differs from the experiment of `other`; `None` if it is the same.
    pub fn difference(&self, other: &Self) -> Option<String> {
        let named = |header: &Self| {
            let Self { program, version, build, arguments, .. } = header.clone();
            let arguments = format!("`{}`", arguments.join(" "));
            let schema = header.schema.to_string();
            let names = ["format", "the program", "version", "build", "the experiment"];
            names.into_iter().zip([schema, program, version, build, arguments])
        };
        if let Some(((what, own), (_, other))) =
            named(self).zip(named(other)).find(|(own, other)| own != other)
        {
            return Some(format!("of {what} {own}, not {other}"));
        }
        if (&self.settings, self.trials) != (&other.settings, other.trials) {
            return Some("of an experiment with the same arguments, but other worlds or settings".to_owned());
        }
        let [shards, others] = [self, other].map(|header| header.shard.count());
        (shards != others).then(|| format!("one of {shards} shards, not of {others}"))
    }
}
