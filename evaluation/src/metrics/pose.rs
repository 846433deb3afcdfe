use super::statistics::Counts;
use localizer::{Correction, PoseEstimate, PoseState};
use nalgebra::{Isometry2, Point2, distance};

/// Errors larger than this count as this large, m.
const MAX_ERROR_M: u32 = 100;
/// A pose that is wrong by more than this, m or rad, ...
const LOCK_IN_M: f64 = 0.05;
const LOCK_IN_RAD: f64 = 0.02;
/// ... for longer than this, while the localizer takes it for certain, is locked in, s.
const LOCK_IN_S: f64 = 1.0;

/// The errors of the poses that the robot used, compared with the true poses.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub struct PoseErrors {
    positions_m: Counts<100_000, MAX_ERROR_M>,
    headings_rad: Counts<1_000_000, 4>,
    /// All but the mode and the quantiles.
    scores: PoseScores,
    /// The beginning of the present large error with a certain pose, s; counted once it lasts.
    wrong_since_s: Option<f64>,
    last_s: f64,
}

/// The quality of the poses of a run.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub struct PoseScores {
    /// How poses were known: `exact`, `odometry` or `localized`.
    pub mode: String,
    /// The median error of the position over the readings with a certain pose, m.
    pub median_m: Option<f64>,
    /// The error that 95 % of these readings do not exceed, m.
    pub p95_m: Option<f64>,
    /// The largest error of these readings, m.
    pub max_m: f64,
    /// The error of the heading that 95 % of these readings do not exceed, degrees.
    pub heading_p95_deg: Option<f64>,
    /// The time with a pose that was not certain, without the time in which the robot was lost, s.
    pub uncertain_s: f64,
    /// The time in which the robot was lost, s.
    pub lost_s: f64,
    /// How often a pose was taken for certain for more than a second although it was wrong by more than 5 cm or 1.1°.
    pub lock_ins: usize,
    /// How often a closed loop has shown that the map was inconsistent, so that the map was learned again.
    pub loops_closed: usize,
    /// The largest distance by which a pose of the past has moved then, m.
    pub largest_correction_m: f64,
}

impl PoseErrors {
    /// Compares the pose of one reading, in the frame of the map, with the true pose. A pose without an estimate counts
    /// as certain.
    pub fn observe(
        &mut self,
        time_s: f64,
        pose: &Isometry2<f64>,
        truth: &Isometry2<f64>,
        estimate: Option<&PoseEstimate>,
    ) {
        let last_s = std::mem::replace(&mut self.last_s, time_s);
        let elapsed_s = time_s - last_s;
        match estimate.map_or(PoseState::Tracking, |estimate| estimate.state) {
            PoseState::Tracking => {}
            PoseState::Uncertain => self.scores.uncertain_s += elapsed_s,
            PoseState::Lost => self.scores.lost_s += elapsed_s,
        }
        if estimate.is_some_and(|estimate| estimate.state != PoseState::Tracking) {
            self.wrong_since_s = None;
            return;
        }
        let (at, true_at): (Point2<f64>, Point2<f64>) =
            (pose.translation.vector.into(), truth.translation.vector.into());
        let error_m = distance(&at, &true_at);
        let error_rad = pose.rotation.angle_to(&truth.rotation).abs();
        self.positions_m.add(error_m);
        self.headings_rad.add(error_rad);
        self.scores.max_m = self.scores.max_m.max(error_m);
        if error_m <= LOCK_IN_M && error_rad <= LOCK_IN_RAD {
            self.wrong_since_s = None;
            return;
        }
        let since_s = *self.wrong_since_s.get_or_insert(time_s);
        // Counted once: at the reading with which the error has lasted.
        if time_s - since_s > LOCK_IN_S && last_s - since_s <= LOCK_IN_S {
            self.scores.lock_ins += 1;
        }
    }

    /// Lets time pass without a pose, until `until_s`: the robot rests.
    pub fn rest(&mut self, until_s: f64) {
        (self.last_s, self.wrong_since_s) = (until_s, None);
    }

    /// Counts a closed loop.
    pub fn correct(&mut self, correction: &Correction) {
        let PoseScores { loops_closed, largest_correction_m, .. } = &mut self.scores;
        *loops_closed += 1;
        *largest_correction_m = largest_correction_m.max(correction.largest_m);
    }

    /// The scores so far.
    pub fn scores(&self, mode: &str) -> PoseScores {
        PoseScores {
            mode: mode.to_owned(),
            median_m: self.positions_m.quantile(0.5),
            p95_m: self.positions_m.quantile(0.95),
            heading_p95_deg: self.headings_rad.quantile(0.95).map(f64::to_degrees),
            ..self.scores.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix3;

    fn estimate(state: PoseState) -> PoseEstimate {
        PoseEstimate { pose: Isometry2::identity(), covariance: Matrix3::identity(), support: 1.0, state }
    }

    /// Errors of `error_m` for 100 readings in each state.
    fn observed(error_m: f64, states: &[PoseState]) -> PoseScores {
        let mut errors = PoseErrors::default();
        for (reading, state) in states.iter().flat_map(|state| [*state; 100]).enumerate() {
            let pose = interfaces::pose(error_m, 0.0, 0.001);
            errors.observe(0.1 * (reading + 1) as f64, &pose, &Isometry2::identity(), Some(&estimate(state)));
        }
        errors.scores("localized")
    }

    #[test]
    fn only_certain_poses_have_errors_and_others_cost_time() {
        use PoseState::{Lost, Tracking, Uncertain};
        let scores = observed(0.003, &[Tracking, Uncertain, Lost, Lost]);
        assert!((scores.median_m.unwrap() - 0.003).abs() < 1e-9);
        assert!((scores.heading_p95_deg.unwrap() - 0.001_f64.to_degrees()).abs() < 1e-9);
        assert!((scores.uncertain_s - 10.0).abs() < 1e-9 && (scores.lost_s - 20.0).abs() < 1e-9);
        assert_eq!(scores.lock_ins, 0);
        assert_eq!(observed(0.003, &[Lost]).median_m, None);
    }

    #[test]
    fn a_wrong_pose_that_is_taken_for_certain_is_locked_in_once() {
        use PoseState::{Tracking, Uncertain};
        assert_eq!(observed(0.06, &[Tracking]).lock_ins, 1);
        assert_eq!(observed(0.06, &[Tracking, Uncertain, Tracking]).lock_ins, 2);
        assert_eq!(observed(0.06, &[Uncertain]).lock_ins, 0);
        assert_eq!(observed(0.04, &[Tracking]).lock_ins, 0);
    }

    #[test]
    fn rests_are_no_time_with_an_uncertain_pose() {
        let mut errors = PoseErrors::default();
        let (lost, at) = (estimate(PoseState::Lost), Isometry2::identity());
        errors.observe(1.0, &at, &at, Some(&lost));
        errors.rest(3600.0);
        errors.observe(3600.1, &at, &at, Some(&lost));
        assert!((errors.scores("localized").lost_s - 1.1).abs() < 1e-9);
    }

    #[test]
    fn closed_loops_are_counted() {
        let mut errors = PoseErrors::default();
        for largest_m in [0.3, 0.2] {
            errors.correct(&Correction { places: 2, readings: 100, largest_m });
        }
        let scores = errors.scores("localized");
        assert_eq!((scores.loops_closed, scores.largest_correction_m), (2, 0.3));
    }
}
