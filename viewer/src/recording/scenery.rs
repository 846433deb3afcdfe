//! What is logged once: the house, and how everything looks.

use super::columns::Place;
use super::{entity, sight};
use crate::layer::{CURIOUS, Layer, OTHERS, Rgb};
use crate::view::{RobotView, Scene, TimeUnit, View};
use interfaces::GridFrame;
use nalgebra::Point2;
use rerun::external::re_sdk_types::datatypes;
use rerun::{
    AnnotationContext, Arrows2D, ChannelDatatype, Color, ImageFormat, LineStrips2D, Points2D, Radius,
    RecordingStream, RecordingStreamResult, SegmentationImage, SeriesLines, Transform3D,
};

/// Drawn in this order, from the bottom up.
pub(super) mod order {
    pub(super) const MAP: f32 = -10.0;
    pub(in crate::recording) const SIGHT: f32 = -9.0;
    pub(super) const WALLS: f32 = 1.0;
    pub(in crate::recording) const SIGHT_OUTLINE: f32 = 2.0;
    pub(super) const TRAIL: f32 = 3.0;
    pub(super) const OTHERS_TRAIL: f32 = 3.5;
    pub(super) const PATH: f32 = 4.0;
    pub(super) const BODY: f32 = 5.0;
    pub(super) const HEADING: f32 = 6.0;
}

/// What the curious robot sees.
pub(super) const SENSOR: Rgb = [64, 196, 120];
const WALLS: Rgb = [120, 72, 40];
const OBSTACLES: Rgb = [200, 90, 20];
const PATH: Rgb = [224, 122, 20];
const GOAL: Rgb = [214, 30, 60];

/// The names of more things than this would hide the map; a viewer still shows them one by one.
const MAX_LABELS: usize = 4;

/// Logs everything that stays the same for a run whose first view is `view`.
pub(super) fn send(stream: &RecordingStream, scene: &Scene, view: &View) -> RecordingStreamResult<()> {
    // A viewer's y points down.
    stream.log_static(entity::WORLD, &Transform3D::from_scale([1.0, -1.0, 1.0]))?;
    house(stream, scene, view)?;
    for robot in view.robots {
        self::robot(stream, robot)?;
    }
    sight::send(stream, view)?;
    for layer in Layer::ALL {
        map(stream, view.mapper.frame(), layer, scene.unit)?;
    }
    curves(stream, view)
}

pub(super) fn colour([red, green, blue]: Rgb, alpha: u8) -> Color {
    Color::from_unmultiplied_rgba(red, green, blue, alpha)
}

fn house(stream: &RecordingStream, scene: &Scene, view: &View) -> RecordingStreamResult<()> {
    let place = |point: &Point2<f64>| -> Place { [point.x as f32, point.y as f32] };
    let closed =
        |outline: &Vec<Point2<f64>>| outline.iter().chain(outline.first()).map(place).collect::<Vec<_>>();
    let walls = LineStrips2D::new(scene.walls.iter().map(closed))
        .with_colors([colour(WALLS, 255)])
        .with_radii([Radius::new_ui_points(1.0)])
        .with_draw_order(order::WALLS);
    stream.log_static(format!("{}/walls", entity::HOUSE), &walls)?;
    for thing in view.obstacles {
        let look = LineStrips2D::update_fields()
            .with_colors([colour(OBSTACLES, 255)])
            .with_radii([Radius::new_ui_points(2.0)])
            .with_labels([thing.name])
            .with_show_labels(view.obstacles.len() <= MAX_LABELS)
            .with_draw_order(order::WALLS);
        stream.log_static(entity::obstacle(thing.name), &look)?;
    }
    let path = LineStrips2D::update_fields()
        .with_colors([colour(PATH, 255)])
        .with_radii([Radius::new_ui_points(1.5)])
        .with_draw_order(order::PATH);
    stream.log_static(entity::PATH, &path)?;
    let goal = Points2D::update_fields()
        .with_colors([colour(GOAL, 255)])
        .with_radii([Radius::new_ui_points(6.0)])
        .with_labels(["goal"])
        .with_show_labels(true)
        .with_draw_order(order::PATH);
    stream.log_static(entity::GOAL, &goal)
}

fn robot(stream: &RecordingStream, robot: &RobotView) -> RecordingStreamResult<()> {
    let part = |part| entity::robot(robot.name, part);
    let (own, trail_order) =
        if robot.is_curious { (CURIOUS, order::TRAIL) } else { (OTHERS, order::OTHERS_TRAIL) };
    let body = Points2D::update_fields()
        .with_colors([colour(own, 255)])
        .with_radii([Radius::new_scene_units(robot.radius_m as f32)])
        .with_labels([robot.name])
        .with_show_labels(true)
        .with_draw_order(order::BODY);
    stream.log_static(part("body"), &body)?;
    let heading = Arrows2D::update_fields()
        .with_colors([colour([16, 18, 24], 255)])
        .with_radii([Radius::new_ui_points(1.5)])
        .with_draw_order(order::HEADING);
    stream.log_static(part("heading"), &heading)?;
    let trail = LineStrips2D::update_fields()
        .with_colors([colour(own, 140)])
        .with_radii([Radius::new_ui_points(1.0)])
        .with_draw_order(trail_order);
    stream.log_static(part("trail"), &trail)
}

fn map(
    stream: &RecordingStream,
    frame: &GridFrame,
    layer: Layer,
    unit: TimeUnit,
) -> RecordingStreamResult<()> {
    let entity = entity::map(layer);
    let class = |(class, meaning): (u8, String)| datatypes::AnnotationInfo {
        id: class.into(),
        label: Some(meaning.into()),
        color: Some(*colour(layer.colour(class), 255)),
    };
    let context = AnnotationContext::new(layer.legend(unit).into_iter().map(class));
    stream.log_static(entity.as_str(), &context)?;

    Picture::of_frame(frame).log(stream, &format!("{entity}/cells"), order::MAP, 1.0)?;
    colour_bar(stream, layer, frame, unit)
}

/// A picture of classes: how many, and where.
pub(super) struct Picture {
    columns: usize,
    rows: usize,
    origin: Point2<f64>,
    cell_m: [f64; 2],
}

impl Picture {
    pub(super) fn of_frame(frame: &GridFrame) -> Self {
        let cell_m = [frame.resolution_m(); 2];
        Self { columns: frame.width(), rows: frame.height(), origin: frame.origin(), cell_m }
    }

    /// Logs everything but the classes.
    pub(super) fn log(
        &self,
        stream: &RecordingStream,
        entity: &str,
        order: f32,
        opacity: f32,
    ) -> RecordingStreamResult<()> {
        let [x, y] = [self.origin.x as f32, self.origin.y as f32];
        let [width, height] = self.cell_m.map(|side| side as f32);
        let at = Transform3D::from_translation([x, y, 0.0]).with_scale([width, height, 1.0]);
        stream.log_static(entity, &at)?;
        let size = [self.columns as u32, self.rows as u32];
        let format = SegmentationImage::update_fields()
            .with_format(ImageFormat::segmentation(size, ChannelDatatype::U8))
            .with_opacity(opacity)
            .with_draw_order(order);
        stream.log_static(entity, &format)
    }
}

/// Draws the colour bar below the map, for a layer that has one.
fn colour_bar(
    stream: &RecordingStream,
    layer: Layer,
    frame: &GridFrame,
    unit: TimeUnit,
) -> RecordingStreamResult<()> {
    let Some(scale) = layer.scale(unit) else { return Ok(()) };
    let entity = format!("{}/colour_bar", entity::map(layer));
    let origin = frame.origin();
    let [width_m, height_m] =
        [frame.width(), frame.height()].map(|cells| cells as f64 * frame.resolution_m());
    let bar = Point2::new(origin.x + 0.06 * width_m, origin.y - 0.07 * height_m);
    let (length_m, thickness_m) = (0.88 * width_m, 0.035 * height_m);
    let classes = layer.scale_classes();
    let cell_m = [length_m / classes.len() as f64, thickness_m];
    Picture { columns: classes.len(), rows: 1, origin: bar, cell_m }.log(stream, &entity, order::MAP, 1.0)?;
    stream.log_static(entity, &SegmentationImage::update_fields().with_buffer(classes))?;

    let at = |value: f64| [(bar.x + scale.place(value) * length_m) as f32, (bar.y - 0.035 * height_m) as f32];
    let marks = Points2D::new(layer.ticks(unit).iter().map(|(value, _)| at(*value)))
        .with_labels(layer.ticks(unit).iter().map(|(_, text)| *text))
        .with_show_labels(true)
        .with_radii([Radius::new_ui_points(0.0)])
        .with_colors([colour([225, 228, 232], 255)]);
    stream.log_static(format!("{}/marks", entity::map(layer)), &marks)
}

fn curves(stream: &RecordingStream, view: &View) -> RecordingStreamResult<()> {
    let line = |entity: String, name: &str, own: Rgb| {
        let look = SeriesLines::new().with_names([name]).with_colors([colour(own, 255)]).with_widths([2.0]);
        stream.log_static(entity, &look)
    };
    line(entity::COVERAGE.into(), "coverage", [90, 170, 250])?;
    line(entity::MAP_QUALITY.into(), "map quality", [250, 190, 60])?;
    if view.rate_errors.is_some() {
        line(entity::RELATIVE_ERROR.into(), "relative", [200, 130, 220])?;
        line(entity::LOG_ERROR.into(), "of the logarithm", [240, 140, 90])?;
    }
    line(entity::P.into(), "p", [240, 90, 90])?;
    line(entity::R.into(), "r", [120, 200, 120])?;
    for (strategy, colour) in view.strategies.iter().zip(colorous::TABLEAU10.iter().cycle()) {
        for curves in [entity::VALUES, entity::SHARES] {
            line(entity::strategy(curves, strategy.name), strategy.name, [colour.r, colour.g, colour.b])?;
        }
    }
    Ok(())
}
