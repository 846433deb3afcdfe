//! What changes during a run, and how often each part of it is logged.

use super::columns::{Arrow, Classes, Item, Line, Now, Place, Rows, State, Strip};
use super::pace::{Due, Pace};
use super::{entity, sight};
use crate::layer::Layer;
use crate::view::{Level, RobotView, TimeUnit, Trail, View};
use nalgebra::{Isometry2, Point2};
use rerun::RecordingStream;

/// Everything about one robot.
struct Robot {
    body: Rows<Place>,
    heading: Rows<Arrow>,
    trail: Rows<Strip>,
    way: Trail,
    last: Option<Isometry2<f64>>,
}

impl Robot {
    fn new(robot: &RobotView) -> Self {
        let part = |part| entity::robot(robot.name, part);
        Self {
            body: Rows::new(part("body")),
            heading: Rows::new(part("heading")),
            trail: Rows::new(part("trail")),
            way: Trail::new(robot.name, robot.is_curious),
            last: None,
        }
    }

    fn push(&mut self, now: Now, robot: &RobotView) {
        if self.last != Some(robot.pose) {
            self.last = Some(robot.pose);
            let at = Point2::from(robot.pose.translation.vector);
            let nose = robot.pose * nalgebra::Vector2::new(1.4 * robot.radius_m, 0.0);
            self.body.push(now, [place(&at)]);
            self.heading.push(now, [Arrow { origin: place(&at), vector: [nose.x as f32, nose.y as f32] }]);
            if self.way.push(at)
                && let [.., from, to] = self.way.points()
            {
                self.trail.push(now, [Strip(vec![place(from), place(to)])]);
            }
        }
    }
}

/// A map and the classes that were logged last.
struct Map {
    layer: Layer,
    rows: Rows<Classes>,
    last: Vec<u8>,
}

impl Map {
    fn new(layer: Layer) -> Self {
        Self { layer, rows: Rows::new(format!("{}/cells", entity::map(layer))), last: Vec::new() }
    }

    fn push(&mut self, now: Now, view: &View, unit: TimeUnit) {
        let classes = self.layer.classes(view.mapper, unit);
        if classes != self.last {
            self.rows.push(now, [Classes(classes.clone())]);
            self.last = classes;
        }
    }
}

/// All rows of a recording.
pub(super) struct Tracks {
    unit: TimeUnit,
    robots: Vec<Robot>,
    sight: sight::Track,
    /// Each with the outline that was logged last, without corners while it is not there.
    obstacles: Vec<(Rows<Strip>, Vec<Point2<f64>>)>,
    path: (Rows<Strip>, Vec<Point2<f64>>),
    goal: (Rows<Place>, Option<Point2<f64>>),
    occupancy: Map,
    maps: [Map; 3],
    /// Coverage, map quality.
    scores: [Rows<f64>; 2],
    /// Relative, of the logarithm.
    rate_errors: [Rows<f64>; 2],
    /// p, r.
    features: [Rows<f64>; 2],
    /// Value and share of each strategy.
    strategies: Vec<[Rows<f64>; 2]>,
    strategy: (Rows<State>, String),
    log: Rows<Line>,
    occupancy_due: Due,
    maps_due: Due,
    curves_due: Due,
    scores_due: Due,
    rate_errors_due: Due,
}

impl Tracks {
    /// Tracks for everyone who takes part in `view`.
    pub(super) fn new(view: &View, unit: TimeUnit) -> Self {
        let (pace, map) = (Pace::of(unit), view.mapper.frame());
        let curves =
            |name: &str| [entity::VALUES, entity::SHARES].map(|of| Rows::new(entity::strategy(of, name)));
        Self {
            unit,
            robots: view.robots.iter().map(Robot::new).collect(),
            sight: sight::Track::new(view, &pace),
            obstacles: view
                .obstacles
                .iter()
                .map(|thing| (Rows::new(entity::obstacle(thing.name)), Vec::new()))
                .collect(),
            path: (Rows::new(entity::PATH), Vec::new()),
            goal: (Rows::new(entity::GOAL), None),
            occupancy: Map::new(Layer::Occupancy),
            maps: [Layer::Interval, Layer::ChangeProbability, Layer::Recency].map(Map::new),
            scores: [entity::COVERAGE, entity::MAP_QUALITY].map(Rows::new),
            rate_errors: [entity::RELATIVE_ERROR, entity::LOG_ERROR].map(Rows::new),
            features: [entity::P, entity::R].map(Rows::new),
            strategies: view.strategies.iter().map(|strategy| curves(strategy.name)).collect(),
            strategy: (Rows::new(entity::STRATEGY), String::new()),
            log: Rows::new(entity::LOG),
            occupancy_due: Due::every(pace.picture(pace.occupancy, map)),
            maps_due: Due::every(pace.picture(pace.maps, map)),
            curves_due: Due::every(pace.curves),
            scores_due: Due::every(pace.curves),
            rate_errors_due: Due::every(pace.curves),
        }
    }

    /// Appends what is due now; everything in the last view.
    pub(super) fn push(&mut self, view: &View, is_last: bool) {
        let now = Now { time: view.time, step: view.step };
        for (track, robot) in self.robots.iter_mut().zip(view.robots) {
            track.push(now, robot);
        }
        self.sight.push(now, view, is_last);
        for ((track, last), thing) in self.obstacles.iter_mut().zip(view.obstacles) {
            let outline = if thing.is_present { thing.outline } else { &[] };
            if last != outline {
                *last = outline.to_vec();
                let closed = outline.iter().chain(outline.first());
                track.push(now, thing.is_present.then(|| Strip(closed.map(place).collect())));
            }
        }
        if self.path.1 != view.path {
            self.path.1 = view.path.to_vec();
            self.path
                .0
                .push(now, (view.path.len() > 1).then(|| Strip(view.path.iter().map(place).collect())));
        }
        if self.goal.1 != view.goal {
            self.goal.1 = view.goal;
            self.goal.0.push(now, view.goal.as_ref().map(place));
        }
        if let Some(current) = view.strategies.iter().find(|strategy| strategy.is_current)
            && current.name != self.strategy.1
        {
            self.strategy.1 = current.name.into();
            self.strategy.0.push(now, [State(current.name.into())]);
        }
        for message in view.messages {
            let level = match message.level {
                Level::Decision => rerun::TextLogLevel::INFO,
                Level::Event => rerun::TextLogLevel::WARN,
                Level::Trouble => rerun::TextLogLevel::ERROR,
            };
            self.log.push(now, [Line { text: message.text.clone(), level }]);
        }
        self.push_maps(now, view, is_last);
        self.push_curves(now, view, is_last);
    }

    fn push_maps(&mut self, now: Now, view: &View, is_last: bool) {
        if self.occupancy_due.now(view.time) || is_last {
            self.occupancy.push(now, view, self.unit);
        }
        if self.maps_due.now(view.time) || is_last {
            for map in &mut self.maps {
                map.push(now, view, self.unit);
            }
        }
    }

    fn push_curves(&mut self, now: Now, view: &View, is_last: bool) {
        if self.curves_due.now(view.time) || is_last {
            let [p, r] = &mut self.features;
            p.push(now, [view.features.p]);
            r.push(now, [view.features.r]);
            for ([value, share], strategy) in self.strategies.iter_mut().zip(view.strategies) {
                value.push(now, [strategy.value]);
                share.push(now, [strategy.share]);
            }
        }
        if let Some(scores) = view.scores
            && (self.scores_due.now(view.time) || is_last)
        {
            let [coverage, map_quality] = &mut self.scores;
            coverage.push(now, [scores.coverage]);
            map_quality.push(now, [scores.map_quality]);
        }
        if let Some(errors) = view.rate_errors.filter(|errors| !errors.log.is_nan())
            && (self.rate_errors_due.now(view.time) || is_last)
        {
            let [relative, log] = &mut self.rate_errors;
            relative.push(now, [errors.relative]);
            log.push(now, [errors.log]);
        }
    }

    /// Hands everything over.
    pub(super) fn flush(&mut self, stream: &RecordingStream) -> Result<(), String> {
        fn all<'a, T: Item + 'a>(
            rows: impl IntoIterator<Item = &'a mut Rows<T>>,
            to: (&RecordingStream, TimeUnit),
        ) -> Result<(), String> {
            rows.into_iter().try_for_each(|rows| rows.flush(to.0, to.1))
        }
        let to = (stream, self.unit);
        for robot in &mut self.robots {
            all([&mut robot.body], to)?;
            all([&mut robot.heading], to)?;
            all([&mut robot.trail], to)?;
        }
        self.sight.flush(stream, self.unit)?;
        let obstacles = self.obstacles.iter_mut().map(|(rows, _)| rows);
        all(obstacles.chain([&mut self.path.0]), to)?;
        all([&mut self.goal.0], to)?;
        all(self.maps.iter_mut().chain([&mut self.occupancy]).map(|map| &mut map.rows), to)?;
        let strategies = self.strategies.iter_mut().flatten();
        all(strategies.chain(&mut self.scores).chain(&mut self.rate_errors).chain(&mut self.features), to)?;
        all([&mut self.strategy.0], to)?;
        all([&mut self.log], to)
    }
}

pub(super) fn place(point: &Point2<f64>) -> Place {
    [point.x as f32, point.y as f32]
}
