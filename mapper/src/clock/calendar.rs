use jiff::Timestamp;
use jiff::tz::TimeZone;

/// Seconds of a day, and of a week.
pub const DAY_S: f64 = 86_400.0;
pub(super) const WEEK_S: f64 = 7.0 * DAY_S;

/// How the times of looks relate to local civil time, in which people live: the hours of a door move with summer time.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Calendar {
    /// Times count from an arbitrary moment: there is no hour and no weekday, and nothing has a schedule.
    #[default]
    Relative,
    /// Times are seconds since 1970-01-01 UTC, and people live by the clocks of this zone.
    Zone(TimeZone),
}

impl Calendar {
    /// Coordinated universal time.
    pub const UTC: Self = Self::Zone(TimeZone::UTC);

    /// The calendar of a zone by its IANA name, such as `Europe/Berlin`. The zones are built in, so that they are the same
    /// on every machine.
    ///
    /// # Errors
    ///
    /// When no zone has this name.
    pub fn of_zone(name: &str) -> Result<Self, UnknownZone> {
        TimeZone::get(name).map(Self::Zone).map_err(|_| UnknownZone { name: name.to_owned() })
    }

    /// The local civil time, s since the Monday before 1970-01-01, 0:00; `None` without a calendar, or outside of the years
    /// −9999 to 9999.
    pub(super) fn civil_s(&self, time_s: f64) -> Option<f64> {
        /// 1970-01-01 was a Thursday.
        const MONDAY_TO_EPOCH_S: f64 = 3.0 * DAY_S;
        let Self::Zone(zone) = self else { return None };
        let second = Timestamp::from_second(time_s.floor() as i64).ok()?;
        Some(time_s + f64::from(zone.to_offset(second).seconds()) + MONDAY_TO_EPOCH_S)
    }
}

/// No time zone has this name.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("no time zone is called `{name}`; names are those of the IANA, such as Europe/Berlin, America/New_York or UTC")]
pub struct UnknownZone {
    name: String,
}
