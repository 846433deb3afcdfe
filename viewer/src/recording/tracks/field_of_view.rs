//! The field of view of the laser of the curious robot.

use super::{Kind, Tracks, WORLD, color, line, order, position, strips};
use draw::outline::field_of_view;
use draw::palette;
use draw::view::View;
use rerun::RecordingStreamResult;

/// Adds the outline of what the robot sees; nothing if no robot sees in the first view.
pub(super) fn add(tracks: &mut Tracks) -> RecordingStreamResult<()> {
    if tracks.view.sight().is_none() {
        return Ok(());
    }
    let path = format!("{WORLD}/field_of_view");
    tracks.always(&path, &line(color(palette::SENSOR, 220), 1.5, order::SIGHT_OUTLINE))?;
    let outline = |view: &View| {
        let corners = view.sight().map(field_of_view);
        corners.iter().map(|corners| corners.iter().map(position).collect()).collect()
    };
    tracks.add(path, (Kind::State, 0.2), outline, strips);
    Ok(())
}
