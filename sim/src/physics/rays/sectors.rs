//! The beams of a scan that sweeps: each has an origin of its own, and sees bodies at a time of its own.
//!
//! Beams that are neighbors in time are neighbors in space. A few of them at a time are a sector: what lies beside the
//! sector, or behind the hits of all its beams, is left out. All others are compared beam by beam.

use super::beams::EDGE_ON_M;
use super::disc::Disc;
use super::edges::Edge;
use crate::physics::form::Form;
use nalgebra::{Point2, Vector2};

/// The borders of a sector are used if no beam is farther away from its middle than 60°: the cosine of the angle.
const MIN_ALONG: f64 = 0.5;
/// What is farther away than the farthest hit by this factor may be left out: far above rounding.
const SAFE: f64 = 1.0 + 1e-9;

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

/// The nearest hits of some rays.
pub(super) struct Sector<'a> {
    rays: &'a [Ray],
    /// One over the range, 1/m; 0 where there is no hit.
    inverse: &'a mut [f64],
    /// A circle that contains the origins.
    origins: Disc,
    /// The rightmost and the leftmost direction; `None` if the sector is too wide.
    borders: Option<[Vector2<f64>; 2]>,
    range_max_m: f64,
    /// What is farther away from all origins is hidden, m.
    pub(super) reach_m: f64,
}

/// Whether two points lie at least `beyond_m` beyond the same one of the two `borders` [right, left] of rays from the origin.
pub(super) fn is_beside(
    borders: &Option<[Vector2<f64>; 2]>,
    [a, b]: [&Vector2<f64>; 2],
    beyond_m: f64,
) -> bool {
    let Some([right, left]) = borders else { return false };
    right.perp(a).max(right.perp(b)) < -beyond_m || left.perp(a).min(left.perp(b)) > beyond_m
}

impl<'a> Sector<'a> {
    /// No hits yet. `inverse` has as many values as there are rays, at least one.
    pub(super) fn new(rays: &'a [Ray], inverse: &'a mut [f64], range_max_m: f64) -> Self {
        inverse.fill(0.0);
        let middle = rays[rays.len() / 2];
        let radius_m = rays.iter().map(|ray| (ray.from - middle.from).norm()).fold(0.0, f64::max);
        let (mut right, mut left, mut is_narrow) = (middle.along, middle.along, true);
        for Ray { along, .. } in rays {
            is_narrow &= middle.along.dot(along) > MIN_ALONG;
            right = if right.perp(along) < 0.0 { *along } else { right };
            left = if left.perp(along) > 0.0 { *along } else { left };
        }
        let origins = Disc { center: middle.from, radius_m: radius_m * SAFE };
        let borders = is_narrow.then_some([right, left]);
        Self { rays, inverse, origins, borders, range_max_m, reach_m: range_max_m * SAFE }
    }

    /// Rays for which `is_inside` is true begin in a solid: their range is 0.
    pub(super) fn add_inside(&mut self, is_inside: impl Fn(&Point2<f64>) -> bool) {
        self.add(|ray| if is_inside(&ray.from) { f64::INFINITY } else { 0.0 });
    }

    /// Whether a ray may hit an edge of a solid that does not move.
    fn may_hit(&self, edge: &Edge) -> bool {
        let gap_m = edge.gap_m(&self.origins.center);
        let is_in_reach = gap_m >= -self.origins.radius_m && gap_m <= self.reach_m + self.origins.radius_m;
        is_in_reach && !self.is_beside(&edge.from, &edge.to, 0.0)
    }

    /// Adds an edge of a solid that does not move.
    pub(super) fn add_edge(&mut self, edge: &Edge) {
        if self.may_hit(edge) {
            let range_max_m = self.range_max_m;
            self.add(|ray| edge_hit(ray, edge, range_max_m));
        }
    }

    /// Whether a ray may hit a body that moves.
    fn may_meet(&self, body: &Passing) -> bool {
        let Disc { center, radius_m } = body.around;
        let most_m = self.reach_m + self.origins.radius_m + radius_m;
        (center - self.origins.center).norm_squared() <= most_m * most_m
            && !self.is_beside(&center, &center, radius_m)
    }

    /// Adds a body that moves.
    pub(super) fn add_passing(&mut self, body: &Passing) {
        if !self.may_meet(body) {
            return;
        }
        let range_max_m = self.range_max_m;
        match body.sides.as_slice() {
            [] => self.add(|ray| match body.disc(ray.share) {
                Some(disc) => disc_hit(ray, &disc),
                None => polygon_hit(ray, body.sides(ray.share), range_max_m),
            }),
            sides => {
                self.add_inside(|at| sides.iter().all(|side| side.gap_m(at) <= 0.0));
                sides.iter().for_each(|side| self.add_edge(side));
            }
        }
    }

    /// Whether everything within `around_m` of the line from `a` to `b` lies on one outer side of all rays.
    fn is_beside(&self, a: &Point2<f64>, b: &Point2<f64>, around_m: f64) -> bool {
        let [a, b] = [a, b].map(|point| point - self.origins.center);
        // A ray of the sector never crosses the borders outwards, but begins up to a radius beyond them.
        is_beside(&self.borders, [&a, &b], self.origins.radius_m + around_m)
    }

    /// Adds a body that the rays hit at these inverse ranges, 1/m.
    fn add(&mut self, hit: impl Fn(&Ray) -> f64) {
        let (mut is_nearer, mut least) = (false, f64::INFINITY);
        for (ray, inverse) in self.rays.iter().zip(&mut *self.inverse) {
            let hit = hit(ray);
            if hit > *inverse {
                (*inverse, is_nearer) = (hit, true);
            }
            least = least.min(*inverse);
        }
        if is_nearer {
            self.reach_m = self.reach_m.min(SAFE / least);
        }
    }
}

/// One over the range at which a ray hits an edge of a solid from outside, 1/m; 0: it does not hit the edge.
fn edge_hit(ray: &Ray, edge: &Edge, range_max_m: f64) -> f64 {
    let gap_m = edge.gap_m(&ray.from);
    if gap_m < EDGE_ON_M || gap_m > range_max_m {
        return 0.0;
    }
    // Seen from outside, the sides of a counter-clockwise polygon run clockwise.
    let [left, right] = [edge.from, edge.to].map(|point| point - ray.from);
    let is_between = right.perp(&ray.along) >= 0.0 && ray.along.perp(&left) >= 0.0;
    if is_between { -edge.normal.dot(&ray.along) / gap_m } else { 0.0 }
}

/// The same for a disc; ∞: the ray begins in it.
fn disc_hit(ray: &Ray, disc: &Disc) -> f64 {
    let to = disc.center - ray.from;
    let power = to.norm_squared() - disc.radius_m * disc.radius_m;
    if power <= 0.0 {
        return f64::INFINITY;
    }
    // The nearer root of t² − 2bt + power = 0 is power / (b + √(b² − power)).
    let b = to.dot(&ray.along);
    let root2 = b * b - power;
    if b > 0.0 && root2 >= 0.0 { (b + root2.sqrt()) / power } else { 0.0 }
}

/// The same for a convex body.
fn polygon_hit(ray: &Ray, sides: impl Iterator<Item = Edge>, range_max_m: f64) -> f64 {
    let (mut most, mut is_inside) = (0.0_f64, true);
    for side in sides {
        is_inside &= side.gap_m(&ray.from) <= 0.0;
        most = most.max(edge_hit(ray, &side, range_max_m));
    }
    if is_inside { f64::INFINITY } else { most }
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
    /// The sides of a body with corners that does not move in the interval; empty for all others.
    sides: Vec<Edge>,
    /// A disc that contains the body at all times.
    pub(super) around: Disc,
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
        let around_m = ((high - low).norm() / 2.0 + radius_m) * (1.0 + 1e-9);
        let around = Disc { center: nalgebra::center(&low, &high), radius_m: around_m };
        let is_still = radius_m == 0.0 && corners[0] == corners[1];
        let sides = if is_still { Edge::around(corners[0].iter().copied()).collect() } else { Vec::new() };
        Self { robot, corners, radius_m, sides, around }
    }

    /// Whether the lasers of a robot see the body.
    pub(super) fn is_seen_by(&self, robot: usize) -> bool {
        self.robot != Some(robot)
    }

    /// The disc that the body is at a share of the interval; `None` if the body has corners.
    pub(super) fn disc(&self, share: f64) -> Option<Disc> {
        (self.radius_m > 0.0).then(|| Disc { center: self.corner(0, share), radius_m: self.radius_m })
    }

    /// The sides of a body with corners at a share of the interval.
    pub(super) fn sides(&self, share: f64) -> impl Iterator<Item = Edge> {
        Edge::around((0..self.corners[0].len()).map(move |index| self.corner(index, share)))
    }

    fn corner(&self, index: usize, share: f64) -> Point2<f64> {
        let [from, to] = [0, 1].map(|end| self.corners[end][index]);
        from + (to - from) * share
    }
}
