//! The curves over time, and the strategy that chose the goal.

use super::{Kind, ON_CHANGE, Tracks, color, escape};
use draw::palette::{self, Rgb};
use draw::view::View;
use localizer::PoseState;
use rerun::{RecordingStreamResult, Scalars, SeriesLines, StateChange, StateConfiguration};
use robot::StrategyState;

/// The strategy that chose the goal.
pub(in crate::recording) const STRATEGY: &str = "/curves/strategy";

/// A panel with curves.
pub(in crate::recording) struct Plot {
    /// The title of the panel.
    pub(in crate::recording) title: &'static str,
    /// The entity above the curves.
    pub(in crate::recording) path: &'static str,
    /// What the axis of values spans, unless it follows the values.
    pub(in crate::recording) range: Option<[f64; 2]>,
    curves: Vec<Curve>,
}

struct Curve {
    /// The part of the path.
    part: String,
    name: String,
    color: Rgb,
    value: Box<Value>,
}

/// The value of a curve at one instant; `None` where it has none.
type Value = dyn Fn(&View) -> Option<f64> + Send;

/// A share of something: the axis ends a little above 1, so that a curve at 1 is visible.
const SHARE: Option<[f64; 2]> = Some([0.0, 1.05]);

/// The panels for a run whose first view is `view`. A panel without any curve to come is left out.
pub(in crate::recording) fn plots(view: &View) -> Vec<Plot> {
    let curve = |part: &str, name: &str, color: Rgb, value: fn(&View) -> Option<f64>| Curve {
        part: part.to_owned(),
        name: name.to_owned(),
        color,
        value: Box::new(value),
    };
    let mut plots = Vec::new();
    let mut plot = |title, path, range, curves| {
        plots.push(Plot { title, path, range, curves });
    };
    if view.measured.coverage_and_quality.is_some() {
        let coverage = curve("coverage", "coverage: cells that were seen", palette::SENSOR, |view| {
            Some(view.measured.coverage_and_quality?[0])
        });
        let quality = curve("map_quality", "quality: cells that are correct", palette::PATH, |view| {
            Some(view.measured.coverage_and_quality?[1])
        });
        plot("Map: coverage and quality", "/curves/scores", SHARE, vec![coverage, quality]);
    }
    if let Some(belief) = view.belief {
        let error = curve("error", "true error", palette::GOAL, |view| Some(1000.0 * view.error_m()?));
        let mut curves = vec![error];
        if belief.estimate.is_some() {
            curves.push(curve("deviation", "standard deviation", palette::SENSOR, |view| {
                Some(1000.0 * view.belief?.estimate.as_ref()?.position_std_m())
            }));
            let support = curve("support", "share of the scan that fits the map", palette::PATH, |view| {
                Some(view.belief?.estimate.as_ref()?.support)
            });
            let certain = curve("certain", "the pose is certain", palette::OTHER_ROBOT, |view| {
                let state = view.belief?.estimate.as_ref()?.state;
                Some(if state == PoseState::Tracking { 1.0 } else { 0.0 })
            });
            plot("Localization: support", "/curves/support", SHARE, vec![support, certain]);
        }
        plot("Localization: error of the position (mm)", "/curves/pose_error", None, curves);
    }
    let expected = curve("p", "changes expected out of view", palette::GOAL, |view| Some(view.features.p));
    plot("Changes expected out of view", "/curves/expected_changes", None, vec![expected]);
    let oldest = curve("r", "longest time", palette::OTHER_ROBOT, |view| Some(view.features.r));
    plot("Longest time since a cell was seen (s)", "/curves/longest_unseen", None, vec![oldest]);
    if has_choice(view) {
        // A strategy about which nothing was learned has the value 0.
        let values = of_strategies(view, |strategy| strategy.value.unwrap_or(0.0));
        plot("Strategies: expected map updates per step", "/curves/strategy_value", None, values);
        let shares = of_strategies(view, |strategy| strategy.share);
        plot("Strategies: share of the goals", "/curves/strategy_share", SHARE, shares);
    }
    plots
}

/// A curve for each strategy.
fn of_strategies(view: &View, value: fn(&StrategyState) -> f64) -> Vec<Curve> {
    let curve = |(index, strategy): (usize, &StrategyState)| Curve {
        part: escape(&strategy.name),
        name: strategy.name.clone(),
        color: palette::strategy(&strategy.name),
        value: Box::new(move |view| view.strategies.get(index).map(value)),
    };
    view.strategies.iter().enumerate().map(curve).collect()
}

/// Whether there are strategies to choose from.
pub(in crate::recording) fn has_choice(view: &View) -> bool {
    view.strategies.len() > 1
}

pub(super) fn add(tracks: &mut Tracks) -> RecordingStreamResult<()> {
    let (view, when) = (tracks.view, (Kind::Events, 1.0));
    for plot in plots(view) {
        for Curve { part, name, color: own, value } in plot.curves {
            let path = format!("{}/{part}", plot.path);
            let line = SeriesLines::new()
                .with_names([name])
                .with_colors([color(palette::on_dark(own), 255)])
                .with_widths([2.0]);
            tracks.always(&path, &line)?;
            let value = move |view: &View| value(view).into_iter().filter(|value| !value.is_nan()).collect();
            tracks.add(path, when, value, |values| Scalars::update_fields().with_scalars(values));
        }
    }
    if has_choice(view) {
        let names = || view.strategies.iter().map(|strategy| strategy.name.as_str());
        let colors = names().map(|name| color(palette::on_dark(palette::strategy(name)), 255));
        tracks.always(STRATEGY, &StateConfiguration::new().with_values(names()).with_colors(colors))?;
        let current = |view: &View| {
            let current = view.strategies.iter().filter(|strategy| strategy.is_current);
            current.map(|strategy| strategy.name.clone()).collect()
        };
        tracks.add(STRATEGY, ON_CHANGE, current, |names| StateChange::update_fields().with_state(names));
    }
    Ok(())
}
