use super::Shard;
use super::line::{seal, unseal};
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
    schema: u32,
    /// The name of the program.
    pub program: String,
    /// The version of the program.
    pub version: String,
    /// The build of the program: another build need not compute the same.
    pub build: String,
    /// The arguments that describe the experiment, without those on output, threads and shards.
    pub arguments: Vec<String>,
    /// A hash of all settings, of the worlds as well.
    settings: String,
    /// The number of trials of the experiment.
    pub trials: u64,
    /// The number of the shard, from 1 on.
    shard: u64,
    shards: u64,
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
            shard: shard.number(),
            shards: shard.count(),
        }
    }

    /// The shard.
    pub fn shard(&self) -> Option<Shard> {
        Shard::new(self.shard, self.shards)
    }

    /// The header of another shard of the same experiment.
    pub fn of_shard(&self, shard: Shard) -> Self {
        Self { shard: shard.number(), shards: shard.count(), ..self.clone() }
    }

    /// The same header from another build.
    #[cfg(test)]
    pub(super) fn of_build(self, build: &str) -> Self {
        Self { build: build.to_owned(), ..self }
    }

    /// The key of the hashes of the lines: a line of another experiment does not match.
    pub(super) fn key(&self) -> u64 {
        xxh3_64(format!("{} {} {}", self.program, self.version, self.settings).as_bytes())
    }

    /// Whether both are shards of the same experiment and the same build.
    pub fn is_same_experiment(&self, other: &Self) -> bool {
        self.difference(other).is_none()
    }

    /// What differs from the experiment of `other`; `None` if it is the same.
    pub(super) fn difference(&self, other: &Self) -> Option<String> {
        let named = |what: &str, of: fn(&Self) -> String| {
            let [own, other] = [self, other].map(of);
            (own != other).then(|| format!("of {what} {own}, not {other}"))
        };
        let is_otherwise = (&self.settings, self.trials) != (&other.settings, other.trials);
        let otherwise = "of an experiment with the same arguments, but other worlds or settings";
        let shards = || format!("one of {} shards, not of {}", self.shards, other.shards);
        named("format", |header| header.schema.to_string())
            .or_else(|| named("the program", |header| header.program.clone()))
            .or_else(|| named("version", |header| header.version.clone()))
            .or_else(|| named("build", |header| header.build.clone()))
            .or_else(|| named("the experiment", |header| format!("`{}`", header.arguments.join(" "))))
            .or_else(|| is_otherwise.then(|| otherwise.to_owned()))
            .or_else(|| (self.shards != other.shards).then(shards))
    }

    /// The header as a line.
    pub(super) fn line(&self) -> serde_json::Result<String> {
        Ok(seal(&serde_json::to_string(self)?, 0))
    }

    /// The header in a line without its end; `None` for something else.
    pub(super) fn read(line: &str) -> Option<Self> {
        serde_json::from_str(&format!("{}}}", unseal(line, 0)?)).ok()
    }
}
