//! Whether the map drifts in a long run: where the estimated pose puts fixed corners, hour by hour.

use crate::score::quantile;
use interfaces::GridFrame;
use localizer::{PoseEstimate, PoseState};
use nalgebra::{Isometry2, Point2, Vector2};

const HOUR_S: f64 = 3600.0;
/// A corner counts while the robot is this near, m.
const NEAR_M: f64 = 4.0;

/// The corners of the place, and where the estimates of an hour put them.
#[derive(Clone, Debug)]
pub(crate) struct Corners {
    corners: [Point2<f64>; 4],
    hour: usize,
    /// The sums of the differences from the true place, and their number.
    sums: [(Vector2<f64>, u32); 4],
    /// The means of the first hour in which the robot was near.
    first: [Option<Vector2<f64>>; 4],
    /// The shifts since, m.
    shifts_m: Vec<f64>,
}

impl Corners {
    pub(crate) fn new(frame: &GridFrame) -> Self {
        let size = Vector2::new(frame.width() as f64, frame.height() as f64) * frame.resolution_m();
        let corner = |x: f64, y: f64| frame.origin() + Vector2::new(x * size.x, y * size.y);
        Self {
            corners: [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)],
            hour: 0,
            sums: [(Vector2::zeros(), 0); 4],
            first: [None; 4],
            shifts_m: Vec::new(),
        }
    }

    pub(crate) fn observe(&mut self, time_s: f64, estimate: &PoseEstimate, true_pose: &Isometry2<f64>) {
        if (time_s / HOUR_S) as usize > self.hour {
            self.finish_hour();
        }
        if estimate.state != PoseState::Tracking {
            return;
        }
        let error = estimate.pose * true_pose.inverse();
        for (corner, (sum, count)) in self.corners.iter().zip(&mut self.sums) {
            if (corner.coords - true_pose.translation.vector).norm() < NEAR_M {
                *sum += error * corner - corner;
                *count += 1;
            }
        }
    }

    fn finish_hour(&mut self) {
        self.hour += 1;
        let means = std::mem::replace(&mut self.sums, [(Vector2::zeros(), 0); 4]);
        print!("    hour {}: corners moved by", self.hour);
        for ((sum, count), first) in means.into_iter().zip(&mut self.first) {
            if count == 0 {
                print!(" –");
                continue;
            }
            let mean = sum / f64::from(count);
            let shift_m = (mean - *first.get_or_insert(mean)).norm();
            print!(" {:.1}", shift_m * 1e3);
            self.shifts_m.push(shift_m);
        }
        println!(" mm since the first hour; at most {:.1} mm so far", quantile(&self.shifts_m, 1.0) * 1e3);
    }
}
