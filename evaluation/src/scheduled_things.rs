//! How well the predicted map knew the things with a schedule, at all times of a run: while the robot drives, and while it rests
//! without looking.

mod layout;

use crate::metrics::{Freshness, UserRegret};
use layout::Layout;
use mapper::Mapper;
use serde::{Deserialize, Serialize};
use sim::physics::PhysicsWorld;

/// Compares the predicted map with the truth every minute, in worlds with a calendar.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct ScheduledThings {
    freshness: Freshness,
    users: UserRegret,
    /// The number of samples so far, which is that of the next one.
    samples: u64,
    /// Follows from the world.
    #[serde(skip)]
    layout: Option<Layout>,
}

impl Default for ScheduledThings {
    fn default() -> Self {
        let (freshness, users) = (Freshness::new(Self::EVERY_S), UserRegret::default());
        Self { freshness, users, samples: 0, layout: None }
    }
}

/// How well the predicted map knew the things with a schedule.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ScheduledScores {
    /// The number of things with a schedule.
    pub things: usize,
    /// The number of minutes.
    pub samples: u64,
    /// The mean of (probability of being blocked − true state)² over all things and minutes, in view or not.
    pub brier: f64,
    /// The number of changes that lasted an hour or more.
    pub lasting_changes: usize,
    /// The median and the 95 % point of the time from such a change until the predicted map shows it, s; `null` without one.
    pub detection_delay_s: [f64; 2],
    /// The share of such changes that the map did not show until the next one.
    pub missed: f64,
    /// The mean time that a user loses per trip between places, s, since doors that the map shows as open are closed; `null` without a
    /// door.
    pub user_lost_s: f64,
    /// The share of the possible trips that a user does not make, since the map shows no open way.
    pub trips_not_made: f64,
}

impl ScheduledThings {
    /// The time from sample to sample, s.
    pub const EVERY_S: f64 = 60.0;

    /// Whether nothing was compared.
    pub fn is_empty(&self) -> bool {
        self.samples == 0
    }

    /// Compares the map with the world if a sample is due. The map predicts from its last reading.
    pub fn sample(&mut self, world: &PhysicsWorld, mapper: &Mapper) {
        let is_due = world.time_s() + 1e-6 >= self.samples as f64 * Self::EVERY_S;
        if world.spec().starts_s.is_none() || !is_due {
            return;
        }
        self.samples += 1;
        let layout = self.layout.get_or_insert_with(|| Layout::of(world.spec()));
        let predicted: Vec<f64> =
            layout.things.iter().map(|thing| thing.predicted(mapper, world.time_s())).collect();
        let is_blocked: Vec<bool> =
            layout.things.iter().map(|thing| thing.is_blocked(world.truth())).collect();
        self.freshness.add(&predicted, &is_blocked);
        self.users.add(&layout.routes, &predicted, &is_blocked);
    }

    /// The scores; `None` in a world without a calendar.
    pub fn scores(&self) -> Option<ScheduledScores> {
        let things = self.freshness.things();
        let fresh = self.freshness.scores();
        (things > 0).then(|| ScheduledScores {
            things,
            samples: self.samples,
            brier: fresh.brier,
            lasting_changes: fresh.lasting_changes,
            detection_delay_s: fresh.detection_delay_s,
            missed: fresh.missed,
            user_lost_s: self.users.lost_s(),
            trips_not_made: self.users.not_made(),
        })
    }
}
