//! Times that make no sense. Clocks of robots are set while they run, and some programs write too few digits.

/// Two scans of a log are never farther apart than a month, s: a robot may rest for a weekend or a holiday, and a clock that was
/// never set is wrong by years.
pub(crate) const LONGEST_PAUSE_S: f64 = 30.0 * DAY_S;
/// A pause of more than a day, s, is noted, because a clock that was set looks the same.
const DAY_S: f64 = 86_400.0;
/// Times that go back by less than this come from messages that were written in another order, s.
const DISORDER_S: f64 = 60.0;
/// The time between scans that have the time of the scan before, or an earlier one, s.
const MIN_STEP_S: f64 = 1e-3;
/// The time between scans of a log without usable times, s.
const STEP_WITHOUT_TIMES_S: f64 = 1.0;

/// Times that pass this much faster or slower than those of the recording, over at least this time, s, are noted.
const OTHER_PACE: f64 = 1.5;
const MIN_SPAN_S: f64 = 10.0;

/// The times of the readings.
pub(crate) struct Times {
    /// From the first reading on, strictly increasing, s.
    pub(crate) times_s: Vec<f64>,
    /// Whether the times in the log can be compared with each other.
    pub(crate) has_times: bool,
    /// The time of the first reading by the clock of the longest part between two jumps of the clock, s.
    pub(crate) begin_s: f64,
    /// The length of this part, s; `None` without a jump.
    dated_s: Option<f64>,
    /// What was repaired.
    pub(crate) note: Option<String>,
}

impl Times {
    /// A note on the date of a log whose clock was set.
    pub(crate) fn date_note(&self) -> Option<String> {
        let (dated_s, all_s) = (self.dated_s?, self.times_s.last()?);
        Some(format!(
            "the date and the hours are those of the longest part between jumps of the clock ({dated_s:.1} s of {all_s:.1} s)"
        ))
    }
}

/// Repairs the times of the scans of a log.
pub(crate) fn repaired(raw_s: &[f64]) -> Times {
    let mut steps: Vec<f64> = raw_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let count = steps.len();
    steps.retain(|step| *step > 0.0 && *step <= LONGEST_PAUSE_S);
    if steps.len() * 2 < count || !raw_s.iter().all(|time_s| time_s.abs() < 1e15) {
        let note = format!(
            "the times of the scans are unusable ({} of {count} steps go forward): scans count as {STEP_WITHOUT_TIMES_S} s \
             apart, and rates are per scan",
            steps.len(),
        );
        let times_s = (0..raw_s.len()).map(|scan| scan as f64 * STEP_WITHOUT_TIMES_S).collect();
        return Times { times_s, has_times: false, begin_s: 0.0, dated_s: None, note: Some(note) };
    }
    let period_s = interfaces::median(steps.into_iter()).unwrap_or(STEP_WITHOUT_TIMES_S);
    let (mut jumps, mut back, mut rests_s) = (0, 0, Vec::new());
    // By how much the clock is behind, as far as is known, s.
    let mut behind_s = 0.0;
    let (mut times_s, mut offset_s) = (Vec::with_capacity(raw_s.len()), 0.0);
    let (mut part_s, mut longest) = (0.0, (0.0, 0.0));
    for (scan, raw) in raw_s.iter().enumerate() {
        let Some(last_s) = times_s.last().copied() else {
            offset_s = -raw;
            times_s.push(0.0);
            continue;
        };
        let step_s = raw + offset_s - last_s;
        let is_pause = (-DISORDER_S..=LONGEST_PAUSE_S).contains(&step_s);
        let catches_up = (behind_s / 2.0..behind_s + DISORDER_S).contains(&step_s);
        if !is_pause || step_s > DAY_S && (catches_up || is_undone(&raw_s[scan..], step_s)) {
            behind_s = if step_s < 0.0 { behind_s - step_s } else { 0.0 };
            jumps += 1;
            longest = longer(longest, (last_s - part_s, offset_s));
            offset_s += period_s - step_s;
            part_s = last_s + period_s;
        } else if step_s < MIN_STEP_S {
            back += 1;
        } else if step_s > DAY_S {
            rests_s.push(step_s);
        }
        times_s.push((raw + offset_s).max(last_s + MIN_STEP_S));
    }
    let end_s = times_s.last().copied().unwrap_or_default();
    let (dated_s, offset_s) = longer(longest, (end_s - part_s, offset_s));
    let of_back = match back {
        1 => "1 scan is not later than the scan before and counts".to_owned(),
        _ => format!("{back} scans are not later than the scan before and count"),
    };
    let of_back = (back > 0).then(|| format!("{of_back} as {MIN_STEP_S} s later"));
    let of_jumps = match jumps {
        1 => "a jump of the clock counts".to_owned(),
        _ => format!("{jumps} jumps of the clock count"),
    };
    let of_jumps = (jumps > 0).then(|| format!("{of_jumps} as {period_s:.3} s"));
    let of_rests = match rests_s[..] {
        [] => None,
        [rest_s] => Some(format!("{:.1} days without a scan count as a rest of the robot", rest_s / DAY_S)),
        _ => Some(format!(
            "{} pauses of more than a day ({:.1} days in all) count as rests of the robot",
            rests_s.len(),
            rests_s.iter().sum::<f64>() / DAY_S
        )),
    };
    let of_rests =
        of_rests.map(|note| format!("{note}: if the clock was set instead, hours and rates are wrong"));
    let notes: Vec<String> = of_back.into_iter().chain(of_jumps).chain(of_rests).collect();
    let note = (!notes.is_empty()).then(|| notes.join("; "));
    let dated_s = (jumps > 0).then_some(dated_s);
    Times { times_s, has_times: true, begin_s: -offset_s, dated_s, note }
}

/// Whether the clock later goes back over more than half of the step, s, to the first of these times: it was wrong for a while.
fn is_undone(from_s: &[f64], step_s: f64) -> bool {
    let undone_s = from_s[0] - step_s - DISORDER_S..from_s[0] - step_s / 2.0;
    from_s.iter().any(|time_s| undone_s.contains(time_s))
}

/// The longer one of two parts of a log, each with its length and its offset; of equal ones the later: clocks are set to be right.
fn longer(earlier: (f64, f64), later: (f64, f64)) -> (f64, f64) {
    if later.0 >= earlier.0 { later } else { earlier }
}

/// A note if the scans took another time, s, than their recording: a log may be recorded while it is played, so that this is
/// no error.
pub(crate) fn other_pace(scans_s: f64, recorded_s: f64) -> Option<String> {
    let is_other = scans_s.max(recorded_s) > OTHER_PACE * scans_s.min(recorded_s);
    (is_other && scans_s.min(recorded_s) > MIN_SPAN_S).then(|| {
        format!(
            "the scans took {scans_s:.0} s by their own times, which count, and {recorded_s:.0} s by those of the recording: \
             one of both is wrong, unless the log was recorded while it was played"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn good_times_begin_at_zero_and_stay() {
        let times = repaired(&[1e9, 1e9 + 0.5, 1e9 + 2.0]);
        assert_eq!((times.begin_s, times.date_note()), (1e9, None));
        assert_eq!((times.times_s, times.has_times, times.note), (vec![0.0, 0.5, 2.0], true, None));
        assert_eq!(repaired(&[7.0]).times_s, [0.0]);
    }

    #[test]
    fn times_that_span_nothing_are_counted() {
        let Times { times_s, has_times, note, .. } = repaired(&[1.018_93e9; 4]);
        assert_eq!((times_s, has_times), (vec![0.0, 1.0, 2.0, 3.0], false));
        assert!(note.unwrap().starts_with("the times of the scans are unusable (0 of 3 steps go forward)"));
        assert!(!repaired(&[0.0, f64::NAN, 1.0]).has_times);
    }

    #[test]
    fn jumps_are_closed_and_disorder_is_ordered() {
        let jump = 4.29e9;
        let repaired = repaired(&[10.0, 10.5, 11.0, 11.0, 10.9, 11.5, 12.0 + jump, 12.5 + jump, 13.0]);
        let expected = [0.0, 0.5, 1.0, 1.001, 1.002, 1.5, 2.0, 2.5, 3.0];
        for (found, expected) in repaired.times_s.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-5, "{found} instead of {expected}");
        }
        let note = "2 scans are not later than the scan before and count as 0.001 s later; 2 jumps of the clock count as 0.500 s";
        assert_eq!(repaired.note.as_deref(), Some(note));
    }

    #[test]
    fn a_log_is_dated_by_its_longest_part_between_jumps() {
        // The clock is set after 3 s, by years, by an hour back, and back and forth for one scan.
        let log = |before: f64, at: std::ops::Range<usize>| {
            let raw_s: Vec<f64> = (0..100)
                .map(|step| 1.7e9 + 0.1 * step as f64 + if at.contains(&step) { before } else { 0.0 })
                .collect();
            repaired(&raw_s)
        };
        let at_60 = [(2e5, 60..61), (-2e5, 60..61), (-2e5, 60..80), (5e6, 60..61)];
        let others = [(-5e8, 0..30), (3600.0, 0..30), (1e9, 0..1), (-4000.0, 80..100)];
        for (before, at) in at_60.into_iter().chain(others) {
            let times = log(before, at.clone());
            assert!((times.begin_s - 1.7e9).abs() < 1e-3, "{before} {at:?}: {}", times.begin_s);
            let note = times.date_note().unwrap();
            assert!(note.starts_with("the date and the hours are those of the longest part"), "{note}");
        }
        let note = "the date and the hours are those of the longest part between jumps of the clock (6.9 s of 9.9 s)";
        assert_eq!(log(-5e8, 0..30).date_note().as_deref(), Some(note));
    }

    #[test]
    fn a_robot_may_rest_for_weeks() {
        for days in [1.5, 3.0, 25.0] {
            let raw_s = [1.7e9, 1.7e9 + 0.1, 1.7e9 + 0.2, 1.7e9 + 0.2 + DAY_S * days];
            let times = repaired(&raw_s);
            assert!((times.times_s[3] - 0.2 - DAY_S * days).abs() < 1e-6, "{days}");
            let note = format!(
                "{days:.1} days without a scan count as a rest of the robot: if the clock was set instead, hours and"
            );
            assert!(times.note.unwrap().starts_with(&note) && times.dated_s.is_none());
        }
        assert!(repaired(&[0.0, 0.1, 0.2, 0.9 * DAY_S]).note.is_none());
    }
}
