//! A robot whose odometry drifts, with a localizer and a map that learns from its estimates.

use crate::house::{House, Thing, rectangle};
use interfaces::{GridFrame, LaserReading, Purpose, RandomStream, heading_rad, pose};
use localizer::{Localized, Localizer, LocalizerSettings, PoseState};
use mapper::{Mapper, MapperSettings};
use nalgebra::Isometry2;

/// The time between two scans, s.
pub(crate) const PERIOD_S: f64 = 0.1;

/// The four rooms with furniture that makes each room different, and a laser with 1 cm of noise.
pub(crate) fn furnished(beams: usize, seed: u64) -> House {
    let mut house = House::new(0.1, 7.0, 0.01, beams, seed);
    for (x0, y0, x1, y1) in [
        (0.1, 1.6, 0.7, 3.4),
        (4.2, 0.1, 5.6, 0.6),
        (7.4, 0.1, 8.2, 1.0),
        (11.2, 3.6, 11.9, 5.4),
        (6.05, 10.9, 7.5, 11.9),
        (0.1, 7.2, 0.5, 8.8),
        (3.6, 11.4, 5.2, 11.9),
    ] {
        house.add(Thing::always(rectangle(x0, y0, x1, y1)));
    }
    house
}

/// The odometry: the sum of the true motions with their errors.
pub(crate) struct Odometry {
    /// The measured pose.
    pub(crate) pose: Isometry2<f64>,
    last: Isometry2<f64>,
    random: RandomStream,
}

impl Odometry {
    pub(crate) fn new(start: Isometry2<f64>, seed: u64) -> Self {
        Self { pose: start, last: start, random: RandomStream::new(seed, Purpose::OdometryNoise(0)) }
    }

    /// Hard drift: 5 % gains, 3° per meter, and noise of the same size.
    pub(crate) fn moved_to(&mut self, true_pose: &Isometry2<f64>) -> Isometry2<f64> {
        let delta = self.last.inv_mul(true_pose);
        self.last = *true_pose;
        let (at, turn) = (delta.translation.vector, heading_rad(&delta));
        let distance = at.norm();
        let measured = turn * 0.95 + 0.052 * distance + 0.05 * turn.abs().sqrt() * self.random.normal();
        let slip = 0.05 * distance.sqrt() * self.random.normal();
        self.pose *= pose(at.x * 1.05 + slip, at.y * 1.05, measured);
        self.pose
    }

    /// The robot is carried: the wheels do not turn.
    pub(crate) fn carried_to(&mut self, true_pose: &Isometry2<f64>) {
        self.last = *true_pose;
    }

    /// The odometry jumps: the robot does not move.
    pub(crate) fn jump(&mut self, by: &Isometry2<f64>) {
        self.pose *= by;
    }
}

/// A localizer that knows nothing.
pub(crate) fn localizer(frame: &GridFrame, start: Isometry2<f64>) -> Localizer {
    Localizer::from_nothing(&LocalizerSettings::default(), frame, start).unwrap()
}

/// The robot.
pub(crate) struct Robot {
    pub(crate) house: House,
    pub(crate) localizer: Localizer,
    pub(crate) odometry: Odometry,
    /// Learns from the estimates.
    pub(crate) estimated: Mapper,
    /// Learns from the true poses.
    pub(crate) exact: Mapper,
    pub(crate) time_s: f64,
    /// Errors of the position of all certain poses, m.
    pub(crate) errors_m: Vec<f64>,
    /// The number of scans without a certain pose.
    pub(crate) uncertain: usize,
    /// Changes in the two maps.
    pub(crate) changes: [usize; 2],
}

pub(crate) fn mapper(frame: GridFrame) -> Mapper {
    Mapper::new(&MapperSettings::default(), frame).unwrap()
}

impl Robot {
    pub(crate) fn new(house: House, start: Isometry2<f64>, seed: u64) -> Self {
        Self {
            odometry: Odometry::new(start, seed),
            localizer: localizer(&house.frame, start),
            estimated: mapper(house.frame),
            exact: mapper(house.frame),
            house,
            time_s: 0.0,
            errors_m: Vec::new(),
            uncertain: 0,
            changes: [0; 2],
        }
    }

    /// Where the tour is at this time, after two seconds of rest.
    pub(crate) fn on_tour(&self) -> Isometry2<f64> {
        self.house.tour((self.time_s - 2.0).max(0.0))
    }

    /// The true reading at a pose.
    pub(crate) fn reading(&mut self, true_pose: Isometry2<f64>) -> LaserReading {
        self.house.reading(self.time_s, true_pose, &[])
    }

    /// One scan at a pose: as measured, with an odometry that drifts.
    pub(crate) fn step(&mut self, true_pose: Isometry2<f64>) -> Localized {
        self.step_with(true_pose, |_| {})
    }

    /// One scan at a pose, with a fault of the sensors. The exact map sees the same scan.
    pub(crate) fn step_with(
        &mut self,
        true_pose: Isometry2<f64>,
        fault: impl FnOnce(&mut LaserReading),
    ) -> Localized {
        let mut reading = self.reading(true_pose);
        self.time_s += PERIOD_S;
        let exact = reading.clone();
        reading.pose = self.odometry.moved_to(&true_pose);
        fault(&mut reading);
        self.exact.update(&exact).unwrap();
        self.changes[0] += events(&self.exact);
        let localized = self.localizer.localize(&reading, &self.estimated);
        if localized.estimate.state == PoseState::Tracking {
            self.estimated.update(&localized.reading).unwrap();
            self.changes[1] += events(&self.estimated);
            self.errors_m.push(error_m(&localized, &true_pose));
        } else {
            self.uncertain += 1;
        }
        localized
    }

    /// Drives along the tour for some time.
    pub(crate) fn tour_until(&mut self, end_s: f64) {
        while self.time_s < end_s {
            self.step(self.on_tour());
        }
    }

    /// The map has few changes that the one with exact poses has not.
    #[track_caller]
    pub(crate) fn assert_few_changes(&self, more: usize, what: &str) {
        let [exact, estimated] = self.changes;
        assert!(estimated <= exact + more, "{what}: {estimated} changes, {exact} with exact poses");
    }

    /// No wrong pose was ever certain.
    #[track_caller]
    pub(crate) fn assert_never_wrong(&self, most_m: f64, what: &str) {
        let error_m = self.error_m(1.0);
        assert!(error_m < most_m, "{what}: a pose off by {error_m} m was certain");
    }

    /// A quantile of the errors, m.
    pub(crate) fn error_m(&self, share: f64) -> f64 {
        let mut sorted = self.errors_m.clone();
        sorted.sort_by(f64::total_cmp);
        sorted[(share * (sorted.len() - 1) as f64).round() as usize]
    }
}

fn events(mapper: &Mapper) -> usize {
    mapper.transitions().iter().filter(|transition| transition.event().is_some()).count()
}

pub(crate) fn error_m(localized: &Localized, true_pose: &Isometry2<f64>) -> f64 {
    (localized.estimate.pose.translation.vector - true_pose.translation.vector).norm()
}
