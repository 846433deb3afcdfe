//! Lines through runs of points, from sums that are subtracted from each other.

use nalgebra::{Matrix2, Point2, Vector2};

/// The sums of the coordinates, and of their products, of a run of points.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moments {
    count: f64,
    sum: Vector2<f64>,
    products: Matrix2<f64>,
}

impl Moments {
    pub(crate) fn plus(mut self, point: &Point2<f64>) -> Self {
        self.count += 1.0;
        self.sum += point.coords;
        self.products += point.coords * point.coords.transpose();
        self
    }

    pub(crate) fn minus(&self, other: &Self) -> Self {
        let (sum, products) = (self.sum - other.sum, self.products - other.products);
        Self { count: self.count - other.count, sum, products }
    }

    /// The unit normal of the line through the points (total least squares), and the mean square distance from it.
    pub(crate) fn line(&self) -> Option<(Vector2<f64>, f64)> {
        let mean = self.sum / self.count;
        let spread = self.products / self.count - mean * mean.transpose();
        let (xx, xy, yy) = (spread[(0, 0)], spread[(0, 1)], spread[(1, 1)]);
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
