use super::{BeamOrder, Order};
use interfaces::{LaserReading, Scan, pose};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

const BEAMS: usize = 360;

/// A robot in a room, with a laser that turns `rate_hz` times per second.
#[derive(Clone, Copy, Debug)]
struct Robot {
    rate_hz: f64,
    turn_radps: f64,
    /// The clock of the odometry is late by this, s.
    late_s: f64,
    /// The distances from the robot to the walls, m.
    walls_m: [f64; 4],
}

impl Robot {
    /// The heading at a time: 2 s at rest, 2 s of a turn, by turns to the left and to the other side.
    fn heading_rad(&self, time_s: f64, back: f64) -> f64 {
        let (cycle, since_s) = ((time_s.max(0.0) / 4.0).floor(), time_s.max(0.0).rem_euclid(4.0));
        let turned = |cycle: f64| if cycle.rem_euclid(2.0) < 1.0 { 1.0 } else { back };
        let before: f64 = (0..cycle as usize).map(|cycle| 2.0 * turned(cycle as f64)).sum();
        self.turn_radps * (before + turned(cycle) * (since_s - 2.0).max(0.0))
    }

    fn range_m(&self, angle_rad: f64) -> f64 {
        let (sin, cos) = angle_rad.sin_cos();
        let [right, up, left, down] = self.walls_m;
        (if cos > 0.0 { right } else { left } / cos.abs()).min(if sin > 0.0 { up } else { down } / sin.abs())
    }

    /// Readings of 40 s, whose beams are measured in this order. `back`: 1 for turns to one side only, -1 for turns to both.
    fn readings(self, order: Order, back: f64) -> impl Iterator<Item = LaserReading> {
        let sweep_s = 1.0 / self.rate_hz;
        (1..(40.0 * self.rate_hz) as usize).map(move |number| {
            let time_s = number as f64 * sweep_s;
            let range_m = |beam: usize| {
                let at_s = time_s - order.left(beam, BEAMS) * sweep_s;
                let error_m = 0.01 * ((number * 7919 + beam * 104_729) as f64).sin();
                let angle_rad = -PI + TAU * beam as f64 / BEAMS as f64;
                (self.range_m(self.heading_rad(at_s, back) + angle_rad) + error_m) as f32
            };
            let scan = Scan {
                angle_min_rad: -PI,
                angle_increment_rad: TAU / BEAMS as f64,
                range_min_m: 0.05,
                range_max_m: 30.0,
                sweep_s,
                ranges_m: (0..BEAMS).map(range_m).collect(),
            };
            let pose = pose(0.0, 0.0, self.heading_rad(time_s - self.late_s, back));
            LaserReading { time_s, pose, scan, ..LaserReading::default() }
        })
    }
}

fn learned(readings: impl Iterator<Item = LaserReading>) -> (BeamOrder, Option<String>) {
    let mut order = BeamOrder::default();
    readings.for_each(|reading| order.add(&reading));
    let note = order.judge();
    assert!(order.judge().is_none(), "a note comes once");
    (order, note)
}

fn robots() -> impl Strategy<Value = Robot> {
    // In a small square room, the ranges change less than their noise.
    let walls_m = [1.0..2.0, 2.0..3.0, 3.0..5.0, 4.0..8.0];
    (prop::sample::select(vec![5.0, 8.0, 10.0]), 0.8..1.5, -0.15..0.15, walls_m)
        .prop_map(|(rate_hz, turn_radps, late_s, walls_m)| Robot { rate_hz, turn_radps, late_s, walls_m })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn the_order_of_the_beams_is_found_and_used(robot in robots()) {
        for order in super::ORDERS {
            let (found, note) = learned(robot.readings(order, -1.0));
            prop_assert_eq!(found.order, order);
            prop_assert_eq!(note.iter().len(), usize::from(order != Order::Written));
            // Each beam keeps its direction and its range, and comes in the order of its measurement.
            let reading = robot.readings(order, -1.0).nth(37).unwrap();
            let mut applied = reading.clone();
            found.apply(&mut applied);
            for beam in 0..BEAMS {
                let (at, age_s) = match order {
                    Order::Written => (beam, reading.scan.age_s(beam)),
                    Order::Reversed => (BEAMS - 1 - beam, reading.scan.age_s(BEAMS - 1 - beam)),
                    Order::AtOnce => (beam, 0.0),
                };
                prop_assert_eq!(applied.scan.ranges_m[at], reading.scan.ranges_m[beam]);
                prop_assert!((applied.scan.angle_rad(at) - reading.scan.angle_rad(beam)).abs() < 1e-9);
                prop_assert!((applied.scan.age_s(at) - age_s).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn turns_to_one_side_say_nothing(robot in robots()) {
        for order in super::ORDERS {
            let (found, note) = learned(robot.readings(order, 1.0));
            prop_assert_eq!((found.order, note.iter().len()), (Order::Written, 0));
        }
    }
}
