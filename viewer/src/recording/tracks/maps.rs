//! The layers of the map.

use super::{Kind, Tracks, WORLD, color, order, position};
use draw::layers::{Layer, UNKNOWN};
use draw::view::View;
use interfaces::{Grid, GridFrame};
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
    let frame = of_at_most(&tracks.scene.frame, MAX_CELLS);
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
        let classes = move |view: &View| vec![coarse_classes(&frame, &layer.classes(view.mapper))];
        tracks.add(map(layer), when, classes, |images| {
            let buffers = images.into_iter().map(|classes: Vec<u8>| ImageBuffer(classes.into()));
            SegmentationImage::update_fields().with_many_buffer(buffers)
        });
    }
    Ok(())
}

// Images of a large map: their cells are as much larger as is needed for the memory of a viewer.

/// The maximum number of cells of an image: a square of 145 m with cells of 0.05 m.
const MAX_CELLS: usize = 1 << 23;

fn of_at_most(whole: &GridFrame, most: usize) -> GridFrame {
    let frame = |side: usize| {
        let [width, height] = [whole.width(), whole.height()].map(|cells| cells.div_ceil(side));
        GridFrame::new(whole.origin(), side as f64 * whole.resolution_m(), width, height)
    };
    (1..=whole.len()).filter_map(frame).find(|frame| frame.len() <= most).unwrap_or(*whole)
}

/// The class of each cell of an image: of the cells of the map in it, the highest one. Values are above surfaces, and surfaces
/// above free cells. The map can still be smaller than at the end.
pub(super) fn coarse_classes(frame: &GridFrame, map: &Grid<u8>) -> Vec<u8> {
    if frame == map.frame() {
        return map.cells().to_vec();
    }
    let mut classes = vec![UNKNOWN; frame.len()];
    for (index, class) in map.cells().other_than(UNKNOWN) {
        let center = map.frame().center(map.frame().cell(index));
        if let Some(at) = frame.index(frame.cell_at(&center)) {
            classes[at] = classes[at].max(*class);
        }
    }
    classes
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::Cell;
    use nalgebra::Point2;

    #[test]
    fn a_coarse_image_shows_the_highest_class_of_its_cells() {
        let frame = |x: f64, width, height| GridFrame::new(Point2::new(x, 0.0), 0.5, width, height).unwrap();
        let (whole, before) = (frame(0.0, 7, 4), frame(0.5, 6, 4));
        let mut map = Grid::filled(before, UNKNOWN);
        for (x, y, class) in [(0, 0, 2), (1, 0, 3), (5, 3, 9), (0, 3, 4)] {
            map.set(Cell::new(x, y), class);
        }
        let coarse = of_at_most(&whole, 8);
        assert_eq!((coarse.resolution_m(), coarse.width(), coarse.height()), (1.0, 4, 2));
        assert_eq!(coarse_classes(&coarse, &map), [2, 3, 1, 1, 4, 1, 1, 9]);
        let fine = coarse_classes(&of_at_most(&whole, 28), &map);
        assert_eq!((fine[1], fine.len()), (2, 28));
        assert_eq!(coarse_classes(&of_at_most(&before, MAX_CELLS), &map), map.cells().to_vec());
    }
}
