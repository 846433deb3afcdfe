//! Short lives of a robot and its node, each with a few faults of the network, of clocks, of sensors, of the disk, and of people. What
//! must hold in every life: the node is never certain of a wrong pose, nothing that was saved is lost, no file of somebody else is touched,
//! every call is answered, and the same seed gives the same bits.
//!
//! 200 lives run in every test. Many, and one again with all that it says:
//! `LIVES=10000 cargo test -p curious-ros2 storm -- --nocapture`, `LIFE=17 cargo test -p curious-ros2 storm -- --nocapture`

mod faults;

use super::*;
use faults::Fault;
use interfaces::heading_rad;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, AtomicUsize};

/// How long a life is, in simulated time, s.
const LIFE_S: f64 = 60.0;
/// The smallest number of faults in a life.
const MIN_FAULTS: usize = 3;
/// A pose is wrong from this error on, m and rad.
const WRONG: [f64; 2] = [0.5, 0.35];
/// A call must be answered within this time.
const PATIENCE: Duration = Duration::from_secs(20);
/// Every life whose number this divides is lived twice, to compare the bits.
const TWICE: u64 = 20;
/// What the folder of the node has of others.
const FOREIGN: [&str; 3] = ["notes.md", "kitchen.yaml", "monday.state"];

struct Life {
    random: ChaCha8Rng,
    folder: tempfile::TempDir,
    parameters: Parameters,
    pair: Pair,
    /// The wall clock goes with the simulated time.
    begin: Instant,
    /// The error of the robot's clock, ns.
    clock_ns: i64,
    /// The frame of the odometry now, in that of the start.
    odom: Isometry2<f64>,
    /// What goes wrong now, and until when, s.
    now: Option<(Fault, f64)>,
    /// What a new node hears at once.
    latched: Option<Message>,
    /// Messages that come later than the next ones.
    held: VecDeque<(Topic, Message)>,
    /// The true pose of the origin of the map, in the node and in its file.
    origin: Option<Isometry2<f64>>,
    saved: Option<Isometry2<f64>>,
    /// What somebody drives, while the node does not: until when, s, and the velocities.
    drive: (f64, f64, f64),
    readings: u64,
    /// The readings in a row with a wrong pose of which the node is certain.
    wrong: u32,
    bits: Vec<f64>,
    story: Vec<String>,
}

impl Life {
    fn new(seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let folder = tempfile::tempdir().unwrap();
        for name in FOREIGN {
            std::fs::write(folder.path().join(name), name).unwrap();
        }
        let mode = if random.random_bool(0.5) { Mode::Explore } else { Mode::Map };
        let parameters =
            Parameters { use_sim_time: true, max_laser_range_m: 8.0, map_size_m: 24.0, ..parameters(mode) };
        let world = worldfile::physics::parse_world("storm.toml", include_str!("storm.toml")).unwrap();
        let (node, others, said) = node(&parameters, Some(&folder.path().join("own.state")));
        let robot = FakeLink::default();
        let settings = SimulationSettings { seed, speed: 1.0, begin_ns: 1_700_000_000_000_000_000 };
        let pair =
            Pair { sim: SimulatedRobot::new(robot.clone(), &world, settings), robot, node, others, said };
        Self {
            random,
            folder,
            parameters,
            pair,
            begin: Instant::now(),
            clock_ns: 0,
            odom: Isometry2::identity(),
            now: None,
            latched: None,
            held: VecDeque::new(),
            origin: None,
            saved: None,
            drive: (0.0, 0.0, 0.0),
            readings: 0,
            wrong: 0,
            bits: Vec::new(),
            story: Vec::new(),
        }
    }

    fn state(&self) -> PathBuf {
        self.folder.path().join("own.state")
    }

    fn time_s(&self) -> f64 {
        self.pair.sim.time_s()
    }

    fn tell(&mut self, text: &str) {
        let text: String = text.chars().take(200).collect();
        self.story.push(format!("{:6.2} s: {text}", self.time_s()));
    }

    /// All of it; the numbers that must be the same again.
    fn live(&mut self) -> Result<Vec<u8>, String> {
        let count = MIN_FAULTS + self.random.random_range(0..4);
        let mut times: Vec<f64> = (0..count).map(|_| self.random.random_range(3.0..LIFE_S - 8.0)).collect();
        times.sort_by(f64::total_cmp);
        let mut times = VecDeque::from(times);
        while self.time_s() < LIFE_S {
            if self.now.is_some_and(|(_, end_s)| self.time_s() >= end_s) {
                self.over()?;
            }
            if times.front().is_some_and(|time_s| self.now.is_none() && self.time_s() >= *time_s) {
                times.pop_front();
                self.begin()?;
            }
            self.step()?;
        }
        self.over()?;
        self.end()
    }

    fn call(&mut self, service: Service, call: Call) -> Result<Reply, String> {
        self.pair.others.calls(1, service, call);
        let begin = Instant::now();
        while begin.elapsed() < PATIENCE {
            self.turn()?;
            if let Some((_, reply)) = self.pair.others.answer() {
                return Ok(reply);
            }
            std::thread::yield_now();
        }
        Err(format!("{service:?} is not answered"))
    }

    /// Saves; whether the node says so.
    fn save(&mut self) -> Result<bool, String> {
        match self.call(Service::SaveState, Call::Nothing)? {
            Reply::Trigger(answer) => Ok(answer.is_done),
            reply => Err(format!("{reply:?}")),
        }
    }

    fn turn(&mut self) -> Result<(), String> {
        let now = self.begin + Duration::from_secs_f64(self.time_s());
        let event = self.pair.node.link.receive(Duration::ZERO);
        self.pair.node.turn_with(event, now);
        let said = std::mem::take(&mut *self.pair.said.lock().unwrap());
        said.into_iter().for_each(|text| self.tell(&text));
        self.check()
    }

    fn step(&mut self) -> Result<(), String> {
        self.pair.sim.step();
        for (topic, message) in self.pair.robot.others(|others| std::mem::take(&mut others.heard)) {
            if !matches!(topic, Topic::Clock | Topic::GroundTruth) {
                self.send(topic, message);
            }
        }
        while self.pair.others.others(|others| !others.events.is_empty()) {
            self.turn()?;
        }
        self.turn()?;
        let orders = self.pair.orders();
        self.pair.others.others(|others| others.heard.clear());
        if self.parameters.mode == Mode::Explore {
            orders
                .into_iter()
                .for_each(|order| self.pair.sim.take(Event::Message(Topic::StampedVelocity, order)));
            return Ok(());
        }
        if self.time_s() >= self.drive.0 {
            self.drive.0 = self.time_s() + self.random.random_range(1.0..4.0);
            self.drive.1 = self.random.random_range(-0.1..0.5);
            self.drive.2 = self.random.random_range(-0.8..0.8);
        }
        self.pair.drive(self.drive.1, self.drive.2);
        Ok(())
    }

    /// After each reading: a pose of which the node is certain is right.
    fn check(&mut self) -> Result<(), String> {
        let node = &self.pair.node;
        if std::mem::replace(&mut self.readings, node.report.readings) == node.report.readings {
            return Ok(());
        }
        let is_certain = node.pose_state == PoseState::Tracking;
        let ([truth, odometry], Some(to_odom)) =
            (self.pair.sim.poses().ok_or("no robot")?, node.published.map_to_odom)
        else {
            return Ok(());
        };
        let in_map = to_odom * self.odom.inverse() * odometry;
        // The first reading says where a new map begins.
        let found = *self.origin.get_or_insert(truth * in_map.inverse()) * in_map;
        let off = truth.inv_mul(&found);
        let (off_m, off_rad) = (off.translation.vector.norm(), heading_rad(&off).abs());
        self.bits.extend([off_m, off_rad, f64::from(u8::from(is_certain))]);
        let is_wrong = is_certain && (off_m > WRONG[0] || off_rad > WRONG[1]);
        let is_displaced =
            self.now.is_some_and(|(fault, _)| matches!(fault, Fault::Carried | Fault::OdometryReset));
        self.wrong = if is_wrong && !is_displaced { self.wrong + 1 } else { 0 };
        if is_wrong {
            self.tell(&format!("certain, and wrong by {off_m:.2} m and {off_rad:.2} rad"));
        }
        match self.wrong {
            0..3 => Ok(()),
            _ => Err(format!(
                "the node is certain of a pose that is wrong by {off_m:.2} m and {off_rad:.2} rad"
            )),
        }
    }

    /// The node ends as by Ctrl-C, and its file is whole.
    fn end(&mut self) -> Result<Vec<u8>, String> {
        let stop = Signals { stop: Arc::new(true.into()), ..Signals::default() };
        self.pair.node.run(&stop).map_err(|why| format!("the state is not saved: {why:#}"))?;
        let mut bits = self.pair.node.robot.mapper.snapshot();
        bits.extend(self.bits.iter().flat_map(|value| value.to_le_bytes()));
        self.saved = self.origin;
        self.kill()?;
        for name in FOREIGN {
            if std::fs::read(self.folder.path().join(name)).ok().as_deref() != Some(name.as_bytes()) {
                return Err(format!("the file {name} of somebody else is touched"));
            }
        }
        Ok(bits)
    }
}

/// One life: what must be the same again, the number of readings, and of those with a certain pose.
type Lived = (Vec<u8>, [usize; 2]);

fn live(seed: u64, is_told: bool) -> Result<Lived, String> {
    let mut life = Life::new(seed);
    let lived = catch_unwind(AssertUnwindSafe(|| life.live()));
    if is_told {
        life.story.iter().for_each(|line| println!("{line}"));
    }
    let certain = life.bits.iter().skip(2).step_by(3).filter(|is_certain| **is_certain > 0.0).count();
    lived.unwrap_or_else(|_| Err("a panic".to_owned())).map(|bits| (bits, [life.bits.len() / 3, certain]))
}

fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok().map(|value| value.parse().unwrap())
}

#[test]
fn storm() {
    let (first, lives) = number("LIFE").map_or((0, number("LIVES").unwrap_or(200)), |seed| (seed, 1));
    let next = AtomicU64::new(first);
    let (failures, readings) = (Mutex::new(Vec::new()), [AtomicUsize::new(0), AtomicUsize::new(0)]);
    let work = || loop {
        let seed = next.fetch_add(1, Ordering::Relaxed);
        if seed >= first + lives {
            return;
        }
        let mut lived = live(seed, lives == 1);
        if seed.is_multiple_of(TWICE) && lived.is_ok() && live(seed, false) != lived {
            lived = Err("the same seed gives other bits".to_owned());
        }
        match lived {
            Ok((_, counts)) => {
                for (all, count) in readings.iter().zip(counts) {
                    all.fetch_add(count, Ordering::Relaxed);
                }
            }
            Err(why) => {
                eprintln!("LIFE={seed}: {why}");
                failures.lock().unwrap().push(seed);
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    let failures = failures.into_inner().unwrap();
    let [readings, certain] = readings.map(AtomicUsize::into_inner);
    println!("{lives} lives, {readings} readings, {certain} of them with a certain pose");
    assert!(lives == 1 || certain * 2 > readings, "a node that is never certain is never wrong");
    assert!(failures.is_empty(), "{} of {lives} lives: {failures:?}", failures.len());
}
