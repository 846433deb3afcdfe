//! Errors over rates, one panel for every pattern of observations.

use crate::chains::{Outcome, SHARES};
use crate::patterns::Pattern;
use mapper::EstimatorChoice;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};

const SIZE: (u32, u32) = (900, 620);
/// The number of panels in a row.
const COLUMNS: usize = 3;
/// The lowest rate that is shown, per step.
const FROM: f64 = 0.0004;
const TO: f64 = 0.5;

/// Okabe and Ito's colors, which color-blind readers can tell apart.
const COLOURS: [RGBColor; 5] = [
    RGBColor(0, 0, 0),
    RGBColor(153, 153, 153),
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
];

/// Draws the log error of every estimator over the true rate, for cells that are blocked half of the time.
pub(crate) fn draw(outcomes: &[Outcome]) -> anyhow::Result<String> {
    let mut text = String::new();
    // In the drawing, text stays text; the font is used only to measure text.
    register_font("sans-serif", FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT)
        .map_err(|_| anyhow::anyhow!("the font is damaged"))?;
    let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let rows = Pattern::ALL.len().div_ceil(COLUMNS);
    for (number, (panel, pattern)) in area.split_evenly((rows, COLUMNS)).iter().zip(Pattern::ALL).enumerate()
    {
        let mut chart = ChartBuilder::on(panel)
            .caption(pattern.name(), ("sans-serif", 15))
            .margin(8)
            .x_label_area_size(34)
            .y_label_area_size(40)
            .build_cartesian_2d((FROM..TO).log_scale(), 0.0..2.4)?;
        chart
            .configure_mesh()
            .x_desc("true cycles per step")
            .y_desc("log error")
            .x_labels(4)
            .y_labels(5)
            .label_style(("sans-serif", 12))
            .light_line_style(TRANSPARENT)
            .draw()?;
        for (at, estimator) in EstimatorChoice::all().iter().enumerate() {
            let of_panel = |outcome: &&Outcome| {
                outcome.pattern == pattern && (outcome.share_blocked - SHARES[0]).abs() < 1e-9
            };
            let line =
                outcomes.iter().filter(of_panel).map(|outcome| (outcome.rate, outcome.scores[at].log_error));
            let style = COLOURS[at].stroke_width(2);
            let series = chart.draw_series([PathElement::new(line.collect::<Vec<_>>(), style)])?;
            if number == 0 {
                series
                    .label(estimator.name())
                    .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], style));
            }
        }
        if number == 0 {
            chart
                .configure_series_labels()
                .position(SeriesLabelPosition::UpperRight)
                .label_font(("sans-serif", 12))
                .background_style(WHITE.mix(0.8))
                .draw()?;
        }
    }
    area.present()?;
    drop(area);
    Ok(text)
}
