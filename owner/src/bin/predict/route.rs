//! A route, and a graph of routes, at the times of arrival.

use anyhow::{Context, Result, bail, ensure};
use interfaces::FARTHEST_M;
use nalgebra::Point2;
use serde::Serialize;
use serde_json::Value;
use std::path::Path;
use survey::{Forecast, RouteGraph, Travel};

/// The most points of a route: those of three hours at 10 Hz, which take a few seconds.
const MAX_POINTS: usize = 100_000;

/// What is less probably in the way is not worth a word.
const MIN_BLOCKED: f64 = 0.05;

/// A point of a route.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Stop {
    pub(crate) x_m: f64,
    pub(crate) y_m: f64,
    /// The distance along the route, m.
    #[serde(skip)]
    pub(crate) way_m: f64,
    /// The time of arrival, s.
    pub(crate) time_s: f64,
    /// The probability that the way to it is blocked then; `null` if it was never seen.
    pub(crate) blocked: Option<f64>,
}

/// The points of a route, and what it meets, with the distances along the route, m.
type Route = (Vec<Stop>, Vec<survey::Stop>);

/// The points of the route in a file, and what it meets: a line for each, with x and y (m), or with time (s), x and y, as in a TUM trajectory.
pub(crate) fn route(path: &Path, forecast: &Forecast, travel: Travel) -> Result<Route> {
    let text = files::read_text(path, RouteGraph::MAX_BYTES)
        .with_context(|| format!("{}: cannot read it", path.display()))?;
    let mut points: Vec<(Option<f64>, Point2<f64>)> = Vec::new();
    for (number, line) in (1..).zip(text.lines().map(str::trim)) {
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let values = line.split([',', ' ', '\t', ';']).filter(|word| !word.is_empty());
        let numbers: Result<Vec<f64>, _> = values.map(str::parse::<f64>).collect();
        match numbers.as_deref() {
            Ok([x, y]) => points.push((None, Point2::new(*x, *y))),
            Ok([time_s, x, y, ..]) => points.push((Some(*time_s), Point2::new(*x, *y))),
            Err(_) if points.is_empty() => {} // the names of the columns
            _ => bail!("{}, line {number}: a point is `x y` or `time x y`, as in 1.5 2.0", path.display()),
        }
        let Some((time_s, at)) = points.last() else { continue };
        let line = || format!("{}, line {number}", path.display());
        ensure!(
            points.len() <= MAX_POINTS,
            "{}: a route has at most {MAX_POINTS} points; leave some out",
            line()
        );
        ensure!(
            at.iter().all(|at_m| at_m.abs() <= FARTHEST_M),
            "{}: x and y must be numbers from -{FARTHEST_M} to {FARTHEST_M} m, found {} and {}",
            line(),
            at.x,
            at.y
        );
        let before_s = points.iter().rev().nth(1).and_then(|(time_s, _)| *time_s);
        ensure!(
            time_s.is_none_or(|time_s| time_s.is_finite() && before_s.is_none_or(|before_s| time_s >= before_s)),
            "{}: a time must be a finite number of seconds, not before that of the point before, found {}",
            line(),
            time_s.unwrap_or_default()
        );
    }
    ensure!(points.len() >= 2, "{}: a route needs at least two points", path.display());
    let (begin_s, mut stops, mut met) = (points[0].0, Vec::<Stop>::new(), Vec::<survey::Stop>::new());
    // Points can be nearer than the body is wide: a route is looked at in pieces of at least its radius, or of ten seconds.
    let mut looked = (points[0].1, 0.0, travel.departure_s);
    let piece_m = travel.radius_m.max(forecast.mapper().frame().resolution_m());
    let last = points.len() - 1;
    for (number, (own_s, at)) in points.into_iter().enumerate() {
        let (before, way_m, from_s) = match stops.last() {
            Some(last) => (Point2::new(last.x_m, last.y_m), last.way_m, last.time_s),
            None => (at, 0.0, travel.departure_s),
        };
        let length_m = (at - before).norm();
        let time_s = match own_s.zip(begin_s) {
            Some((own_s, begin_s)) => travel.departure_s + own_s - begin_s,
            None => from_s + length_m / travel.speed_m_s,
        };
        let (begin, way_m, end_m, from_s) = (looked.0, looked.1, way_m + length_m, looked.2);
        let ahead = (at - begin).norm();
        if number > 0 && number < last && ahead < piece_m && time_s < looked.2 + 10.0 {
            let blocked = stops.last().and_then(|stop| stop.blocked);
            stops.push(Stop { x_m: at.x, y_m: at.y, way_m: end_m, time_s, blocked });
            continue;
        }
        looked = (at, end_m, time_s);
        let arrival_s = |ahead_m: f64| from_s + (time_s - from_s) * ahead_m / ahead.max(1e-9);
        let found = forecast.outlook().stops([begin, at], travel.radius_m, arrival_s);
        let blocked = found.as_ref().map(|found| found.iter().fold(0.0, |most, stop| stop.blocked.max(most)));
        stops.push(Stop { x_m: at.x, y_m: at.y, way_m: end_m, time_s, blocked });
        for stop in found.into_iter().flatten() {
            let stop = survey::Stop { ways_m: stop.ways_m.map(|ahead_m| way_m + ahead_m), ..stop };
            // Each thing once, where it is most probably in the way.
            match met.iter_mut().find(|known| known.is_same(&stop)) {
                Some(known) if known.continues(&stop) => known.join(stop),
                Some(known) if stop.blocked <= known.blocked => {}
                Some(known) => *known = stop,
                None => met.push(stop),
            }
        }
    }
    met.retain(|stop| stop.blocked >= MIN_BLOCKED);
    Ok((stops, met))
}

/// The graph of routes in a file, with the probability that each edge is open at the time of arrival.
pub(crate) fn graph(path: &Path, forecast: &Forecast, travel: Travel, from: Option<u64>) -> Result<Value> {
    let name = path.display();
    let text =
        files::read_text(path, RouteGraph::MAX_BYTES).with_context(|| format!("{name}: cannot read it"))?;
    let graph =
        RouteGraph::parse(&text).with_context(|| format!("{name}: this is no graph of nav2_route"))?;
    let edges = graph.outlook(&forecast.outlook(), travel, from)?;
    Ok(graph.with(&edges))
}
