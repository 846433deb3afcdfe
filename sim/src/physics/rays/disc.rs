use nalgebra::Point2;

/// A round body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::physics) struct Disc {
    /// The center, m.
    pub(in crate::physics) center: Point2<f64>,
    /// The radius, m.
    pub(in crate::physics) radius_m: f64,
}
