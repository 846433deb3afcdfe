//! Point-to-line Gauss-Newton: the pose that lays the points of a scan on the surfels of the line map.
//!
//! Censi (2008), "An ICP variant using a point-to-line metric", with the correspondences of a map of surfels instead of
//! a second scan (as Segal, Haehnel & Thrun 2009 use surfaces on both sides), the kernel of Geman & McClure (1987), and
//! a prior from odometry.

use crate::constants::{MAX_STEPS, STEP, SURFEL_STD_M};
use crate::placement::Placement;
use crate::scan_points::ScanPoint;
use crate::surfel_map::SurfelMap;
use interfaces::{Spread, heading_rad};
use nalgebra::{Isometry2, Matrix3, Matrix6, Vector2, Vector3, Vector6};

/// A point whose noise across the surface is small must not pull where it hits another surface: minimum share of the kernel.
const MIN_KERNEL: f64 = 0.3;

/// A pose with the inverse of its covariance, in the frame of the map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Prior {
    pub(crate) pose: Isometry2<f64>,
    pub(crate) information: Matrix3<f64>,
    /// For a scan that sweeps: what is known about its begin.
    pub(crate) begin: Option<Begin>,
}

/// What is known about the pose at the last scan, where the way of a scan that sweeps begins.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Begin {
    /// The inverse of the covariance of the pose at the begin.
    pub(crate) information: Matrix3<f64>,
    /// The inverse of the covariance of both poses: of the begin, then of the end.
    pub(crate) joint: Matrix6<f64>,
    /// Jacobian of the end pose with respect to the begin pose.
    pub(crate) by_heading: Matrix3<f64>,
    /// How far the place of the begin has moved with the expected end, since another source knows the end: x, y (m) and
    /// heading (rad); and how far from this place the begin is expected.
    pub(crate) moved: Vector3<f64>,
    pub(crate) expected: Vector3<f64>,
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
    pub(crate) placement: Placement,
    /// The information of the scan alone, without the prior.
    pub(crate) scan_information: Matrix3<f64>,
    /// The information of scan and prior.
    pub(crate) information: Matrix3<f64>,
    /// The covariance of the pose of a beam, in the mean over the scan: for a scan that sweeps, less than that of the
    /// pose at its end.
    pub(crate) beam_covariance: Matrix3<f64>,
    /// The mean square of the residuals over their expectation; about 1 for a good match.
    pub(crate) residual_ratio: f64,
}

/// The sums of the normal equations.
#[derive(Clone, Copy, Debug, Default)]
struct NormalEquations {
    /// Of the pose at the begin of the scan, and of that at its end: of a rigid scan, of the end alone.
    hessian: Matrix6<f64>,
    gradient: Vector6<f64>,
    squares: f64,
    weight: f64,
    /// The sum of the weights of the points alone.
    points: f64,
}

impl NormalEquations {
    /// Adds a point that follows the pose at the end with this share, and the begin with the rest.
    #[inline]
    fn add(&mut self, hessian: &Matrix3<f64>, gradient: &Vector3<f64>, share: f64) {
        let rest = 1.0 - share;
        let blocks = [(3, 3, share * share), (0, 0, rest * rest), (0, 3, rest * share), (3, 0, rest * share)];
        // A rigid scan has no begin.
        for (row, column, part) in blocks.into_iter().take(if share < 1.0 { 4 } else { 1 }) {
            let mut block = self.hessian.fixed_view_mut::<3, 3>(row, column);
            block += hessian * part;
        }
        self.gradient += stack(&(gradient * rest), &(gradient * share));
    }

    /// The steps of the end and of the begin. `None` if the points do not fix the pose.
    fn step(&self, placement: &Placement, prior: Option<&Prior>) -> Option<[Vector3<f64>; 2]> {
        let off = prior.map_or(Vector3::zeros(), |prior| difference(&placement.pose, &prior.pose));
        let Some(begin) = prior.and_then(|prior| prior.begin) else {
            let information = prior.map_or(Matrix3::zeros(), |prior| prior.information);
            let gradient = self.gradient.fixed_rows::<3>(3) + information * off;
            return Some([-((self.end() + information).try_inverse()? * gradient), Vector3::zeros()]);
        };
        let off = stack(&(placement.begin() - begin.expected), &off);
        let step = -(begin.joint + self.hessian).cholesky()?.solve(&(begin.joint * off + self.gradient));
        Some([step.fixed_rows::<3>(3).into(), step.fixed_rows::<3>(0).into()])
    }

    /// Of the pose at the end of the scan.
    fn end(&self) -> Matrix3<f64> {
        self.hessian.fixed_view::<3, 3>(3, 3).into()
    }

    /// What is known about the pose at the end of the scan: of the points alone, and together with the prior; and the
    /// covariance of the pose of a beam, in the mean over all.
    fn known(&self, prior: Option<&Prior>) -> Option<[Matrix3<f64>; 3]> {
        let Some(begin) = prior.and_then(|prior| prior.begin) else {
            let all = self.end() + prior.map_or(Matrix3::zeros(), |prior| prior.information);
            return Some([self.end(), all, all.try_inverse()?]);
        };
        let mut scan = self.hessian;
        let all = scan + begin.joint;
        let mut own = scan.fixed_view_mut::<3, 3>(0, 0);
        own += begin.information;
        let covariance = all.try_inverse()?;
        let block = |row, column| covariance.fixed_view::<3, 3>(row, column);
        // A beam at the share f of the way has the pose (1 - f) begin + f end.
        let beam = (block(0, 0) + block(3, 3)) / 3.0 + (block(0, 3) + block(3, 0)) / 6.0;
        Some([end_of(&scan)?, end_of(&all)?, beam])
    }
}

/// A matrix of both poses, from its blocks.
pub(crate) fn blocks(blocks: [[Matrix3<f64>; 2]; 2]) -> Matrix6<f64> {
    Matrix6::from_fn(|row, column| blocks[row / 3][column / 3][(row % 3, column % 3)])
}

fn stack(begin: &Vector3<f64>, end: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(begin.x, begin.y, begin.z, end.x, end.y, end.z)
}

/// The information about the end, whatever the begin is: the Schur complement.
fn end_of(joint: &Matrix6<f64>) -> Option<Matrix3<f64>> {
    let block = |row, column| joint.fixed_view::<3, 3>(row, column).into_owned();
    Some(block(3, 3) - block(3, 0) * block(0, 0).try_inverse()? * block(0, 3))
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

/// How uncertain the distance of a point from its surface is: the same at all steps of a match.
#[derive(Clone, Copy, Debug)]
struct Noise {
    variance: f64,
    /// The scale of the kernel of the point, as a share of that of a point with the largest noise.
    kernel_share: f64,
}

impl Noise {
    fn of(point: &ScanPoint, gates: &Gates) -> Self {
        let variance = |noise_m: f64| noise_m * noise_m + SURFEL_STD_M * SURFEL_STD_M;
        let (own, largest) = (variance(gates.noise_m * point.noise_share), variance(gates.noise_m));
        Self { variance: own, kernel_share: (own / largest).sqrt().max(MIN_KERNEL) }
    }
}

fn accumulate(
    map: &SurfelMap,
    points: &[ScanPoint],
    noises: &[Noise],
    placement: &Placement,
    [gate_m, suspect_m]: [f64; 2],
    gates: &Gates,
) -> NormalEquations {
    let mut sums = NormalEquations::default();
    // Well inside of the gate: what moved by a little more than the noise must not pull.
    let scale_m = gate_m / 2.0;
    for (point, noise) in points.iter().zip(noises) {
        let at = placement.place(point);
        let arm = at.coords - placement.pose.translation.vector;
        let normal = placement.pose.rotation * point.normal;
        let Some((index, off_m)) = map.nearest(&at, &normal, gate_m) else { continue };
        let surfel = map.surfel(index);
        if surfel.is_suspect() && off_m.abs() > suspect_m {
            continue;
        }
        let rate_weight = if gates.by_rates { surfel.steadiness } else { 1.0 };
        let weight = point.weight * surfel.weight() * rate_weight;
        let kernel = kernel(off_m, scale_m * noise.kernel_share);
        let certain = weight / noise.variance * kernel;
        let (j, share) = (derivative(&arm, &surfel.normal), placement.share(point));
        sums.add(&(j * j.transpose() * certain), &(j * (off_m * certain)), share);
        sums.squares += off_m * off_m * certain;
        sums.weight += weight * kernel;
        sums.points += point.weight * kernel;
    }
    // Trust decides between surfels; it does not make a scan worth less than the odometry.
    if sums.weight > 0.0 {
        let scale = sums.points / sums.weight;
        (sums.hessian, sums.gradient) = (sums.hessian * scale, sums.gradient * scale);
        (sums.squares, sums.weight) = (sums.squares * scale, sums.points);
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

/// Matches a scan, from the pose for which it was deskewed, with an optional prior. `None` if the points do not fix
/// the pose.
pub(crate) fn align(
    map: &SurfelMap,
    points: &[ScanPoint],
    start: &Isometry2<f64>,
    prior: Option<&Prior>,
    gates: &Gates,
) -> Option<Match> {
    let is_elastic = prior.is_some_and(|prior| prior.begin.is_some());
    let mut placement = if is_elastic { Placement::elastic(start) } else { Placement::rigid(start) };
    let noises: Vec<Noise> = points.iter().map(|point| Noise::of(point, gates)).collect();
    let (mut gate_m, mut steps) = (gates.first_m, 0);
    let sums = loop {
        // What has moved before must not pull from afar, where the odometry knows better.
        let suspect_m = if prior.is_some() { gates.last_m } else { gate_m };
        let sums = accumulate(map, points, &noises, &placement, [gate_m, suspect_m], gates);
        let [step, begin] = sums.step(&placement, prior)?;
        if !step.iter().chain(&begin).all(|value| value.is_finite()) {
            return None;
        }
        placement.correct(&step, &begin);
        steps += 1;
        // With a wide gate, the pose need only be good enough for the next gate.
        let is_last = gate_m <= gates.last_m;
        let limit = if is_last { STEP } else { Spread::of_error(gate_m / 20.0) };
        let is_small = step.xy().norm() < limit.m && step.z.abs() < limit.rad;
        if !is_small && steps < MAX_STEPS {
            continue;
        }
        if is_last {
            break sums; // those of a pose that is off by less than the last step
        }
        (gate_m, steps) = (if gate_m > 3.0 * gates.last_m { gate_m / 2.0 } else { gates.last_m }, 0);
    };
    placement.pose.rotation.renormalize();
    let [scan_information, information, beam_covariance] = sums.known(prior)?;
    Some(Match {
        placement,
        scan_information,
        information,
        beam_covariance,
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
