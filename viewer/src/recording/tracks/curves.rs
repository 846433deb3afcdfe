//! The curves over time, and the strategy that chose the goal.

use super::{Start, Track, color};
use crate::recording::pace::Due;
use crate::recording::path;
use crate::recording::rows::{Now, Rows, State, Target};
use crate::scene::Scene;
use crate::view::View;
use evaluation::palette::{self, Rgb};
use rerun::{RecordingStreamResult, SeriesLines, StateConfiguration};

/// A panel with curves.
pub(in crate::recording) struct Plot {
    /// The title of the panel.
    pub(in crate::recording) title: String,
    /// The entity above the curves.
    pub(in crate::recording) entity: &'static str,
    /// What the axis of values spans, unless it follows the values.
    pub(in crate::recording) range: Option<[f64; 2]>,
    curves: Vec<Curve>,
}

struct Curve {
    /// The part of the path.
    path: String,
    name: String,
    color: Rgb,
    value: Box<dyn Fn(&View) -> Option<f64> + Send>,
}

/// A share of something: the axis ends a little above 1, so that a curve at 1 is visible.
const SHARE: Option<[f64; 2]> = Some([0.0, 1.05]);

/// The panels for a run whose first view is `view`. A panel without any curve to come is left out.
pub(in crate::recording) fn plots(scene: &Scene, view: &View) -> Vec<Plot> {
    let curve = |path: &str, name: &str, color: Rgb, value: fn(&View) -> Option<f64>| Curve {
        path: path.to_owned(),
        name: name.to_owned(),
        color,
        value: Box::new(value),
    };
    let plot = |title: &str, entity, range, curves| Plot { title: title.to_owned(), entity, range, curves };
    let mut plots = Vec::new();
    if view.measured.scores.is_some() {
        let coverage = curve("coverage", "coverage: cells that were seen", palette::SENSOR, |view| {
            Some(view.measured.scores?.coverage)
        });
        let quality = curve("map_quality", "quality: cells that are correct", palette::PATH, |view| {
            Some(view.measured.scores?.map_quality)
        });
        plots.push(plot("Map: coverage and quality", "/curves/scores", SHARE, vec![coverage, quality]));
    }
    if view.measured.rate_errors.is_some() && !scene.obstacles.is_empty() {
        let relative = curve("relative", "relative error", palette::MOVING, |view| {
            Some(view.measured.rate_errors?.relative)
        });
        let log = curve("log", "log error", palette::GOAL, |view| Some(view.measured.rate_errors?.log));
        plots.push(plot("Errors of the rates of change", "/curves/rate_errors", None, vec![relative, log]));
    }
    let expected = curve("p", "changes expected out of view", palette::GOAL, |view| Some(view.features.p));
    plots.push(plot("Changes expected out of view", "/curves/expected_changes", None, vec![expected]));
    let unit = scene.unit.symbol();
    let oldest = curve("r", "longest time", palette::OTHER_ROBOT, |view| Some(view.features.r));
    let title = format!("Longest time since a cell was seen ({unit})");
    plots.push(plot(&title, "/curves/longest_unseen", None, vec![oldest]));
    if has_choice(view) {
        let each = |value: fn(&View, usize) -> Option<f64>| {
            let curve = |(index, strategy): (usize, &robot::StrategyState)| Curve {
                path: path::escape(&strategy.name),
                name: strategy.name.clone(),
                color: palette::strategy(&strategy.name),
                value: Box::new(move |view| value(view, index)),
            };
            view.strategies.iter().enumerate().map(curve).collect::<Vec<_>>()
        };
        // A strategy about which nothing was learned has the value 0.
        let values = each(|view, index| Some(view.strategies.get(index)?.value.unwrap_or(0.0)));
        let shares = each(|view, index| Some(view.strategies.get(index)?.share));
        let title = "Strategies: expected map updates per step";
        plots.push(plot(title, "/curves/strategy_value", None, values));
        plots.push(plot("Strategies: share of the goals", "/curves/strategy_share", SHARE, shares));
    }
    plots
}

/// Whether there are strategies to choose from.
pub(in crate::recording) fn has_choice(view: &View) -> bool {
    view.strategies.len() > 1
}

pub(super) struct Curves {
    plots: Vec<(Plot, Vec<Rows<f64>>, Due)>,
    /// The strategy that chose the goal, with the name that was logged last.
    strategy: (Rows<State>, String),
}

impl Curves {
    pub(super) fn new(start: Start) -> RecordingStreamResult<Self> {
        let mut tracks = Vec::new();
        for plot in plots(start.scene, start.view) {
            let mut rows = Vec::new();
            for curve in &plot.curves {
                let entity = format!("{}/{}", plot.entity, curve.path);
                let look = SeriesLines::new()
                    .with_names([curve.name.as_str()])
                    .with_colors([color(palette::on_dark(curve.color), 255)])
                    .with_widths([2.0]);
                start.stream.log_static(entity.as_str(), &look)?;
                rows.push(Rows::new(entity));
            }
            tracks.push((plot, rows, Due::every(start.pace.curves)));
        }
        let names = || start.view.strategies.iter().map(|strategy| strategy.name.as_str());
        if has_choice(start.view) {
            let look = StateConfiguration::new()
                .with_values(names())
                .with_colors(names().map(|name| color(palette::on_dark(palette::strategy(name)), 255)));
            start.stream.log_static(path::STRATEGY, &look)?;
        }
        Ok(Self { plots: tracks, strategy: (Rows::new(path::STRATEGY), String::new()) })
    }
}

impl Track for Curves {
    fn push(&mut self, now: Now, view: &View, is_last: bool) {
        for (plot, rows, due) in &mut self.plots {
            let values: Vec<Option<f64>> = plot.curves.iter().map(|curve| (curve.value)(view)).collect();
            let is_known = values.iter().flatten().any(|value| !value.is_nan());
            if is_known && (due.now(view.time) || is_last) {
                for (rows, value) in rows.iter_mut().zip(values) {
                    rows.push(now, value);
                }
            }
        }
        let current = view.strategies.iter().find(|strategy| strategy.is_current);
        if let Some(current) = current.filter(|current| has_choice(view) && current.name != self.strategy.1) {
            self.strategy.1.clone_from(&current.name);
            self.strategy.0.push(now, [State(current.name.clone())]);
        }
    }

    fn flush(&mut self, to: Target) -> RecordingStreamResult<()> {
        for (_, rows, _) in &mut self.plots {
            rows.iter_mut().try_for_each(|rows| rows.flush(to))?;
        }
        self.strategy.0.flush(to)
    }
}
