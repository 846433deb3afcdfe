//! What a robot does by itself.

mod patrol;

use crate::error::{Source, WorldError};
use crate::physics::file::{BehaviourFile, RobotFile};
use crate::physics::numbers::Table;
use crate::physics::space::{Around, Solid};
use crate::together::Together;
use nalgebra::Point2;
use serde_spanned::Spanned;
use sim::physics::shape::TOUCH_M;
use sim::physics::{BehaviorSpec, CircleSpec, DriveKind, DriveLimits, Repeat, WanderSpec, WaypointsSpec};
use std::ops::Range;

/// What comes after the last waypoint, as the file calls it.
pub(super) const REPEATS: [(&str, Repeat); 3] =
    [("loop", Repeat::Loop), ("back_and_forth", Repeat::BackAndForth), ("once", Repeat::Once)];

/// A robot of the file, and what it could run into.
pub(super) struct Context<'a> {
    pub(super) source: &'a Source<'a>,
    pub(super) robot: &'a RobotFile,
    /// The radius of the circle that holds it, m, and where it starts. No way is judged if that is wrong.
    pub(super) place: Option<(f64, Point2<f64>)>,
    pub(super) drive: &'a DriveLimits,
    pub(super) around: &'a Around<'a>,
}

/// The keys of each behaviour, and what it is.
const KINDS: [(&str, &[&str], &str); 6] = [
    ("driven", &[], "goes where it is told to"),
    ("standing", &[], "stands"),
    ("circle", &["speed_mps", "turn_radius_m", "direction"], "drives a circle"),
    ("wander", &["speed_mps", "clearance_m"], "drives about"),
    ("waypoints", &["points_m", "speed_mps", "repeat", "clearance_m"], "drives from point to point"),
    ("wall_patrol", &["from_m", "to_m", "speed_mps", "wall_side", "clearance_m"], "follows a wall"),
];

impl Context<'_> {
    pub(super) fn behavior(&self) -> Result<BehaviorSpec, WorldError> {
        let file = self.robot.behaviour.get_ref();
        let kind = file.kind.get_ref().as_str();
        let Some((_, known, does)) = KINDS.iter().find(|(name, _, _)| *name == kind) else {
            let what = format!("`{kind}` is no behaviour");
            let names = KINDS.map(|(name, _, _)| format!("\"{name}\""));
            let help = format!("it must be one of {}", names.join(", "));
            return Err(self.source.error(&what, (file.kind.span(), "not known"), &[], &help));
        };
        if let DriveKind::Car { .. } = self.drive.kind
            && !["driven", "standing", "circle"].contains(&kind)
        {
            let what = format!("a car cannot be `{kind}`");
            let help = "it cannot turn in place: it is \"driven\" or \"standing\", or drives a \"circle\"";
            return Err(self.source.error(&what, (file.kind.span(), "not for a car"), &[], help));
        }
        let foreign = keys(file).into_iter().filter(|(key, _)| !known.contains(key));
        let foreign = foreign.map(|(key, span)| {
            let what = format!("a robot that is `{kind}` has no `{key}`");
            let keys =
                if known.is_empty() { String::new() } else { format!("; its keys are {}", known.join(", ")) };
            let help = format!("leave it out: such a robot {does}{keys}");
            Err::<(), _>(self.source.error(&what, (span, "not for this robot"), &[], &help))
        });
        // Where such a key stands, the kind may be what is wrong: nothing else is judged by it.
        foreign.collect::<Vec<_>>().together()?;
        match kind {
            "driven" => Ok(BehaviorSpec::Driven),
            "standing" => Ok(BehaviorSpec::Standing),
            "circle" => self.circle(file),
            "wander" => {
                let (speed_mps, clearance_m) = (self.speed_mps(file), self.clearance_m(file)).together()?;
                Ok(BehaviorSpec::Wander(WanderSpec { speed_mps, clearance_m }))
            }
            "waypoints" => self.waypoints(file),
            _ => patrol::patrol(self, file),
        }
    }

    pub(super) const TABLE: &'static str = "robot.behaviour";

    pub(super) fn table(&self) -> Table<'_> {
        Table { source: self.source, path: Self::TABLE }
    }

    /// A key that this behaviour cannot do without.
    pub(super) fn needed<'f, T>(
        &self,
        key: &str,
        value: &'f Option<Spanned<T>>,
    ) -> Result<&'f Spanned<T>, WorldError> {
        value.as_ref().ok_or_else(|| {
            let (name, kind) = (self.robot.name.get_ref(), &self.robot.behaviour.get_ref().kind);
            let what = format!("the behaviour of `{name}` has no `{key}`");
            let help = format!("a robot that is `{}` needs a line `{key} = …`", kind.get_ref());
            self.source.error(&what, (kind.span(), "this behaviour"), &[], &help)
        })
    }

    pub(super) fn speed_mps(&self, file: &BehaviourFile) -> Result<f64, WorldError> {
        let speed = self.needed("speed_mps", &file.speed_mps)?;
        self.table().number("speed_mps", speed, 0.01..=self.drive.max_linear_mps)
    }

    pub(super) fn clearance_m(&self, file: &BehaviourFile) -> Result<f64, WorldError> {
        self.table().number_or("clearance_m", &file.clearance_m, 0.15, 0.05..=10.0)
    }

    fn circle(&self, file: &BehaviourFile) -> Result<BehaviorSpec, WorldError> {
        let radius = self
            .needed("turn_radius_m", &file.turn_radius_m)
            .and_then(|radius| Ok((radius, self.table().number("turn_radius_m", radius, 0.01..=1000.0)?)));
        let sides = [("left", true), ("right", false)];
        let is_left = self.table().choice("direction", &file.direction, &sides);
        let (speed_mps, (radius, radius_m), is_left) = (self.speed_mps(file), radius, is_left).together()?;
        let curved_radps = speed_mps * self.drive.max_curvature_radpm();
        let fastest_radps = self.drive.max_angular_radps.min(curved_radps);
        if speed_mps / radius_m > fastest_radps {
            let marks = [(file.speed_mps.as_ref().map_or(radius.span(), Spanned::span), "at this speed")];
            let help = format!(
                "its drive turns at {:.1} °/s at most: at {speed_mps} m/s a circle has a radius of {:.3} m or more",
                fastest_radps.to_degrees(),
                speed_mps / fastest_radps
            );
            return Err(self.source.error(
                "a circle is too tight",
                (radius.span(), "too small"),
                &marks,
                &help,
            ));
        }
        let turn_radps = speed_mps / radius_m * if is_left { 1.0 } else { -1.0 };
        Ok(BehaviorSpec::Circle(CircleSpec { speed_mps, turn_radps }))
    }

    fn waypoints(&self, file: &BehaviourFile) -> Result<BehaviorSpec, WorldError> {
        let points = self.needed("points_m", &file.points_m).and_then(|list| {
            if (1..=1000).contains(&list.get_ref().len()) {
                return self.table().points("points_m", list.get_ref(), &self.around.size);
            }
            let what = format!("`robot.behaviour.points_m` has {} points", list.get_ref().len());
            let help = "it must have 1 to 1000, as in `[[1.0, 2.0], [3.0, 2.0]]`";
            Err(self.source.error(&what, (list.span(), "these points"), &[], help))
        });
        let repeat = self.table().choice("repeat", &file.repeat, &REPEATS);
        let (points, speed_mps, repeat, clearance_m) =
            (points, self.speed_mps(file), repeat, self.clearance_m(file)).together()?;
        self.is_way_free(file, &points, repeat)?;
        Ok(BehaviorSpec::Waypoints(WaypointsSpec { points, speed_mps, repeat, clearance_m }))
    }

    /// The way from the start to all points leads past everything.
    fn is_way_free(
        &self,
        file: &BehaviourFile,
        points: &[Point2<f64>],
        repeat: Repeat,
    ) -> Result<(), WorldError> {
        /// Kept free beside the way, m.
        const BESIDE_M: f64 = 0.05;
        let Some((radius_m, start)) = self.place else { return Ok(()) };
        let spans = file.points_m.iter().flat_map(|points| points.get_ref()).map(Spanned::span);
        let points: Vec<(Point2<f64>, Range<usize>)> = points.iter().copied().zip(spans).collect();
        let start = (start, self.robot.pose_m.span());
        let back = (repeat == Repeat::Loop && points.len() > 1).then(|| points[0].clone());
        let way: Vec<_> = [start].into_iter().chain(points).chain(back).collect();
        let keep_m = radius_m + BESIDE_M;
        for (leg, pair) in way.windows(2).enumerate() {
            let [(a, from), (b, to)] = pair else { continue };
            let marks = |label| (to.clone(), label);
            // The robot may start on its first point.
            if leg > 0 && (b - a).norm() < 0.1 {
                let others = [(from.clone(), "from here")];
                let help = "they must be at least 0.1 m apart";
                return Err(self.source.error("two waypoints coincide", marks("to here"), &others, help));
            }
            let near = |solid: &&Solid| solid.shape.segment_distance_m(a, b) < keep_m - TOUCH_M;
            if let Some(solid) = self.around.solids.iter().find(near) {
                let what =
                    format!("the way of `{}` leads through a wall or an obstacle", self.robot.name.get_ref());
                let others = [(from.clone(), "from here"), (solid.span.clone(), "too near to this one")];
                let help =
                    format!("the way must keep {keep_m:.3} m away, 0.05 m more than the robot's radius");
                return Err(self.source.error(&what, marks("to here"), &others, &help));
            }
        }
        Ok(())
    }
}

/// The keys that the file has, besides the kind, with their places.
fn keys(file: &BehaviourFile) -> Vec<(&'static str, Range<usize>)> {
    fn place<T>(key: &'static str, value: &Option<Spanned<T>>) -> Option<(&'static str, Range<usize>)> {
        value.as_ref().map(|value| (key, value.span()))
    }
    let found = [
        place("speed_mps", &file.speed_mps),
        place("clearance_m", &file.clearance_m),
        place("turn_radius_m", &file.turn_radius_m),
        place("from_m", &file.from_m),
        place("to_m", &file.to_m),
        place("points_m", &file.points_m),
        place("wall_side", &file.wall_side),
        place("direction", &file.direction),
        place("repeat", &file.repeat),
    ];
    found.into_iter().flatten().collect()
}
