//! Series of events: what a thing did, and what a robot saw of it.

use crate::recorded::Recording;
use interfaces::{Purpose, RandomStream};
use mapper::{DAY_S, Look};
use std::path::Path;

/// The step of all series, s.
pub(crate) const STEP_S: f64 = 60.0;

/// No recording is longer, s: ten years.
const MAX_S: f64 = 10.0 * 365.25 * DAY_S;

/// The recorded states of one thing.
pub(crate) struct Series {
    pub(crate) name: String,
    /// The parameters are learned before this time, predictions are scored after it, s.
    pub(crate) split_s: f64,
    /// The time of the first step, s.
    pub(crate) start_s: f64,
    /// For each step whether the thing was blocked; `None` where nothing was recorded.
    pub(crate) states: Vec<Option<bool>>,
}

impl Series {
    /// Reads a file.
    pub(crate) fn read(path: &Path) -> Result<Self, String> {
        let at = |what: &str| format!("{}: {what}", path.display());
        let text = std::fs::read_to_string(path).map_err(|error| at(&error.to_string()))?;
        let recording = Recording::parse(&text).map_err(|error| at(&error))?;
        let [start_s, last_s] = [recording.changes.first(), recording.changes.last()]
            .map(|change| change.map_or(0.0, |change| change.0));
        // Comments may state when the recording ended, and where its part for learning ends.
        let stated = |key: &str| -> Option<f64> {
            let words = text.lines().filter(|line| line.starts_with('#')).flat_map(str::split_whitespace);
            words.filter_map(|word| word.strip_prefix(key)).find_map(|value| value.parse().ok())
        };
        let end_s = stated("end_s=").unwrap_or(last_s + STEP_S).min(start_s + MAX_S);
        let split_s = stated("split_s=").unwrap_or(0.5 * (start_s + end_s));
        let mut next = recording.changes.iter().peekable();
        let mut state = None;
        let states = (0..((end_s - start_s) / STEP_S) as usize).map(|step| {
            while let Some((_, changed)) =
                next.next_if(|(time_s, _)| *time_s <= start_s + step as f64 * STEP_S)
            {
                state = *changed;
            }
            state
        });
        let states = states.collect();
        let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        Ok(Self { name, split_s, start_s, states })
    }

    /// The set of a series: its name up to the first `-`.
    pub(crate) fn set(&self) -> &str {
        self.name.split('-').next().unwrap_or(&self.name)
    }

    /// The first step after the split.
    pub(crate) fn split(&self) -> usize {
        (((self.split_s - self.start_s) / STEP_S).max(0.0) as usize).min(self.states.len())
    }

    /// What a look at a step shows; `None` where nothing was recorded.
    pub(crate) fn look(&self, step: usize) -> Option<Look> {
        let is_blocked = (*self.states.get(step)?)?;
        Some(Look { time_s: self.start_s + step as f64 * STEP_S, is_blocked })
    }
}

/// When a robot looks at a thing.
#[derive(Clone, Copy)]
pub(crate) enum Looks {
    /// At every step.
    Full,
    /// At random steps, this share of all.
    Share(f64),
    /// Every two hours, at a random time within half an hour of it, for five minutes.
    Patrol,
}

pub(crate) const LOOKS: [(&str, Looks); 5] = [
    ("full", Looks::Full),
    ("5 %", Looks::Share(0.05)),
    ("2 %", Looks::Share(0.02)),
    ("1 %", Looks::Share(0.01)),
    ("patrol", Looks::Patrol),
];

impl Looks {
    /// For each step whether the robot looks.
    pub(crate) fn draw(self, steps: usize, seed: u64) -> Vec<bool> {
        let mut rng = RandomStream::new(seed, Purpose::Task);
        match self {
            Self::Full => vec![true; steps],
            Self::Share(share) => (0..steps).map(|_| rng.bernoulli(share)).collect(),
            Self::Patrol => {
                const ROUND: usize = (DAY_S / 12.0 / STEP_S) as usize;
                let mut looks = vec![false; steps];
                for round in (0..steps).step_by(ROUND) {
                    let first = round + rng.uniform(0.0..ROUND as f64 / 2.0) as usize;
                    looks[first.min(steps)..(first + 5).min(steps)].fill(true);
                }
                looks
            }
        }
    }
}
