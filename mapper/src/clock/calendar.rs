use jiff::Timestamp;
use jiff::tz::TimeZone;

/// A day, s.
pub const DAY_S: f64 = 86_400.0;

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

    /// The hour of the week, from Monday 0:00 on in local civil time, from 0 to 168; `None` without hours.
    pub fn hour_of_week(&self, time_s: f64) -> Option<f64> {
        let civil = self.civil(time_s);
        civil.has_hours.then(|| civil.time_s.rem_euclid(7.0 * DAY_S) / 3600.0)
    }

    /// The local civil time of a moment.
    pub(super) fn civil(&self, time_s: f64) -> Civil {
        /// 1970-01-01 was a Thursday.
        const MONDAY_TO_EPOCH_S: f64 = 3.0 * DAY_S;
        let second = || Timestamp::from_second(time_s.floor() as i64).ok();
        match self {
            Self::Zone(zone) => second().map(|second| {
                let offset_s = f64::from(zone.to_offset(second).seconds());
                Civil { time_s: time_s + offset_s + MONDAY_TO_EPOCH_S, has_hours: true }
            }),
            Self::Relative => None,
        }
        .unwrap_or(Civil { time_s, has_hours: false })
    }
}

/// A local civil time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Civil {
    /// The time since the Monday before 1970-01-01, 0:00, s; without hours since an arbitrary moment.
    pub(super) time_s: f64,
    /// Whether hour and weekday are known: with a calendar, in the years −9999 to 9999.
    pub(super) has_hours: bool,
}

/// No time zone has this name.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "no time zone is called `{name}`; names are those of the IANA, such as Europe/Berlin, America/New_York or UTC"
)]
pub struct UnknownZone {
    name: String,
}
