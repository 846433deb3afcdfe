//! Mutated logs, bags, states, worlds and messages: whatever a file or a sensor says, no call panics, takes more than
//! 10 s, or takes more than 1 GiB.
//!
//! 4,000 inputs by default. More, and where to begin:
//! `CASES=1000000 cargo test -p curious-evaluation --test fuzz -- --nocapture`; `FIRST=4711 CASES=1` repeats one;
//! `KIND=3` tries only states.

mod states;

use interfaces::{GridFrame, LaserReading, Twist, World};
use localizer::{Localizer, LocalizerSettings};
use logs::ros::{LaserScan, scan_message, scan_of};
use logs::{Log, McapWriter, TopicChoice};
use mapper::{Mapper, MapperSettings};
use nalgebra::{Isometry2, Point2};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use sim::physics::{PhysicsWorld, WorldSpec};
use states::States;
use std::collections::BTreeMap;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

const MAX_TIME: Duration = Duration::from_secs(10);
const MAX_MEMORY_BYTES: u64 = 1 << 30;
/// The longest input, bytes.
const MAX_INPUT_BYTES: usize = 50_000;
/// Numbers that programs do not expect.
const NUMBERS: &str = "nan inf -inf 0 -0 -1 1e308 -1e308 1e-308 1e7 4294967296 -9223372036854775808 18446744073709551616 \
                       0.1e-400  x";

/// The inputs as they should be, and what reads them.
struct Targets {
    folder: tempfile::TempDir,
    readings: Vec<LaserReading>,
    carmen: Vec<u8>,
    mcaps: [Vec<u8>; 2],
    sqlite: Vec<u8>,
    worlds: Vec<(String, Vec<u8>)>,
    states: States,
}

impl Targets {
    fn new() -> Self {
        let worlds = format!("{}/../worlds", env!("CARGO_MANIFEST_DIR"));
        let read = |name: &str| (name.to_owned(), fs::read(Path::new(&worlds).join(name)).unwrap());
        let worlds =
            ["four_rooms.toml", "house.toml", "yard.toml", "two_blocks.toml", "stage/lab.world"].map(read);
        let text = std::str::from_utf8(&worlds[0].1).unwrap();
        let spec = worldfile::physics::parse_world("four_rooms", text).unwrap();
        let readings = readings(&spec);
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("whole.mcap");
        fs::write(&log, bag(&readings)).unwrap();
        let house = std::str::from_utf8(&worlds[1].1).unwrap();
        let house = worldfile::physics::parse_world("house", house).unwrap();
        let states = States::new(&house, &log, &readings[0]);
        Self {
            folder,
            carmen: carmen(&readings[..10]),
            mcaps: [bag(&readings), without_checksums(&bag(&readings[..8]))],
            sqlite: database(&bag(&readings[..8])),
            worlds: worlds.into(),
            states,
            readings,
        }
    }

    /// One mutated input, and what becomes of it.
    fn run(&mut self, random: &mut Random) {
        match setting("KIND", random.below(7) as u64) {
            0 => self.read_log("a.log", &random.mutated_text(&self.carmen)),
            1 => {
                let whole = &self.mcaps[random.below(2)];
                self.read_log("a.mcap", &random.mutated(whole));
            }
            2 => self.read_log("a.db3", &random.mutated(&self.sqlite)),
            3 => self.states.run(random),
            4 | 5 => self.read_world(random),
            _ => self.read_messages(random),
        }
    }

    fn read_log(&self, name: &str, bytes: &[u8]) {
        let path = self.folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        let Ok(log) = Log::open(&path, &TopicChoice::default()) else { return };
        log.content_hash().ok();
        let Ok(readings) = log.readings() else { return };
        let (mut mapper, mut localizer) = robot();
        for reading in readings.take(100).map_while(Result::ok) {
            let localized = localizer.localize(&reading, &mapper);
            mapper.update(&LaserReading { pose: localized.estimate.pose, ..reading }).ok();
        }
    }

    fn read_world(&self, random: &mut Random) {
        let (name, text) = &self.worlds[random.below(self.worlds.len())];
        let text = random.mutated_text(text);
        if name.ends_with(".world") {
            let files = BTreeMap::from([(PathBuf::from(name), text)]);
            drop(stage::load(Path::new(name), &files));
            return;
        }
        let Ok(text) = std::str::from_utf8(&text) else { return };
        drop(worldfile::grid::parse(name, text));
        if let Ok(spec) = worldfile::physics::parse_world(name, text) {
            let mut world = PhysicsWorld::new(&spec, 1);
            drop(world.sense());
        }
    }

    /// Scans as messages with other numbers, between right ones.
    fn read_messages(&self, random: &mut Random) {
        let (mut mapper, mut localizer) = robot();
        for reading in self.readings.iter().take(6) {
            let mut message = scan_message(reading, "laser".to_owned(), (reading.time_s * 1e9) as i64);
            let mut other = reading.clone();
            if random.below(2) == 0 {
                random.change_scan(&mut message);
            }
            if random.below(4) == 0 {
                random.change_pose(&mut other);
            }
            let Ok(scan) = scan_of(message, random.below(2) == 0) else { continue };
            let reading = LaserReading { scan, ..other };
            let localized = localizer.localize(&reading, &mapper);
            mapper.update(&LaserReading { pose: localized.estimate.pose, ..reading }).ok();
        }
    }
}

/// A robot that knows nothing.
fn robot() -> (Mapper, Localizer) {
    let frame = GridFrame::new(Point2::new(-6.0, -6.0), 0.1, 120, 120).unwrap();
    let mapper = Mapper::new(&MapperSettings::default(), frame).unwrap();
    let settings = LocalizerSettings::default();
    (mapper, Localizer::from_nothing(&settings, &frame, Isometry2::identity()).unwrap())
}

fn readings(spec: &WorldSpec) -> Vec<LaserReading> {
    let mut world = PhysicsWorld::new(spec, 1);
    let drive = |world: &mut PhysicsWorld| {
        world.act(&Twist { linear_mps: 0.3, angular_radps: 0.4 });
        world.sense()
    };
    (0..20).map(|_| drive(&mut world)).collect()
}

/// The readings as a CARMEN log.
fn carmen(readings: &[LaserReading]) -> Vec<u8> {
    let mut text = String::from("# a comment\nPARAM robot_frontlaser_offset 0.1\n");
    for reading in readings {
        let (at, time_s) = (reading.pose.translation.vector, 1.7e9 + reading.time_s);
        let pose = format!("{:.4} {:.4} {:.4}", at.x, at.y, reading.pose.rotation.angle());
        let ranges: Vec<String> =
            reading.scan.ranges_m.iter().map(|range_m| format!("{range_m:.2}")).collect();
        text += &format!("ODOM {pose} 0.3 0.4 0 {time_s:.6} host {:.6}\n", reading.time_s);
        let (count, ranges) = (ranges.len(), ranges.join(" "));
        text += &format!("FLASER {count} {ranges} {pose} {pose} {time_s:.6} host {:.6}\n", reading.time_s);
    }
    text.into_bytes()
}

/// The readings as a bag.
fn bag(readings: &[LaserReading]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut writer = McapWriter::new(&mut bytes, "a.mcap", 1.7e9).unwrap();
    readings.iter().for_each(|reading| writer.reading(reading).unwrap());
    writer.finish().unwrap();
    bytes.into_inner()
}

/// The bag with nothing that shows that bytes were changed.
fn without_checksums(bag: &[u8]) -> Vec<u8> {
    let options = mcap::WriteOptions::new()
        .compression(None)
        .calculate_chunk_crcs(false)
        .calculate_data_section_crc(false)
        .calculate_summary_section_crc(false)
        .calculate_attachment_crcs(false);
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut writer = options.create(&mut bytes).unwrap();
    for message in mcap::MessageStream::new(bag).unwrap() {
        writer.write(&message.unwrap()).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    let bytes = bytes.into_inner();
    assert!(bytes.len() < MAX_INPUT_BYTES, "{}", bytes.len());
    bytes
}

/// The messages of a bag as a database.
fn database(bag: &[u8]) -> Vec<u8> {
    let file = tempfile::NamedTempFile::new().unwrap();
    let database = rusqlite::Connection::open(file.path()).unwrap();
    let tables = "PRAGMA page_size = 1024; CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, \
                  serialization_format TEXT); CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, \
                  timestamp INTEGER, data BLOB); BEGIN";
    database.execute_batch(tables).unwrap();
    for message in mcap::MessageStream::new(bag).unwrap().map(Result::unwrap) {
        let (channel, id) = (&message.channel, i64::from(message.channel.id));
        let topic = (id, &channel.topic, channel.schema.as_ref().map(|schema| &schema.name), "cdr");
        database.execute("INSERT OR IGNORE INTO topics VALUES (?1, ?2, ?3, ?4)", topic).unwrap();
        let row = (id, message.log_time as i64, message.data.as_ref());
        database.execute("INSERT INTO messages VALUES (NULL, ?1, ?2, ?3)", row).unwrap();
    }
    database.execute_batch("COMMIT").unwrap();
    drop(database);
    let bytes = fs::read(file.path()).unwrap();
    assert!(bytes.len() < MAX_INPUT_BYTES, "{}", bytes.len());
    bytes
}

struct Random(ChaCha8Rng);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0.next_u64() as usize % bound.max(1)
    }

    /// The bytes with one to four changes: bits, bytes, extreme numbers, parts that are missing, doubled or cut off.
    fn mutated(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut bytes = bytes.to_vec();
        for _ in 0..=self.below(4) {
            let (at, length) = (self.below(bytes.len()), 1 + self.below(64));
            let end = (at + length).min(bytes.len());
            match self.below(8) {
                0 if at < bytes.len() => bytes[at] ^= 1 << self.below(8),
                1 if at < bytes.len() => bytes[at] = [0, 1, 0x7f, 0x80, 0xff][self.below(5)],
                2 => bytes.truncate(at),
                3 => drop(bytes.drain(at..end)),
                4 => {
                    let part = bytes[at..end].to_vec();
                    bytes.splice(at..at, part);
                }
                5 | 6 => {
                    let width = [2, 4, 8][self.below(3)];
                    let numbers = [0, 1, 0x7fff_ffff, 1 << 31, u64::MAX, 1 << 40, 1 << 62, 0x7ff0 << 48];
                    let number = numbers[self.below(8)].to_le_bytes();
                    let fits = width.min(bytes.len() - at.min(bytes.len()));
                    bytes[at..at + fits].copy_from_slice(&number[..fits]);
                }
                _ => (0..length).for_each(|_| bytes.push(self.below(256) as u8)),
            }
        }
        bytes.truncate(MAX_INPUT_BYTES);
        bytes
    }

    /// A part of a state with other bytes or numbers of variable length.
    fn mutated_part(&mut self, part: &[u8]) -> Vec<u8> {
        if self.below(2) == 0 {
            return self.mutated(part);
        }
        let mut part = part.to_vec();
        let at = self.below(part.len());
        let end =
            part[at..].iter().position(|byte| *byte < 0x80).map_or(part.len(), |length| at + length + 1);
        let numbers: [&[u8]; 8] = [
            &[0],
            &[1],
            &[2],
            &[0x7f],
            &[0x80, 0x40],
            &[0xff, 0xff, 0x3f],
            &[0xff, 0xff, 0xff, 0xff, 0x0f],
            &[0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01],
        ];
        part.splice(at..end, numbers[self.below(8)].iter().copied());
        part
    }

    /// The text with other words, or changed as bytes.
    fn mutated_text(&mut self, text: &[u8]) -> Vec<u8> {
        if self.below(3) == 0 {
            return self.mutated(text);
        }
        let mut text = String::from_utf8_lossy(text).into_owned();
        for _ in 0..=self.below(4) {
            let is_of_number = |c: char| c.is_ascii_digit() || "+-.e_".contains(c);
            let is_start = |at: &usize| *at == 0 || !text[..*at].ends_with(is_of_number);
            let starts: Vec<usize> =
                text.match_indices(is_of_number).map(|(at, _)| at).filter(is_start).collect();
            let Some(start) = starts.get(self.below(starts.len())) else { break };
            let end = text[*start..].find(|c| !is_of_number(c)).map_or(text.len(), |length| start + length);
            text.replace_range(*start..end, self.word());
        }
        text.truncate(MAX_INPUT_BYTES);
        text.into_bytes()
    }

    /// One of [`NUMBERS`]; one of them is empty.
    fn word(&mut self) -> &'static str {
        NUMBERS.split(' ').nth(self.below(16)).unwrap_or_default()
    }

    fn number(&mut self) -> f64 {
        self.word().parse().unwrap_or(f64::from_bits(self.0.next_u64()))
    }

    fn change_scan(&mut self, scan: &mut LaserScan) {
        let number = self.number() as f32;
        match self.below(9) {
            0 => scan.angle_min = number,
            1 => scan.angle_max = number,
            2 => scan.angle_increment = number,
            3 => scan.time_increment = number,
            4 => scan.scan_time = number,
            5 => scan.range_min = number,
            6 => scan.range_max = number,
            7 => scan.ranges.truncate(self.below(scan.ranges.len())),
            _ => {
                let changed = self.below(scan.ranges.len());
                (0..changed).for_each(|beam| scan.ranges[beam] = number);
            }
        }
    }

    fn change_pose(&mut self, reading: &mut LaserReading) {
        let number = self.number();
        match self.below(5) {
            0 => reading.time_s = number,
            1 => reading.pose.translation.x = number,
            2 => reading.twist.angular_radps = number,
            3 => reading.mount.translation.y = number,
            _ => reading.velocities.iter_mut().for_each(|sample| sample.twist.linear_mps = number),
        }
    }
}

/// The greatest memory of this process since the last call, bytes; `None` where the system does not say it.
fn peak_memory() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    fs::write("/proc/self/clear_refs", "5").ok()?;
    line.split_whitespace().next()?.parse::<u64>().ok().map(|kib| kib << 10)
}

/// How long this thread has computed, whatever else the machine does; `None` where the system does not say it.
fn computed() -> Option<Duration> {
    let text = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(Duration::from_nanos(text.split_whitespace().next()?.parse().ok()?))
}

fn setting(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|value| value.parse().ok()).unwrap_or(default)
}

/// Tries inputs: the longest time, and the greatest memory.
fn run_inputs(numbers: impl Iterator<Item = u64>) -> (Duration, u64) {
    let mut targets = Targets::new();
    let path = targets.folder.path().join("whole.db3");
    fs::write(&path, &targets.sqlite).unwrap();
    assert_eq!(Log::open(&path, &TopicChoice::default()).unwrap().summary().scans, 8);
    peak_memory();
    let (mut slowest, mut largest) = (Duration::ZERO, 0);
    for number in numbers {
        let mut random = Random(ChaCha8Rng::seed_from_u64(number));
        let (start, began) = (Instant::now(), computed());
        let ran = catch_unwind(AssertUnwindSafe(|| targets.run(&mut random)));
        let time = computed().zip(began).map_or_else(|| start.elapsed(), |(now, began)| now - began);
        let memory = peak_memory().unwrap_or_default();
        let again = format!("FIRST={number} CASES=1 repeats it");
        assert!(ran.is_ok(), "input {number} panicked; {again}");
        assert!(time < MAX_TIME, "input {number} took {time:?}; {again}");
        assert!(memory < MAX_MEMORY_BYTES, "input {number} took {} MiB; {again}", memory >> 20);
        (slowest, largest) = (slowest.max(time), largest.max(memory));
    }
    (slowest, largest)
}

#[test]
fn no_input_panics_or_takes_long_or_takes_much_memory() {
    let (first, cases) = (setting("FIRST", 0), setting("CASES", 4_000));
    // The memory is that of both threads.
    let (slowest, largest) = std::thread::scope(|scope| {
        let threads =
            [0, 1].map(|begin| scope.spawn(move || run_inputs((first + begin..first + cases).step_by(2))));
        let [one, other] = threads.map(|thread| thread.join().unwrap());
        (one.0.max(other.0), one.1.max(other.1))
    });
    println!("{cases} inputs: at most {slowest:?} and {} MiB", largest >> 20);
}
