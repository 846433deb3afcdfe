//! False changes against latency: the same house with increasing numbers of misses until a cell is cleared.

use crate::things::{BOXES, cleared_after};
use crate::{TURNED, false_changes};
use files::write_file;
use mapper::OccupancyChoice;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};
use serde::Serialize;

/// The numbers of consecutive misses after which a surface is cleared.
const MISSES: [u8; 11] = [1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20];
const SEEDS: u64 = 5;

/// A logarithmic axis has no zero: smaller numbers of changes are drawn here.
const FLOOR: f64 = 0.1;

/// One setting, averaged over the seeds.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Point {
    pub(crate) misses_to_free: u8,
    pub(crate) false_changes: f64,
    /// For a box in the open, s.
    pub(crate) half_cleared_s: f64,
}

/// Tours the turned house with every setting.
pub(crate) fn sweep() -> anyhow::Result<Vec<Point>> {
    let mut points: Vec<_> =
        MISSES.map(|misses_to_free| Point { misses_to_free, false_changes: 0.0, half_cleared_s: 0.0 }).into();
    for seed in 1..=SEEDS {
        let (house, readings) = TURNED.tour(seed);
        for point in &mut points {
            let mut settings = TURNED.settings(OccupancyChoice::steady());
            settings.steady.misses_to_free = point.misses_to_free;
            settings.steady.misses_to_free_fresh =
                settings.steady.misses_to_free_fresh.min(point.misses_to_free);
            let (changes, _) = false_changes(&house, &readings, &settings)?;
            let (half_s, _) = cleared_after(TURNED.house(100 + seed), &settings, BOXES[0])?;
            point.false_changes += changes as f64 / SEEDS as f64;
            point.half_cleared_s += half_s / SEEDS as f64;
        }
    }
    Ok(points)
}

/// Draws the false changes over the time until a removed box is cleared.
pub(crate) fn draw(points: &[Point], path: &str) -> anyhow::Result<()> {
    // In the drawing, text stays text; the font is used only to measure text.
    register_font("sans-serif", FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT)
        .map_err(|_| anyhow::anyhow!("the font is damaged"))?;
    let most = |of: fn(&Point) -> f64| points.iter().map(of).fold(0.0, f64::max);
    let (right_s, top) = (most(|point| point.half_cleared_s) * 1.1, most(|point| point.false_changes) * 1.5);
    let mut drawing = String::new();
    let area = SVGBackend::with_string(&mut drawing, (720, 420)).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .margin(16)
        .x_label_area_size(44)
        .y_label_area_size(60)
        .build_cartesian_2d(0.0..right_s, (FLOOR..top).log_scale())?;
    chart
        .configure_mesh()
        .x_desc("seconds until half of a removed box is free")
        .y_desc("false changes in 6000 scans of a static house")
        .label_style(("sans-serif", 14))
        .y_label_formatter(&|changes| format!("{changes}"))
        .light_line_style(BLACK.mix(0.05))
        .draw()?;
    let at = |point: &Point| (point.half_cleared_s, point.false_changes.max(FLOOR));
    chart.draw_series([PathElement::new(points.iter().map(at).collect::<Vec<_>>(), BLUE.stroke_width(2))])?;
    chart.draw_series(points.iter().map(|point| Circle::new(at(point), 4, BLUE.filled())))?;
    chart.draw_series(points.iter().map(|point| {
        EmptyElement::at(at(point))
            + Text::new(point.misses_to_free.to_string(), (6, -16), ("sans-serif", 14))
    }))?;
    area.present()?;
    drop((chart, area));
    Ok(write_file(path.as_ref(), |file| file.write_all(drawing.as_bytes()))?)
}
