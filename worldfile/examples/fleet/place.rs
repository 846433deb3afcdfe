//! The world of the benchmark: four rooms of 12 × 12 m, repeated, with robots everywhere.

use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use sim::physics::FleetSpec;
use std::collections::HashMap;
use std::fmt::Write;
use worldfile::WorldError;

/// The side of one house, m.
const HOUSE_M: f64 = 12.0;
/// The thickness of its walls, m.
const WALL_M: f64 = 0.05;
const RADIUS_M: f64 = 0.15;
/// The minimum distance at the start between the centers of two robots, and between a center and a wall, m.
const APART_M: f64 = 2.0 * RADIUS_M + 0.02;
const OFF_WALL_M: f64 = RADIUS_M + 0.02;

/// The number of robots for which there is room in one house, with about 20,000 draws. With a million draws there
/// is room for 900.
const ROOM: usize = 800;

/// Where the doors of 1 m are, as in the shipped four rooms.
const GAPS_M: [(f64, f64); 3] = [(WALL_M, 2.5), (3.5, 8.5), (9.5, HOUSE_M - WALL_M)];

/// A rectangle by its lower left and upper right corner, m.
type Wall = [f64; 4];

/// The settings of the world.
#[derive(Clone, Copy)]
pub(crate) struct Wish {
    pub(crate) robots: usize,
    pub(crate) rays: usize,
    /// The number of sonars of each robot; it is then driven.
    pub(crate) sonars: u32,
    /// The number of corners of each robot; 0: round.
    pub(crate) corners: u32,
    pub(crate) tiles: usize,
    pub(crate) seed: u64,
}

/// Whether there is room for this number of robots; otherwise the number of tiles that is needed.
pub(crate) fn has_room(wish: &Wish) -> Result<(), String> {
    let room = |tiles: usize| ROOM * tiles * tiles;
    let mut tiles = wish.tiles;
    while room(tiles) < wish.robots {
        tiles += 1;
    }
    if tiles == wish.tiles {
        return Ok(());
    }
    Err(format!("there is room for about {} robots; use --tiles {tiles}", room(wish.tiles)))
}

/// The world of the benchmark. There must be room for the robots.
///
/// # Errors
///
/// When a setting is out of the range of its key.
pub(crate) fn place(wish: &Wish) -> Result<FleetSpec, WorldError> {
    worldfile::physics::parse_fleet("fleet", &text(wish))
}

fn text(wish: &Wish) -> String {
    let side_m = HOUSE_M * wish.tiles as f64;
    let mut text = format!(
        "name = \"fleet\"\n\n[map]\nsize_m = [{side_m:?}, {side_m:?}]\ncell_m = 0.25\n\n[physics]\nstep_s = 0.05\n"
    );
    for (column, row) in (0..wish.tiles).flat_map(|row| (0..wish.tiles).map(move |column| (column, row))) {
        let (x, y) = (column as f64 * HOUSE_M, row as f64 * HOUSE_M);
        for [left, bottom, right, top] in house() {
            let (min, max) = ([x + left, y + bottom], [x + right, y + top]);
            let _ = write!(text, "\n[[wall]]\nmin_m = {min:?}\nmax_m = {max:?}\n");
        }
    }
    for (robot, [x, y, heading_deg]) in starts(wish).into_iter().enumerate() {
        // Robot 1 drives a circle, the others wander.
        let behavior = if wish.sonars > 0 {
            "kind = \"driven\""
        } else if robot == 1 {
            "kind = \"circle\"\nspeed_mps = 0.4\nturn_radius_m = 0.8"
        } else {
            "kind = \"wander\"\nspeed_mps = 0.4"
        };
        let _ = write!(
            text,
            "\n[[robot]]\nname = \"robot {robot}\"\n{}\npose_m = [{x:?}, {y:?}]\nheading_deg = {heading_deg:?}\n\n\
             [robot.drive]\nmax_linear_mps = 0.5\nmax_angular_degps = 120.0\n\
             max_linear_acceleration_mps2 = 1.0\nmax_angular_acceleration_degps2 = 360.0\n\n\
             [robot.laser]\nbeams = {}\nrange_max_m = 10.0\nrate_hz = 10.0\n\n{}[robot.behavior]\n{behavior}\n",
            body(wish.corners),
            wish.rays,
            ring(wish.sonars)
        );
    }
    text
}

/// The outline of a robot.
fn body(corners: u32) -> String {
    if corners == 0 {
        return format!("radius_m = {RADIUS_M}");
    }
    let corner = |i: u32| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * (f64::from(i) + 0.5) / f64::from(corners));
        [cos * RADIUS_M, sin * RADIUS_M]
    };
    format!("footprint_m = {:?}", (0..corners).map(corner).collect::<Vec<_>>())
}

/// A ring of sonars that leaves no gap.
fn ring(sonars: u32) -> String {
    let step_deg = 360.0 / f64::from(sonars.max(1));
    let sonar = |i: u32| {
        format!(
            "[[robot.sonar]]\ncone_deg = {:?}\nrange_max_m = 5.0\nrate_hz = 10.0\nmount_deg = {:?}\n\n",
            step_deg.min(30.0),
            f64::from(i) * step_deg
        )
    };
    (0..sonars).map(sonar).collect()
}

/// The walls of one house: around it, and a cross with doors.
fn house() -> Vec<Wall> {
    let (end, middle) = (HOUSE_M - WALL_M, HOUSE_M / 2.0);
    let mut walls = vec![
        [0.0, 0.0, HOUSE_M, WALL_M],
        [0.0, end, HOUSE_M, HOUSE_M],
        [0.0, WALL_M, WALL_M, end],
        [end, WALL_M, HOUSE_M, end],
    ];
    let (low, high) = (middle - WALL_M / 2.0, middle + WALL_M / 2.0);
    for (from, to) in GAPS_M {
        walls.push([low, from, high, to]);
        walls.push([from, low, to, high]);
    }
    walls
}

/// The starts of the robots: for each robot, the first free place that is drawn.
fn starts(wish: &Wish) -> Vec<[f64; 3]> {
    let mut stream = ChaCha8Rng::seed_from_u64(wish.seed);
    let mut draw = |most: f64| (stream.next_u64() >> 11) as f64 * 2.0_f64.powi(-53) * most;
    let side_m = HOUSE_M * wish.tiles as f64;
    let walls = house();
    let off_wall = |x: f64, y: f64| {
        let (x, y) = (x % HOUSE_M, y % HOUSE_M);
        walls.iter().all(|[left, bottom, right, top]| {
            let (dx, dy) = ((left - x).max(x - right).max(0.0), (bottom - y).max(y - top).max(0.0));
            dx * dx + dy * dy > OFF_WALL_M * OFF_WALL_M
        })
    };
    let mut starts: Vec<[f64; 3]> = Vec::new();
    // The robots in each square: only those in the squares around can be too near.
    let mut squares: HashMap<(i32, i32), Vec<usize>> = HashMap::new();
    let square = |x: f64, y: f64| ((x / APART_M) as i32, (y / APART_M) as i32);
    while starts.len() < wish.robots {
        let (x, y) = (draw(side_m), draw(side_m));
        let apart = |robot: &usize| {
            let [a, b, _] = starts[*robot];
            (a - x).powi(2) + (b - y).powi(2) > APART_M * APART_M
        };
        let (column, row) = square(x, y);
        let around =
            (column - 1..=column + 1).flat_map(|column| (row - 1..=row + 1).map(move |row| (column, row)));
        if off_wall(x, y) && around.filter_map(|square| squares.get(&square)).flatten().all(apart) {
            squares.entry((column, row)).or_default().push(starts.len());
            starts.push([x, y, draw(360.0)]);
        }
    }
    starts
}
