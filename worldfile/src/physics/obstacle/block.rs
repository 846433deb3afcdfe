//! A block that moves along a path: the path must lead through free space, and its times must be possible.

use super::Obstacle;
use crate::physics::behavior::REPEATS;
use crate::physics::space::{MAX_TIME_S, inside};
use crate::reader::valid;
use nalgebra::Point2;
use sim::physics::shape::TOUCH_M;
use sim::physics::{Motion, ObstacleSpec, PathSpec, Rectangle, Repeat, convex};
use std::ops::Range;

/// The fastest block, m/s.
const FASTEST_MPS: f64 = 5.0;

type Keys = Vec<(f64, Point2<f64>)>;

/// How fast a block moves on its path.
enum Pace {
    /// The time at each point, s.
    Timed(Vec<f64>),
    /// At a constant speed, with a stay at each point.
    Even { speed_mps: f64, dwell_s: f64 },
}

impl Obstacle<'_> {
    pub(super) fn block(self) -> Option<ObstacleSpec> {
        let sides = self.table.needed("size_m").and_then(|value| value.pair_within(&(0.001..=100.0)));
        let heading_rad = self.heading_rad();
        let points = self.table.needed("path_m").and_then(|path| path.points(&self.space.size));
        let pace = self.pace();
        let repeat = self.table.choice("repeat", &REPEATS);
        let (points, repeat) = (points?, repeat?);
        let shape = Rectangle::around(points[0], sides?.coords, heading_rad?);
        let keys = pace.and_then(|pace| match pace {
            Pace::Timed(times_s) => self.timed(&points, &times_s, repeat),
            Pace::Even { speed_mps, dwell_s } => Some(dwelling(&points, speed_mps, dwell_s, repeat)),
        });
        self.is_path_free(&points, repeat, &shape)?;
        let keys = keys?;
        // A block that never moves has no time to begin again at.
        let is_loop = repeat != Repeat::Once && keys[keys.len() - 1].0 > 0.0;
        Some(ObstacleSpec::new(self.name, shape, Motion::Path(PathSpec { keys, is_loop })))
    }

    /// How fast it moves, as far as that can be judged without its path.
    fn pace(&self) -> Option<Pace> {
        let table = self.table;
        match ["times_s", "speed_mps", "dwell_s"].map(|key| table.has(key)) {
            [true, false, false] => {
                let times_s = table.get("times_s")?.list(|time| time.within(&(0.0..=MAX_TIME_S)));
                Some(Pace::Timed(times_s?))
            }
            [false, true, _] => {
                let speed_mps = table.number("speed_mps", 0.001..=FASTEST_MPS);
                let dwell_s = table.number_or("dwell_s", 0.0, 0.0..=MAX_TIME_S);
                let speed_mps = valid(speed_mps)?;
                self.is_slow_enough(speed_mps, table.at("speed_mps"))?;
                Some(Pace::Even { speed_mps, dwell_s: valid(dwell_s)? })
            }
            _ => {
                let help =
                    "it needs either `times_s`, or `speed_mps` and, if it stays at its points, `dwell_s`";
                self.incomplete("block", help)
            }
        }
    }

    /// At each point at a time of its own.
    fn timed(&self, points: &[Point2<f64>], times_s: &[f64], repeat: Repeat) -> Option<Keys> {
        let table = self.table;
        let error = |what: &str, help: &str| {
            let others = [(table.at("path_m"), "of these points")];
            table.error(what, (table.at("times_s"), "these times"), &others, help)
        };
        if times_s.len() != points.len() {
            let what = format!("{} times for {} points", times_s.len(), points.len());
            return error(&what, "`times_s` has one time for each point of `path_m`");
        }
        if times_s[0] != 0.0 {
            return error("`times_s` does not begin at 0", "the block starts at its first point");
        }
        let mut keys = vec![(0.0, points[0])];
        for (i, (&time_s, at)) in times_s.iter().zip(points).enumerate().skip(1) {
            let (before_s, before) = keys[i - 1];
            if time_s <= before_s {
                return error("`times_s` is not in order", "each time must be later than the one before");
            }
            self.is_slow_enough((at - before).norm() / (time_s - before_s), table.at_item("times_s", i))?;
            keys.push((time_s, *at));
        }
        match repeat {
            Repeat::Once => {}
            Repeat::Loop if points[points.len() - 1] != points[0] => {
                let help = "end it where it begins, or give `repeat = \"back_and_forth\"` or \"once\"";
                return error("a path that is repeated must be closed", help);
            }
            Repeat::Loop => {}
            Repeat::BackAndForth => {
                let end_s = keys[keys.len() - 1].0;
                let back: Keys = keys.iter().rev().skip(1).map(|(s, at)| (2.0 * end_s - s, *at)).collect();
                keys.extend(back);
            }
        }
        Some(keys)
    }

    /// Whether the speed is low enough: the motion in one step must not be longer than the physics can handle.
    fn is_slow_enough(&self, speed_mps: f64, span: Range<usize>) -> Option<()> {
        let fastest_mps = FASTEST_MPS.min(self.fastest_mps());
        if speed_mps <= fastest_mps {
            return Some(());
        }
        let what = format!("the block `{}` moves at {speed_mps:.3} m/s", self.name);
        let help = format!("{fastest_mps} m/s are the most with a physics step of {} s", self.space.step_s);
        self.table.error(&what, (span, "too fast"), &[], &help)
    }

    fn is_path_free(&self, points: &[Point2<f64>], repeat: Repeat, shape: &Rectangle) -> Option<()> {
        let back = (repeat == Repeat::Loop).then_some(0);
        let mut from = points[0];
        for i in (0..points.len()).chain(back) {
            let (to, span) = (points[i], self.table.at_item("path_m", i));
            let at = |point: &Point2<f64>| shape.moved(point - points[0]);
            let what = format!("the path of `{}` leads out of the map", self.name);
            inside(self.table.file, &what, span.clone(), &at(&to), &self.space.size)?;
            let swept = convex::hull([at(&from).corners(), at(&to).corners()].concat());
            let is_in_way = |wall: &Rectangle| convex::gap_m(&swept, &wall.corners()) < -TOUCH_M;
            if let Some(wall) = self.space.walls.first(is_in_way) {
                let what = format!("the path of `{}` leads through a wall", self.name);
                let others = [(wall.span.clone(), "through this one")];
                let help = "the block may touch walls all the way, but not overlap them";
                return self.table.error(&what, (span, "on the way here"), &others, help);
            }
            from = to;
        }
        Some(())
    }
}

/// Some time at each point, and then on.
fn dwelling(points: &[Point2<f64>], speed_mps: f64, dwell_s: f64, repeat: Repeat) -> Keys {
    let mut keys = vec![(0.0, points[0])];
    let mut stop = |at: &Point2<f64>| {
        let (mut time_s, before) = keys[keys.len() - 1];
        time_s += (at - before).norm() / speed_mps;
        if *at != before {
            keys.push((time_s, *at));
        }
        if dwell_s > 0.0 {
            keys.push((time_s + dwell_s, *at));
        }
    };
    points.iter().for_each(&mut stop);
    match repeat {
        Repeat::Once => {}
        // The stay at the first point belongs to the next time around.
        Repeat::Loop => {
            stop(&points[0]);
            if dwell_s > 0.0 {
                keys.pop();
            }
        }
        Repeat::BackAndForth => {
            points.iter().rev().skip(1).for_each(&mut stop);
            if dwell_s > 0.0 && points.len() > 1 {
                keys.pop();
            }
        }
    }
    keys
}
