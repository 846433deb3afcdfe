//! What the scan filter removes of the scans of a laser whose beams have a width: in generated houses, with exact poses.
//!
//! The robot drives about at random. A second world, equal but for a laser of rays without noise, tells which hits are
//! veils: those that are more than 0.1 m from what the ray in the middle of the beam hits, and from what the rays at the
//! edges of the beam hit. Posts of 3 cm stand in the house. Printed per beam width and filter: the share of veils that is
//! removed, the share of the other hits that is lost, how many posts of those that beams hit in five scans are on the map,
//! and the changes of cells where nothing ever changes.
//!
//! ```text
//! cargo run -p curious-evaluation --example veils -- [HOUSES [MINUTES]]
//! ```

use evaluation::metrics::rate_scores;
use interfaces::{CellState, LaserReading, Twist, World};
use mapper::{Mapper, MapperSettings, NoReturn, ScanFilter, ScanFilterSettings};
use nalgebra::{Point2, Vector2};
use sim::physics::{FleetSpec, FreeSpace, Motion, ObstacleSpec, PhysicsWorld, Rectangle, WorldSpec};
use std::error::Error;

/// The side of a post, m.
const POST_M: f64 = 0.03;
/// The farthest hit by which a post counts as seen, m: a beam of the laser is 3 cm from the next one there.
const NEAR_M: f64 = 3.5;

/// The sums of one filter over all houses.
#[derive(Clone, Copy, Default)]
struct Sums {
    veils: [usize; 2],
    hits: [usize; 2],
    posts: [usize; 2],
    changes: u64,
    scans: usize,
}

fn main() -> Result<(), Box<dyn Error>> {
    let number = |index: usize, default| std::env::args().nth(index).map_or(Ok(default), |text| text.parse());
    let (houses, minutes): (u64, u64) = (number(1, 6)?, number(2, 10)?);
    println!(
        "| beam width | filter | veils removed | other hits lost | posts on the map | false changes per 1000 scans |"
    );
    println!("|---|---|---|---|---|---|");
    for width_deg in [0.0, 0.25, 0.5, 1.0] {
        let mut sums = [Sums::default(); 3];
        (0..houses).for_each(|seed| run(seed, width_deg, minutes, &mut sums));
        for (name, sums) in ["none", "veils", "veils, and 0.04 m beside edges"].iter().zip(sums) {
            let percent = |[part, all]: [usize; 2]| match all {
                0 => "–".to_owned(),
                _ => format!("{:.2} %", 100.0 * part as f64 / all as f64),
            };
            let ([found, seen], per_1000) = (sums.posts, sums.changes as f64 * 1000.0 / sums.scans as f64);
            let (mut veils, hits) = (percent(sums.veils), percent(sums.hits));
            if sums.veils[1] > 0 {
                veils += &format!(" of {}", sums.veils[1]);
            }
            println!("| {width_deg}° | {name} | {veils} | {hits} | {found} of {seen} | {per_1000:.1} |");
        }
    }
    Ok(())
}

/// One house with three filters on the same scans.
fn run(seed: u64, width_deg: f64, minutes: u64, sums: &mut [Sums; 3]) {
    let (spec, posts) = house(seed);
    let [mut world, mut exact] = [width_deg, 0.0].map(|width_deg| {
        let mut fleet: FleetSpec = spec.fleet().clone();
        let laser = &mut fleet.robots[spec.driven_index()].laser;
        (laser.beam_width_rad, laser.sweep_s) = (f64::to_radians(width_deg), 0.0);
        laser.noise_std_m = if width_deg > 0.0 { laser.noise_std_m } else { 0.0 };
        let mut world = PhysicsWorld::new(&WorldSpec::new(fleet).unwrap(), seed);
        world.correct_odometry();
        world
    });
    let settings = MapperSettings { max_gap: 8.0, ..MapperSettings::default() };
    let mut mappers = [(); 3].map(|()| Mapper::new(&settings, spec.frame).unwrap());
    let filter = |edge_m| ScanFilterSettings { edge_m, no_return: NoReturn::Free, ..Default::default() };
    let mut filters = [0.0, 0.04].map(|edge_m| ScanFilter::new(&filter(edge_m)).unwrap());
    let mut seen = vec![0; posts.len()];
    while world.time_s() < minutes as f64 * 60.0 {
        let (reading, truth) = (world.sense(), exact.sense());
        let scans = [reading.clone(), filters[0].filter(reading.clone()), filters[1].filter(reading.clone())];
        for ((sums, mapper), filtered) in sums.iter_mut().zip(&mut mappers).zip(&scans) {
            mapper.update(filtered).unwrap();
            sums.scans += 1;
            count(&reading, filtered, &truth, sums);
        }
        for (post, seen) in posts.iter().zip(&mut seen) {
            let at = reading.pose.inverse() * post;
            let hit = truth.hits().any(|hit| (hit - at).norm() < POST_M && at.coords.norm() < NEAR_M);
            *seen += usize::from(hit);
        }
        let drive = wander(&truth);
        world.act(&drive);
        exact.act(&drive);
    }
    for (sums, mapper) in sums.iter_mut().zip(&mappers) {
        sums.changes += rate_scores(mapper, world.truth()).false_change_events;
        let near = |post: &Point2<f64>| {
            let cells =
                mapper.frame().cell_at(post).neighbours8().into_iter().chain([mapper.frame().cell_at(post)]);
            cells.into_iter().any(|cell| mapper.states().get(cell) == Some(&CellState::Blocked))
        };
        let seen = posts.iter().zip(&seen).filter(|(_, seen)| **seen >= 5);
        let [found, all] = &mut sums.posts;
        seen.for_each(|(post, _)| (*found, *all) = (*found + usize::from(near(post)), *all + 1));
    }
}

/// Counts the veils and the other hits of a scan, and those that the filter has removed.
fn count(reading: &LaserReading, filtered: &LaserReading, truth: &LaserReading, sums: &mut Sums) {
    let (scan, beams) = (&reading.scan, truth.scan.ranges_m.len());
    for (beam, (range_m, kept_m)) in scan.ranges_m.iter().zip(&filtered.scan.ranges_m).enumerate() {
        let around = [beam + beams - 1, beam, beam + 1].map(|beam| truth.scan.ranges_m[beam % beams]);
        if range_m.is_finite() {
            let is_veil = around.iter().all(|true_m| (range_m - true_m).abs() > 0.1);
            let [removed, all] = if is_veil { &mut sums.veils } else { &mut sums.hits };
            (*removed, *all) = (*removed + usize::from(kept_m.is_nan()), *all + 1);
        }
    }
}

/// A generated house with posts where nothing else is.
fn house(seed: u64) -> (WorldSpec, Vec<Point2<f64>>) {
    let mut fleet = WorldSpec::generate_house(seed).fleet().clone();
    let spec = WorldSpec::new(fleet.clone()).unwrap();
    let space = FreeSpace::new(&spec, 0.35);
    let start = spec.driven().pose.translation.vector.into();
    let free = (0..spec.frame.len()).filter(|index| space.regions()[*index].is_some());
    let mut posts: Vec<Point2<f64>> = Vec::new();
    for at in free.map(|index| spec.frame.center(spec.frame.cell(index))) {
        if posts.iter().chain([&start]).all(|other| (at - other).norm() > 2.5) {
            posts.push(at);
        }
    }
    fleet.obstacles.extend(posts.iter().enumerate().map(|(number, at)| ObstacleSpec {
        name: format!("post {number}"),
        shape: Rectangle::around(*at, Vector2::repeat(POST_M), 0.3),
        motion: Motion::Fixed,
        appears_s: None,
        disappears_s: None,
        part: None,
    }));
    (WorldSpec::new(fleet).unwrap(), posts)
}

/// Drives straight, and turns where something is ahead.
fn wander(reading: &LaserReading) -> Twist {
    let ahead = |hit: &Point2<f64>| (0.0..0.55).contains(&hit.x) && hit.y.abs() < 0.3;
    if reading.hits().any(|hit| ahead(&hit)) {
        return Twist { linear_mps: 0.0, angular_radps: 1.0 };
    }
    Twist { linear_mps: 0.4, angular_radps: 0.15 * libm::sin(reading.time_s / 7.0) }
}
