//! A block's path: it must lead through free space, and its times must make sense.

use super::Context;
use crate::error::WorldError;
use crate::physics::behavior::REPEATS;
use crate::physics::file::{Number, Pair};
use crate::physics::space::{MAX_TIME_S, Solid, inside};
use crate::together::Together;
use nalgebra::{Point2, Vector2};
use serde_spanned::Spanned;
use sim::physics::shape::TOUCH_M;
use sim::physics::{Motion, ObstacleSpec, PathSpec, Rectangle, Repeat, convex};

const MOST_POINTS: usize = 1000;
/// The fastest block, m/s.
const FASTEST_MPS: f64 = 5.0;

type Keys = Vec<(f64, Point2<f64>)>;

/// How fast a block goes on its path.
enum Pace<'a> {
    /// At each point at a time of its own.
    Timed { times: &'a Spanned<Vec<Number>>, times_s: Vec<f64> },
    /// Always alike, with a stay at each point.
    Even { speed_mps: f64, dwell_s: f64 },
}

impl Context<'_> {
    pub(super) fn block(self) -> Result<ObstacleSpec, WorldError> {
        let (table, file) = (self.table(), self.file);
        let size = self.needed("size_m", &file.size_m);
        let path = self.needed("path_m", &file.path_m).and_then(|path| {
            if (1..=MOST_POINTS).contains(&path.get_ref().len()) {
                return Ok((path, table.points("path_m", path.get_ref(), self.size)?));
            }
            let what = format!("`obstacle.path_m` has {} points", path.get_ref().len());
            let help = format!("it must have 1 to {MOST_POINTS}, as in `[[1.0, 2.0], [3.0, 2.0]]`");
            Err(self.source.error(&what, (path.span(), "these points"), &[], &help))
        });
        let (sides, heading_deg, (path, points), pace, repeat) = (
            size.and_then(|size| table.pair("size_m", size, 0.001..=100.0)),
            table.number_or("heading_deg", &file.heading_deg, 0.0, -360.0..=360.0),
            path,
            self.pace(),
            table.choice("repeat", &file.repeat, &REPEATS),
        )
            .together()?;
        let shape = Rectangle::around(points[0], sides.coords, heading_deg.to_radians());
        let keys = match pace {
            Pace::Timed { times, times_s } => self.timed(path, &points, times, &times_s, repeat),
            Pace::Even { speed_mps, dwell_s } => Ok(dwelling(&points, speed_mps, dwell_s, repeat)),
        };
        let is_free = self.is_way_free(path, &points, repeat, &shape);
        let (keys, ()) = (keys, is_free).together()?;
        // A block that never moves has no time to begin again at.
        let is_loop = repeat != Repeat::Once && keys[keys.len() - 1].0 > 0.0;
        Ok(self.spec(shape, Motion::Path(PathSpec { keys, is_loop })))
    }

    /// How fast it goes, as far as that makes sense without its path.
    fn pace(&self) -> Result<Pace<'_>, WorldError> {
        let (table, file) = (self.table(), self.file);
        match (&file.times_s, &file.speed_mps) {
            (Some(times), None) if file.dwell_s.is_none() => {
                let times_s = table.numbers("times_s", times.get_ref(), 0.0..=MAX_TIME_S)?;
                Ok(Pace::Timed { times, times_s })
            }
            (None, Some(speed)) => {
                let speed_mps = table.number("speed_mps", speed, 0.001..=FASTEST_MPS);
                let speed_mps = speed_mps.and_then(|mps| self.is_slow_enough(mps, speed).map(|()| mps));
                let dwell_s = table.number_or("dwell_s", &file.dwell_s, 0.0, 0.0..=MAX_TIME_S);
                let (speed_mps, dwell_s) = (speed_mps, dwell_s).together()?;
                Ok(Pace::Even { speed_mps, dwell_s })
            }
            _ => {
                let help =
                    "it needs either `times_s`, or `speed_mps` and, if it stays at its points, `dwell_s`";
                Err(self.incomplete("block", help))
            }
        }
    }

    /// At each point at a time of its own.
    fn timed(
        &self,
        path: &Spanned<Vec<Pair>>,
        points: &[Point2<f64>],
        times: &Spanned<Vec<Number>>,
        times_s: &[f64],
        repeat: Repeat,
    ) -> Result<Keys, WorldError> {
        let (list, span) = (times.get_ref(), times.span());
        let error = |what: &str, help: &str| {
            Err(self.source.error(
                what,
                (span.clone(), "these times"),
                &[(path.span(), "of these points")],
                help,
            ))
        };
        if list.len() != points.len() {
            let what = format!("{} times for {} points", list.len(), points.len());
            return error(&what, "`times_s` has one time for each point of `path_m`");
        }
        let mut keys = Keys::new();
        for ((time, &time_s), at) in list.iter().zip(times_s).zip(points) {
            let Some((before_s, before)) = keys.last() else {
                if time_s != 0.0 {
                    return error("`times_s` does not begin at 0", "the block starts at its first point");
                }
                keys.push((time_s, *at));
                continue;
            };
            if time_s <= *before_s {
                return error("`times_s` is not in order", "each time must be later than the one before");
            }
            self.is_slow_enough((at - before).norm() / (time_s - before_s), time)?;
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
        Ok(keys)
    }

    /// In one step it goes no farther than what the physics keeps apart.
    fn is_slow_enough(&self, speed_mps: f64, at: &Number) -> Result<(), WorldError> {
        let fastest_mps = FASTEST_MPS.min(self.fastest_mps());
        if speed_mps <= fastest_mps {
            return Ok(());
        }
        let what = format!("the block `{}` moves at {speed_mps:.3} m/s", self.name);
        let help = format!("{fastest_mps} m/s are the most with a physics step of {} s", self.step_s);
        Err(self.source.error(&what, (at.span(), "too fast"), &[], &help))
    }

    /// The fastest that a surface may move, m/s: 0.1 m in a physics step.
    pub(super) fn fastest_mps(&self) -> f64 {
        0.1 / self.step_s
    }

    fn is_way_free(
        &self,
        path: &Spanned<Vec<Pair>>,
        points: &[Point2<f64>],
        repeat: Repeat,
        shape: &Rectangle,
    ) -> Result<(), WorldError> {
        let back = (repeat == Repeat::Loop).then(|| (points[0], path.get_ref()[0].span()));
        let ends: Vec<_> =
            points.iter().copied().zip(path.get_ref().iter().map(Spanned::span)).chain(back).collect();
        let first = ends[..1].iter().chain(&ends);
        for ((from, _), (to, span)) in first.zip(&ends) {
            let at = |point: &Point2<f64>| shape.moved(point - points[0]);
            let what = format!("the path of `{}` leads out of the map", self.name);
            inside(self.source, &what, span.clone(), &at(to), self.size)?;
            let swept = swept(&at(from), &(to - from));
            let is_in_way = |wall: &&Solid| convex::gap_m(&swept, &wall.shape.corners()) < -TOUCH_M;
            if let Some(wall) = self.walls.iter().find(is_in_way) {
                let what = format!("the path of `{}` leads through a wall", self.name);
                let marks = [(wall.span.clone(), "through this one")];
                let help = "the block may touch walls all the way, but not overlap them";
                return Err(self.source.error(&what, (span.clone(), "on the way here"), &marks, help));
            }
        }
        Ok(())
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

/// What a rectangle sweeps on a straight way: a convex body of at most six corners.
fn swept(shape: &Rectangle, way: &Vector2<f64>) -> Vec<Point2<f64>> {
    let corners = shape.corners();
    let mut hull = Vec::new();
    for i in 0..4 {
        let (before, at, after) = (corners[(i + 3) % 4], corners[i], corners[(i + 1) % 4]);
        // Counter-clockwise: a side whose solid lies behind the way's direction moves along.
        let is_ahead = |from: Point2<f64>, to: Point2<f64>| (to - from).perp(way) < 0.0;
        match (is_ahead(before, at), is_ahead(at, after)) {
            (true, true) => hull.push(at + way),
            (false, false) => hull.push(at),
            (false, true) => hull.extend([at, at + way]),
            (true, false) => hull.extend([at + way, at]),
        }
    }
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_block_sweeps_is_the_hull_of_both_ends() {
        let shape = Rectangle::around(Point2::new(1.0, 1.0), Vector2::new(0.4, 0.2), 0.3);
        for way in
            [Vector2::new(2.0, 0.7), Vector2::new(-0.1, 3.0), Vector2::new(-1.0, -1.0), Vector2::zeros()]
        {
            let hull = swept(&shape, &way);
            for corner in shape.corners().into_iter().chain(shape.moved(way).corners()) {
                assert!(convex::disc_gap_m(&hull, &corner, 0.0) < 1e-9, "{way}: {corner}");
            }
            let turns = (0..hull.len()).map(|i| {
                let [a, b, c] = [0, 1, 2].map(|k| hull[(i + k) % hull.len()]);
                (b - a).perp(&(c - b))
            });
            assert!(turns.into_iter().all(|turn| turn > -1e-9), "{way}: {hull:?}");
        }
    }
}
