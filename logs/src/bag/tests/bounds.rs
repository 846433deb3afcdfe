//! What a bag may hold is bounded before it is allocated.

use super::builder::*;
use mcap::Compression;

/// A record.
fn record(code: u8, content: &[u8]) -> Vec<u8> {
    [&[code][..], &(content.len() as u64).to_le_bytes(), content].concat()
}

/// Text after its length.
fn text(bytes: &[u8]) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes(), bytes].concat()
}

/// A file with a chunk of these records.
fn file(chunks: &[Vec<u8>]) -> Vec<u8> {
    file_with_sum(chunks, [0; 4])
}

/// A file with these checksums of the chunks; 0: none.
fn file_with_sum(chunks: &[Vec<u8>], sum: [u8; 4]) -> Vec<u8> {
    let chunk = |records: &Vec<u8>| {
        let packed = zstd::encode_all(&records[..], 0).unwrap();
        let head = [&[0; 16][..], &(records.len() as u64).to_le_bytes(), &sum, &text(b"zstd")].concat();
        record(6, &[&head[..], &(packed.len() as u64).to_le_bytes(), &packed].concat())
    };
    let end = [record(15, &[0; 4]), record(2, &[0; 20]), b"\x89MCAP0\r\n".to_vec()].concat();
    [b"\x89MCAP0\r\n".to_vec(), chunks.iter().flat_map(chunk).collect(), end].concat()
}

/// The memory that was used at most so far, KiB; `None` elsewhere than on Linux.
fn peak_kib() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.split_whitespace().next()?.parse().ok()
}

#[test]
fn names_of_gigabytes_are_refused_before_they_are_read() {
    // 120 schemas with names of 60 MB in a file of 260 kB.
    let schema = |id: u16| record(3, &[&id.to_le_bytes()[..], &text(&vec![b'a'; 60 << 20])].concat());
    let bomb = file(&[schema(1)]);
    let chunk = &bomb[8..bomb.len() - 8 - 13 - 29];
    let start = bomb[..8].to_vec();
    let many = [start, chunk.repeat(120), bomb[bomb.len() - 50..].to_vec()].concat();
    assert!(many.len() < 1 << 20, "{} bytes", many.len());
    let before_kib = peak_kib();
    insta::assert_snapshot!(refused(&many), @"test: byte 8: a schema has a name of 62914560 bytes; at most 1024 are read");
    let used_kib = before_kib.zip(peak_kib()).map(|(before, after)| after - before);
    assert!(used_kib.is_none_or(|kib| kib < 300 << 10), "{used_kib:?} KiB");
    let topic = record(4, &[&[1, 0, 0, 0][..], &text(&[b'a'; 1025])].concat());
    insta::assert_snapshot!(refused(&file(&[topic])), @"test: byte 8: a channel has a name of 1025 bytes; at most 1024 are read");
}

#[test]
fn chunks_that_unpack_to_more_than_a_thousand_times_the_file_are_refused() {
    let zeros = record(9, &vec![0; 40 << 20]);
    let error = refused(&file(&[zeros.clone(), zeros.clone(), zeros]));
    assert!(error.contains("the chunks so far unpack to 83886098 bytes; at most"), "{error}");
}

#[test]
fn damaged_chunks_count_among_those_that_unpack_to_too_much() {
    let zeros = record(9, &vec![0; 40 << 20]);
    let error = refused(&file_with_sum(&[zeros.clone(), zeros.clone(), zeros], [1; 4]));
    assert!(error.contains("the chunks so far unpack to 83886098 bytes; at most"), "{error}");
}

#[test]
fn a_summary_that_leads_backward_ends() {
    let mut bytes = file_with_sum(&[record(9, &[0; 40])], [1; 4]);
    let footer = bytes.len() - 8 - 29;
    // A record that claims to end where it begins.
    let backward = [&[11][..], &(-9_i64).to_le_bytes(), &[0; 40]].concat();
    bytes.splice(footer..footer, backward);
    let at = bytes.len() - 8 - 20;
    bytes[at..at + 8].copy_from_slice(&(footer as u64).to_le_bytes());
    assert!(refused(&bytes).contains("the checksum of a chunk does not match"), "{}", refused(&bytes));
}

#[test]
fn long_definitions_of_schemas_are_skipped() {
    let mut bag = Builder::default();
    bag.laser(0.0).laser(0.1);
    let bytes = bag.mcap(compressed(Compression::Zstd));
    let long =
        record(3, &[&[9, 0][..], &text(b"a/msg/B"), &text(b"ros2msg"), &text(&vec![b' '; 1 << 20])].concat());
    let bytes = [&bytes[..8], &long, &bytes[8..]].concat();
    assert_eq!(read(&bytes).summary().scans, 2);
}

#[test]
fn long_names_in_databases_and_of_frames_are_refused() {
    let (long, bag) = ("a".repeat(2000), Builder::default);
    let topic = refused(&bag().scan(&long, 0.0, &scan(0.0, "laser")).sqlite());
    insta::assert_snapshot!(topic, @"test: the database is damaged: a name in `topics` has 2000 bytes; at most 1024 are read");
    let frame = bag().scan("/scan", 0.0, &scan(0.0, &long)).refused();
    insta::assert_snapshot!(frame, @"test: message 1 of /scan: the name of a frame has 2000 bytes; at most 1024 are read");
    let child = bag().tf("/tf", 0.0, &[still("base_link", &long)]).refused();
    assert!(child.contains("the name of a frame has 2000 bytes"), "{child}");
}

#[test]
fn a_robot_may_have_thousands_of_frames() {
    let mut bag = Builder::default();
    bag.mount().odometry("/odom", 0.0, 0.0, 0.0).odometry("/odom", 1.0, 1.0, 0.0);
    let edges: Vec<_> = (0..2000)
        .map(|joint| still(&format!("joint{joint}"), &format!("joint{}", joint + 1)))
        .chain([still("base_link", "joint0")])
        .collect();
    bag.tf("/tf_static", 0.0, &edges).scan("/scan", 0.5, &scan(0.5, "joint2000"));
    let opened = bag.log();
    assert_eq!(readings(&opened)[0].pose.translation.x, 0.5);
}
