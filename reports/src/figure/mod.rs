//! Figure 3 of the paper, in grid worlds and in physics worlds: the plan of the world (over several worlds: the share of its
//! changing cells that is correct), and the curves of the errors of the rates and of the share of the map that is correct, one
//! per strategy, with bands of 95 % confidence.

mod curves;

use super::{ONE_BY_ONE, Report};
use crate::builder::{Run, conditions};
use draw::canvas::{Canvas, Drawn, PictureError, ink, why};
use draw::palette;
use draw::pen::{Pen, Sheet, svg};
use draw::pictures::plan_on;
use draw::scene::Scene;
use evaluation::trials::Metric;
use files::write_file;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;
use results::file_name;
use std::collections::BTreeSet;
use std::path::Path;

// All lengths in pixels of the finished picture.
const WIDTH: u32 = 1180;
const MARGIN: i32 = 16;
const TITLE: i32 = 46;
const LEGEND_ROW: i32 = 26;
const LEGEND_COLUMNS: usize = 5;
const PANEL_HEIGHT: i32 = 360;

/// Writes the figures as PNG and SVG.
pub(super) fn write_all(folder: &Path, report: &Report, worlds: &[Scene]) -> Result<(), PictureError> {
    for (name, run) in chosen(report) {
        let world = worlds.iter().find(|world| run.worlds == 1 && world.title == run.world);
        let figure = Figure { report, run, world };
        let failed = |why| PictureError::Draw { name: name.clone(), why };
        let [png, vector] = ["png", "svg"].map(|ending| folder.join(format!("{name}.{ending}")));
        Canvas::draw(figure.size(), |sheet| figure.draw(sheet, &Pen::BITMAP)).map_err(failed)?.write(&png)?;
        let text = svg(figure.size(), |sheet| figure.draw(sheet, &Pen::VECTOR)).map_err(failed)?;
        write_file(&vector, |file| file.write_all(text.as_bytes()))?;
    }
    Ok(())
}

/// The runs that are drawn, each with the name of its file: the run over all worlds, or the only one, has no ending. With many worlds,
/// only all of them together are drawn.
fn chosen(report: &Report) -> Vec<(String, &Run)> {
    let runs = &report.runs;
    let worlds = runs.iter().map(|run| run.worlds).max().unwrap_or(1);
    let main = runs.iter().position(|run| run.worlds == worlds);
    let has_one_estimator = runs.iter().all(|run| run.estimator == runs[0].estimator);
    let mut names = BTreeSet::new();
    let mut chosen = Vec::new();
    for (index, run) in runs.iter().enumerate() {
        if run.worlds == 1 && worlds > ONE_BY_ONE {
            continue;
        }
        let mut name = String::from(report.settings.length.choose("figure3", "curves"));
        if Some(index) != main {
            if run.worlds == 1 {
                name += &format!("-{}", file_name::of(&run.world));
            }
            if !has_one_estimator {
                name += &format!("-{}", file_name::of(&run.estimator));
            }
        }
        // Different names can become the same in a file name.
        let mut unique = name.clone();
        let mut number = 2;
        while !names.insert(unique.clone()) {
            unique = format!("{name}-{number}");
            number += 1;
        }
        chosen.push((unique, run));
    }
    chosen
}

/// One figure.
struct Figure<'a> {
    report: &'a Report,
    run: &'a Run,
    /// The plan, of a single world.
    world: Option<&'a Scene>,
}

impl Figure<'_> {
    /// Width and height in pixels.
    fn size(&self) -> [u32; 2] {
        [WIDTH, (TITLE + self.legend_height() + 2 * PANEL_HEIGHT + MARGIN) as u32]
    }

    fn legend_height(&self) -> i32 {
        self.run.strategies.len().div_ceil(LEGEND_COLUMNS) as i32 * LEGEND_ROW
    }

    fn draw<DB: DrawingBackend>(&self, sheet: &Sheet<DB>, pen: &Pen) -> Drawn {
        sheet.fill(&WHITE).map_err(why)?;
        let sheet = sheet.margin(0, pen.px(MARGIN), pen.px(MARGIN), pen.px(MARGIN));
        let (head, rest) = sheet.split_vertically(pen.px(TITLE));
        let title = format!("{}: {}", self.run.world, conditions(self.run, &self.report.settings));
        pen.write(&head, (pen.px(MARGIN), pen.px(TITLE / 2)), HPos::Left, 20, &title)?;
        let over = if self.run.worlds > 1 { "worlds" } else { "trials" };
        let note = format!("lines: means over {over}; bands: their 95 % confidence");
        pen.write(&head, (pen.px(WIDTH as i32 - 2 * MARGIN), pen.px(TITLE / 2)), HPos::Right, 15, &note)?;
        let (legend, panels) = rest.split_vertically(pen.px(self.legend_height()));
        self.legend(&legend, pen)?;
        let panels = panels.split_evenly((2, 2));
        let length = self.report.settings.length;
        let draw = |panel, metric| curves::draw(panel, pen, metric, length, &self.run.strategies);
        match self.world {
            Some(world) => plan_on(&panels[0], *pen, world)?,
            None => draw(&panels[0], Metric::MapQualityChanging)?,
        }
        let second = length.choose(Metric::RateError, Metric::RateAuc);
        let curves = [second, Metric::LogError, Metric::MapQuality];
        panels[1..].iter().zip(curves).try_for_each(|(panel, metric)| draw(panel, metric))
    }

    fn legend<DB: DrawingBackend>(&self, sheet: &Sheet<DB>, pen: &Pen) -> Drawn {
        let column_width = (WIDTH as i32 - 2 * MARGIN) / LEGEND_COLUMNS as i32;
        for (index, strategy) in self.run.strategies.iter().enumerate() {
            let left = MARGIN + (index % LEGEND_COLUMNS) as i32 * column_width;
            let middle = (index / LEGEND_COLUMNS) as i32 * LEGEND_ROW + LEGEND_ROW / 2;
            let color = ink(palette::strategy(&strategy.name));
            pen.bar(sheet, [left, middle - 7], [26, 14], &color.mix(curves::BAND))?;
            let line = [left, left + 26].map(|x| (pen.px(x), pen.px(middle)));
            let is_dashed = curves::is_dashed(&strategy.name);
            curves::draw_line(sheet, pen, line.into(), pen.line(color, 2), is_dashed)?;
            pen.write(sheet, (pen.px(left + 34), pen.px(middle)), HPos::Left, 16, &strategy.name)?;
        }
        Ok(())
    }
}
