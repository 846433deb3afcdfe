/// An hour, s.
pub const HOUR_S: f64 = 3600.0;
/// A day, s.
pub const DAY_S: f64 = 24.0 * HOUR_S;
/// A week, s.
pub const WEEK_S: f64 = 7.0 * DAY_S;
/// The resolution of [`Hours`], s: half an hour.
pub const SLOT_S: f64 = 0.5 * HOUR_S;
const SLOTS: usize = 336;

/// The half hours of a week in which a place is active; in the others it is quiet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hours {
    active: Vec<bool>,
}

impl Hours {
    /// Active all the time.
    pub fn always() -> Self {
        Self { active: vec![true; SLOTS] }
    }

    /// Never active.
    pub fn never() -> Self {
        Self { active: vec![false; SLOTS] }
    }

    /// Active on these days (0 is Monday) from `begin_h` to `end_h` (hours of the day, rounded to half hours).
    pub fn daily(days: &[usize], begin_h: f64, end_h: f64) -> Self {
        let mut hours = Self::never();
        days.iter().for_each(|day| hours.set(*day, begin_h, end_h, true));
        hours
    }

    /// Makes the hours from `begin_h` to `end_h` of a day (0 is Monday) active or quiet.
    pub fn set(&mut self, day: usize, begin_h: f64, end_h: f64, is_active: bool) {
        let slot = |hour: f64| (2.0 * hour).round().clamp(0.0, 48.0) as usize;
        self.active[day % 7 * 48..][slot(begin_h)..slot(end_h).max(slot(begin_h))].fill(is_active);
    }

    /// Whether the place is active at a time, s.
    pub fn is_active(&self, time_s: f64) -> bool {
        self.active[slot_of(time_s) as usize % SLOTS]
    }

    /// The first time after `time_s` at which the place becomes active or quiet, s; infinite if it never does.
    pub fn next_switch_s(&self, time_s: f64) -> f64 {
        let (first, week) = (slot_of(time_s) as usize, (time_s / WEEK_S).floor() * WEEK_S);
        let is_active = self.active[first % SLOTS];
        (1..=SLOTS)
            .find(|ahead| self.active[(first + ahead) % SLOTS] != is_active)
            .map_or(f64::INFINITY, |ahead| week + (first + ahead) as f64 * SLOT_S)
    }
}

/// The half hour of the week, 0 to 335.
fn slot_of(time_s: f64) -> f64 {
    (time_s.rem_euclid(WEEK_S) / SLOT_S).floor().min(SLOTS as f64 - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_office_is_active_on_weekdays() {
        let office = Hours::daily(&[0, 1, 2, 3, 4], 8.0, 18.0);
        assert!(!office.is_active(7.9 * HOUR_S) && office.is_active(8.0 * HOUR_S));
        assert!(office.is_active(17.9 * HOUR_S) && !office.is_active(18.0 * HOUR_S));
        assert!(!office.is_active(5.0 * DAY_S + 12.0 * HOUR_S));
        assert_eq!(office.next_switch_s(0.0), 8.0 * HOUR_S);
        assert_eq!(office.next_switch_s(8.0 * HOUR_S), 18.0 * HOUR_S);
        // Over the weekend, into the next week and before the first one.
        assert_eq!(office.next_switch_s(4.0 * DAY_S + 18.0 * HOUR_S), WEEK_S + 8.0 * HOUR_S);
        assert_eq!(office.next_switch_s(-WEEK_S), -WEEK_S + 8.0 * HOUR_S);
        assert_eq!(Hours::always().next_switch_s(1.0), f64::INFINITY);
    }
}
