//! The beams of a scan that sweeps: each has an origin of its own, and sees bodies at a time of its own.

use super::beams::EDGE_ON_M;
use super::disc::Disc;
use super::edges::Edge;
use crate::physics::form::Form;
use nalgebra::{Point2, Vector2};

/// A beam of a scan that sweeps.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Ray {
    /// The origin, m.
    pub(in crate::physics) from: Point2<f64>,
    /// The direction, a unit vector.
    pub(in crate::physics) along: Vector2<f64>,
    /// The index of the interval of time in which the beam measures.
    pub(in crate::physics) interval: usize,
    /// The share of the interval that has passed, from 0 to 1.
    pub(in crate::physics) share: f64,
}

impl Ray {
    /// One over the range at which the ray hits an edge of a solid from outside, 1/m; 0: it does not hit the edge.
    pub(super) fn edge_hit(&self, edge: &Edge, range_max_m: f64) -> f64 {
        let gap_m = edge.gap_m(&self.from);
        if gap_m < EDGE_ON_M || gap_m > range_max_m {
            return 0.0;
        }
        // Seen from outside, the sides of a counter-clockwise polygon run clockwise.
        let [left, right] = [edge.from, edge.to].map(|point| point - self.from);
        let is_between = right.perp(&self.along) >= 0.0 && self.along.perp(&left) >= 0.0;
        if is_between { -edge.normal.dot(&self.along) / gap_m } else { 0.0 }
    }

    /// The same for a disc; ∞: the ray begins in it.
    fn disc_hit(&self, disc: &Disc) -> f64 {
        let to = disc.center - self.from;
        let power = to.norm_squared() - disc.radius_m * disc.radius_m;
        if power <= 0.0 {
            return f64::INFINITY;
        }
        // The nearer root of t² − 2bt + power = 0 is power / (b + √(b² − power)).
        let b = to.dot(&self.along);
        let root2 = b * b - power;
        if b > 0.0 && root2 >= 0.0 { (b + root2.sqrt()) / power } else { 0.0 }
    }

    /// The same for a convex body.
    fn polygon_hit(&self, sides: impl Iterator<Item = Edge>, range_max_m: f64) -> f64 {
        let (mut most, mut is_inside) = (0.0_f64, true);
        for side in sides {
            is_inside &= side.gap_m(&self.from) <= 0.0;
            most = most.max(self.edge_hit(&side, range_max_m));
        }
        if is_inside { f64::INFINITY } else { most }
    }
}

/// A body that moves during an interval of time: each of its corners, or the center of a disc, moves straight.
#[derive(Clone, Debug)]
pub(in crate::physics) struct Passing {
    /// The robot that the body belongs to: its lasers never see the body.
    robot: Option<usize>,
    /// The corners at the begin and at the end, counter-clockwise, m; for a disc only the center.
    corners: [Vec<Point2<f64>>; 2],
    /// The radius of a disc, m; 0 for a body with corners.
    radius_m: f64,
    /// A disc that contains the body at all times.
    around: Disc,
}

impl Passing {
    /// A body with its outlines at the begin and at the end.
    pub(in crate::physics) fn new(robot: Option<usize>, from: &Form, to: &Form) -> Self {
        let corners = |form: &Form| match form {
            Form::Disc { center, .. } => vec![*center],
            Form::Convex(corners) => corners.clone(),
        };
        let radius_m = if let Form::Disc { radius_m, .. } = from { *radius_m } else { 0.0 };
        let corners = [from, to].map(corners);
        let low = corners.iter().flatten().fold(corners[0][0], |low, corner| low.inf(corner));
        let high = corners.iter().flatten().fold(corners[0][0], |high, corner| high.sup(corner));
        // A little larger, because of rounding.
        let around_m = ((high - low).norm() / 2.0 + radius_m) * (1.0 + 1e-6);
        let around = Disc { center: nalgebra::center(&low, &high), radius_m: around_m };
        Self { robot, corners, radius_m, around }
    }

    /// Whether the lasers of a robot see the body.
    pub(super) fn is_seen_by(&self, robot: usize) -> bool {
        self.robot != Some(robot)
    }

    /// One over the range at which a ray hits the body, 1/m; 0: it does not hit it, ∞: it begins in it.
    pub(super) fn hit(&self, ray: &Ray, range_max_m: f64) -> f64 {
        let to = self.around.center - ray.from;
        if to.perp(&ray.along).abs() > self.around.radius_m {
            return 0.0;
        }
        let corner = |index: usize| {
            let [from, to] = [0, 1].map(|end| self.corners[end][index]);
            from + (to - from) * ray.share
        };
        if self.radius_m > 0.0 {
            return ray.disc_hit(&Disc { center: corner(0), radius_m: self.radius_m });
        }
        let count = self.corners[0].len();
        let sides = (0..count).map(|index| Edge::new(corner(index), corner((index + 1) % count)));
        ray.polygon_hit(sides, range_max_m)
    }
}
