//! Series of events: what a thing did, and what a robot saw of it.

use interfaces::{Purpose, RandomStream};
use mapper::{DAY_S, Look};
use std::path::Path;

/// The step of all series, s.
pub const STEP_S: f64 = 60.0;

/// The recorded states of one thing.
pub struct Series {
    pub name: String,
    /// The parameters are learned before this time, predictions are scored after it, s.
    pub split_s: f64,
    /// The time of the first step, s.
    pub start_s: f64,
    /// For each step whether the thing was blocked; `None` where nothing was recorded.
    pub states: Vec<Option<bool>>,
}

impl Series {
    /// Reads a file: lines `time_s,state`, one per change, with `# split_s=… end_s=…` before them.
    pub fn read(path: &Path) -> Result<Self, String> {
        let at = |what: &str| format!("{}: {what}", path.display());
        let text = std::fs::read_to_string(path).map_err(|error| at(&error.to_string()))?;
        let head = |key: &str| -> Option<f64> {
            let comments = text.lines().filter(|line| line.starts_with('#'));
            comments.flat_map(str::split_whitespace).find_map(|word| word.strip_prefix(key)?.parse().ok())
        };
        let mut changes: Vec<(f64, Option<bool>)> = Vec::new();
        for (index, line) in text.lines().enumerate() {
            if line.starts_with('#') || line.starts_with("time_s") || line.is_empty() {
                continue;
            }
            let wrong = || at(&format!("line {}: expected `time_s,state` with a state of 0, 1 or nan, found `{line}`", index + 1));
            let (time, state) = line.split_once(',').ok_or_else(wrong)?;
            let time_s = time.trim().parse::<f64>().map_err(|_| wrong())?;
            let state = match state.trim() {
                "0" => Some(false),
                "1" => Some(true),
                "nan" | "NaN" => None,
                _ => return Err(wrong()),
            };
            if changes.last().is_some_and(|(last_s, _)| time_s < *last_s) {
                return Err(at(&format!("line {}: time goes backwards", index + 1)));
            }
            changes.push((time_s, state));
        }
        let (Some((start_s, _)), Some((last_s, _))) = (changes.first().copied(), changes.last().copied()) else {
            return Err(at("no events"));
        };
        let end_s = head("end_s=").unwrap_or(last_s + STEP_S);
        let split_s = head("split_s=").unwrap_or(0.5 * (start_s + end_s));
        let mut states = Vec::new();
        let (mut next, mut state) = (0, None);
        for step in 0..((end_s - start_s) / STEP_S) as usize {
            while next < changes.len() && changes[next].0 <= start_s + step as f64 * STEP_S {
                state = changes[next].1;
                next += 1;
            }
            states.push(state);
        }
        let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        Ok(Self { name, split_s, start_s, states })
    }

    /// The set of a series: its name up to the first `-`.
    pub fn set(&self) -> &str {
        self.name.split('-').next().unwrap_or(&self.name)
    }

    pub fn time_s(&self, step: usize) -> f64 {
        self.start_s + step as f64 * STEP_S
    }

    /// The state at a step that a robot sees, if it looks.
    pub fn look(&self, step: usize) -> Option<Look> {
        let is_blocked = (*self.states.get(step)?)?;
        Some(Look { time_s: self.time_s(step), is_blocked })
    }
}

/// When a robot looks at a thing.
#[derive(Clone, Copy)]
pub enum Looks {
    /// At every step.
    Full,
    /// At random steps, this share of all.
    Share(f64),
    /// Every two hours, at a random time within half an hour of it, for five minutes.
    Patrol,
}

pub const LOOKS: [(&str, Looks); 5] = [
    ("full", Looks::Full),
    ("5 %", Looks::Share(0.05)),
    ("2 %", Looks::Share(0.02)),
    ("1 %", Looks::Share(0.01)),
    ("patrol", Looks::Patrol),
];

impl Looks {
    /// For each step whether the robot looks.
    pub fn draw(self, steps: usize, seed: u64) -> Vec<bool> {
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
