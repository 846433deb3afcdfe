//! The picture of all verdicts: a forest plot.

use crate::Finding;
use crate::claim::Claim;
use files::write_file;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};
use reports::Comparison;
use std::path::Path;

const ROW: i32 = 22;
const LEFT: i32 = 330;
const WIDTH: u32 = 1100;
const TOP: i32 = 74;
/// The two panels: their titles, their ranges to both sides (larger differences end at the edge), and the positions
/// of their ticks. Differences to recency are ten times smaller.
const PANELS: [(&str, f64, f64); 2] = [("against recency", 0.12, 0.1), ("against poisson", 1.2, 1.0)];
const PANEL: i32 = 340;
const GAP: i32 = 30;

/// One row per condition and kind of world: all generated worlds together, and the paper's world.
pub(crate) fn draw(findings: &[Finding], path: &Path) -> anyhow::Result<()> {
    register_font("sans-serif", FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT)
        .map_err(|_| anyhow::anyhow!("the font is damaged"))?;
    let mut rows: Vec<(String, Claim)> = Vec::new();
    for finding in findings {
        for claim in finding.claims() {
            if claim.world.starts_with("all") || claim.world == "two blocks" {
                let worlds = if claim.world.starts_with("all") { "generated" } else { "two blocks" };
                rows.push((format!("{}, {worlds}", finding.condition.name), claim));
            }
        }
    }
    let height = (TOP + ROW * rows.len() as i32 + 30) as u32;
    let mut drawing = String::new();
    let area = SVGBackend::with_string(&mut drawing, (WIDTH, height)).into_drawing_area();
    area.fill(&WHITE)?;
    let text = ("sans-serif", 14).into_font();
    let title = "Log error of the rates over the run: curious minus another, with 95 % interval";
    area.draw(&Text::new(title, (12, 10), ("sans-serif", 17)))?;
    for (panel, (name, reach, tick)) in PANELS.into_iter().enumerate() {
        let middle = x(panel, 0.0);
        area.draw(&Text::new(name, (middle - 60, 36), text.clone()))?;
        area.draw(&Text::new("curious better", (x(panel, -reach), 54), ("sans-serif", 12)))?;
        area.draw(&Text::new("worse", (x(panel, reach) - 34, 54), ("sans-serif", 12)))?;
        area.draw(&PathElement::new([(middle, TOP - 4), (middle, height as i32 - 28)], BLACK.mix(0.4)))?;
        for tick in [-tick, tick] {
            let at = x(panel, tick);
            area.draw(&PathElement::new([(at, TOP - 4), (at, height as i32 - 28)], BLACK.mix(0.1)))?;
            area.draw(&Text::new(format!("{tick:+}"), (at - 12, height as i32 - 24), ("sans-serif", 12)))?;
        }
    }
    for (number, (name, claim)) in rows.iter().enumerate() {
        let y = TOP + ROW * number as i32 + ROW / 2;
        if number % 2 == 0 {
            area.draw(&Rectangle::new(
                [(0, y - ROW / 2), (WIDTH as i32, y + ROW / 2)],
                BLACK.mix(0.03).filled(),
            ))?;
        }
        area.draw(&Text::new(name.clone(), (12, y - 8), text.clone()))?;
        for (panel, comparison) in claim.speed.iter().enumerate() {
            whisker(&area, panel, y, comparison)?;
        }
        let colour = match claim.verdict {
            "holds" => RGBColor(0, 158, 115),
            "fails" => RGBColor(213, 94, 0),
            _ => RGBColor(110, 110, 110),
        };
        let verdict = Text::new(claim.verdict, (WIDTH as i32 - 66, y - 8), text.clone().color(&colour));
        area.draw(&verdict)?;
    }
    area.present()?;
    drop(area);
    Ok(write_file(path, |file| file.write_all(drawing.as_bytes()))?)
}

fn whisker(
    area: &DrawingArea<SVGBackend, plotters::coord::Shift>,
    panel: usize,
    y: i32,
    comparison: &Comparison,
) -> anyhow::Result<()> {
    let colour = match () {
        () if !comparison.is_significant() => RGBColor(110, 110, 110),
        () if comparison.mean_difference < 0.0 => RGBColor(0, 158, 115),
        () => RGBColor(213, 94, 0),
    };
    let [low, mean, high] =
        [comparison.low, comparison.mean_difference, comparison.high].map(|at| x(panel, at));
    area.draw(&PathElement::new([(low, y), (high, y)], colour.stroke_width(2)))?;
    area.draw(&Circle::new((mean, y), 4, colour.filled()))?;
    Ok(())
}

/// The position of a difference in a panel.
fn x(panel: usize, difference: f64) -> i32 {
    let (_, reach, _) = PANELS[panel];
    let part = (difference.clamp(-reach, reach) / reach + 1.0) / 2.0;
    LEFT + panel as i32 * (PANEL + GAP) + (part * f64::from(PANEL)) as i32
}
