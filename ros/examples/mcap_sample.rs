//! A short bag with messages of every kind, for a look in Foxglove and for tests with other readers.
//!
//! ```text
//! cargo run -p curious-ros --example mcap_sample -- sample.mcap
//! ```
//!
//! A robot drives around in a square room, and a door in the right wall opens and closes.

use files::UnfinishedFile;
use interfaces::{Cell, Event, Grid, GridFrame, LaserReading, Scan, Twist, pose, rotation};
use nalgebra::{Isometry2, Point2, Vector2};
use ros::McapWriter;
use std::error::Error;
use std::f64::consts::TAU;
use std::io::BufWriter;

/// Half the side of the room, m.
const WALL_M: f64 = 4.0;
const BEAMS: usize = 360;
const PERIOD_S: f64 = 0.1;
/// 2026-01-01, s since the epoch.
const BEGIN_S: f64 = 1_767_225_600.0;

fn main() -> Result<(), Box<dyn Error>> {
    let Some(path) = std::env::args().nth(1) else { return Err("usage: mcap_sample FILE.mcap".into()) };
    let mut writer = McapWriter::new(BufWriter::new(UnfinishedFile::create(path.as_ref())?), &path, BEGIN_S)?;
    for step in 0..300 {
        let time_s = f64::from(step) * PERIOD_S;
        let reading = reading(time_s);
        writer.reading(&reading)?;
        if step % 10 == 0 {
            let is_open = step / 30 % 2 == 1;
            writer.correction(time_s, &pose(0.0, 0.01 * time_s, 0.0))?;
            writer.grid("/map", time_s, &room(is_open), |value| *value)?;
            let ahead = [0.0, 0.5, 1.0].map(|later_s| robot(time_s + later_s));
            writer.goal(time_s, &ahead[2])?;
            writer.path(time_s, &ahead)?;
            if step % 30 == 0 && step > 0 {
                let event = if is_open { Event::Free } else { Event::Block };
                writer.events(time_s, &[(Point2::new(WALL_M, 0.0), event)])?;
            }
        }
    }
    writer.finish()?.into_inner()?.finish()?;
    Ok(())
}

/// The robot drives on a circle with 0.5 m/s and 0.25 rad/s.
fn robot(time_s: f64) -> Isometry2<f64> {
    let turn_rad = 0.25 * time_s;
    let at = rotation(turn_rad) * Vector2::new(0.0, -2.0);
    pose(at.x, at.y, turn_rad)
}

fn reading(time_s: f64) -> LaserReading {
    let (pose, mount) = (robot(time_s), interfaces::pose(0.2, 0.0, 0.0));
    let from = pose * mount;
    let range_m = |beam: usize| {
        let along = from.rotation * rotation(beam as f64 * TAU / BEAMS as f64) * Vector2::x();
        let at = from.translation.vector;
        let to_wall = |at: f64, along: f64| (WALL_M.copysign(along) - at) / along;
        to_wall(at.x, along.x).min(to_wall(at.y, along.y)) as f32
    };
    let scan = Scan {
        angle_min_rad: 0.0,
        angle_increment_rad: TAU / BEAMS as f64,
        range_min_m: 0.1,
        range_max_m: 12.0,
        sweep_s: 0.0,
        ranges_m: (0..BEAMS).map(range_m).collect(),
    };
    let twist = Twist { linear_mps: 0.5, angular_radps: 0.25 };
    LaserReading { time_s, pose, twist, velocities: Vec::new(), mount, scan }
}

/// The walls, and a door in the right one; nothing is known beyond them.
fn room(is_open: bool) -> Grid<Option<f64>> {
    let cells = |length_m: f64| (length_m / 0.1).round() as usize;
    let side = cells(2.0 * WALL_M) + 4;
    let corner = -WALL_M - 0.2;
    let frame = GridFrame::new(Point2::new(corner, corner), 0.1, side, side).expect("a small grid");
    let mut grid = Grid::filled(frame, None);
    for index in 0..frame.len() {
        let Cell { x, y } = frame.cell(index);
        let center = frame.center(Cell::new(x, y));
        let away = center.x.abs().max(center.y.abs());
        let is_door = center.x > WALL_M && center.y.abs() < 0.5;
        grid.cells_mut()[index] = match away {
            _ if away < WALL_M => Some(0.0),
            _ if away < WALL_M + 0.1 => Some(if is_door && is_open { 0.0 } else { 1.0 }),
            _ => None,
        };
    }
    grid
}
