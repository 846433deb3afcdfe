//! The layers of the map, each with its color bar.

use super::{LABEL, Start, Track, color, order};
use crate::layers::Layer;
use crate::recording::pace::Due;
use crate::recording::path;
use crate::recording::rows::{Classes, Now, Rows, Target};
use crate::scene::TimeUnit;
use crate::view::View;
use interfaces::GridFrame;
use nalgebra::Point2;
use rerun::external::re_sdk_types::datatypes;
use rerun::{
    AnnotationContext, ChannelDatatype, ImageFormat, Points2D, Radius, RecordingStream,
    RecordingStreamResult, SegmentationImage, Transform3D,
};

/// The height of the strip below a map that holds the color bar, as a share of the height of the map.
pub(in crate::recording) const BAR_SHARE: f64 = 0.2;

pub(super) struct Maps {
    unit: TimeUnit,
    maps: Vec<Map>,
}

/// A layer and the classes that were logged last.
struct Map {
    layer: Layer,
    rows: Rows<Classes>,
    due: Due,
    last: Vec<u8>,
}

impl Maps {
    pub(super) fn new(start: Start) -> RecordingStreamResult<Self> {
        let (unit, pace, frame) = (start.scene.unit, start.pace, start.view.mapper.frame());
        let mut maps = Vec::new();
        for layer in Layer::ALL {
            log(start.stream, frame, layer, unit)?;
            let period = if layer == Layer::Occupancy { pace.occupancy } else { pace.maps };
            let due = Due::every(pace.picture(period, frame));
            maps.push(Map { layer, rows: Rows::new(cells(layer)), due, last: Vec::new() });
        }
        Ok(Self { unit, maps })
    }
}

impl Track for Maps {
    fn push(&mut self, now: Now, view: &View, is_last: bool) {
        for map in &mut self.maps {
            if map.due.now(now.time) || is_last {
                let classes = map.layer.classes(view.mapper, self.unit);
                if classes != map.last {
                    map.rows.push(now, [Classes(classes.clone())]);
                    map.last = classes;
                }
            }
        }
    }

    fn flush(&mut self, to: Target) -> RecordingStreamResult<()> {
        self.maps.iter_mut().try_for_each(|map| map.rows.flush(to))
    }
}

fn cells(layer: Layer) -> String {
    format!("{}/cells", path::map(layer))
}

/// Logs how a layer looks, and its color bar below the map if it has one.
fn log(
    stream: &RecordingStream,
    frame: &GridFrame,
    layer: Layer,
    unit: TimeUnit,
) -> RecordingStreamResult<()> {
    let entity = path::map(layer);
    let class = |(class, meaning): (u8, String)| datatypes::AnnotationInfo {
        id: class.into(),
        label: Some(meaning.into()),
        color: Some(*color(layer.color(class), 255)),
    };
    let context = AnnotationContext::new(layer.legend(unit).into_iter().map(class));
    stream.log_static(entity.as_str(), &context)?;
    Picture::of_frame(frame).log(stream, &cells(layer), order::MAP, 1.0)?;

    let Some(scale) = layer.scale(unit) else { return Ok(()) };
    let bar_entity = format!("{entity}/color_bar");
    let origin = frame.origin();
    let [width_m, height_m] =
        [frame.width(), frame.height()].map(|cells| cells as f64 * frame.resolution_m());
    let bar = Point2::new(origin.x + 0.06 * width_m, origin.y - 0.07 * height_m);
    let (length_m, thickness_m) = (0.88 * width_m, 0.035 * height_m);
    let classes = layer.scale_classes();
    let cell_m = [length_m / classes.len() as f64, thickness_m];
    let picture = Picture { columns: classes.len(), rows: 1, origin: bar, cell_m };
    picture.log(stream, &bar_entity, order::MAP, 1.0)?;
    stream.log_static(bar_entity, &SegmentationImage::update_fields().with_buffer(classes))?;

    let at =
        |value: f64| [(bar.x + scale.position(value) * length_m) as f32, (bar.y - 0.035 * height_m) as f32];
    let marks = Points2D::new(scale.ticks.iter().map(|&value| at(value)))
        .with_labels(scale.ticks.iter().map(|value| value.to_string()))
        .with_show_labels(true)
        .with_radii([Radius::new_ui_points(0.0)])
        .with_colors([color(LABEL, 255)]);
    stream.log_static(format!("{entity}/marks"), &marks)
}

/// An image of classes: its size and its position.
pub(super) struct Picture {
    pub(super) columns: usize,
    pub(super) rows: usize,
    /// The lower left corner, m.
    pub(super) origin: Point2<f64>,
    /// Width and height of a cell, m.
    pub(super) cell_m: [f64; 2],
}

impl Picture {
    /// The cells of a frame.
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
