//! Wait or go round? Trips between random rooms of generated buildings, in which doors open and close.
//!
//! ```text
//! cargo run --locked -p curious-studies --bin trips
//! ```
//!
//! Rooms lie in a grid. A tree of passages that are always open, some of them long, joins all rooms, so that there is a way round
//! every door; doors are short cuts. A door is a two-state chain: its mean stays are log-uniform. Every robot plans by the expected
//! time through the doors at the time of arrival, by dynamic programming over rooms and the doors that it has given up; in front of a
//! closed door it waits as long as its belief says. The robots differ in their belief alone:
//!
//! - `oracle`: the true rates and the last look. In front of a door with a known rate, waiting is best to the end or not at all.
//! - `waits`: learned from 20 looks, of which at least five found the door closed; there the robot waited for up to two minutes.
//! - `snapshots`: learned from the same looks without a wait. `nothing`: from the last look and the shipped population alone.
//! - `last look`: doors stay as they were last seen. `always wait`: the shortest way, at any wait. `never wait`: the shortest way, round
//!   what is closed.
//!
//! The looks at a door are one to five minutes apart, and so are the trips; the robots go on learning. All robots meet the same
//! changes.

use clap::Parser;
use interfaces::{Purpose, RandomStream};
use mapper::{Evidence, Population, Posterior, Waiting};
use rayon::prelude::*;

#[derive(Parser)]
struct Options {
    /// The number of buildings
    #[arg(long, default_value_t = 400)]
    buildings: u64,
    /// The seed of the first building
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// The number of trips in each building
    #[arg(long, default_value_t = 3)]
    trips: usize,
    /// The number of looks at each door before the trips
    #[arg(long, default_value_t = 20)]
    looks: usize,
    /// The range of mean stays, s
    #[arg(long, num_args = 2, default_values_t = [15.0, 1800.0])]
    stays: Vec<f64>,
}

const SPEED_MPS: f64 = 0.5;
const ROOMS: [usize; 2] = [4, 3];
const PITCH_M: f64 = 6.0;
const DOORS: usize = 5;
/// Before a trip, looks at a door are this far apart, s.
const BETWEEN_S: [f64; 2] = [60.0, 300.0];
/// While a robot learns, it waits for a time in this range, s.
const WAIT_S: [f64; 2] = [20.0, 120.0];
/// A look in a view.
const STEP_S: f64 = 2.0;
const MIN_WAITS: usize = 5;

/// A door and what happens to it.
#[derive(Clone)]
struct Chain {
    /// The mean stays open and closed, s.
    stays_s: [f64; 2],
    /// The times of its changes, s, alternately closing and opening; it is open first.
    changes_s: Vec<f64>,
    random: RandomStream,
}

impl Chain {
    fn new(stays_s: [f64; 2], mut random: RandomStream) -> Self {
        // From the stationary state.
        let is_closed = random.bernoulli(stays_s[1] / (stays_s[0] + stays_s[1]));
        Self { stays_s, changes_s: if is_closed { vec![0.0] } else { Vec::new() }, random }
    }

    /// The number of changes until a time.
    fn count(&mut self, time_s: f64) -> usize {
        while self.changes_s.last().is_none_or(|last_s| *last_s <= time_s) {
            let last_s = self.changes_s.last().copied().unwrap_or(0.0);
            let stay_s = self.random.exponential(self.stays_s[self.changes_s.len() % 2]);
            self.changes_s.push(last_s + stay_s);
        }
        self.changes_s.partition_point(|change_s| *change_s <= time_s)
    }

    fn is_closed(&mut self, time_s: f64) -> bool {
        self.count(time_s) % 2 == 1
    }

    /// When it opens, if it is closed.
    fn opens_s(&mut self, time_s: f64) -> f64 {
        let next = self.count(time_s);
        self.changes_s[next]
    }
}

/// What a robot knows of a door.
#[derive(Clone)]
struct Known {
    evidence: Evidence,
    posterior: Posterior,
    was_closed: bool,
    last_s: f64,
}

impl Known {
    fn new(was_closed: bool, last_s: f64) -> Self {
        let evidence = Evidence::default();
        let posterior = Posterior::new(&evidence, &Population::default());
        Self { evidence, posterior, was_closed, last_s }
    }

    /// Looks at the door, and, if it is closed, waits for at most a time. Returns when the wait is over, and whether the door is open.
    fn visit(&mut self, chain: &mut Chain, time_s: f64, patience_s: f64) -> (f64, bool) {
        let is_closed = chain.is_closed(time_s);
        if time_s > self.last_s {
            self.evidence.gap(self.was_closed, is_closed, time_s - self.last_s);
        }
        let (mut now_s, mut is_open) = (time_s, !is_closed);
        if is_closed {
            let opens_s = chain.opens_s(time_s);
            let end_s = opens_s.min(time_s + patience_s);
            while now_s + STEP_S < end_s {
                self.evidence.look(true, true, STEP_S);
                now_s += STEP_S;
            }
            is_open = opens_s <= time_s + patience_s;
            if end_s > now_s {
                self.evidence.look(true, !is_open, end_s - now_s);
            }
            now_s = end_s;
        }
        (self.was_closed, self.last_s) = (!is_open, now_s);
        (now_s, is_open)
    }

    fn learn(&mut self) {
        self.posterior = Posterior::new(&self.evidence, &Population::default());
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Robot {
    Oracle,
    Waits,
    Snapshots,
    Nothing,
    LastLook,
    AlwaysWait,
    NeverWait,
}

const ROBOTS: [(Robot, &str); 7] = [
    (Robot::Oracle, "oracle"),
    (Robot::Waits, "waits"),
    (Robot::Snapshots, "snapshots"),
    (Robot::Nothing, "nothing"),
    (Robot::LastLook, "last look"),
    (Robot::AlwaysWait, "always wait"),
    (Robot::NeverWait, "never wait"),
];

/// What a robot expects of a door at a time: the probability that it is closed, and for how long then.
fn expected(robot: Robot, known: &Known, chain: &Chain, time_s: f64) -> (f64, Waiting) {
    let never = || Waiting::known(1e-9);
    let elapsed_s = time_s - known.last_s;
    match robot {
        Robot::Oracle => {
            let [open_hz, closed_hz] = chain.stays_s.map(f64::recip);
            let (all_hz, share) = (open_hz + closed_hz, open_hz / (open_hz + closed_hz));
            let was = f64::from(u8::from(known.was_closed));
            (share + (was - share) * libm::exp(-all_hz * elapsed_s), Waiting::known(closed_hz))
        }
        Robot::Waits | Robot::Snapshots | Robot::Nothing => {
            let closed = known.posterior.probability(known.was_closed, elapsed_s);
            (closed, known.posterior.waiting(true, known.was_closed, elapsed_s))
        }
        Robot::LastLook => (f64::from(u8::from(known.was_closed)), never()),
        Robot::AlwaysWait => (0.0, Waiting::known(1e9)),
        Robot::NeverWait => (0.0, never()),
    }
}

/// A connection of two rooms.
#[derive(Clone, Copy)]
struct Edge {
    rooms: [usize; 2],
    time_s: f64,
    door: Option<usize>,
}

struct Building {
    edges: Vec<Edge>,
    chains: Vec<Chain>,
    /// What is known of each door by robots that waited, and by those that only looked.
    known: [Vec<Known>; 2],
    /// When the trips begin, s.
    begin_s: f64,
}

impl Building {
    fn generate(seed: u64, options: &Options) -> Self {
        let mut random = RandomStream::new(seed, Purpose::DayGenerator);
        let [columns, rows] = ROOMS;
        let mut pairs = Vec::new();
        for room in 0..columns * rows {
            if room % columns + 1 < columns {
                pairs.push([room, room + 1]);
            }
            if room + columns < columns * rows {
                pairs.push([room, room + columns]);
            }
        }
        for last in (1..pairs.len()).rev() {
            pairs.swap(last, random.uniform(0.0..(last + 1) as f64) as usize);
        }
        // Kruskal's algorithm in a random order: the first ones make the tree.
        let mut group: Vec<usize> = (0..columns * rows).collect();
        let (mut edges, mut doors) = (Vec::new(), 0);
        for rooms in pairs {
            let [a, b] = rooms.map(|room| group[room]);
            let length_m = PITCH_M * random.uniform(0.8..1.2);
            if a != b {
                group.iter_mut().filter(|group| **group == b).for_each(|group| *group = a);
                let length_m = length_m * random.uniform(1.0..2.5);
                edges.push(Edge { rooms, time_s: length_m / SPEED_MPS, door: None });
            } else if doors < DOORS {
                edges.push(Edge { rooms, time_s: length_m / SPEED_MPS, door: Some(doors) });
                doors += 1;
            }
        }
        let between_s = |random: &mut RandomStream| random.uniform(BETWEEN_S[0]..BETWEEN_S[1]);
        let begin_s = 400.0 * (options.looks + 2) as f64;
        let (mut chains, mut known) = (Vec::new(), [Vec::new(), Vec::new()]);
        for door in 0..doors {
            for attempt in 0.. {
                let number = 1000 * attempt + door;
                let logs = [options.stays[0], options.stays[1]].map(libm::log);
                let stays_s = [0, 1].map(|_| libm::exp(random.uniform(logs[0]..logs[1])));
                let mut chain = Chain::new(stays_s, RandomStream::new(seed, Purpose::Thing(number)));
                // Backwards from the last look, so that the looks end before the trips.
                let mut looks_s = vec![begin_s - random.uniform(0.0..BETWEEN_S[1])];
                for _ in 1..options.looks.max(1) {
                    looks_s.push(looks_s[looks_s.len() - 1] - between_s(&mut random));
                }
                looks_s.reverse();
                let was_closed = chain.is_closed(looks_s[0]);
                let mut each = [Known::new(was_closed, looks_s[0]), Known::new(was_closed, looks_s[0])];
                let mut waits = 0;
                for (number, look_s) in looks_s.iter().enumerate() {
                    let room_s = looks_s.get(number + 1).unwrap_or(&begin_s) - look_s;
                    let patience_s = random.uniform(WAIT_S[0]..WAIT_S[1]).min(0.5 * room_s);
                    waits += usize::from(chain.is_closed(*look_s));
                    each[0].visit(&mut chain, *look_s, patience_s);
                    each[1].visit(&mut chain, *look_s, 0.0);
                }
                if options.looks < 20 || waits >= MIN_WAITS {
                    each.iter_mut().for_each(Known::learn);
                    let [with, without] = each;
                    known[0].push(with);
                    known[1].push(without);
                    chains.push(chain);
                    break;
                }
            }
        }
        Self { edges, chains, known, begin_s }
    }

    /// The shortest times from a room, s, with all doors open.
    fn shortest(&self, from: usize) -> Vec<f64> {
        let mut times_s = vec![f64::INFINITY; ROOMS[0] * ROOMS[1]];
        times_s[from] = 0.0;
        for _ in 0..times_s.len() {
            for edge in &self.edges {
                for [a, b] in [edge.rooms, [edge.rooms[1], edge.rooms[0]]] {
                    times_s[b] = times_s[b].min(times_s[a] + edge.time_s);
                }
            }
        }
        times_s
    }

    /// The expected times from all rooms to the goal, s, by the doors that are given up, as a set of bits. `beliefs`: of each door.
    fn values(&self, beliefs: &[(f64, Waiting)], goal: usize, given_up: usize) -> Vec<Vec<f64>> {
        let sets = 1 << beliefs.len();
        let mut values = vec![Vec::new(); sets];
        for set in (0..sets).rev().filter(|set| set & given_up == given_up) {
            let mut own = vec![f64::INFINITY; ROOMS[0] * ROOMS[1]];
            own[goal] = 0.0;
            loop {
                let mut is_done = true;
                for edge in &self.edges {
                    for [from, to] in [edge.rooms, [edge.rooms[1], edge.rooms[0]]] {
                        let value = self.through(*edge, own[to], from, set, &values, beliefs);
                        if value < own[from] - 1e-9 {
                            own[from] = value;
                            is_done = false;
                        }
                    }
                }
                if is_done {
                    break;
                }
            }
            values[set] = own;
        }
        values
    }

    /// The expected time from a room to the goal through an edge, s.
    fn through(
        &self,
        edge: Edge,
        after_s: f64,
        from: usize,
        set: usize,
        values: &[Vec<f64>],
        beliefs: &[(f64, Waiting)],
    ) -> f64 {
        let open_s = edge.time_s + after_s;
        let Some(door) = edge.door else { return open_s };
        if set & 1 << door != 0 || open_s == f64::INFINITY {
            return f64::INFINITY;
        }
        let (closed, waiting) = &beliefs[door];
        open_s + closed * waiting.best_s((values[set | 1 << door][from] - open_s).max(0.0))
    }

    /// The time of a trip, s.
    fn trip(&mut self, robot: Robot, known: &mut [Known], [start, goal]: [usize; 2], begin_s: f64) -> f64 {
        let (mut room, mut now_s, mut given_up) = (start, begin_s, 0);
        while room != goal {
            let ways_s = self.shortest(room);
            let doors = self.edges.iter().filter(|edge| edge.door.is_some());
            let mut beliefs = vec![(0.0, Waiting::known(1.0)); self.chains.len()];
            for edge in doors {
                let Some(door) = edge.door else { continue };
                let arrival_s =
                    now_s + edge.rooms.map(|room| ways_s[room]).iter().copied().fold(f64::INFINITY, f64::min);
                beliefs[door] = expected(robot, &known[door], &self.chains[door], arrival_s);
            }
            let values = self.values(&beliefs, goal, given_up);
            let own = &values[given_up];
            let others = |edge: &Edge| match edge.rooms {
                [a, b] if a == room => Some(b),
                [a, b] if b == room => Some(a),
                _ => None,
            };
            let choices = self.edges.iter().filter_map(|edge| {
                let to = others(edge)?;
                Some((self.through(*edge, own[to], room, given_up, &values, &beliefs), *edge, to))
            });
            let Some((_, edge, to)) = choices.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            if let Some(door) = edge.door {
                // The door is seen now.
                let open_s = edge.time_s + own[to];
                let is_closed = self.chains[door].is_closed(now_s);
                let patience_s = if is_closed {
                    known[door].visit(&mut self.chains[door], now_s, 0.0);
                    if matches!(robot, Robot::Waits | Robot::Snapshots | Robot::Nothing) {
                        known[door].learn();
                    }
                    let (_, waiting) = expected(robot, &known[door], &self.chains[door], now_s);
                    let waiting = if robot == Robot::AlwaysWait { Waiting::known(1e9) } else { waiting };
                    waiting.patience_s((values[given_up | 1 << door][room] - open_s).max(0.0))
                } else {
                    0.0
                };
                let (end_s, is_open) = known[door].visit(&mut self.chains[door], now_s, patience_s);
                if matches!(robot, Robot::Waits | Robot::Snapshots | Robot::Nothing) {
                    known[door].learn();
                }
                now_s = end_s;
                if !is_open {
                    given_up |= 1 << door;
                    continue;
                }
            }
            now_s += edge.time_s;
            room = to;
        }
        now_s - begin_s
    }
}

/// The mean times of the trips of all robots in a building, s.
fn run(seed: u64, options: &Options) -> Vec<f64> {
    let mut building = Building::generate(seed, options);
    let of_robot = |(robot, _): &(Robot, &str)| {
        let mut known = building.known[usize::from(*robot == Robot::Snapshots)].clone();
        if *robot == Robot::Nothing {
            known.iter_mut().for_each(|known| *known = Known::new(known.was_closed, known.last_s));
        }
        let mut random = RandomStream::new(seed, Purpose::Task);
        let (mut begin_s, mut sum_s) = (building.begin_s, 0.0);
        for _ in 0..options.trips {
            let rooms = (ROOMS[0] * ROOMS[1]) as f64;
            let start = random.uniform(0.0..rooms) as usize;
            let goal = (start + 1 + random.uniform(0.0..rooms - 1.0) as usize) % rooms as usize;
            let time_s = building.trip(*robot, &mut known, [start, goal], begin_s);
            sum_s += time_s;
            begin_s = f64::max(begin_s + BETWEEN_S[1], begin_s + time_s);
        }
        sum_s / options.trips as f64
    };
    ROBOTS.iter().map(of_robot).collect()
}

fn main() {
    let options = Options::parse();
    let seeds: Vec<u64> = (options.seed..options.seed + options.buildings).collect();
    let times_s: Vec<Vec<f64>> = seeds.par_iter().map(|seed| run(*seed, &options)).collect();
    let count = times_s.len() as f64;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let of = |robot: usize| -> Vec<f64> { times_s.iter().map(|times_s| times_s[robot]).collect() };
    let oracle_s = of(0);
    println!(
        "{} buildings, {} trips in each, {} looks before",
        options.buildings, options.trips, options.looks
    );
    println!("{:<12} {:>8} {:>22}", "robot", "s/trip", "more than the oracle");
    for (robot, (_, name)) in ROBOTS.iter().enumerate() {
        let own_s = of(robot);
        let more_s: Vec<f64> = own_s.iter().zip(&oracle_s).map(|(own, oracle)| own - oracle).collect();
        let mean_s = mean(&more_s);
        let variance = more_s.iter().map(|more_s| (more_s - mean_s).powi(2)).sum::<f64>() / (count - 1.0);
        let percent = 100.0 / mean(&oracle_s);
        let error = percent * (variance / count).sqrt();
        println!("{name:<12} {:>8.1} {:>14.2} % ± {error:.2} %", mean(&own_s), percent * mean_s);
    }
}
