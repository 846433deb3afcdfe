//! People who walk through a corridor, seen by a laser: where they go is known, and must be found.

use super::*;
use interfaces::{LaserReading, Scan};
use nalgebra::Vector2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};
use std::f64::consts::{PI, TAU};

/// A corridor, m; turned by this angle, rad.
const CORRIDOR_M: [f64; 2] = [8.0, 2.4];
const TURN_RAD: f64 = 0.6;
/// The radius of a person, m, and the standard deviation of a range, m.
const RADIUS_M: f64 = 0.22;
const NOISE_M: f64 = 0.01;

/// Where people walk, in the corridor.
#[derive(Clone, Copy)]
struct Walks {
    /// The share of the people that go in the direction of the x axis, and the mean time between two of them, s.
    forward: f64,
    every_s: f64,
    /// How far lines differ from the middle, m.
    beside_m: f64,
    /// Whether they walk across the corridor, not along it.
    is_across: bool,
}

/// The distance from a laser to the wall of the corridor or to a person, along a beam.
fn range_m(laser: Vector2<f64>, heading_rad: f64, person: Option<Vector2<f64>>) -> f64 {
    let along = Vector2::new(libm::cos(heading_rad), libm::sin(heading_rad));
    let wall = [0, 1].map(|axis| {
        let far = if along[axis] > 0.0 { CORRIDOR_M[axis] } else { 0.0 };
        if along[axis] == 0.0 { f64::INFINITY } else { (far - laser[axis]) / along[axis] }
    });
    let of_person = person.and_then(|person| {
        let to = person - laser;
        let (ahead, beside) = (to.dot(&along), to.perp(&along));
        (ahead > 0.0 && beside.abs() < RADIUS_M).then(|| ahead - (RADIUS_M.powi(2) - beside.powi(2)).sqrt())
    });
    wall.into_iter().chain(of_person).fold(f64::INFINITY, f64::min)
}

/// A survey of a corridor for some time: the share of the people that really went forward, and the place book.
fn walked(walks: Walks, seconds: f64, laser: [f64; 2], hz: f64) -> (f64, Room) {
    const BEAMS: usize = 720;
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let noise = Normal::new(0.0, NOISE_M).unwrap();
    let frame = GridFrame::covering(Point2::new(-3.0, -1.0), 12.0, 9.0, 0.05).unwrap();
    let mapper = Mapper::new(&MapperSettings::default(), frame).unwrap();
    let mut room = Room { mapper, log: ChangeLog::default(), book: PlaceBook::default(), time_s: 0.0 };
    let turn = interfaces::rotation(TURN_RAD);
    let laser = Vector2::from(laser);
    let mut person: Option<(f64, [Vector2<f64>; 2], f64)> = None;
    let (mut next_s, mut counts) = (20.0, [0.0, 0.0]);
    while room.time_s < seconds {
        if person.is_none() && room.time_s >= next_s {
            let is_forward = random.random_bool(walks.forward);
            counts[usize::from(!is_forward)] += 1.0;
            let aside = random.random_range(-walks.beside_m..=walks.beside_m);
            let middle = Vector2::from(CORRIDOR_M) / 2.0;
            let (along, beside) =
                if walks.is_across { (Vector2::y(), Vector2::x()) } else { (Vector2::x(), Vector2::y()) };
            let half = middle.dot(&along) - RADIUS_M;
            let ends = [-half, half].map(|way| middle + along * way + beside * aside);
            let ends = if is_forward { ends } else { [ends[1], ends[0]] };
            person = Some((room.time_s, ends, random.random_range(0.6..1.5)));
        }
        let at = person.map(|(begin_s, [from, to], speed_mps)| {
            let length = (to - from).norm();
            (
                from + (to - from) * ((room.time_s - begin_s) * speed_mps / length),
                (room.time_s - begin_s) * speed_mps >= length,
            )
        });
        if at.is_some_and(|(_, is_gone)| is_gone) {
            person = None;
            next_s = room.time_s + random.random_range(0.5..1.5) * walks.every_s;
        }
        let at = at.filter(|(_, is_gone)| !is_gone).map(|(at, _)| at);
        let ranges_m = (0..BEAMS).map(|beam| {
            (range_m(laser, TAU * beam as f64 / BEAMS as f64, at) + noise.sample(&mut random)) as f32
        });
        let scan = Scan {
            angle_increment_rad: TAU / BEAMS as f64,
            range_min_m: 0.05,
            range_max_m: 20.0,
            ranges_m: ranges_m.collect(),
            ..Scan::default()
        };
        let stands = turn * laser;
        let reading = LaserReading {
            time_s: room.time_s,
            pose: interfaces::pose(stands.x, stands.y, TURN_RAD),
            scan,
            ..LaserReading::default()
        };
        room.mapper.update(&reading).unwrap();
        room.log.note(&room.mapper);
        room.book.note(&room.mapper);
        room.time_s += 1.0 / hz;
    }
    (counts[0] / (counts[0] + counts[1]), room)
}

/// The directions of all tiles with traffic.
fn directions(room: &Room) -> Vec<Direction> {
    let places = room.places();
    let traffic = places.iter().filter(|place| place.kind == PlaceKind::Traffic);
    traffic.flat_map(|place| &place.tiles).filter_map(|tile| tile.direction).collect()
}

fn apart_rad(a: f64, b: f64) -> f64 {
    interfaces::wrap_rad(a - b).abs()
}

#[test]
fn the_way_of_people_and_the_share_that_goes_each_way_are_found() {
    let along = Walks { forward: 1.0, every_s: 12.0, beside_m: 0.2, is_across: false };
    let cases = [
        ("away from the laser", along, [0.4, 0.4], 10.0),
        ("both ways, seen from the end", Walks { forward: 0.5, ..along }, [0.4, 1.2], 10.0),
        ("mostly forward, three scans per second", Walks { forward: 0.8, ..along }, [4.0, 0.3], 3.0),
        ("across", Walks { is_across: true, beside_m: 0.1, ..along }, [2.0, 0.4], 10.0),
    ];
    for (name, walks, laser, hz) in cases {
        let (forward, room) = walked(walks, 1500.0, laser, hz);
        let found = directions(&room);
        assert!(found.len() >= if walks.is_across { 8 } else { 36 }, "{name}: {} tiles", found.len());
        let ahead_rad = TURN_RAD + if walks.is_across { PI / 2.0 } else { 0.0 };
        let (mut worst_rad, mut share_off, mut inside): (f64, f64, usize) = (0.0, 0.0, 0);
        for Direction { heading_rad, share, share_90: [low, high], .. } in found.iter().copied() {
            let off_rad = apart_rad(heading_rad, ahead_rad);
            let of_heading = if off_rad < PI / 2.0 { forward } else { 1.0 - forward };
            worst_rad = worst_rad.max(off_rad.min(PI - off_rad));
            share_off += (share - of_heading).abs() / found.len() as f64;
            inside += usize::from((low..=high).contains(&of_heading));
        }
        let (worst_deg, count) = (worst_rad.to_degrees(), found.len());
        println!(
            "{name}: {count} tiles, off by at most {worst_deg:.0} degrees, {share_off:.2} on average of the share {forward:.2}, \
             {inside} inside the intervals"
        );
        assert!(worst_deg < 16.0 && share_off < 0.12, "{name}: {worst_deg} degrees, {share_off}");
        assert!(inside as f64 >= 0.85 * count as f64, "{name}: {inside} of {count}");
    }
}
