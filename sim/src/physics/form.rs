use super::convex;
use nalgebra::{Isometry2, Point2, Vector2};

/// The outline of a robot at a pose.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// A disc.
    Disc {
        /// The center, m.
        center: Point2<f64>,
        /// The radius, m.
        radius_m: f64,
    },
    /// A convex body, given by its corners, counter-clockwise, m.
    Convex(Vec<Point2<f64>>),
}

impl Form {
    /// The outline of a robot at `pose`: a polygon with `corners` in the frame of the robot, or a disc of `radius_m`
    /// if there are no corners.
    pub fn new(corners: &[Point2<f64>], radius_m: f64, pose: &Isometry2<f64>) -> Self {
        if corners.is_empty() {
            return Self::Disc { center: pose.translation.vector.into(), radius_m };
        }
        Self::Convex(corners.iter().map(|corner| pose * corner).collect())
    }

    /// The gap to a convex body, m; negative if they overlap.
    pub fn gap_m(&self, body: &[Point2<f64>]) -> f64 {
        match self {
            Self::Disc { center, radius_m } => convex::disc_gap_m(body, center, *radius_m),
            Self::Convex(corners) => convex::gap_m(corners, body),
        }
    }

    /// The distance to a point, m; negative if the point is inside.
    pub fn gap_m_to(&self, point: &Point2<f64>) -> f64 {
        match self {
            Self::Disc { center, radius_m } => (point - center).norm() - radius_m,
            Self::Convex(corners) => convex::disc_gap_m(corners, point, 0.0),
        }
    }

    /// The gap to the outline of another robot, m; negative if they overlap.
    pub fn apart_m(&self, other: &Self) -> f64 {
        match (self, other) {
            (Self::Disc { center, radius_m }, Self::Disc { center: other, radius_m: other_m }) => {
                (center - other).norm() - radius_m - other_m
            }
            (Self::Convex(corners), other) | (other, Self::Convex(corners)) => other.gap_m(corners),
        }
    }

    /// The radius of a circle within the body, m.
    pub fn inner_m(&self) -> f64 {
        match self {
            Self::Disc { radius_m, .. } => *radius_m,
            Self::Convex(corners) => convex::inner_m(corners),
        }
    }

    /// How far the body reaches from the origin in a direction, m.
    pub fn extent_m(&self, direction: &Vector2<f64>) -> f64 {
        match self {
            Self::Disc { center, radius_m } => center.coords.dot(direction) + radius_m,
            Self::Convex(corners) => {
                corners.iter().map(|corner| corner.coords.dot(direction)).fold(f64::NEG_INFINITY, f64::max)
            }
        }
    }

    /// The corners of the upright box around the outline, m.
    pub fn bounds(&self) -> (Point2<f64>, Point2<f64>) {
        match self {
            Self::Disc { center, radius_m } => {
                let reach = Vector2::repeat(*radius_m);
                (center - reach, center + reach)
            }
            Self::Convex(corners) => bounds(corners),
        }
    }
}

/// The corners of the upright box around points, at least one, m.
pub(crate) fn bounds(points: &[Point2<f64>]) -> (Point2<f64>, Point2<f64>) {
    points.iter().fold((points[0], points[0]), |(low, high), point| (low.inf(point), high.sup(point)))
}
