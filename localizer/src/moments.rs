//! Lines through runs of points, from sums that are subtracted from each other.

use nalgebra::{Point2, Vector2};

/// The sums of the coordinates, and of their products, of a run of points.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moments {
    count: f64,
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
    yy: f64,
}

impl Moments {
    pub(crate) fn plus(mut self, point: &Point2<f64>) -> Self {
        self.count += 1.0;
        self.x += point.x;
        self.y += point.y;
        self.xx += point.x * point.x;
        self.xy += point.x * point.y;
        self.yy += point.y * point.y;
        self
    }

    pub(crate) fn minus(&self, other: &Self) -> Self {
        Self {
            count: self.count - other.count,
            x: self.x - other.x,
            y: self.y - other.y,
            xx: self.xx - other.xx,
            xy: self.xy - other.xy,
            yy: self.yy - other.yy,
        }
    }

    /// The unit normal of the line through the points (total least squares), and the mean square distance from it.
    pub(crate) fn line(&self) -> Option<(Vector2<f64>, f64)> {
        let (mean_x, mean_y) = (self.x / self.count, self.y / self.count);
        let xx = self.xx / self.count - mean_x * mean_x;
        let xy = self.xy / self.count - mean_x * mean_y;
        let yy = self.yy / self.count - mean_y * mean_y;
        let (half_sum, half_difference) = ((xx + yy) / 2.0, (xx - yy) / 2.0);
        let root = (half_difference * half_difference + xy * xy).sqrt();
        // The direction along the line is the eigenvector of the larger eigenvalue, half_sum + root.
        let along = if half_difference >= 0.0 {
            Vector2::new(half_difference + root, xy)
        } else {
            Vector2::new(xy, root - half_difference)
        };
        let length = along.norm();
        (length > 1e-12).then(|| (Vector2::new(-along.y, along.x) / length, (half_sum - root).max(0.0)))
    }
}
