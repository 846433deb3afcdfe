//! The state of the shards in a folder, as text.

use super::{Scan, Shard, Shards};
use results::numbers::{duration, percent};
use std::fmt::Write;
use std::time::SystemTime;

/// A shard counts as running while its newest trial is not older than this number of trials take, and at least
/// [`MIN_SILENCE_S`].
const SILENT_TRIALS: f64 = 5.0;
const MIN_SILENCE_S: f64 = 60.0;

/// A shard that is not complete.
struct Open<'a> {
    shard: Shard,
    scan: Option<&'a Scan>,
    trials: u64,
    /// The time since its newest trial, s.
    age_s: Option<f64>,
}

impl Open<'_> {
    fn finished(&self) -> u64 {
        self.scan.map_or(0, Scan::finished)
    }

    fn is_running(&self, mean_s: f64) -> bool {
        self.age_s.is_some_and(|age_s| age_s <= MIN_SILENCE_S.max(SILENT_TRIALS * mean_s))
    }

    /// The time to its end at the speed of its newest trials, s.
    fn left_s(&self) -> Option<f64> {
        Some((self.trials - self.finished()) as f64 * self.scan?.seconds_per_trial()?)
    }
}

/// The time, s since 1970.
pub(super) fn now_s() -> u64 {
    SystemTime::UNIX_EPOCH.elapsed().map_or(0, |time| time.as_secs())
}

impl Shards {
    /// The present state as text: one line for each shard that is not complete, and one for all shards.
    pub fn status(&self) -> String {
        let (mut finished, mut seconds, mut complete) = (0, 0.0, 0);
        let mut open = Vec::new();
        let (now_s, trials) = (now_s(), self.header().trials);
        for (shard, scan) in self.shards() {
            let of_shard = Open {
                shard,
                scan,
                trials: shard.trials(trials),
                age_s: scan.and_then(Scan::last_finished).map(|last| now_s.saturating_sub(last) as f64),
            };
            finished += of_shard.finished();
            seconds += scan.map_or(0.0, |scan| scan.seconds);
            if of_shard.finished() < of_shard.trials {
                open.push(of_shard);
            } else {
                complete += 1;
            }
        }
        let mean_s = seconds / finished.max(1) as f64;
        let mut text = String::new();
        for shard in &open {
            let state = match (shard.scan, shard.age_s) {
                (None, _) => "not started".into(),
                (Some(_), None) => "no trial yet".into(),
                (Some(_), Some(age_s)) if !shard.is_running(mean_s) => {
                    format!("silent for {}", duration(age_s))
                }
                (Some(_), Some(_)) => match shard.left_s() {
                    None => "running".into(),
                    Some(left_s) => format!("running, {} left", duration(left_s)),
                },
            };
            let done = format!("{} of {}", shard.finished(), shard.trials);
            let _ = writeln!(text, "shard {:<9} {done:>15} trials  {state}", shard.shard.to_string());
        }
        let running = open.iter().filter(|shard| shard.is_running(mean_s));
        let count = running.clone().count();
        let left_s = running.filter_map(Open::left_s).fold(f64::NAN, f64::max);
        let share = percent(finished as f64 / trials.max(1) as f64);
        let _ = writeln!(text, "{finished} of {trials} trials ({share}), {:.3} core-hours", seconds / 3600.0);
        let all = complete + open.len();
        let _ = write!(text, "{complete} of {all} shards complete, {count} running");
        if !left_s.is_nan() {
            let _ = write!(text, ": {} left", duration(left_s));
        }
        text
    }
}
