//! The rigid motion between two trajectories.

use nalgebra::{Isometry2, Vector2};

/// The motion that lays found positions on the true ones, m, with the least squares of distances (Umeyama 1991, without scale).
/// Each pair is a found position and the true one. Without a pair, it is the motion that changes nothing.
pub(crate) fn alignment(pairs: &[(Vector2<f64>, Vector2<f64>)]) -> Isometry2<f64> {
    let count = pairs.len().max(1) as f64;
    let from = pairs.iter().map(|(found, _)| found).sum::<Vector2<f64>>() / count;
    let to = pairs.iter().map(|(_, truth)| truth).sum::<Vector2<f64>>() / count;
    let (mut dot, mut cross) = (0.0, 0.0);
    for (found, truth) in pairs {
        let (a, b) = (found - from, truth - to);
        dot += a.dot(&b);
        cross += a.perp(&b);
    }
    let rotation = interfaces::rotation(f64::atan2(cross, dot));
    Isometry2::from_parts((to - rotation * from).into(), rotation)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point2;

    #[test]
    fn a_rigid_motion_is_found() {
        let motion = interfaces::pose(3.0, -2.0, 2.5);
        let points = [[0.0, 0.0], [4.0, 1.0], [-2.0, 5.0], [1.0, 1.0]].map(|[x, y]| Point2::new(x, y));
        let pairs: Vec<_> = points.iter().map(|at| (at.coords, (motion * at).coords)).collect();
        let found = alignment(&pairs);
        assert!(points.iter().all(|at| (found * at - motion * at).norm() < 1e-12), "{found}");
        assert_eq!(alignment(&[]), Isometry2::identity());
    }
}
