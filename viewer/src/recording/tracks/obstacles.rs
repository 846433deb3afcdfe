//! The walls, and everything else that is no robot.

use super::{ON_CHANGE, Tracks, WORLD, closed, color, escape, line, order, strips};
use draw::palette;
use draw::view::View;
use rerun::RecordingStreamResult;

pub(super) fn add(tracks: &mut Tracks) -> RecordingStreamResult<()> {
    let scene = tracks.scene;
    let walls = line(color(palette::WALL, 255), 1.0, order::WALLS);
    let walls = walls.with_strips(scene.walls.iter().map(|wall| closed(wall)));
    tracks.always(&format!("{WORLD}/walls"), &walls)?;
    for (index, obstacle) in scene.obstacles.iter().enumerate() {
        let path = format!("{WORLD}/obstacles/{}", escape(&obstacle.name));
        tracks.always(&path, &line(color(obstacle.color(), 255), 2.5, order::WALLS))?;
        let outline =
            move |view: &View| view.obstacles[index].iter().map(|outline| closed(outline)).collect();
        tracks.add(path, ON_CHANGE, outline, strips);
    }
    Ok(())
}
