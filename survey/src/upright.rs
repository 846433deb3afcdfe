//! The turn of a map after which most of its walls are horizontal or vertical, for drawings that people read.

use interfaces::CellState;
use mapper::Mapper;
use nalgebra::Point2;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Turns are searched in steps of half a degree.
const STEPS: usize = 180;
/// The largest number of blocked cells that are looked at.
const MAX_CELLS: usize = 20_000;
/// A turn is worth it if the walls are this much sharper than on average.
const SHARPER: f64 = 1.2;

/// The angle by which a map must be turned, rad, from -π/4 to π/4, so that most surfaces lie along the axes; 0 for a map
/// without a main direction.
///
/// The blocked cells are projected to both axes: of walls along an axis, many fall on one point. The turn with the largest sum
/// of the squared numbers is taken, with its mean as the measure of what has no direction.
pub fn upright_rad(mapper: &Mapper) -> f64 {
    let frame = mapper.frame();
    let is_blocked = |index: &usize| mapper.states().cells()[*index] == CellState::Blocked;
    let blocked: Vec<usize> = (0..frame.len()).filter(is_blocked).collect();
    let every = blocked.len().div_ceil(MAX_CELLS).max(1);
    let points: Vec<Point2<f64>> =
        blocked.iter().step_by(every).map(|index| frame.center(frame.cell(*index))).collect();
    let angle_rad = |step: usize| FRAC_PI_2 * step as f64 / STEPS as f64 - FRAC_PI_4;
    let scores: Vec<f64> =
        (0..STEPS).map(|step| sharpness(&points, angle_rad(step), frame.resolution_m())).collect();
    let mean = scores.iter().sum::<f64>() / STEPS as f64;
    // Of equal ones, the smallest turn.
    let order = |a: &usize, b: &usize| {
        scores[*a].total_cmp(&scores[*b]).then(angle_rad(*b).abs().total_cmp(&angle_rad(*a).abs()))
    };
    let best = (0..STEPS).max_by(order).filter(|best| scores[*best] >= SHARPER * mean);
    best.map_or(0.0, angle_rad)
}

fn sharpness(points: &[Point2<f64>], angle_rad: f64, bin_m: f64) -> f64 {
    let (sin, cos) = libm::sincos(angle_rad);
    let along = |axis: [f64; 2]| {
        let bin = |point: &Point2<f64>| ((axis[0] * point.x + axis[1] * point.y) / bin_m).floor() as i64;
        let mut bins: Vec<i64> = points.iter().map(bin).collect();
        bins.sort_unstable();
        bins.chunk_by(|a, b| a == b).map(|same| (same.len() * same.len()) as f64).sum::<f64>()
    };
    along([cos, -sin]) + along([sin, cos])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::watched;
    use interfaces::GridFrame;

    /// A map in which these cells are blocked and all others are free.
    fn map(is_blocked: impl Fn(Point2<f64>) -> bool) -> Mapper {
        let frame = GridFrame::new(Point2::new(-6.0, -6.0), 0.05, 240, 240).unwrap();
        watched(frame, 3, |cell, _| is_blocked(frame.center(cell)))
    }

    /// The walls of a room of 8 × 5 m that is turned by this angle.
    fn room(turned_rad: f64) -> Mapper {
        map(|at| {
            let at = interfaces::rotation(-turned_rad) * at;
            let beyond_m = (at.x.abs() - 4.0).max(at.y.abs() - 2.5);
            (0.0..0.1).contains(&beyond_m)
        })
    }

    #[test]
    fn the_walls_of_a_turned_room_become_upright() {
        for turned_deg in [-40.0_f64, -17.0, 0.0, 5.0, 23.0, 38.0] {
            let turn_deg = upright_rad(&room(turned_deg.to_radians())).to_degrees();
            assert!((turn_deg + turned_deg).abs() <= 1.0, "{turned_deg}°: {turn_deg}°");
        }
    }

    #[test]
    fn a_round_room_stays_as_it_is() {
        let round = map(|at| (4.0..4.2).contains(&at.coords.norm()));
        assert_eq!(upright_rad(&round), 0.0);
        assert_eq!(upright_rad(&map(|_| false)), 0.0);
    }
}
