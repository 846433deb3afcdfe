//! The figure of the page: where curiosity pays.

use super::table::{Ratio, Row, ratios};
use draw::canvas::{Drawn, INK, ink, why};
use draw::palette::{self, Rgb};
use draw::pen::{Pen, Sheet, svg};
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

/// The series: a strategy, whether it was measured, its name in the legend, and its color.
const SERIES: [(&str, bool, &str, Rgb); 4] = [
    ("fresh-map", false, "fresh-map, predicted", palette::SENSOR),
    ("fresh-map", true, "fresh-map, measured with a laser", palette::CURIOUS),
    ("oracle", false, "oracle (true rates), predicted", palette::PATH),
    ("oracle", true, "oracle, measured", palette::GOAL),
];
/// Ratios on the axis, from left to right, and their positions, px.
const AXIS: [f64; 7] = [0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1];
const AXIS_PX: [i32; 2] = [470, 860];
const ROW_PX: i32 = 34;
const TOP_PX: i32 = 120;
const TEXT_PX: i32 = 13;
/// Half of the 95 % interval, in standard errors.
const WIDE: f64 = 1.96;

fn at_px(pen: &Pen, ratio: f64) -> i32 {
    let part = ((ratio - AXIS[0]) / (AXIS[AXIS.len() - 1] - AXIS[0])).clamp(-0.02, 1.02);
    pen.px(AXIS_PX[0]) + (part * f64::from(pen.px(AXIS_PX[1] - AXIS_PX[0]))) as i32
}

/// For every setting the ratio of the Brier score of fresh-map, and of the oracle, to that of the best of recency, curious and coverage,
/// with intervals of 95 %: the text of an SVG file.
///
/// # Errors
///
/// As of the plotting library.
pub fn figure(predicted: &[Row], measured: &[Row]) -> Drawn<String> {
    let of_both = [ratios(predicted), ratios(measured)];
    let mut settings: Vec<&str> = Vec::new();
    for (setting, ..) in of_both.iter().flatten() {
        if !settings.contains(&setting.as_str()) {
            settings.push(setting);
        }
    }
    let bottom = TOP_PX + ROW_PX * settings.len() as i32;
    let pen = Pen::VECTOR;
    svg([900, (bottom + 50) as u32], |sheet| {
        sheet.fill(&WHITE).map_err(why)?;
        let title = "Brier score / that of the best of recency, curious and coverage";
        pen.write(sheet, (pen.px(20), pen.px(22)), HPos::Left, 15, title)?;
        for (number, (_, _, name, color)) in SERIES.iter().enumerate() {
            let (x, y) = (20 + 300 * (number as i32 / 2), 50 + 22 * (number as i32 % 2));
            pen.dot(sheet, (pen.px(x + 6), pen.px(y)), *color)?;
            pen.write(sheet, (pen.px(x + 18), pen.px(y)), HPos::Left, TEXT_PX, name)?;
        }
        for ratio in AXIS {
            let x = at_px(&pen, ratio);
            let width = if ratio == 1.0 { 2 } else { 1 };
            let ends = [(x, pen.px(TOP_PX - 12)), (x, pen.px(bottom))];
            let style =
                if ratio == 1.0 { pen.line(INK, width) } else { pen.line(ink(palette::UNKNOWN), width) };
            sheet.draw(&PathElement::new(ends, style)).map_err(why)?;
            pen.write(sheet, (x, pen.px(bottom + 16)), HPos::Center, TEXT_PX, &format!("{ratio:.1}"))?;
        }
        for (row, setting) in settings.iter().enumerate() {
            let y = TOP_PX + ROW_PX * row as i32 + ROW_PX / 2;
            pen.write(sheet, (pen.px(20), pen.px(y)), HPos::Left, TEXT_PX, setting)?;
            for (number, (strategy, is_measured, _, color)) in SERIES.iter().enumerate() {
                let rows = &of_both[usize::from(*is_measured)];
                let found = rows.iter().find(|(of, name, ..)| of == setting && name == strategy);
                if let Some((.., ratio)) = found {
                    interval(&pen, sheet, y - 9 + 6 * number as i32, ratio, *color)?;
                }
            }
        }
        Ok(())
    })
}

fn interval<DB: DrawingBackend>(pen: &Pen, sheet: &Sheet<DB>, y: i32, ratio: &Ratio, color: Rgb) -> Drawn {
    let y = pen.px(y);
    if ratio.standard_error.is_finite() {
        let ends = [-WIDE, WIDE].map(|wide| (at_px(pen, ratio.mean + wide * ratio.standard_error), y));
        sheet.draw(&PathElement::new(ends, pen.line(ink(color), 2))).map_err(why)?;
    }
    pen.dot(sheet, (at_px(pen, ratio.mean), y), color)
}
