//! The reference results test every cell of the grid separately, with exact angles and no state.

use super::*;
use interfaces::{LaserReading, Scan, Twist};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

const RANGE_MIN_M: f64 = 0.1;
const RANGE_MAX_M: f64 = 3.0;
/// Cells whose middle lies nearer than this to a border of the polygon can go either way.
const TIE_M: f64 = 1e-6;

/// A scan from any place, some of whose beams are invalid.
#[derive(Clone, Debug)]
struct Case {
    x_m: f64,
    y_m: f64,
    heading_rad: f64,
    angle_min_rad: f64,
    /// Negative for a laser that sweeps clockwise.
    increment_rad: f64,
    ranges_m: Vec<f32>,
    joined: Vec<bool>,
    max_gap_m: f64,
}

prop_compose! {
    fn case()(beams in prop_oneof![5usize..40, 100usize..400])(
        x_m in -1.5..5.5f64, // the grid covers 4 m: also beside it
        y_m in -1.5..5.5f64,
        heading_rad in -PI..PI,
        angle_min_rad in -PI..PI,
        share in prop_oneof![2 => Just(1.0), 1 => 0.05..0.95f64],
        clockwise in any::<bool>(),
        ranges_m in prop::collection::vec(prop_oneof![
            10 => 0.0..3.5f32,
            1 => Just(f32::INFINITY), 1 => Just(f32::NEG_INFINITY), 1 => Just(f32::NAN),
        ], beams),
        joined in prop::collection::vec(any::<bool>(), beams),
        max_gap_m in prop_oneof![0.02..0.5f64, Just(10.0)],
    ) -> Case {
        let increment_rad = share * TAU / ranges_m.len() as f64 * if clockwise { -1.0 } else { 1.0 };
        Case { x_m, y_m, heading_rad, angle_min_rad, increment_rad, ranges_m, joined, max_gap_m }
    }
}

impl Case {
    fn frame() -> GridFrame {
        GridFrame::new(Point2::origin(), 0.05, 80, 80).unwrap()
    }

    fn cloud(&self) -> ProjectedScan {
        let mut cloud = ProjectedScan::default();
        cloud.project(&LaserReading {
            time_s: 0.0,
            pose: interfaces::pose(self.x_m, self.y_m, self.heading_rad),
            twist: Twist::STOP,
            velocities: Vec::new(),
            mount: interfaces::pose(0.0, 0.0, 0.0),
            scan: Scan {
                angle_min_rad: self.angle_min_rad,
                angle_increment_rad: self.increment_rad,
                range_min_m: RANGE_MIN_M,
                range_max_m: RANGE_MAX_M,
                sweep_s: 0.0,
                ranges_m: self.ranges_m.clone(),
            },
        });
        cloud
    }

    /// The range that is known to be clear along a beam, by REP-117 and the range of the fan.
    fn clear_m(&self, beam: usize) -> f64 {
        let range_m = f64::from(self.ranges_m[beam]);
        let clear_m = if range_m == f64::INFINITY {
            RANGE_MAX_M
        } else if (RANGE_MIN_M..=RANGE_MAX_M).contains(&range_m) {
            range_m
        } else {
            0.0
        };
        clear_m.min(self.max_gap_m / self.increment_rad.abs())
    }

    /// Whether a point lies in the triangle of the two beams around it; `None` on its border.
    fn sees(&self, point: Point2<f64>) -> Option<bool> {
        let to = point - Point2::new(self.x_m, self.y_m);
        let bearing_rad = to.y.atan2(to.x) - self.heading_rad - self.angle_min_rad;
        let turn = (bearing_rad * self.increment_rad.signum()).rem_euclid(TAU) / self.increment_rad.abs();
        let (beam, part, beams) = (turn as usize, turn.fract(), self.ranges_m.len());
        let off_beam_m = part.min(1.0 - part) * self.increment_rad.abs() * to.norm();
        if off_beam_m < TIE_M {
            return None;
        }
        let is_full = self.increment_rad.abs() * (beams as f64 + 1e-3) > TAU;
        if beam + 1 >= beams && !is_full {
            return Some(false);
        }
        let next = (beam + 1) % beams;
        let (mut a_m, mut b_m) = (self.clear_m(beam), self.clear_m(next));
        if !self.joined[beam] {
            (a_m, b_m) = (a_m.min(b_m), a_m.min(b_m));
        }
        // The distance at which the bearing meets the far side of the triangle, by the law of sines.
        let (before_rad, wedge_rad) = (part * self.increment_rad.abs(), self.increment_rad.abs());
        let side = a_m * before_rad.sin() + b_m * (wedge_rad - before_rad).sin();
        let far_m = if side > 0.0 { a_m * b_m * wedge_rad.sin() / side } else { 0.0 };
        ((far_m - to.norm()).abs() > TIE_M).then_some(to.norm() < far_m)
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn fill_takes_the_cells_whose_middle_the_scan_sees_once_each(case in case()) {
        let frame = Case::frame();
        let mut counts = vec![0; frame.len()];
        Footprint::default().fill(&case.cloud(), &frame, case.max_gap_m, |beam| case.joined[beam], |start, end| {
            assert_eq!(start / frame.width(), (end - 1) / frame.width(), "a run is part of one row");
            counts[start..end].iter_mut().for_each(|count| *count += 1);
        });
        for (index, &count) in counts.iter().enumerate() {
            let middle = frame.center(frame.cell(index));
            if let Some(sees) = case.sees(middle) {
                prop_assert_eq!(count, i32::from(sees), "the cell at {}", middle);
            }
        }
    }

    /// Scratch memory is reused: a fill must not affect the next one.
    #[test]
    fn a_second_fill_does_not_remember_the_first(first in case(), second in case()) {
        let runs = |footprint: &mut Footprint, case: &Case| {
            let mut runs = Vec::new();
            let is_joined = |beam: usize| case.joined[beam];
            footprint.fill(&case.cloud(), &Case::frame(), case.max_gap_m, is_joined, |start, end| runs.push((start, end)));
            runs
        };
        let mut used = Footprint::default();
        runs(&mut used, &first);
        prop_assert_eq!(runs(&mut used, &second), runs(&mut Footprint::default(), &second));
    }

    /// The reference follows the segment in steps of a thousandth of a cell.
    #[test]
    fn cells_along_are_those_that_the_segment_crosses(
        from in (-1.0..5.0f64, -1.0..5.0f64),
        to in prop_oneof![
            6 => (-1.0..5.0f64, -1.0..5.0f64),
            1 => (-40i32..160, -40i32..160).prop_map(|(x, y)| (f64::from(x) * 0.05, f64::from(y) * 0.05)),
        ],
        along_x: bool, along_y: bool,
    ) {
        let frame = Case::frame();
        let from = Point2::new(from.0, from.1);
        let to = Point2::new(if along_y { from.x } else { to.0 }, if along_x { from.y } else { to.1 });
        let mut visited = Vec::new();
        cells_along(&frame, &from, &to, |index| visited.push(frame.cell(index)));

        for pair in visited.windows(2) {
            let steps = pair[0].x.abs_diff(pair[1].x) + pair[0].y.abs_diff(pair[1].y);
            prop_assert_eq!(steps, 1, "a step goes to a neighbour: {:?}", pair);
        }
        for &cell in &visited {
            prop_assert_eq!(visited.iter().filter(|&&other| other == cell).count(), 1, "{:?} once", cell);
        }
        if frame.contains(frame.cell_at(&from)) {
            prop_assert_eq!(visited.first(), Some(&frame.cell_at(&from)));
        }
        if frame.contains(frame.cell_at(&to)) {
            prop_assert_eq!(visited.last(), Some(&frame.cell_at(&to)));
        }
        let steps = (to - from).norm() / frame.resolution_m() * 1000.0 + 1.0;
        let mut touched = std::collections::BTreeSet::new();
        for step in 0..=steps as usize {
            let point = from.lerp(&to, (step as f64 / steps).min(1.0));
            let cell = frame.cell_at(&point);
            let off = (point - frame.center(cell)).amax();
            if frame.contains(cell) && off < frame.resolution_m() / 2.0 - 1e-9 {
                prop_assert!(visited.contains(&cell), "{:?} at {} is missing", cell, point);
            }
            // Within a step of a border the neighbors count as touched too.
            let near = Vector2::repeat(1.5e-3 * frame.resolution_m());
            for corner in [point - near, point + near] {
                touched.extend([(corner.x, point.y), (point.x, corner.y), (corner.x, corner.y)].map(|(x, y)| {
                    frame.cell_at(&Point2::new(x, y))
                }));
            }
            touched.extend([
                frame.cell_at(&Point2::new(point.x - near.x, point.y + near.y)),
                frame.cell_at(&Point2::new(point.x + near.x, point.y - near.y)),
            ]);
        }
        for cell in visited {
            prop_assert!(touched.contains(&cell), "{:?} is not on the segment", cell);
        }
    }
}
