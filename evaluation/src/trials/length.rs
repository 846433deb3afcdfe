use results::numbers::thousands;
use serde::Serialize;
use std::fmt;

/// The length of a trial, in the unit of the times of its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum Length {
    /// In a grid world.
    Grid {
        /// The number of steps.
        steps: u64,
    },
    /// In a physics world.
    Physics {
        /// The simulated time, s.
        duration_s: u64,
    },
}

impl Default for Length {
    fn default() -> Self {
        Self::Grid { steps: 0 }
    }
}

impl Length {
    /// One of two, for grid worlds and for physics worlds.
    pub fn choose<T>(self, grid: T, physics: T) -> T {
        match self {
            Self::Grid { .. } => grid,
            Self::Physics { .. } => physics,
        }
    }

    /// The name of the column of times in `trials.csv`.
    pub fn column(self) -> &'static str {
        self.choose("step", "time_s")
    }
}

impl fmt::Display for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Grid { steps } => write!(f, "{} steps", thousands(steps)),
            Self::Physics { duration_s: 60 } => f.write_str("1 simulated minute"),
            Self::Physics { duration_s } if duration_s % 60 == 0 => {
                write!(f, "{} simulated minutes", thousands(duration_s / 60))
            }
            Self::Physics { duration_s } => write!(f, "{} simulated seconds", thousands(duration_s)),
        }
    }
}
