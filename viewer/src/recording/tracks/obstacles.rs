//! The walls, and everything else that is no robot.

use super::{
    ON_CHANGE, Position, Tracks, WORLD, closed, color, escape, labels, line, order, points, position, strips,
};
use draw::palette;
use draw::scene::{Outline, span};
use draw::view::View;
use nalgebra::Point2;
use rerun::RecordingStreamResult;

/// More names than this would hide the map; a viewer still shows them one by one.
const MAX_LABELS: usize = 4;

pub(super) fn add(tracks: &mut Tracks) -> RecordingStreamResult<()> {
    let scene = tracks.scene;
    let walls = line(color(palette::WALL, 255), 1.0, order::WALLS);
    let walls = walls.with_strips(scene.walls.iter().map(|wall| closed(wall)));
    tracks.always(&format!("{WORLD}/walls"), &walls)?;
    for (index, obstacle) in scene.obstacles.iter().enumerate() {
        let path = format!("{WORLD}/obstacles/{}", escape(&obstacle.name));
        tracks.always(&path, &line(color(obstacle.color(), 255), 2.5, order::WALLS))?;
        if scene.obstacles.len() <= MAX_LABELS {
            let name = format!("{path}/name");
            tracks.always(&name, &labels([obstacle.name.as_str()]))?;
            tracks.add(
                name,
                ON_CHANGE,
                move |view| view.obstacles[index].iter().map(below).collect(),
                points,
            );
        }
        let outline =
            move |view: &View| view.obstacles[index].iter().map(|outline| closed(outline)).collect();
        tracks.add(path, ON_CHANGE, outline, strips);
    }
    Ok(())
}

/// The position of a name, below the middle of an outline.
fn below(outline: &Outline) -> Position {
    let [low, high] = span(outline);
    position(&Point2::new(0.5 * (low.x + high.x), low.y))
}
