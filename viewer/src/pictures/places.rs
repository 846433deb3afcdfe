//! The places where something changes, numbered on the map.

use super::panel::{Panel, pair};
use crate::layers::Layer;
use crate::legend::{Legend, Mark};
use crate::scene::TimeUnit;
use mapper::Mapper;
use nalgebra::Point2;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;
use results::drawing::palette;
use results::drawing::{Area, ink, why};

/// Draws the map, the cells that changed, and the number of each place at its corner. A place is a rectangle, m.
pub(super) fn draw(
    panel: &Panel,
    area: &Area,
    mapper: &Mapper,
    title: &str,
    places: &[[Point2<f64>; 2]],
) -> Result<(), String> {
    let (chart, legend) = panel.axes(area, title)?;
    panel.cells(&chart, Layer::Occupancy, &Layer::Occupancy.classes(mapper, TimeUnit::Second))?;
    let frame = mapper.frame();
    // Twice as large as they are: a cell of a building is smaller than a point.
    let half = nalgebra::Vector2::repeat(frame.resolution_m());
    for index in mapper.changed().filter(|index| mapper.rate(*index) > 0.0) {
        let center = frame.center(frame.cell(index));
        let corners = [pair(&(center - half)), pair(&(center + half))];
        chart.plotting_area().draw(&Rectangle::new(corners, ink(palette::MOVING).filled())).map_err(why)?;
    }
    let plot = chart.plotting_area();
    let pixels = plot.use_screen_coord();
    for (number, [low, high]) in (1..).zip(places) {
        let outline = Rectangle::new([pair(low), pair(high)], panel.line(ink(palette::CURIOUS), 1));
        plot.draw(&outline).map_err(why)?;
        let (x, y) = plot.map_coordinate(&pair(high));
        let at = (x + panel.px(8), y - panel.px(6));
        pixels.draw(&Circle::new(at, panel.px(8), WHITE.mix(0.85).filled())).map_err(why)?;
        panel.write(&pixels, at, HPos::Center, &format!("{number}"))?;
    }
    panel.frame(&chart)?;
    panel.legend(&legend, &entries())
}

/// The entries of the legend.
pub(super) fn entries() -> Legend {
    let state =
        |(class, meaning): (u8, &str)| (Mark::Area(Layer::Occupancy.color(class)), meaning.to_owned());
    let mut entries: Legend = Layer::Occupancy.plain_legend().into_iter().map(state).collect();
    entries.push((Mark::Area(palette::MOVING), "changed".to_owned()));
    entries.push((Mark::Line(palette::CURIOUS), "a numbered place".to_owned()));
    entries
}
