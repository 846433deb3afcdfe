//! One map with axes and a legend.

use crate::layer::{Layer, Rgb};
use crate::view::TimeUnit;
use evaluation::drawing::{Area, INK, ink, px, text, why};
use interfaces::GridFrame;
use mapper::Mapper;
use plotters::chart::ChartContext;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// A chart in metres.
pub(super) type Chart<'a, 'b> =
    ChartContext<'a, BitMapBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// All lengths in pixels of the finished picture.
const MAP: u32 = 560;
const MARGIN: u32 = 14;
const TITLE: u32 = 40;
const AXIS: u32 = 52;
const LEGEND: u32 = 168;
const SWATCH: i32 = px(16);
const LINE: i32 = px(26);

/// The size of a panel, width and height: the map keeps its proportions, within reason.
pub(super) fn size(frame: &GridFrame) -> [u32; 2] {
    let proportion = (frame.height() as f64 / frame.width() as f64).clamp(0.4, 2.5);
    let height = (f64::from(MAP) * proportion).round() as u32;
    [MARGIN + AXIS + MAP + LEGEND, MARGIN + TITLE + height + AXIS]
}

/// Draws the axes, in metres, over the rectangle of `frame`. Returns also the place for a legend.
pub(super) fn axes<'a, 'b>(
    area: &'a Area<'b>,
    title: &str,
    frame: &GridFrame,
) -> Result<(Chart<'a, 'b>, Area<'b>), String> {
    axes_in(area, title, frame, "m")
}

/// The same in another unit of length.
pub(super) fn axes_in<'a, 'b>(
    area: &'a Area<'b>,
    title: &str,
    frame: &GridFrame,
    unit: &str,
) -> Result<(Chart<'a, 'b>, Area<'b>), String> {
    let (width, _) = area.dim_in_pixel();
    let (above, below) = area.split_vertically(px(MARGIN + TITLE));
    let middle = (px(MARGIN + AXIS + MAP / 2), px(MARGIN + TITLE / 2));
    above.draw_text(title, &text(22).pos(Pos::new(HPos::Center, VPos::Center)), middle).map_err(why)?;
    let (_, legend) = below.split_horizontally(width as i32 - px(LEGEND));
    let (from, cell_m) = (frame.origin(), frame.resolution_m());
    let x_m = from.x..from.x + frame.width() as f64 * cell_m;
    let y_m = from.y..from.y + frame.height() as f64 * cell_m;
    let mut chart = ChartBuilder::on(&below)
        .margin_left(px(MARGIN))
        .margin_right(px(LEGEND))
        .x_label_area_size(px(AXIS))
        .y_label_area_size(px(AXIS))
        .build_cartesian_2d(x_m, y_m)
        .map_err(why)?;
    chart
        .configure_mesh()
        .disable_mesh()
        .x_labels(7)
        .y_labels(7)
        .x_label_formatter(&|x_m| metres(*x_m))
        .y_label_formatter(&|y_m| metres(*y_m))
        .label_style(text(15))
        .axis_desc_style(text(16))
        .axis_style(INK.stroke_width(px(1) as u32))
        .set_all_tick_mark_size(px(4))
        .x_desc(format!("x ({unit})"))
        .y_desc(format!("y ({unit})"))
        .draw()
        .map_err(why)?;
    Ok((chart, legend))
}

/// As short as it can be: 2 and not 2.0.
fn metres(value: f64) -> String {
    format!("{}", (value * 100.0).round() / 100.0)
}

/// Draws a frame around what the axes span.
pub(super) fn frame(chart: &Chart, map: &GridFrame) -> Result<(), String> {
    let (from, cell_m) = (map.origin(), map.resolution_m());
    let to = (from.x + map.width() as f64 * cell_m, from.y + map.height() as f64 * cell_m);
    let border = Rectangle::new([(from.x, from.y), to], INK.stroke_width(px(1) as u32));
    chart.plotting_area().draw(&border).map_err(why)
}

/// The pixel of a finished panel that shows a place in the world.
#[cfg(test)]
pub(super) fn pixel(map: &GridFrame, at: &nalgebra::Point2<f64>) -> [u32; 2] {
    let [_, height] = size(map);
    let share = (at - map.origin()) / map.resolution_m();
    let plot = [MAP, height - MARGIN - TITLE - AXIS].map(f64::from);
    let x = f64::from(MARGIN + AXIS) + share.x / map.width() as f64 * plot[0];
    let y = f64::from(MARGIN + TITLE) + (1.0 - share.y / map.height() as f64) * plot[1];
    [x as u32, y as u32]
}

/// Draws `layer` of the map with its legend.
pub(super) fn draw(area: &Area, mapper: &Mapper, layer: Layer, unit: TimeUnit) -> Result<(), String> {
    let map = mapper.frame();
    let (chart, legend) = axes(area, &layer.title(unit), map)?;
    cells(&chart, map, layer, &layer.classes(mapper, unit))?;
    frame(&chart, map)?;

    let mut top = LINE / 2;
    if let Some(scale) = layer.scale(unit) {
        let length = (px(MAP) * 3 / 5).min(legend.dim_in_pixel().1 as i32 / 2);
        let strip = length / 64;
        for step in 0..64 {
            let place = 1.0 - (f64::from(step) + 0.5) / 64.0;
            let bar = [(px(18), top + step * strip), (px(18) + SWATCH, top + (step + 1) * strip)];
            legend.draw(&Rectangle::new(bar, ink(layer.colour_at(place)).filled())).map_err(why)?;
        }
        for (value, label) in layer.ticks(unit) {
            let at = (px(26) + SWATCH, top + ((1.0 - scale.place(*value)) * f64::from(64 * strip)) as i32);
            write(&legend, at, &layer.with_unit(label, unit))?;
        }
        top += 64 * strip + LINE;
    }
    for (class, meaning) in layer.plain_legend() {
        swatch(&legend, top, layer.colour(class), &meaning)?;
        top += LINE;
    }
    Ok(())
}

/// Draws a line of a legend: a colour and what it stands for.
pub(super) fn swatch(legend: &Area, top: i32, colour: Rgb, meaning: &str) -> Result<(), String> {
    let corners = [(px(18), top), (px(18) + SWATCH, top + SWATCH)];
    legend.draw(&Rectangle::new(corners, ink(colour).filled())).map_err(why)?;
    legend.draw(&Rectangle::new(corners, INK.stroke_width(1))).map_err(why)?;
    write(legend, (px(26) + SWATCH, top + SWATCH / 2), meaning)
}

/// Writes a line of a legend; `at` is the middle of its left side.
pub(super) fn write(legend: &Area, at: (i32, i32), line: &str) -> Result<(), String> {
    let style = text(15).pos(Pos::new(HPos::Left, VPos::Center));
    // The library puts the middle of a letter a quarter of its height too high.
    legend.draw_text(line, &style, (at.0, at.1 + px(15) / 4)).map_err(why)
}

/// Draws the cells, as few rectangles as the rows allow.
fn cells(chart: &Chart, map: &GridFrame, layer: Layer, classes: &[u8]) -> Result<(), String> {
    let (from, cell_m) = (map.origin(), map.resolution_m());
    for (row, classes) in classes.chunks(map.width()).enumerate() {
        let y_m = [row, row + 1].map(|row| from.y + row as f64 * cell_m);
        let mut column = 0;
        for run in classes.chunk_by(|a, b| a == b) {
            let x_m = [column, column + run.len()].map(|column| from.x + column as f64 * cell_m);
            let corners = [(x_m[0], y_m[0]), (x_m[1], y_m[1])];
            let cells = Rectangle::new(corners, ink(layer.colour(run[0])).filled());
            chart.plotting_area().draw(&cells).map_err(why)?;
            column += run.len();
        }
    }
    Ok(())
}
