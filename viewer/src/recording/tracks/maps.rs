//! The layers of the map.

use super::{Kind, Tracks, WORLD, coarse, color, order, position};
use draw::layers::Layer;
use draw::view::View;
use rerun::components::ImageBuffer;
use rerun::external::re_sdk_types::datatypes::AnnotationInfo;
use rerun::{
    AnnotationContext, AsComponents, ChannelDatatype, ImageFormat, RecordingStreamResult, SegmentationImage,
    Transform3D,
};

/// The image of a layer.
pub(in crate::recording) fn map(layer: Layer) -> String {
    format!("{WORLD}/maps/{}", layer.name())
}

/// Images with more cells than this are logged less often: the maps of a building would fill the file.
const MANY_CELLS: usize = 100_000;

pub(super) fn add(tracks: &mut Tracks) -> RecordingStreamResult<()> {
    let frame = coarse::frame(&tracks.scene.frame);
    let ([x, y], side) = (position(&frame.origin()), frame.resolution_m() as f32);
    let place = Transform3D::from_translation([x, y, 0.0]).with_scale([side, side, 1.0]);
    let size = [frame.width() as u32, frame.height() as u32];
    let image = SegmentationImage::update_fields()
        .with_format(ImageFormat::segmentation(size, ChannelDatatype::U8))
        .with_opacity(1.0)
        .with_draw_order(order::MAP);
    for layer in Layer::ALL {
        // The viewer shows the meaning of the color under the pointer.
        let classes = layer.legend().into_iter();
        let meanings = AnnotationContext::new(classes.map(|(id, meaning)| AnnotationInfo {
            id: id.into(),
            label: Some(meaning.into()),
            color: Some(*color(layer.color(id), 255)),
        }));
        tracks.always(&map(layer), &[&meanings as &dyn AsComponents, &place, &image])?;
        let period_s = if layer == Layer::Occupancy { 1.0 } else { 10.0 };
        let when = (Kind::State, period_s * frame.len().div_ceil(MANY_CELLS) as f64);
        // The map can still be smaller than the image.
        let classes = move |view: &View| vec![coarse::classes(&frame, &layer.classes(view.mapper))];
        tracks.add(map(layer), when, classes, |images| {
            let buffers = images.into_iter().map(|classes: Vec<u8>| ImageBuffer(classes.into()));
            SegmentationImage::update_fields().with_many_buffer(buffers)
        });
    }
    Ok(())
}
