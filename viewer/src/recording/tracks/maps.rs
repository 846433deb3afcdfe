//! The layers of the map, each with its color bar.

use super::{Kind, Tracks, WORLD, coarse, color, labels, order};
use draw::layers::Layer;
use draw::scene::extent;
use draw::view::View;
use interfaces::GridFrame;
use nalgebra::{Point2, Vector2};
use rerun::components::ImageBuffer;
use rerun::external::re_sdk_types::datatypes::AnnotationInfo;
use rerun::{
    AnnotationContext, ChannelDatatype, ImageFormat, RecordingStreamResult, SegmentationImage, Transform3D,
};

/// The height of the strip below a map that holds the color bar, as a share of the height of the map.
pub(in crate::recording) const BAR_SHARE: f64 = 0.2;

/// A map; its cells and its color bar are below.
pub(in crate::recording) fn map(layer: Layer) -> String {
    format!("{WORLD}/maps/{}", layer.name())
}

/// Images with more cells than this are logged less often: the maps of a building would fill the file.
const MANY_CELLS: usize = 100_000;

pub(super) fn add(tracks: &mut Tracks) -> RecordingStreamResult<()> {
    let frame = &tracks.scene.frame;
    for layer in Layer::ALL {
        let cells = format!("{}/cells", map(layer));
        let classes = layer.legend().into_iter();
        let classes = classes.map(|(id, meaning)| AnnotationInfo {
            id: id.into(),
            label: Some(meaning.into()),
            color: Some(*color(layer.color(id), 255)),
        });
        tracks.always(&map(layer), &AnnotationContext::new(classes))?;
        let coarse = coarse::frame(frame);
        Picture::of_frame(&coarse).log(tracks, &cells)?;
        color_bar(tracks, layer, frame)?;
        let period_s = if layer == Layer::Occupancy { 1.0 } else { 10.0 };
        let when = (Kind::State, period_s * coarse.len().div_ceil(MANY_CELLS) as f64);
        // The map can still be smaller than the image.
        let classes = move |view: &View| vec![coarse::classes(&coarse, &layer.classes(view.mapper))];
        tracks.add(cells, when, classes, images);
    }
    Ok(())
}

/// Logs the color bar below a map, if the layer has one.
fn color_bar(tracks: &Tracks, layer: Layer, frame: &GridFrame) -> RecordingStreamResult<()> {
    let Some(scale) = layer.scale() else { return Ok(()) };
    let (origin, size) = extent(frame);
    let at = |x: f64, y: f64| origin + size.component_mul(&Vector2::new(x, y));
    let classes = layer.scale_classes();
    let cell_m = [0.88 * size.x / classes.len() as f64, 0.035 * size.y];
    let bar = Picture { columns: classes.len(), rows: 1, origin: at(0.06, -0.07), cell_m };
    let path = format!("{}/color_bar", map(layer));
    bar.log(tracks, &path)?;
    tracks.always(&path, &images(vec![classes]))?;
    let tick = |&value: &f64| super::position(&at(0.06 + 0.88 * scale.position(value), -0.105));
    let texts: Vec<String> = scale.ticks.iter().map(f64::to_string).collect();
    let marks = labels(texts.iter().map(String::as_str)).with_positions(scale.ticks.iter().map(tick));
    tracks.always(&format!("{}/marks", map(layer)), &marks)
}

/// The components of images: the class of every cell.
fn images(images: Vec<Vec<u8>>) -> SegmentationImage {
    let buffers = images.into_iter().map(|classes| ImageBuffer(classes.into()));
    SegmentationImage::update_fields().with_many_buffer(buffers)
}

/// An image of classes: its size and its position.
struct Picture {
    columns: usize,
    rows: usize,
    /// The lower left corner, m.
    origin: Point2<f64>,
    /// Width and height of a cell, m.
    cell_m: [f64; 2],
}

impl Picture {
    /// The cells of a frame.
    fn of_frame(frame: &GridFrame) -> Self {
        let cell_m = [frame.resolution_m(); 2];
        Self { columns: frame.width(), rows: frame.height(), origin: frame.origin(), cell_m }
    }

    /// Logs everything but the classes.
    fn log(&self, tracks: &Tracks, path: &str) -> RecordingStreamResult<()> {
        let [x, y] = super::position(&self.origin);
        let [width, height] = self.cell_m.map(|side| side as f32);
        let place = Transform3D::from_translation([x, y, 0.0]).with_scale([width, height, 1.0]);
        let size = [self.columns as u32, self.rows as u32];
        let format = SegmentationImage::update_fields()
            .with_format(ImageFormat::segmentation(size, ChannelDatatype::U8))
            .with_opacity(1.0)
            .with_draw_order(order::MAP);
        tracks.always(path, &[&place as &dyn rerun::AsComponents, &format])
    }
}
