//! The curves of a metric, one per strategy.

use crate::is_reference;
use crate::statistics::Estimate;
use crate::strategy::StrategyResult;
use draw::canvas::{Drawn, INK, ink, why};
use draw::palette;
use draw::pen::{Pen, Sheet};
use evaluation::trials::Length;
use evaluation::trials::Metric;
use plotters::chart::ChartContext;
use plotters::coord::CoordTranslate;
use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;
use results::numbers::thousands;
use std::ops::Range;

/// The width of the labels at the left, in pixels of the finished picture.
const LEFT: i32 = 58;
/// The opacity of a band.
pub(super) const BAND: f64 = 0.16;
const GRID: RGBColor = RGBColor(225, 228, 233);
/// The axis of values ignores this first part of a run, in which nothing is known yet.
const BEGINNING: f64 = 0.03;
/// A logarithmic axis of times starts at this part of a run.
const EARLIEST: f64 = 0.003;

type Chart<'a, DB> = ChartContext<'a, DB, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Draws the axes and the curves of `metric`: means over bands, the first strategy on top.
///
/// Times are on a line, as in the paper; for the log error on a logarithmic one, since most is
/// learned early.
pub(super) fn draw<DB: DrawingBackend>(
    sheet: &Sheet<DB>,
    pen: &Pen,
    metric: Metric,
    length: Length,
    strategies: &[StrategyResult],
) -> Drawn {
    let times = strategies.first().map_or(&[][..], |strategy| &strategy.times);
    let horizon = times.last().copied().unwrap_or(0).max(1) as f64;
    let before = |part: f64| times.iter().take_while(|&&time| (time as f64) < part * horizon).count();
    let is_log = metric == Metric::LogError;
    let (first, settled) = if is_log { (before(EARLIEST), before(EARLIEST)) } else { (0, before(BEGINNING)) };
    let position = |time: f64| if is_log { libm::log10(time.max(1.0)) } else { time };
    let positions: Vec<f64> = times[first..].iter().map(|&time| position(time as f64)).collect();
    let reach =
        if is_log { positions.first().copied().unwrap_or(0.0) } else { 0.0 }..position(horizon).max(1e-9);
    let curve = |strategy: &StrategyResult| strategy.curve(metric)[first..].to_vec();
    let shown = range(metric, strategies.iter().flat_map(|strategy| &strategy.curve(metric)[settled..]));
    let time_label = |position: &f64| match is_log {
        false => thousands(*position as u64),
        // Between the powers of ten there are only lines.
        true if (position - position.round()).abs() > 1e-6 => String::new(),
        true => thousands(libm::exp10(*position).round() as u64),
    };

    let (above, _) = sheet.split_vertically(pen.px(34));
    pen.write(&above, (pen.px(LEFT), pen.px(18)), HPos::Left, 17, heading(metric))?;
    let mut chart = ChartBuilder::on(sheet)
        .margin_top(pen.px(34))
        .margin_right(pen.px(14))
        .x_label_area_size(pen.px(44))
        .y_label_area_size(pen.px(LEFT))
        .build_cartesian_2d(reach, shown.clone())
        .map_err(why)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(pen.line(GRID, 1))
        .x_labels(6)
        .y_labels(6)
        .x_label_formatter(&time_label)
        .y_label_formatter(&|value| format!("{}", (value * 1e4).round() / 1e4))
        .label_style(pen.text(15))
        .axis_desc_style(pen.text(15))
        .axis_style(pen.line(INK, 1))
        .set_all_tick_mark_size(pen.px(4))
        .x_desc(format!(
            "{}{}",
            length.choose("steps", "simulated time, s"),
            if is_log { ", logarithmic" } else { "" }
        ))
        .draw()
        .map_err(why)?;
    for strategy in strategies.iter().rev() {
        band(&chart, &positions, &curve(strategy), &shown, ink(palette::strategy(&strategy.name)))?;
    }
    // Dashed curves lie on top: the curve of a coin can be equal to that of curious.
    for dashed in [false, true] {
        let those = strategies.iter().rev().filter(|strategy| is_dashed(&strategy.name) == dashed);
        for strategy in those {
            let style = pen.line(ink(palette::strategy(&strategy.name)), 2);
            for line in lines(&positions, &curve(strategy), &shown) {
                draw_line(chart.plotting_area(), pen, line, style, dashed)?;
            }
        }
    }
    Ok(())
}

/// Whether a strategy's curve is dashed: the strategies to compare with.
pub(super) fn is_dashed(name: &str) -> bool {
    ["random", "coin"].contains(&name) || is_reference(name)
}

/// Draws a line, dashed or not.
pub(super) fn draw_line<DB: DrawingBackend, C: CoordTranslate>(
    area: &DrawingArea<DB, C>,
    pen: &Pen,
    line: Vec<C::From>,
    style: ShapeStyle,
    is_dashed: bool,
) -> Drawn
where
    C::From: Clone,
{
    if is_dashed {
        area.draw(&DashedPathElement::new(line, pen.px(7), pen.px(4), style)).map_err(why)
    } else {
        area.draw(&PathElement::new(line, style)).map_err(why)
    }
}

fn heading(metric: Metric) -> &'static str {
    match metric {
        Metric::RateError => "Relative error of the rates",
        Metric::LogError => "Log error of the rates: 0.69 is a factor of 2",
        Metric::MapQuality => "Map correct: share of cells",
        Metric::MapQualityChanging => "Map correct: changing cells, blocked and free ones alike",
        Metric::RateAuc => "AUC of the rates: changing cells against static cells",
        other => other.name(),
    }
}

/// What the axis spans: errors from 0, map correct up to 1.
fn range<'a>(metric: Metric, settled: impl Iterator<Item = &'a Estimate>) -> Range<f64> {
    let means = settled.map(|at| at.mean).filter(|mean| mean.is_finite());
    let (low, high) =
        means.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), mean| (low.min(mean), high.max(mean)));
    if low > high {
        return 0.0..1.0;
    }
    match metric {
        Metric::MapQuality | Metric::MapQualityChanging | Metric::RateAuc => {
            let span = (1.0 - low).max(0.001);
            1.0 - 1.15 * span..1.0 + 0.05 * span
        }
        _ => 0.0..(1.1 * high).max(0.001),
    }
}

/// The band between the ends of the intervals, cut to what is shown.
fn band<DB: DrawingBackend>(
    chart: &Chart<DB>,
    positions: &[f64],
    curve: &[Estimate],
    shown: &Range<f64>,
    color: RGBColor,
) -> Drawn {
    let is_known = |at: &Estimate| at.low.is_finite() && at.high.is_finite();
    let known: Vec<(f64, &Estimate)> =
        positions.iter().copied().zip(curve).filter(|(_, at)| is_known(at)).collect();
    let cut = |value: f64| value.clamp(shown.start, shown.end);
    let upper = known.iter().map(|(position, at)| (*position, cut(at.high)));
    let lower = known.iter().rev().map(|(position, at)| (*position, cut(at.low)));
    let outline: Vec<(f64, f64)> = upper.chain(lower).collect();
    if known.len() < 2 {
        return Ok(());
    }
    chart.plotting_area().draw(&Polygon::new(outline, color.mix(BAND).filled())).map_err(why)
}

/// The mean as lines: broken where it is outside of what is shown, and where there is no mean.
fn lines(positions: &[f64], curve: &[Estimate], shown: &Range<f64>) -> Vec<Vec<(f64, f64)>> {
    let points: Vec<(f64, f64)> =
        positions.iter().zip(curve).map(|(&position, at)| (position, at.mean)).collect();
    let is_shown = |(_, mean): &(f64, f64)| (shown.start..=shown.end).contains(mean);
    let runs = points.chunk_by(|a, b| is_shown(a) && is_shown(b));
    runs.filter(|run| is_shown(&run[0])).map(<[_]>::to_vec).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_breaks_beyond_the_axis_and_where_nothing_is_known() {
        let at = |mean| Estimate { count: 1, mean, low: f64::NAN, high: f64::NAN };
        let curve = [2.0, 1.0, 0.25, f64::NAN, 0.5, 1.5, 3.0].map(at);
        let found = lines(&[0.0, 3.0, 4.0, 5.0, 6.0, 8.0, 9.0], &curve, &(0.0..1.0));
        assert_eq!(found, [vec![(3.0, 1.0), (4.0, 0.25)], vec![(6.0, 0.5)]]);
    }

    #[test]
    fn the_beginning_does_not_stretch_an_axis() {
        let at = |mean| Estimate { count: 1, mean, low: f64::NAN, high: f64::NAN };
        let settled = [at(0.9), at(0.98), at(f64::NAN)];
        let quality = range(Metric::MapQuality, settled.iter());
        assert!((0.88..0.9).contains(&quality.start) && (1.0..1.01).contains(&quality.end), "{quality:?}");
        assert_eq!(range(Metric::LogError, settled.iter()), 0.0..1.1 * 0.98);
        assert_eq!(range(Metric::LogError, settled[2..].iter()), 0.0..1.0);
    }
}
