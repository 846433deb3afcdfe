use robot::BUILD;
use serde::{Deserialize, Serialize};
use std::fmt::{self, Debug, Display, Formatter};
use std::io::Write;
use std::str::FromStr;
use xxhash_rust::xxh3::Xxh3;

/// The largest number of shards: the index of an array of jobs in Slurm is at most 1000, unless it is configured, and
/// merging opens every file.
const MAX_SHARDS: u64 = 1000;

/// One part of an experiment, as `3/64`: the trials whose number, divided by 64, has the remainder 3. The last shard
/// has those without a remainder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
pub struct Shard {
    #[serde(rename = "shard")]
    number: u64,
    #[serde(rename = "shards")]
    count: u64,
}

/// The error for a text that is not a shard.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("must be I/N with I from 1 to N, and N at most {MAX_SHARDS}: 1/6, 2/6, up to 6/6")]
pub struct InvalidShard;

impl Shard {
    /// Shard `number` of `count`; `None` unless 1 ≤ number ≤ count ≤ 1000.
    pub fn new(number: u64, count: u64) -> Option<Self> {
        (1 <= number && number <= count && count <= MAX_SHARDS).then_some(Self { number, count })
    }

    /// The number of the shard, from 1 on.
    pub fn number(self) -> u64 {
        self.number
    }

    /// The number of shards.
    pub fn count(self) -> u64 {
        self.count
    }

    /// Whether the trial with a number, from 1 on, belongs to the shard.
    pub fn has(self, trial: u64) -> bool {
        trial % self.count == self.number % self.count
    }

    /// The name of the file of the shard.
    pub fn file_name(self) -> String {
        format!("shard-{}-of-{}.jsonl", self.number, self.count)
    }

    /// The shard whose file has this name.
    pub fn of_file_name(name: &str) -> Option<Self> {
        let (number, count) = name.strip_prefix("shard-")?.strip_suffix(".jsonl")?.split_once("-of-")?;
        let shard = Self::new(number.parse().ok()?, count.parse().ok()?)?;
        (shard.file_name() == name).then_some(shard)
    }
}

impl Display for Shard {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.count)
    }
}

impl FromStr for Shard {
    type Err = InvalidShard;

    fn from_str(text: &str) -> Result<Self, InvalidShard> {
        let (number, count) = text.split_once('/').ok_or(InvalidShard)?;
        let number_of = |text: &str| text.parse().map_err(|_| InvalidShard);
        Self::new(number_of(number)?, number_of(count)?).ok_or(InvalidShard)
    }
}

/// Increasing numbers in the syntax of `sbatch --array`, as in `1,3,5-8`.
pub fn array(numbers: &[u64]) -> String {
    let ranges = numbers.chunk_by(|a, b| a + 1 == *b).map(|range| match range {
        [first, .., last] => format!("{first}-{last}"),
        _ => range[0].to_string(),
    });
    ranges.collect::<Vec<_>>().join(",")
}

/// The version of the format of the files of shards.
const SCHEMA: u32 = 4;

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_trial_belongs_to_one_shard() {
        for (trials, count) in [(1, 1), (7, 3), (6, 3), (2, 5), (1000, 64)] {
            let shards: Vec<Shard> = (1..=count).map(|number| Shard::new(number, count).unwrap()).collect();
            for trial in 1..=trials {
                assert_eq!(shards.iter().filter(|shard| shard.has(trial)).count(), 1);
            }
            for shard in shards {
                assert_eq!(Shard::of_file_name(&shard.file_name()), Some(shard));
            }
        }
    }

    #[test]
    fn shards_are_numbered_from_1() {
        assert_eq!("3/64".parse(), Ok(Shard { number: 3, count: 64 }));
        for wrong in ["0/3", "4/3", "1/0", "3", "", "/", "a/3", "1/1001", "-1/3", "1/3/3", "1.5/3"] {
            assert_eq!(wrong.parse::<Shard>(), Err(InvalidShard), "{wrong}");
        }
        for wrong in ["shard-01-of-3.jsonl", "shard-4-of-3.jsonl", "shard-1-of-3.json", "report.json"] {
            assert_eq!(Shard::of_file_name(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn numbers_are_written_as_sbatch_reads_them() {
        assert_eq!(array(&[1, 3, 5, 6, 7, 9, 10]), "1,3,5-7,9-10");
        assert_eq!(array(&[]), "");
    }
}
