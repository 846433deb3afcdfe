use serde::{Deserialize, Serialize};

/// What a robot did with its time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DayTotals {
    /// The time on patrol, s.
    pub patrol_s: f64,
    /// The time at rest, s.
    pub rest_s: f64,
    /// The number of patrols.
    pub patrols: u32,
    /// How often the battery was flat before the robot was back.
    pub flat: u32,
}

impl DayTotals {
    /// The share of the time on patrol; `None` before any time has passed.
    pub fn patrol_share(&self) -> Option<f64> {
        let all_s = self.patrol_s + self.rest_s;
        (all_s > 0.0).then(|| self.patrol_s / all_s)
    }
}
