use super::builder::*;
use crate::Log;
use crate::summary::TopicChoice;
use mcap::{Compression, WriteOptions};
use ros::LaserScan;

/// Twenty scans, without a pose.
fn standing() -> Builder {
    let mut bag = Builder::default();
    for time_s in times(20, 0.1) {
        bag.laser(time_s);
    }
    bag
}

/// The offset of the first record with a code, outside of chunks.
fn record(bytes: &[u8], code: u8) -> usize {
    let mut at = 8;
    while bytes[at] != code {
        at += 9 + u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
    }
    at
}

#[test]
fn what_is_whole_of_a_file_without_its_end_is_read() {
    for options in [plain(), compressed(Compression::Lz4), WriteOptions::new().use_chunks(false)] {
        let bytes = standing().mcap(options);
        let data_end = record(&bytes, 15);
        let bag = read(&bytes[..data_end]);
        assert_eq!(readings(&bag).len(), 20);
        let note =
            "test has no end, since it is cut off or its recorder was stopped: what is whole before byte";
        let end = "what could be read ends 1.9 s after the first scan";
        assert_eq!(notes(&bag), format!("{note} {data_end} of {data_end} was read\n{end}"));
        let mut zeros = bytes[..data_end].to_vec();
        zeros.resize(data_end + 4096, 0);
        assert_eq!(read(&zeros).summary().scans, 20);
    }
    let bytes = standing().mcap(plain());
    let chunk = record(&bytes, 6);
    let bag = open(&bytes[..chunk + 1500], &TopicChoice::default()).unwrap();
    let scans = readings(&bag).len();
    assert!((5..20).contains(&scans), "{scans} scans");
    insta::assert_snapshot!(refused(&bytes[..10]), @"test: no message: the bag is empty; test has no end, since it is cut off or its recorder was stopped: what is whole before byte 8 of 10 was read");
}

/// A robot that stands, with this number of scans of a crowd.
fn with_scans(count: u32) -> Builder {
    let mut bag = standing();
    for step in 20..count {
        let time_s = f64::from(step) * 0.1;
        let ranges =
            (0..50).map(|beam| 1.0 + ((step * 7919 + beam * 104_729) % 4001) as f32 * 1e-3).collect();
        bag.scan("/scan", time_s, &LaserScan { ranges, ..scan(time_s, "laser") });
    }
    bag
}

#[test]
fn what_is_whole_of_a_file_that_is_cut_off_while_it_is_compressed_is_read() {
    let bag = with_scans(3000);
    let whole = bag.mcap(plain().chunk_size(Some(10_000)));
    let packed = zstd::encode_all(&whole[..], 0).unwrap();
    let half = &packed[..packed.len() / 2];
    let found = read(half);
    let scans = readings(&found).len();
    assert!((100..2900).contains(&scans), "{scans} scans");
    let [zstd, mcap, end] = &found.summary().notes[..] else { panic!("{:?}", found.summary().notes) };
    let expected = format!("the zstd file test is cut off after {} bytes: the first ", half.len());
    assert!(zstd.starts_with(&expected) && zstd.ends_with(" bytes could be unpacked"), "{zstd}");
    assert!(mcap.starts_with("test has no end, since it is cut off or"), "{mcap}");
    let duration_s = found.summary().duration_s;
    assert_eq!(*end, format!("what could be read ends {duration_s:.1} s after the first scan"));
    assert!(duration_s > 9.0);
    insta::assert_snapshot!(refused(&packed[..12]), @"test: the zstd file is cut off after 12 bytes, before a bag could be unpacked");
    let database = zstd::encode_all(&bag.sqlite()[..], 0).unwrap();
    let found = open(&database[..database.len() / 2], &TopicChoice::default()).unwrap();
    let scans = readings(&found).len();
    assert!((100..2900).contains(&scans), "{scans} scans");
    let [zstd, sqlite, _] = &found.summary().notes[..] else { panic!("{:?}", found.summary().notes) };
    assert!(zstd.starts_with("the zstd file test is cut off after "), "{zstd}");
    assert!(sqlite.starts_with("the database test is cut off after "), "{sqlite}");
}

#[test]
fn damaged_records_are_named_by_their_offset() {
    let bytes = standing().mcap(plain());
    let chunk = record(&bytes, 6);
    let (after_head, sizes) =
        (chunk + 9, [1_u64 << 60, 1 << 30, 5 << 30, 1, 1 << 40, u64::MAX].map(u64::to_le_bytes));
    for (at, to, says) in [
        (chunk + 1, &sizes[0][..], "a record (code 6) of 1152921504606846976 bytes"),
        (chunk + 1, &sizes[1], "a record ends beyond the end of the file, which is not cut off"),
    ] {
        let mut bytes = bytes.clone();
        bytes[at..at + to.len()].copy_from_slice(to);
        assert_has(&refused(&bytes), &[&format!("test: byte {chunk}: {says}")]);
    }
    // The only chunk is left out.
    for (at, to, says) in [
        (
            after_head + 16,
            &sizes[2][..],
            "a chunk of 5368709120 bytes, unpacked; at most 1073741824 are read",
        ),
        (after_head + 24, &sizes[3][..4], "the checksum of a chunk does not match"),
        (after_head + 41, &sizes[4], "a record is longer than its chunk"),
        (after_head + 32, &sizes[5], "the records of a chunk have 1844"),
    ] {
        let mut bytes = bytes.clone();
        bytes[at..at + to.len()].copy_from_slice(to);
        assert_has(
            &refused(&bytes),
            &[&format!("1 chunk is left out, the first one at byte {chunk}: {says}")],
        );
    }
}

#[test]
fn what_is_whole_beside_damaged_chunks_is_read() {
    for options in [plain(), compressed(Compression::Lz4), compressed(Compression::Zstd)] {
        let bytes = Builder { has_sums: true, ..with_scans(300) }.mcap(options.chunk_size(Some(10_000)));
        let all = read(&bytes).summary().scans;
        let mut chunks = Vec::new();
        let mut at = 8;
        while bytes[at] != 15 {
            let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
            chunks.extend((bytes[at] == 6).then_some(at..at + 9 + length));
            at += 9 + length;
        }
        assert!(chunks.len() > 5, "{} chunks", chunks.len());
        // The first one has the definitions as well.
        for chunk in [&chunks[0], &chunks[chunks.len() / 2]] {
            let mut damaged = bytes.clone();
            damaged[(chunk.start + chunk.end) / 2] ^= 0x5a;
            let bag = read(&damaged);
            assert!(
                (all / 2..all).contains(&bag.summary().scans),
                "{} of {all} scans, {}",
                bag.summary().scans,
                notes(&bag)
            );
            let expected =
                format!("test is damaged: 1 chunk is left out, the first one at byte {}: ", chunk.start);
            assert!(notes(&bag).contains(&expected), "{}", notes(&bag));
        }
    }
}

#[test]
fn a_chunk_that_grows_without_end_needs_no_memory() {
    // A megabyte of zeros in a few bytes; the header says 20 bytes, then a gigabyte.
    let bytes = standing().mcap(compressed(Compression::Zstd));
    let chunk = record(&bytes, 6);
    let bomb = zstd::encode_all(&vec![5_u8; 64 << 20][..], 0).unwrap();
    for claimed in [20_u64, 1 << 30] {
        let mut file = bytes[..chunk].to_vec();
        file.push(6);
        file.extend((16 + 8 + 4 + 4 + 4 + 8 + bomb.len() as u64).to_le_bytes());
        file.extend([0; 16]);
        file.extend(claimed.to_le_bytes());
        file.extend([0; 4]);
        file.extend([4, 0, 0, 0]);
        file.extend(b"zstd");
        file.extend((bomb.len() as u64).to_le_bytes());
        file.extend(&bomb);
        assert_has(&refused(&file), &[&format!("byte {chunk}: ")]);
    }
}

#[test]
fn damaged_messages_are_named_by_their_number() {
    let mut bag = standing();
    bag.messages[2].3.truncate(30);
    let error = bag.refused();
    assert!(error.starts_with("test: message 3 of /scan: it is damaged: "), "{error}");
    bag.messages[2].3 = vec![0, 9, 0, 0];
    insta::assert_snapshot!(bag.refused(), @"test: message 3 of /scan: the encoding 0009 is not CDR");
    // 2³² − 1 ranges.
    let mut bag = standing();
    let at = bag.messages[0].3.len() - 4 - 3 * 4 - 4;
    bag.messages[0].3[at..at + 4].copy_from_slice(&u32::MAX.to_le_bytes());
    let error = bag.refused();
    assert!(error.starts_with("test: message 1 of /scan: it is damaged: "), "{error}");
}

#[test]
fn scans_that_are_none_are_left_out() {
    let swapped = |time_s| LaserScan { range_min: 10.0, range_max: 0.1, ..scan(time_s, "laser") };
    let mut bag = standing();
    bag.scan("/scan", 3.0, &swapped(3.0));
    let opened = bag.log();
    assert_eq!(opened.summary().scans, 20);
    insta::assert_snapshot!(notes(&opened), @"1 scans are invalid and left out, the first: test: message 21 of /scan: range limits must hold 0 <= range_min < range_max, finite: 10 m, 0.10000000149011612 m");
    let mut bag = Builder::default();
    bag.scan("/scan", 3.0, &swapped(3.0));
    assert!(bag.refused().starts_with("test: no scan is valid; the first: test: message 1 of /scan: range"));
}

#[test]
fn poses_that_are_none_are_left_out() {
    let mut bag = standing();
    bag.mount().odometry("/odom", 2.0, f64::NAN, 0.0).odometry("/odom", 3.0, 1e30, 0.0);
    let opened = bag.log();
    insta::assert_snapshot!(notes(&opened), @"2 poses of odometry or transforms are invalid and left out");
}

#[test]
fn other_formats_are_named() {
    let error = refused(b"#ROSBAG V2.0\n and so on");
    assert!(error.contains("a bag of ROS 1; convert it with `rosbags-convert --src FILE.bag"), "{error}");
    let packed = zstd::encode_all(&b"something else"[..], 0).unwrap();
    insta::assert_snapshot!(refused(&packed), @"test: compressed with zstd, but what is in it is no bag");
    // A bomb.
    let mut zeros = vec![0; 80 << 20];
    zeros[..16].copy_from_slice(b"SQLite format 3\0");
    let packed = zstd::encode_all(&zeros[..], 0).unwrap();
    let error = refused(&packed);
    let most = format!(
        "test: the {} bytes of the file unpack to more than {}",
        packed.len(),
        packed.len() * 100 + (64 << 20)
    );
    assert_has(
        &error,
        &[&most, "which is the most that is unpacked; if it is a log, unpack it first: zstd -d FILE"],
    );
}

#[test]
fn what_is_before_the_cut_of_a_database_that_is_cut_off_is_read() {
    let mut bag = standing();
    for step in 0..400 {
        bag.scan("/scan", 2.0, &scan(2.0 + f64::from(step), "laser"));
    }
    let bytes = bag.sqlite();
    let whole = readings(&read(&bytes));
    // Between two pages, and at all kinds of places within one.
    let half = bytes.len() / 8192 * 4096;
    for cut in (half..half + 8192).step_by(512).chain([bytes.len() * 2 / 3, bytes.len() - 4096]) {
        let found = read(&bytes[..cut]);
        let scans = readings(&found);
        assert_eq!(scans, whole[..scans.len()]);
        let share = cut as f64 / bytes.len() as f64;
        let least = ((share - 0.15) * whole.len() as f64) as usize;
        assert!((least..whole.len()).contains(&scans.len()), "{}", scans.len());
        let note =
            format!("the database test is cut off after {cut} of {} bytes: the messages before", bytes.len());
        assert_has(&notes(&found), &[&note, " the cut were read\nwhat could be read ends "]);
    }
    // Without the table of the topics nothing is left.
    insta::assert_snapshot!(refused(&bytes[..4096]), @"test: the database is damaged: database disk image is malformed; `sqlite3 FILE .recover` prints what can be saved");
}

#[test]
fn other_databases_are_refused() {
    let database = |sql: &str| {
        let file = tempfile::NamedTempFile::new().unwrap();
        rusqlite::Connection::open(file.path()).unwrap().execute_batch(sql).unwrap();
        refused(&std::fs::read(file.path()).unwrap())
    };
    let missing = database("CREATE TABLE other(a)");
    insta::assert_snapshot!(missing, @"test: a database without a stored table `topics`: not a bag of rosbag2");
    // Rows without end.
    let endless = "CREATE TABLE topics(id, name, type, serialization_format); CREATE VIEW messages AS WITH RECURSIVE \
                   n(rowid, topic_id, timestamp, data) AS (SELECT 1, 1, 1, x'00' UNION ALL SELECT rowid + 1, 1, 1, x'00' \
                   FROM n) SELECT * FROM n";
    insta::assert_snapshot!(database(endless), @"test: a database without a stored table `messages`: not a bag of rosbag2");
    // Gigabytes from a few bytes: columns that are computed when they are read.
    for (name, other) in [("data", "topic_id, timestamp"), ("timestamp", "topic_id, data")] {
        let computed = format!(
            "CREATE TABLE topics(id, name, type, serialization_format); CREATE TABLE messages(id INTEGER PRIMARY KEY, {other}, \
             {name} GENERATED ALWAYS AS (hex(zeroblob(400000000))) VIRTUAL)"
        );
        let expected = "test: a database without a stored table `messages`: not a bag of rosbag2";
        assert_eq!(database(&computed), expected);
    }
    let unknown = "CREATE TABLE topics(id, name, type, serialization_format); CREATE TABLE messages(id INTEGER PRIMARY KEY, \
                   topic_id, timestamp, data); INSERT INTO messages VALUES (1, 7, 0, x'00')";
    insta::assert_snapshot!(database(unknown), @"test: the database is damaged: row 1 of `messages`: topic 7 is not in `topics`");
}

/// In a file that is cut off, a view can have the name of a table.
#[test]
fn a_view_with_the_name_of_a_table_is_refused() {
    let file = tempfile::NamedTempFile::new().unwrap();
    let sql = "CREATE TABLE topics(id, name, type, serialization_format); CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, \
               timestamp, data); PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql = NULL WHERE name = 'messages'; \
               INSERT INTO sqlite_schema VALUES ('view', 'messages', 'messages', 0, 'CREATE VIEW messages AS WITH RECURSIVE \
               n(rowid, topic_id, timestamp, data) AS (SELECT 1, 1, 1, x''00'' UNION ALL SELECT rowid + 1, 1, 1, x''00'' FROM n) \
               SELECT * FROM n')";
    rusqlite::Connection::open(file.path()).unwrap().execute_batch(sql).unwrap();
    let mut bytes = std::fs::read(file.path()).unwrap();
    bytes[31] += 5; // pages that are not there
    let error = refused(&bytes);
    assert!(error.ends_with("a database without a stored table `messages`: not a bag of rosbag2"), "{error}");
}

/// The last messages are in a file beside a database whose recorder was killed, and SQLite would write to a third one.
#[test]
fn nothing_is_written_beside_a_database() {
    let (recorded, left) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let database = recorded.path().join("a.db3");
    let bag = standing();
    std::fs::write(&database, bag.sqlite()).unwrap();
    let before = readings(&Log::open(&database, &TopicChoice::default()).unwrap()).len();
    let recorder = rusqlite::Connection::open(&database).unwrap();
    let again = "PRAGMA journal_mode = WAL; INSERT INTO messages(topic_id, timestamp, data) SELECT topic_id, timestamp, data \
                 FROM messages";
    recorder.execute_batch(again).unwrap();
    for name in ["a.db3", "a.db3-wal"] {
        std::fs::copy(recorded.path().join(name), left.path().join(name)).unwrap();
    }
    std::fs::write(left.path().join("a.db3-shm"), "keep").unwrap();
    let files =
        || ["a.db3", "a.db3-wal", "a.db3-shm"].map(|name| std::fs::read(left.path().join(name)).unwrap());
    let old = files();
    let log = Log::open(&left.path().join("a.db3"), &TopicChoice::default()).unwrap();
    assert!(readings(&log).len() > before, "the last messages are read");
    assert!(files() == old && std::fs::read_dir(left.path()).unwrap().count() == 3);
    std::fs::remove_file(left.path().join("a.db3-wal")).unwrap();
    assert_eq!(
        readings(&Log::open(&left.path().join("a.db3"), &TopicChoice::default()).unwrap()).len(),
        before
    );
    assert_eq!(std::fs::read(left.path().join("a.db3-shm")).unwrap(), b"keep");
}

#[test]
fn bags_that_cannot_be_true_are_named() {
    let bag = |ranges: Vec<f32>, range_max: f32| {
        let mut bag = Builder::default();
        for time_s in times(20, 0.1) {
            bag.scan(
                "/scan",
                time_s,
                &LaserScan { ranges: ranges.clone(), range_max, ..scan(time_s, "laser") },
            );
        }
        bag
    };
    let impossible = |bag: &Builder| bag.log().summary().impossible.clone();
    let ranges: Vec<f32> = (0..60).map(|beam| 2.0 + 0.01 * beam as f32).collect();
    assert_eq!(impossible(&bag(ranges.clone(), 10.0)), None);
    for range_max in [10.0, 10_000.0] {
        let millimeters = ranges.iter().map(|range_m| 1000.0 * range_m).collect();
        let why = impossible(&bag(millimeters, range_max)).unwrap();
        assert!(why.starts_with("the ranges look like millimeters: in 20 of 20 scans"), "{why}");
    }
    let why = impossible(&bag(vec![f32::INFINITY; 60], 10.0)).unwrap();
    assert!(why.starts_with("none of 20 scans has a range"), "{why}");
    let mut mostly = bag(ranges, 10.0);
    for time_s in times(60, 0.1).skip(20) {
        mostly.scan("/scan", time_s, &LaserScan { range_min: 20.0, ..scan(time_s, "laser") });
    }
    insta::assert_snapshot!(impossible(&mostly).unwrap(), @"40 of 60 scans are invalid: what is left is no log of a place");
}
