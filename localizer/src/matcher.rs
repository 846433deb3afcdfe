//! Point-to-line Gauss-Newton: the pose that lays the points of a scan on the surfels of the line map.
//!
//! Censi (2008), "An ICP variant using a point-to-line metric", with the correspondences of a map of surfels instead of
//! a second scan (as Segal, Haehnel & Thrun 2009 use surfaces on both sides), the kernel of Geman & McClure (1987), and
//! a prior from odometry.

use crate::scan_points::ScanPoint;
use crate::surfel_map::SurfelMap;
use interfaces::heading_rad;
use nalgebra::{Isometry2, Matrix3, UnitComplex, Vector2, Vector3};

/// The largest number of steps at one gate.
const MAX_STEPS: usize = 8;
/// Steps below these sizes end the iteration: far below the errors of every sensor.
const STEP_M: f64 = 1e-4;
const STEP_RAD: f64 = 2e-5;
/// The error of a surfel beyond the noise of its hits, m: surfaces are not perfectly straight, and were learned at
/// poses with an error.
pub(crate) const SURFEL_STD_M: f64 = 0.003;

/// A pose with the inverse of its covariance, in the frame of the map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Prior {
    pub(crate) pose: Isometry2<f64>,
    pub(crate) information: Matrix3<f64>,
}

/// The way to match.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gates {
    /// The standard deviation of the range noise, m.
    pub(crate) noise_m: f64,
    /// The distance up to which a point belongs to a surfel in the first steps, m.
    pub(crate) first_m: f64,
    /// The same in the last steps, m; not above the first.
    pub(crate) last_m: f64,
    /// Whether surfaces that often change count less.
    pub(crate) by_rates: bool,
}

/// The result of a match.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Match {
    pub(crate) pose: Isometry2<f64>,
    /// The information of the scan alone, without the prior.
    pub(crate) scan_information: Matrix3<f64>,
    /// The information of scan and prior.
    pub(crate) information: Matrix3<f64>,
    /// The mean square of the residuals over their expectation; about 1 for a good match.
    pub(crate) residual_ratio: f64,
}

/// The sums of the normal equations.
#[derive(Clone, Copy, Debug)]
struct NormalEquations {
    hessian: Matrix3<f64>,
    gradient: Vector3<f64>,
    squares: f64,
    weight: f64,
    /// The sum of the weights of the points alone.
    points: f64,
}

/// The residual of a point and its derivative with respect to a shift of the pose in x and y and to a turn about the
/// position of the robot.
pub(crate) fn derivative(arm: &Vector2<f64>, normal: &Vector2<f64>) -> Vector3<f64> {
    Vector3::new(normal.x, normal.y, arm.perp(normal))
}

/// The kernel of Geman and McClure as a weight: 1 at residual 0, 1/4 at `scale`.
fn kernel(residual: f64, scale: f64) -> f64 {
    let ratio = residual / scale;
    let root = 1.0 / (1.0 + ratio * ratio);
    root * root
}

fn accumulate(
    map: &SurfelMap,
    points: &[ScanPoint],
    pose: &Isometry2<f64>,
    gate_m: f64,
    gates: &Gates,
) -> NormalEquations {
    let variance = gates.noise_m * gates.noise_m + SURFEL_STD_M * SURFEL_STD_M;
    let mut sums = NormalEquations {
        hessian: Matrix3::zeros(),
        gradient: Vector3::zeros(),
        squares: 0.0,
        weight: 0.0,
        points: 0.0,
    };
    // Well inside of the gate: what moved by a little more than the noise must not pull.
    let scale_m = gate_m / 2.0;
    for point in points {
        let arm = pose.rotation * point.at.coords;
        let at = (pose.translation.vector + arm).into();
        let Some((index, off_m)) = map.nearest(&at, &(pose.rotation * point.normal), gate_m) else {
            continue;
        };
        let surfel = map.surfel(index);
        let mut weight = point.weight * surfel.weight();
        if gates.by_rates {
            weight *= surfel.steadiness;
        }
        let certain = weight / variance * kernel(off_m, scale_m);
        let j = derivative(&arm, &surfel.normal);
        sums.hessian += j * j.transpose() * certain;
        sums.gradient += j * (off_m * certain);
        sums.squares += off_m * off_m * certain;
        sums.weight += weight * kernel(off_m, scale_m);
        sums.points += point.weight * kernel(off_m, scale_m);
    }
    // Trust decides between surfels; it does not make a scan worth less than the odometry.
    if sums.weight > 0.0 {
        let scale = sums.points / sums.weight;
        sums.hessian *= scale;
        sums.gradient *= scale;
        sums.squares *= scale;
        sums.weight = sums.points;
    }
    sums
}

/// The difference of two poses: x, y, and the heading in (−π, π].
pub(crate) fn difference(pose: &Isometry2<f64>, from: &Isometry2<f64>) -> Vector3<f64> {
    let shift = pose.translation.vector - from.translation.vector;
    let turn = heading_rad(&Isometry2::from_parts(
        nalgebra::Translation2::identity(),
        from.rotation.inverse() * pose.rotation,
    ));
    Vector3::new(shift.x, shift.y, turn)
}

/// Matches a scan, from a pose, with an optional prior. `None` if the points do not fix the pose.
pub(crate) fn align(
    map: &SurfelMap,
    points: &[ScanPoint],
    start: &Isometry2<f64>,
    prior: Option<&Prior>,
    gates: &Gates,
) -> Option<Match> {
    let mut pose = *start;
    let mut gate_m = gates.first_m;
    loop {
        for _ in 0..MAX_STEPS {
            let mut sums = accumulate(map, points, &pose, gate_m, gates);
            if let Some(prior) = prior {
                sums.hessian += prior.information;
                sums.gradient += prior.information * difference(&pose, &prior.pose);
            }
            let step = -(sums.hessian.try_inverse()? * sums.gradient);
            if !step.iter().all(|value| value.is_finite()) {
                return None;
            }
            pose.translation.vector += step.xy();
            pose.rotation = interfaces::rotation(step.z) * pose.rotation;
            if step.xy().norm() < STEP_M && step.z.abs() < STEP_RAD {
                break;
            }
        }
        if gate_m <= gates.last_m {
            break;
        }
        gate_m = (gate_m / 2.0).max(gates.last_m);
    }
    pose.rotation = UnitComplex::from_cos_sin_unchecked(pose.rotation.re, pose.rotation.im);
    pose.rotation.renormalize();
    let sums = accumulate(map, points, &pose, gate_m, gates);
    let information = sums.hessian + prior.map_or(Matrix3::zeros(), |prior| prior.information);
    Some(Match {
        pose,
        scan_information: sums.hessian,
        information,
        residual_ratio: if sums.weight > 0.0 { sums.squares / sums.weight } else { 1.0 },
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::pose;
    use nalgebra::Point2;

    #[test]
    fn the_derivative_is_that_of_finite_differences() {
        let (surfel, normal) = (Point2::new(2.0, 1.5), interfaces::rotation(0.4) * Vector2::x());
        let (point, at) = (Point2::new(1.7, -0.6), [0.3, -0.2, 0.9]);
        let residual = |x: f64, y: f64, turn: f64| {
            let pose = pose(at[0] + x, at[1] + y, at[2] + turn);
            (pose * point - surfel).dot(&normal)
        };
        let arm = interfaces::rotation(at[2]) * point.coords;
        let expected = derivative(&arm, &normal);
        let step = 1e-6;
        let difference = |x: f64, y: f64, turn: f64| {
            (residual(x * step, y * step, turn * step) - residual(-x * step, -y * step, -turn * step))
                / (2.0 * step)
        };
        let found =
            Vector3::new(difference(1.0, 0.0, 0.0), difference(0.0, 1.0, 0.0), difference(0.0, 0.0, 1.0));
        assert!((found - expected).norm() < 1e-8, "{found} {expected}");
    }

    #[test]
    fn the_difference_of_headings_is_the_short_way() {
        let off = difference(&pose(1.0, 2.0, 3.1), &pose(0.5, 2.5, -3.1));
        assert!((off - Vector3::new(0.5, -0.5, 6.2 - std::f64::consts::TAU)).norm() < 1e-9, "{off}");
    }
}
