use crate::recovery::Recovery;
use interfaces::{GridFrame, GroundTruth, LaserReading, heading_rad};
use localizer::{Localized, PoseEstimate, PoseState};
use mapper::Mapper;
use nalgebra::{Isometry2, Matrix3};
use std::time::Duration;

/// The measurements of a run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Score {
    pub(crate) errors_m: Vec<f64>,
    pub(crate) headings_rad: Vec<f64>,
    /// Errors of the position over their standard deviation.
    ratios: Vec<f64>,
    pub(crate) uncertain: usize,
    pub(crate) lost: usize,
    pub(crate) scans: usize,
    elapsed: Duration,
    slowest: Duration,
    /// Changes per cell in the map with exact poses, and in that with estimated poses.
    changes: [Vec<u32>; 2],
    pub(crate) false_changes: [u32; 2],
    all_changes: [u32; 2],
    pub(crate) recovery: Recovery,
}

/// The distance and the angle between two poses, m and rad.
pub(crate) fn error(estimate: &Isometry2<f64>, true_pose: &Isometry2<f64>) -> (f64, f64) {
    let off = true_pose.inv_mul(estimate);
    (off.translation.vector.norm(), heading_rad(&off).abs())
}

impl Score {
    pub(crate) fn new(frame: &GridFrame) -> Self {
        Self { changes: [vec![0; frame.len()], vec![0; frame.len()]], ..Self::default() }
    }

    pub(crate) fn observe(
        &mut self,
        estimate: &PoseEstimate,
        true_pose: &Isometry2<f64>,
        exact: &Mapper,
        estimated: Option<&Mapper>,
        elapsed: Duration,
    ) {
        let (error_m, error_rad) = error(&estimate.pose, true_pose);
        self.scans += 1;
        self.elapsed += elapsed;
        self.slowest = self.slowest.max(elapsed);
        match estimate.state {
            PoseState::Tracking => {
                self.errors_m.push(error_m);
                self.headings_rad.push(error_rad);
                self.ratios.push(error_m / estimate.position_std_m().max(1e-4));
            }
            PoseState::Uncertain => self.uncertain += 1,
            PoseState::Lost => self.lost += 1,
        }
        for (mapper, changes) in [Some(exact), estimated].into_iter().zip(&mut self.changes) {
            let transitions = mapper.map_or(&[][..], Mapper::transitions).iter();
            for transition in transitions.filter(|transition| transition.event().is_some()) {
                changes[exact.frame().index(transition.cell).expect("a cell of the map")] += 1;
            }
        }
    }

    /// The changes in a map that was learned again.
    pub(crate) fn learned_again(&mut self, estimated: &Mapper) {
        for (index, changes) in self.changes[1].iter_mut().enumerate() {
            *changes = estimated.statistics(index).events();
        }
    }

    /// Ends a run, and counts the false changes: those of cells that nothing ever touched.
    pub(crate) fn finish(&mut self, truth: &impl GroundTruth) {
        self.recovery.finish();
        for (which, changes) in self.changes.iter().enumerate() {
            self.all_changes[which] = changes.iter().sum();
            let still = changes.iter().enumerate().filter(|(index, _)| !truth.is_swept(*index));
            self.false_changes[which] = still.map(|(_, changes)| changes).sum();
        }
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.errors_m.extend(&other.errors_m);
        self.headings_rad.extend(&other.headings_rad);
        self.ratios.extend(&other.ratios);
        self.uncertain += other.uncertain;
        self.lost += other.lost;
        self.scans += other.scans;
        self.elapsed += other.elapsed;
        self.slowest = self.slowest.max(other.slowest);
        self.recovery.add(&other.recovery);
        for which in 0..2 {
            self.false_changes[which] += other.false_changes[which];
            self.all_changes[which] += other.all_changes[which];
        }
    }

    pub(crate) fn print(&self, name: &str) {
        let mm = |share| quantile(&self.errors_m, share) * 1e3;
        let share = |count: usize| 100.0 * count as f64 / self.scans.max(1) as f64;
        println!(
            "{name}: position {:.1} / {:.1} / {:.1} mm, heading 95 % {:.3}°, max {:.2}°; error over sigma 95 % {:.1}; \
             uncertain {:.2} %, lost {:.2} %; false changes {} (exact {}), all {} (exact {}); {:.0} µs per scan, \
             at most {:.1} ms",
            mm(0.5),
            mm(0.95),
            mm(1.0),
            quantile(&self.headings_rad, 0.95).to_degrees(),
            quantile(&self.headings_rad, 1.0).to_degrees(),
            quantile(&self.ratios, 0.95),
            share(self.uncertain),
            share(self.lost),
            self.false_changes[1],
            self.false_changes[0],
            self.all_changes[1],
            self.all_changes[0],
            self.elapsed.as_secs_f64() * 1e6 / self.scans.max(1) as f64,
            self.slowest.as_secs_f64() * 1e3,
        );
        self.recovery.print();
    }
}

pub(crate) fn quantile(values: &[f64], share: f64) -> f64 {
    evaluation::metrics::quantile(values, share).unwrap_or(f64::NAN)
}

/// The estimate of a robot that believes its odometry.
pub(crate) fn by_odometry(pose: Isometry2<f64>, reading: LaserReading) -> Localized {
    let estimate =
        PoseEstimate { pose, covariance: Matrix3::zeros(), support: 1.0, state: PoseState::Tracking };
    Localized { reading: LaserReading { pose, ..reading }, estimate }
}
