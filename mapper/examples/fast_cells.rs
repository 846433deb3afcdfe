//! Things that change fast, before a laser that stands: the cycle rate that the mapper finds, divided by the true one.
//!
//! ```text
//! (echo "# $(git show -s --format='commit %h of %cs'), cargo run -p curious-mapper --example fast_cells";
//!  cargo run -p curious-mapper --example fast_cells) > docs/results/fast_changes.csv
//! ```
//!
//! A box comes and goes; the leaf of a door swings between closed and open within 0.2 s; a row of round bodies, 0.4 m wide and
//! 0.8 m from center to center, passes. Each is away (open) and there (closed) for the dwell, from the first scan on. A row
//! has the mean over cells and phases, and the means of the lowest and of the highest phase.

#[path = "../tests/house/mod.rs"]
mod house;

use house::{House, Thing, rectangle};
use mapper::{Mapper, MapperSettings};
use nalgebra::{Point2, Vector2};

const RUN_S: f64 = 60.0;
const PHASES: u32 = 5;
const DWELLS_S: [f64; 9] = [0.4, 0.5, 0.6, 0.8, 0.9, 1.0, 1.5, 2.0, 3.0];
const RATES_HZ: [f64; 3] = [5.0, 10.0, 20.0];
const SWING_S: f64 = 0.2;
const LASER: [f64; 2] = [3.0, 2.0];

/// Outlines, and discs with their radius, m.
type Solids = (Vec<Vec<Point2<f64>>>, Vec<(Point2<f64>, f64)>);

/// A thing that moves, and the cells (from and to, by column and row) whose rate is looked at.
struct Kind {
    name: &'static str,
    cells: [[i32; 2]; 2],
    /// The outlines and the discs at a time, for a dwell.
    place: fn(f64, f64) -> Solids,
}

const KINDS: [Kind; 4] = [
    Kind { name: "box sides", cells: [[30, 60], [37, 60]], place: blink },
    Kind { name: "box inside", cells: [[31, 63], [35, 66]], place: blink },
    Kind { name: "door leaf", cells: [[53, 68], [66, 68]], place: swing },
    Kind { name: "bodies that pass", cells: [[50, 59], [68, 61]], place: pass },
];

fn blink(time_s: f64, dwell_s: f64) -> Solids {
    let is_there = time_s.rem_euclid(2.0 * dwell_s) < dwell_s;
    (if is_there { vec![rectangle(1.5, 3.0, 1.9, 3.4)] } else { Vec::new() }, Vec::new())
}

/// The hinge is at (2.6, 3.4); closed, the leaf points along x.
fn swing(time_s: f64, dwell_s: f64) -> Solids {
    let at_s = time_s.rem_euclid(2.0 * dwell_s);
    let closed = (1.0 - at_s / SWING_S).max(0.0) + ((at_s - dwell_s) / SWING_S).clamp(0.0, 1.0);
    let turn = interfaces::rotation((1.0 - closed) * 1.5);
    let corner = |corner: Point2<f64>| Point2::new(2.6, 3.4) + turn * corner.coords;
    (vec![rectangle(0.0, 0.0, 0.8, 0.05).into_iter().map(corner).collect()], Vec::new())
}

fn pass(time_s: f64, dwell_s: f64) -> Solids {
    let first_m = (0.4 / dwell_s * time_s).rem_euclid(0.8);
    let body = |number: i32| (Point2::new(2.0 + first_m + 0.8 * f64::from(number), 3.0), 0.2);
    (Vec::new(), (0..3).map(body).collect())
}

/// The rate that is found, divided by the true one: the mean over the cells.
fn found(kind: &Kind, rate_hz: f64, dwell_s: f64, phase: u32) -> f64 {
    let still = House::new(0.1, 0.0, 0.01, 720, 1 + u64::from(phase));
    let mut mapper = Mapper::new(&MapperSettings::default(), still.frame).expect("default settings");
    let phase_s = (f64::from(phase) + 0.5) / f64::from(PHASES) * 2.0 * dwell_s;
    for scan in 0..(RUN_S * rate_hz) as u32 {
        let time_s = f64::from(scan) / rate_hz;
        let (outlines, discs) = (kind.place)(time_s + phase_s, dwell_s);
        let mut house = still.clone();
        outlines.into_iter().for_each(|outline| house.add(Thing::always(outline)));
        let reading = house.reading(time_s, interfaces::pose(LASER[0], LASER[1], 0.0), &discs);
        mapper.update(&reading).expect("a valid reading");
    }
    let [low, high] = kind.cells;
    let cells = (low[1]..=high[1]).flat_map(|y| (low[0]..=high[0]).map(move |x| Vector2::new(x, y)));
    let index =
        |at: Vector2<i32>| mapper.frame().index(interfaces::Cell::new(at.x, at.y)).expect("in the map");
    let rates: Vec<f64> = cells.map(|at| mapper.rate(index(at))).collect();
    rates.iter().sum::<f64>() / rates.len() as f64 * 2.0 * dwell_s
}

fn main() {
    println!("kind,dwell_s,rate_hz,mean,low,high");
    for kind in &KINDS {
        for dwell_s in DWELLS_S {
            for rate_hz in RATES_HZ {
                let phases: Vec<f64> =
                    (0..PHASES).map(|phase| found(kind, rate_hz, dwell_s, phase)).collect();
                let mean = phases.iter().sum::<f64>() / phases.len() as f64;
                let (low, high) =
                    phases.iter().fold((f64::MAX, 0.0_f64), |(low, high), &p| (low.min(p), high.max(p)));
                println!("{},{dwell_s},{rate_hz},{mean:.4},{low:.4},{high:.4}", kind.name);
            }
        }
    }
}
