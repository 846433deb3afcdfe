use super::disc::Disc;
use super::edges::Edge;
use crate::physics::form::Form;
use nalgebra::Point2;

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

    /// The sides of a body with corners that does not move in the interval; empty for all others.
    pub(super) fn still_sides(&self) -> &[Edge] {
        &self.sides
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
