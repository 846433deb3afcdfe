//! A map with a title, axes in meters, and a legend below.

use crate::canvas::{Drawn, INK, ink, px, why};
use crate::layers::Layer;
use crate::legend::Mark;
use crate::pen::{Pen, Sheet};
use crate::scene::extent;
use interfaces::{Grid, GridFrame};
use mapper::Mapper;
use nalgebra::Point2;
use plotters::chart::ChartContext;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// A point as plotters has points.
pub(crate) fn pair(point: &Point2<f64>) -> (f64, f64) {
    (point.x, point.y)
}

/// A chart in meters.
pub(crate) type Chart<'a, DB> = ChartContext<'a, DB, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

// All lengths in points. A panel of 280 points is legible as a third of a page of 840 pixels.
const MARGIN: u32 = 12;
const TITLE: u32 = 28;
const Y_AXIS: u32 = 36;
const X_AXIS: u32 = 38;
const BAR: u32 = 40;
const ROW: u32 = 19;
const LETTERS: u32 = 12;
const SWATCH: u32 = 12;

/// The size and the position of the parts of a panel.
#[derive(Clone, Copy)]
pub(crate) struct Panel {
    frame: GridFrame,
    /// The unit of length.
    unit: &'static str,
    /// The width of the map, in points.
    width: u32,
    pub(crate) pen: Pen,
    /// Entries of the legend side by side.
    columns: u32,
    /// Rows of the legend.
    rows: u32,
    /// Whether there is room for a color bar.
    has_bar: bool,
}

impl Panel {
    /// A panel for one layer of the map, a third of Figure 5.
    pub(crate) fn of_layer(frame: &GridFrame) -> Self {
        Self { columns: 2, has_bar: true, ..Self::of_width(frame, 280 - Y_AXIS - MARGIN, 2, 3) }
    }

    /// A panel for a picture of its own, with a legend of `entries` entries.
    pub(crate) fn of_scene(frame: &GridFrame, is_grid: bool, entries: usize) -> Self {
        let unit = if is_grid { "cells" } else { "m" };
        Self { unit, ..Self::of_width(frame, 430, 2, entries.div_ceil(3) as u32) }
    }

    /// Half of a frame of the moving picture.
    pub(crate) fn of_film(frame: &GridFrame, has_bar: bool) -> Self {
        let width = 420 - Y_AXIS - MARGIN;
        Self { width, has_bar, ..Self::of_width(frame, width, 1, if has_bar { 2 } else { 4 }) }
    }

    /// A panel of a scene as large as possible within a width and a height in points.
    pub(crate) fn within(
        frame: &GridFrame,
        is_grid: bool,
        [width, height]: [u32; 2],
        pen: Pen,
        entries: usize,
    ) -> Self {
        let panel = Self { pen, ..Self::of_scene(frame, is_grid, entries) };
        let around = TITLE + X_AXIS + panel.rows * ROW + MARGIN / 2;
        let high = f64::from(height.saturating_sub(around)) / panel.proportion();
        let width = width.saturating_sub(Y_AXIS + MARGIN).min(high as u32).max(1);
        Self { width, ..panel }
    }

    /// A panel of at least this width, with the pixels of the finished picture per point and a number of rows of the legend.
    fn of_width(frame: &GridFrame, least: u32, scale: u32, rows: u32) -> Self {
        let (width, pen) = (least.max(enough_for(frame)), Pen::of_points(scale));
        Self { frame: *frame, unit: "m", width, pen, columns: 3, rows, has_bar: false }
    }

    /// A length in points, in pixels to draw with.
    pub(crate) fn px(&self, points: u32) -> i32 {
        self.pen.px(points as i32)
    }

    /// The height of the map divided by its width, within reason.
    fn proportion(&self) -> f64 {
        (self.frame.height() as f64 / self.frame.width() as f64).clamp(0.4, 2.5)
    }

    /// The height of the map in points.
    fn height(&self) -> u32 {
        (f64::from(self.width) * self.proportion()).round() as u32
    }

    /// Width and height of the finished picture, pixels.
    pub(crate) fn size(&self) -> [u32; 2] {
        let legend = self.rows * ROW + if self.has_bar { BAR } else { 0 };
        [Y_AXIS + self.width + MARGIN, TITLE + self.height() + X_AXIS + legend + MARGIN / 2]
            .map(|length| (self.px(length) / px(1)) as u32)
    }

    /// Draws the title and the axes. Returns the chart of the map, and the area of the legend below it.
    pub(crate) fn axes<'a, DB: DrawingBackend>(
        &self,
        area: &'a Sheet<DB>,
        title: &str,
    ) -> Drawn<(Chart<'a, DB>, Sheet<DB>)> {
        let middle = (self.px(Y_AXIS + self.width / 2), self.px(TITLE / 2));
        let style = self.pen.text(LETTERS as i32 + 1).pos(Pos::new(HPos::Center, VPos::Center));
        area.draw_text(title, &style, middle).map_err(why)?;
        let below = self.px(TITLE + self.height() + X_AXIS);
        let (_, legend) = area.split_vertically(below);
        let (_, legend) = legend.split_horizontally(self.px(MARGIN));
        let (width, height) = area.dim_in_pixel();
        let (from, size) = extent(&self.frame);
        let to = from + size;
        let mut chart = ChartBuilder::on(area)
            .margin_top(self.px(TITLE))
            .margin_left(self.px(4)) // the library writes the name of the y axis a little too far left
            .margin_right(width as i32 - self.px(Y_AXIS + self.width))
            .margin_bottom(height as i32 - below)
            .x_label_area_size(self.px(X_AXIS))
            .y_label_area_size(self.px(Y_AXIS - 4))
            .build_cartesian_2d(from.x..to.x, from.y..to.y)
            .map_err(why)?;
        chart
            .configure_mesh()
            .disable_mesh()
            .x_labels(7)
            .y_labels(7)
            .x_label_formatter(&|x_m| short(*x_m))
            .y_label_formatter(&|y_m| short(*y_m))
            .label_style(self.pen.text(LETTERS as i32))
            .axis_desc_style(self.pen.text(LETTERS as i32))
            .axis_style(self.line(INK, 1))
            .set_all_tick_mark_size(self.px(2))
            .x_desc(format!("x ({})", self.unit))
            .y_desc(format!("y ({})", self.unit))
            .draw()
            .map_err(why)?;
        Ok((chart, legend))
    }

    /// The chart of a map that fills a picture.
    pub(crate) fn bare<'a, DB: DrawingBackend>(&self, area: &'a Sheet<DB>) -> Drawn<Chart<'a, DB>> {
        let (from, size) = extent(&self.frame);
        let to = from + size;
        ChartBuilder::on(area).build_cartesian_2d(from.x..to.x, from.y..to.y).map_err(why)
    }

    /// A line with a width in half points.
    pub(crate) fn line(&self, color: RGBColor, width: u32) -> ShapeStyle {
        color.stroke_width(self.px(width) as u32 / 2)
    }

    /// Draws a line around the map.
    pub(crate) fn frame(&self, chart: &Chart<impl DrawingBackend>) -> Drawn {
        let (from, size) = extent(&self.frame);
        let to = from + size;
        let border = Rectangle::new([(from.x, from.y), (to.x, to.y)], self.line(INK, 1));
        chart.plotting_area().draw(&border).map_err(why)
    }

    /// Draws the entries of the legend.
    pub(crate) fn legend(&self, legend: &Sheet<impl DrawingBackend>, entries: &[(Mark, String)]) -> Drawn {
        let column = (self.width + Y_AXIS) / self.columns;
        let top = if self.has_bar { BAR } else { 0 };
        for (index, (mark, meaning)) in (0..).zip(entries) {
            let x = self.px(index % self.columns * column);
            let y = self.px(top + index / self.columns * ROW + ROW / 2);
            self.pen.mark(legend, *mark, (x, y), SWATCH as i32)?;
            self.write(legend, (x + self.px(SWATCH + 5), y), HPos::Left, meaning)?;
        }
        Ok(())
    }

    /// Writes a line; `at` is the middle of its left side, or of the line.
    pub(crate) fn write(
        &self,
        area: &Sheet<impl DrawingBackend>,
        at: (i32, i32),
        anchor: HPos,
        line: &str,
    ) -> Drawn {
        self.pen.write(area, at, anchor, LETTERS as i32, line)
    }

    /// Width and height of a line of text, in pixels to draw with.
    pub(crate) fn text_size(&self, area: &Sheet<impl DrawingBackend>, line: &str) -> Drawn<[i32; 2]> {
        let (width, height) = area.estimate_text_size(line, &self.pen.text(LETTERS as i32)).map_err(why)?;
        Ok([width as i32, height as i32])
    }

    /// Draws a layer of the map with its legend. Returns the chart of the map.
    pub(crate) fn layer<'a, DB: DrawingBackend>(
        &self,
        area: &'a Sheet<DB>,
        mapper: &Mapper,
        layer: Layer,
    ) -> Drawn<Chart<'a, DB>> {
        self.classes(area, (layer, layer.title()), &layer.classes(mapper))
    }

    /// Draws the classes of the cells, in the colors of a layer, with its legend. Returns the chart of the map.
    pub(crate) fn classes<'a, DB: DrawingBackend>(
        &self,
        area: &'a Sheet<DB>,
        (layer, title): (Layer, &str),
        classes: &Grid<u8>,
    ) -> Drawn<Chart<'a, DB>> {
        let (chart, legend) = self.axes(area, title)?;
        self.cells(&chart, layer, classes)?;
        self.frame(&chart)?;
        let mut panel = *self;
        if let Some(scale) = layer.scale() {
            let (left, length) = (self.px(Y_AXIS - MARGIN), f64::from(self.px(self.width)));
            let at = |position: f64| left + (position * length) as i32;
            let (top, bottom) = (self.px(4), self.px(4 + SWATCH));
            let classes = layer.scale_classes();
            for (index, &class) in classes.iter().enumerate() {
                let edge = |index: usize| at(index as f64 / classes.len() as f64);
                let corners = [(edge(index), top), (edge(index + 1), bottom)];
                legend.draw(&Rectangle::new(corners, ink(layer.color(class)).filled())).map_err(why)?;
            }
            for &value in scale.ticks {
                let x = at(scale.position(value));
                let tick = PathElement::new([(x, bottom), (x, bottom + self.px(2))], self.line(INK, 1));
                legend.draw(&tick).map_err(why)?;
                self.write(&legend, (x, bottom + self.px(10)), HPos::Center, &value.to_string())?;
            }
        } else {
            panel.has_bar = false;
        }
        let entries = layer.plain_legend().into_iter();
        let entries: Vec<(Mark, String)> =
            entries.map(|(class, text)| (Mark::Area(layer.color(class)), text.to_owned())).collect();
        panel.legend(&legend, &entries)?;
        if let Some(note) = layer.note() {
            let row = (entries.len() as u32).div_ceil(self.columns);
            self.write(&legend, (0, self.px(BAR + row * ROW + ROW / 2)), HPos::Left, note)?;
        }
        Ok(chart)
    }

    /// Draws the cells, as few rectangles as the rows allow.
    pub(crate) fn cells(
        &self,
        chart: &Chart<impl DrawingBackend>,
        layer: Layer,
        classes: &Grid<u8>,
    ) -> Drawn {
        let (from, cell_m) = (self.frame.origin(), self.frame.resolution_m());
        for (row, classes) in classes.rows().enumerate() {
            let of_row: Vec<u8> = classes.copied().collect();
            let y_m = [row, row + 1].map(|row| from.y + row as f64 * cell_m);
            let mut column = 0;
            for run in of_row.chunk_by(|a, b| a == b) {
                let x_m = [column, column + run.len()].map(|column| from.x + column as f64 * cell_m);
                let corners = [(x_m[0], y_m[0]), (x_m[1], y_m[1])];
                let cells = Rectangle::new(corners, ink(layer.color(run[0])).filled());
                chart.plotting_area().draw(&cells).map_err(why)?;
                column += run.len();
            }
        }
        Ok(())
    }

    /// The pixel of a finished panel that shows a position in the world.
    #[cfg(test)]
    pub(crate) fn pixel(&self, position: &Point2<f64>) -> [u32; 2] {
        let share = (position - self.frame.origin()) / self.frame.resolution_m();
        let [width, height] = [self.width, self.height()].map(|length| f64::from(self.px(length) / px(1)));
        let x = f64::from(self.px(Y_AXIS) / px(1)) + share.x / self.frame.width() as f64 * width;
        let y = f64::from(self.px(TITLE) / px(1)) + (1.0 - share.y / self.frame.height() as f64) * height;
        [x as u32, y as u32]
    }
}

/// The width in points with which the walls of a large map stay visible: half a point, one pixel, per cell. Maps of up to
/// 600 cells are drawn smaller.
fn enough_for(frame: &GridFrame) -> u32 {
    const LARGE: usize = 600;
    const MAX_LINES: usize = 1000;
    let cells = frame.width().max(frame.height());
    if cells > LARGE { (cells / 2).min(MAX_LINES) as u32 } else { 0 }
}

/// A number without unneeded digits: 2 and not 2.0.
fn short(value: f64) -> String {
    format!("{}", (value * 100.0).round() / 100.0)
}
