//! `map.yaml`, valid and invalid.

use super::*;
use crate::Disk;
use crate::reader::tests::mutations;
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::path::PathBuf;

const GOOD: &str = "\
image: house.pgm
mode: trinary
resolution: 0.05
origin: [-6.0, -5.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
";

/// Blocked, unknown, free; the last three are the first three with `negate`.
const HOUSE: &[u8] = b"P5 6 1 255 \x00\xcd\xfe\xff\x32\x01";

fn read(yaml: &str) -> (Option<FloorPlan>, Findings) {
    read_with(yaml, HOUSE)
}

fn read_with(yaml: &str, picture: &[u8]) -> (Option<FloorPlan>, Findings) {
    let files = [("maps/house.yaml", yaml.as_bytes()), ("maps/house.pgm", picture)];
    let files = BTreeMap::from(files.map(|(name, bytes)| (PathBuf::from(name), bytes.to_vec())));
    let mut findings = Findings::default();
    let plan = read_floor_plan(Path::new("maps/house.yaml"), &files, &mut findings);
    assert_eq!(plan.is_none(), findings.errors() > 0);
    (plan, findings)
}

fn blocked(yaml: &str) -> String {
    let (plan, findings) = read(yaml);
    let plan = plan.unwrap_or_else(|| panic!("{findings}"));
    (0..6).map(|x| if plan.bitmap.is_blocked(x, 0) { '#' } else { '.' }).collect()
}

#[test]
fn a_map_is_read() {
    let (plan, findings) = read(GOOD);
    let plan = plan.unwrap();
    assert_eq!(plan.origin, interfaces::pose(-6.0, -5.0, 0.0));
    assert_eq!(plan.pixel_m.x, 0.05);
    // 0xcd is 205, p = 0.19608; 0x32 is 50, p = 0.804.
    assert_eq!(blocked(GOOD), "#...##");
    insta::assert_snapshot!(findings, @"
    note: maps/house.yaml: 1 of the 6 pixels are unknown
      = help: they are taken as free: no walls, and lasers look through
    ");
}

#[test]
fn modes_and_negation() {
    for (from, to, expected) in [
        ("negate: 0", "negate: 1", ".###.."),
        ("negate: 0", "negate: true", ".###.."),
        ("trinary", "scale", "#...##"),
        // Strictly: p = 1 is not above 1.
        ("0.65", "1.0", "......"),
        // A byte order mark is skipped.
        ("image", "\u{feff}image", "#...##"),
    ] {
        assert_eq!(blocked(&GOOD.replacen(from, to, 1)), expected, "{to}");
    }
    // In percent: 0, 205 (unknown), …, 50, 1.
    assert_eq!(blocked(&GOOD.replace("trinary", "raw").replace("0.65", "0.3")), "....#.");
}

#[test]
fn everything_invalid_is_reported_at_once() {
    let bad = "image: [1, 2]\nresolution: -0.05\norigin: [0.0, 0.0]\nnegate: 2\noccupied_thresh: high\n\
               free_thres: 0.1\nmode: fancy\n";
    let cases = [
        ("many faults", bad.to_owned()),
        ("a key twice", format!("{GOOD}negate: 1\n")),
        ("no picture", GOOD.replace("house.pgm", "home.pgm").replace("0.05", "-1").replace("0.65", "65")),
        ("not a picture", GOOD.replace("house.pgm", "house.yaml")),
        ("thresholds crossed", GOOD.replace("0.196", "0.7")),
        ("not finite", GOOD.replace("-6.0", ".inf")),
        ("empty", String::new()),
    ];
    let messages = cases.iter().map(|(case, yaml)| format!("# {case}\n\n{}\n\n", read(yaml).1));
    let messages: String = messages.collect();
    insta::with_settings!({ omit_expression => true }, { insta::assert_snapshot!(messages) });
}

/// Words of the parser and of the decoders.
const JARGON: [&str; 10] = [
    "deserialize",
    "budget",
    "scalar",
    "mapping",
    "Option",
    "Chunk",
    "Format error",
    "MAXVAL",
    "indicator",
    "expected",
];

#[test]
fn faults_of_the_text_are_said_in_plain_words() {
    const PLAIN: &str = "this is not a list of keys with values";
    let deep = format!("a: {}", "[".repeat(1000));
    let blocks: String = (0..500).map(|depth| format!("{}a:\n", " ".repeat(depth))).collect();
    let bomb = format!(
        "a: &a [1, 1]\n{}",
        (1..30).map(|i| format!("{0}: &{0} [*{1}, *{1}]\n", letter(i), letter(i - 1))).collect::<String>()
    );
    let long = format!("a: [{}]", "1, ".repeat(300_000));
    let cases = [
        ("- a", 1, PLAIN),
        ("just a text", 1, PLAIN),
        ("42", 1, PLAIN),
        (": 1\nimage: a.pgm", 1, PLAIN),
        ("image: a.pgm\n~: 1", 2, PLAIN),
        ("image: a.pgm\nimage: b.pgm", 2, "a key is given twice"),
        ("image: [a.pgm\nnegate: 0", 0, PLAIN),
        ("negate: 0\norigin: [1, 2}", 0, PLAIN),
        ("negate: 0\norigin: 1, 2]: [", 0, PLAIN),
        ("negate: 0\nimage: \"a.pgm\nmode: raw", 0, PLAIN),
        ("negate: 0\nimage: 'a.pgm", 0, PLAIN),
        ("origin:\n\t- 1", 0, PLAIN),
        ("negate: 0\n a: b: c", 0, PLAIN),
        ("negate: 0\nimage a.pgm", 0, PLAIN),
        ("negate: 0\n---\nnegate: 1", 3, PLAIN),
        ("negate: 0\nimage: \0", 0, PLAIN),
        ("negate: *b", 1, PLAIN),
        (&bomb, 0, ""),
        (&deep, 1, ""),
        (&blocks, 0, PLAIN),
        (&long, 1, PLAIN),
    ];
    for (yaml, line, what) in cases {
        let (plan, findings) = read(yaml);
        let first = findings.iter().next().unwrap();
        assert!(plan.is_none() && !first.help.is_empty());
        for word in JARGON {
            assert!(!findings.to_string().contains(word), "{findings}");
        }
        assert!(if line == 0 { first.line > 0 } else { first.line == line }, "{findings}");
        assert!(what.is_empty() || first.what == what, "{findings}");
    }
}

fn letter(index: u8) -> char {
    char::from(b'a' + index % 26)
}

#[test]
fn values_of_every_kind_are_shown_as_they_are_written() {
    for value in ["", " ~", " # none", " ''", " \"a\\eb\\n\"", " 1e300", " [a, b]", " {a: b}"] {
        let (_, findings) = read(&GOOD.replace(" house.pgm", value));
        let is = match value {
            "" | " ~" | " # none" => "has no value".to_owned(),
            written => format!("is `{}`", written.trim()),
        };
        assert_eq!(findings.iter().next().unwrap().what, format!("`image` {is}"), "{findings}");
    }
}

#[test]
fn pictures_that_are_none_are_named_in_plain_words() {
    const HEADER: &str = "its header is damaged or incomplete, or that of too large a picture";
    for (bytes, why) in [
        (&b""[..], "it is neither a PNG nor a PGM picture"),
        (b"P7\nWIDTH 1\n", HEADER),
        (b"\xff\xd8\xff\xe0 JFIF", "it is neither a PNG nor a PGM picture"),
        (b"\x89PNG\r\n\x1a\n", HEADER),
        (b"\x89PNG\r\n\x1a\n\0\0\0\x0dIDAT\0\0\0\x01\0\0\0\x01\x08\0\0\0\0", HEADER),
        (b"P5", HEADER),
        (b"P5 a b 255 ", HEADER),
        (b"P5 2 2 0 \0\0\0\0", HEADER),
        (b"P5 2 2 255 \0\0\0", "its pixels are damaged or incomplete"),
        (b"P2 2 1 255 0 x", "its pixels are damaged or incomplete"),
        (b"P5 0 5 255 ", "it has no pixels"),
        (b"P5 99999 99999 255 ", "99999 × 99999 pixels are too many: at most 67108864"),
    ] {
        let (_, findings) = read_with(GOOD, bytes);
        let what = format!("cannot read the picture maps/house.pgm: {why}");
        assert_eq!(findings.iter().next().unwrap().what, what);
    }
}

#[test]
fn missing_and_strange_files() {
    let mut findings = Findings::default();
    assert!(super::read(Path::new("no/map.yaml"), &Disk, &mut findings).is_none());
    insta::assert_snapshot!(findings.iter().next().unwrap().what, @"cannot read this file: No such file or directory (os error 2)");
    assert!(Disk.read(Path::new("/dev/zero"), 10).is_err());
}

proptest! {
    #[test]
    fn no_text_makes_it_panic(changed in mutations::changed(GOOD)) {
        read(&changed);
    }

    #[test]
    fn no_bytes_make_it_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let mut files = BTreeMap::new();
        files.insert(PathBuf::from("m.yaml"), bytes);
        super::read(Path::new("m.yaml"), &files, &mut Findings::default());
    }

    /// Aliases of aliases, deep lists and long lines.
    #[test]
    fn no_yaml_makes_it_panic(text in "([&*][ab] |[-?:\\[\\]{},\"'|>#!%@`~ \n]|[a-z0-9.]){0,200}") {
        let (_, findings) = read(&text);
        let shown = findings.to_string();
        prop_assert!(JARGON.iter().all(|word| !shown.contains(word)), "{}", shown);
    }
}
