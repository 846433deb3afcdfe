//! `predict`: a place at other times, from a state of `map_log`.

use crate::map_log::{scan_line, standing_line, standing_log};
use crate::run::{Ended, Run, Summary};
use serde_json::{Value, json};
use std::fs;

/// Monday, 2024-01-01, 0:00 in Berlin.
const MONDAY_S: f64 = 1_704_063_600.0;
const DAY_S: f64 = 86_400.0;
const SAVED: &str = "--quiet --no-rrd --state a.state";

/// What stands 1 m before the laser from 8 to 18 o'clock, seen every two hours on 15 days, from a Monday on.
fn days() -> String {
    let looks = (0..15 * 12)
        .flat_map(|look| (0..20).map(move |second| 7200.0 * f64::from(look) + 600.0 + f64::from(second)));
    let line =
        |time_s: f64| standing_line(MONDAY_S + time_s, (8.0..18.0).contains(&(time_s % DAY_S / 3600.0)));
    looks.map(line).collect()
}

/// A folder with the state `a.state` of these days.
fn with_state() -> Run {
    let run = Run::of("map_log");
    run.write("days.log", &days());
    run.goes_well(&format!("days.log --time-zone europe/berlin {SAVED}"));
    assert_eq!(run.summary().text("/hours"), "Europe/Berlin");
    fs::remove_dir_all(run.path("out")).unwrap();
    run.with("predict")
}

fn feature(kind: &str, properties: Value, coordinates: Option<[f64; 2]>) -> Value {
    json!({"type": "Feature", "properties": properties, "geometry": {"type": kind, "coordinates": coordinates}})
}

fn node(id: u64, x: f64, y: f64) -> Value {
    feature("Point", json!({"id": id, "frame": "map"}), Some([x, y]))
}

fn edge(id: u64, startid: u64, endid: u64) -> Value {
    let metadata = json!({"aisle": 14});
    let properties = json!({"id": id, "startid": startid, "endid": endid, "cost": 1.0, "overridable": true, "metadata": metadata});
    feature("MultiLineString", properties, None)
}

fn graph(features: &[Value]) -> String {
    json!({"type": "FeatureCollection", "name": "graph", "features": features}).to_string()
}

#[test]
fn hours_routes_and_graphs_are_predicted() {
    let run = with_state();
    let ended = run.goes_well("a.state --at 2024-01-16T13:00 --at 2024-01-16T03:00 --place 1,0 --place 3,-2");
    ended.prints(&[
        "last reading: Mon 2024-01-15 22:10 CET",
        "  Tue 2024-01-16 13:00 CET: blocked with a probability of ",
        " %, from the hours and days around it)",
        "  Usually blocked Mon to Sun ",
        "Observed on 15 days, in ",
        " intervals of 30 minutes.",
        "  Nothing ever changed within half a meter: it was always free.",
    ]);
    let blocked = |number: usize| run.summary().number(&format!("/places/0/expected/{number}/probability"));
    assert!(blocked(0) > 0.8 && blocked(1) < 0.2, "noon {}, night {}", blocked(0), blocked(1));
    let expected = "expiry.npy expiry.png keepout_mask_1.pgm keepout_mask_1.yaml keepout_mask_2.pgm keepout_mask_2.yaml \
                    predicted_1.npy predicted_1.pgm predicted_1.png predicted_1.yaml predicted_2.npy predicted_2.pgm \
                    predicted_2.png predicted_2.yaml speed_mask_1.pgm speed_mask_1.yaml speed_mask_2.pgm speed_mask_2.yaml";
    assert_eq!(*run.summary().at("/files"), json!(expected.split(' ').collect::<Vec<_>>()));

    // The way through the thing, and the way around it.
    run.write("way.csv", "x,y\n0.5,0\n1.6,0\n1.6,-1\n");
    let nodes = [node(0, 0.5, 0.0), node(1, 2.0, 0.0), node(2, 0.5, -1.0), node(3, 2.0, -1.0)];
    let features = [&nodes[..], &[edge(10, 0, 1), edge(11, 0, 2), edge(12, 2, 3)]].concat();
    run.write("g.json", &graph(&features));
    run.goes_well("a.state --at 13:00 --route way.csv --graph g.json --from 0");
    let graph: Value = serde_json::from_slice(&fs::read(run.out("graph.geojson")).unwrap()).unwrap();
    let [through, first, around] = [4, 5, 6].map(|edge| graph["features"][edge]["properties"].clone());
    let open = |edge: &Value| edge["metadata"]["open_probability"].as_f64().unwrap();
    assert!(open(&through) < 0.2 && open(&around) == 1.0, "{through}, {around}");
    // No way round, and how long it lasts is not known.
    let expected_m = 1.5 + 1000.0 * (1.0 - open(&through));
    assert!((through["cost"].as_f64().unwrap() - expected_m).abs() < 1e-6, "{through}");
    assert_eq!((&first["cost"], &around["cost"]), (&json!(1.0), &json!(1.5)));
    assert_eq!((&around["overridable"], &around["metadata"]["aisle"]), (&json!(false), &json!(14)));
    let after_s =
        |edge: &Value| edge["metadata"]["arrival_s"].as_f64().unwrap() - run.summary().number("/times_s/0");
    assert_eq!((after_s(&through), after_s(&around)), (0.0, 2.0));
    assert_eq!(graph["name"], "graph");
    // 1.1 m at 0.5 m/s.
    let summary = run.summary();
    assert!(summary.number("/route/1/blocked") > 0.8 && summary.number("/route/2/blocked") == 0.0);
    assert!((summary.number("/route/1/time_s") - summary.number("/times_s/0") - 2.2).abs() < 1e-6);
}

/// A scan before a wall that is 2 m away and has a door of 0.9 m; the room behind it ends at 4 m.
fn door_line(time_s: f64, is_open: bool) -> String {
    scan_line(time_s, |beam| {
        let (ahead, aside) = f64::from(beam).to_radians().sin_cos();
        let wall_m = if is_open && (2.0 * aside / ahead).abs() < 0.45 { 4.0 } else { 2.0 };
        (wall_m / ahead.max(1e-9)).min(3.0 / aside.abs().max(1e-9))
    })
}

/// A door that is open from 8 to 18 o'clock, seen for 20 s in every half hour of 15 days, and when it opens and closes.
fn door_days() -> String {
    let scan = |time_s: f64| {
        let is_open = (8.0..18.0).contains(&(time_s % DAY_S / 3600.0));
        door_line(MONDAY_S + time_s, is_open)
    };
    let halves = (0..15 * 48).map(|half| 1800.0 * f64::from(half));
    let of_half = |begin_s: f64| {
        (-10..10).map(move |second| begin_s + f64::from(second)).filter(|time_s| *time_s >= 0.0)
    };
    halves.flat_map(of_half).map(scan).collect()
}

#[test]
fn doors_have_hours_and_so_have_masks_and_edges() {
    let run = Run::of("map_log");
    run.write("days.log", &door_days());
    run.write("names.toml", "[[place]]\nname = \"front\"\nx_m = 2.0\ny_m = 0.0\n");
    run.goes_well(&format!("days.log --time-zone Europe/Berlin --places names.toml {SAVED}"));
    fs::remove_dir_all(run.path("out")).unwrap();
    let run = run.with("predict");
    run.goes_well("a.state --at 2024-01-16T13:00 --at 2024-01-16T03:00").prints(&[
        "door 0, place 1 (front), at (2.0",
        " m wide, closed when it was last seen, Mon 2024-01-15 23:30 CET",
        "  Tue 2024-01-16 13:00 CET: open with a probability of ",
        "  Opens ",
        "  Usually open Mon to Sun ",
    ]);
    let expected = |summary: &Summary, number: usize| {
        let of = |key: &str| summary.number(&format!("/places/0/expected/{number}/{key}"));
        [of("interval_90/0"), of("probability"), of("interval_90/1")]
    };
    let [noon, night] = [0, 1].map(|number| expected(&run.summary(), number));
    assert!(noon[0] > 0.5 && night[2] < 0.3, "{noon:?}, {night:?}");
    assert!([noon, night].iter().all(|found| found.is_sorted()), "{noon:?}, {night:?}");
    // The closed leaf is kept out of at night only. A door that opens once a day slows no robot.
    let darkest = |mask: &str| {
        let picture = fs::read(run.out(&format!("{mask}.pgm"))).unwrap();
        *picture.iter().skip(20).min().unwrap()
    };
    assert_eq!(["keepout_mask_1", "keepout_mask_2"].map(darkest), [255, 0]);
    run.goes_well("a.state --at 2024-01-16T08:00 --at 2024-01-16T03:00");
    assert_eq!(["speed_mask_1", "speed_mask_2"].map(darkest), [255, 255]);

    // A place at the door and an edge through it are predicted as the door.
    let features = [node(0, 1.0, 0.1), node(1, 3.0, 0.1), edge(10, 0, 1)];
    run.write("g.json", &graph(&features));
    run.goes_well("a.state --at 2024-01-16T13:00 --place 1.8,0.3 --graph g.json --speed 100");
    assert_eq!(expected(&run.summary(), 0), noon);
    let graph: Value = serde_json::from_slice(&fs::read(run.out("graph.geojson")).unwrap()).unwrap();
    let open = graph["features"][2]["properties"]["metadata"]["open_probability"].as_f64().unwrap();
    assert!((open - noon[1]).abs() < 1e-3, "{open}, {noon:?}");
    // So is its place in the report, by number and by name.
    for asked in ["1", "front"] {
        run.goes_well(&format!("a.state --at 2024-01-16T13:00 --place {asked}"));
        let summary = run.summary();
        assert_eq!(expected(&summary, 0), noon);
        assert_eq!((summary.number("/places/0/number"), summary.text("/places/0/name")), (1.0, "front"));
        let title = summary.text("/places/0/title");
        assert!(title.starts_with("door 0, place 1 (front), at "), "{title}");
    }
    insta::assert_snapshot!(run.refuses("a.state --place 9"), @"error: --place 9: there is no such place; known are 1 (front)");
    let refused = run.refuses("a.state --door 0 --door 7");
    let says = ["error: --door 7: there is no such door; known are 0 at ", "are those of places: --place"];
    assert!(says.iter().all(|says| refused.contains(says)), "{refused}");
}

/// Two rooms of 5 m × 8 m: a door in the wall between them (x = 5 m, y from 3.5 to 4.5 m), and a passage (y from 7 to 8 m).
const WALLS: [[f64; 4]; 9] = [
    [0.0, 0.0, 10.0, 0.0],
    [10.0, 0.0, 10.0, 8.0],
    [10.0, 8.0, 0.0, 8.0],
    [0.0, 8.0, 0.0, 0.0],
    [5.0, 0.0, 5.0, 3.5],
    [5.0, 4.5, 5.0, 7.0],
    [2.0, 1.0, 3.0, 1.0],
    [7.0, 1.0, 7.0, 2.0],
    [9.0, 5.0, 9.5, 5.5],
];
const DOOR: [f64; 4] = [5.0, 3.5, 5.0, 4.5];

/// The range along a heading, m.
fn range_m([x, y, heading_rad]: [f64; 3], is_closed: bool) -> f64 {
    let (dy, dx) = heading_rad.sin_cos();
    let hit = |[x1, y1, x2, y2]: &[f64; 4]| {
        let (along, across) = ([x2 - x1, y2 - y1], dx * (y2 - y1) - dy * (x2 - x1));
        let ahead = ((x1 - x) * along[1] - (y1 - y) * along[0]) / across;
        let beside = ((x1 - x) * dy - (y1 - y) * dx) / across;
        (ahead > 0.0 && (0.0..=1.0).contains(&beside)).then_some(ahead)
    };
    WALLS.iter().chain([&DOOR].into_iter().filter(|_| is_closed)).filter_map(hit).fold(30.0, f64::min)
}

/// The log of a robot that goes around through the passage and back, and then watches the door for half an hour: it stays closed, and
/// open, for a minute on average, and is closed at the end. The map begins at (2, 4) m.
fn two_rooms() -> String {
    let (mut text, mut time_s, mut pose) = (String::new(), 1.7e9, [2.0_f64, 4.0, 0.0]);
    // The quantiles of an exponential distribution, in an order without a pattern.
    let stay_s = |stay: u32| -60.0 * (f64::from(stay * 7 % 29) / 29.0 + 0.5 / 29.0).ln();
    let (mut stay, mut until_s) = (0, time_s + 60.0);
    let mut scan = |pose: [f64; 3], step_s: f64| {
        time_s += step_s;
        if time_s > until_s {
            (stay, until_s) = (stay + 1, until_s + stay_s(stay));
        }
        let is_closed = stay % 2 == 1;
        let ranges: String = (0..180)
            .map(|beam| range_m([pose[0], pose[1], pose[2] + f64::from(beam - 90).to_radians()], is_closed))
            .map(|range_m| format!("{range_m:.3} "))
            .collect();
        let at = format!("{:.3} {:.3} {:.4}", pose[0] - 2.0, pose[1] - 4.0, pose[2]);
        text += &format!("ODOM {at} 0 0 0 {time_s:.2} h 0\nFLASER 180 {ranges}{at} {at} {time_s:.2} h 0\n");
        is_closed
    };
    for [x, y] in [[2.0_f64, 7.5], [8.0, 7.5], [8.0, 2.5], [8.0, 7.5], [2.0, 7.5], [2.0, 4.0], [3.0, 4.0]] {
        let (ahead, length_m) = ((y - pose[1]).atan2(x - pose[0]), (y - pose[1]).hypot(x - pose[0]));
        let turn_rad =
            (ahead - pose[2] + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
        let turns = (turn_rad.abs() / 0.1).ceil().max(1.0);
        for _ in 0..turns as u32 {
            pose[2] += turn_rad / turns;
            scan(pose, 0.2);
        }
        let steps = (length_m / 0.1).ceil();
        for _ in 0..steps as u32 {
            (pose[0], pose[1]) =
                (pose[0] + length_m / steps * ahead.cos(), pose[1] + length_m / steps * ahead.sin());
            scan(pose, 0.2);
        }
    }
    for _ in 0..1500 {
        scan(pose, 1.0);
    }
    while !scan(pose, 1.0) {}
    for _ in 0..8 {
        scan(pose, 1.0);
    }
    text
}

/// In front of a closed door, a robot for which the way round is short goes round, one for which it is long waits, and one that does not
/// fit through the passage has no other choice.
#[test]
fn a_route_through_a_closed_door_waits_or_goes_round() {
    let run = Run::of("map_log");
    run.write("two.log", &two_rooms());
    run.goes_well(&format!("two.log {SAVED}"));
    fs::remove_dir_all(run.path("out")).unwrap();
    let run = run.with("predict");
    for (name, points) in [
        ("through.csv", "1 0\n6 0\n"),
        ("inside.csv", "3 0\n6 0\n"),
        ("wall.csv", "1 0\n1 -5\n"),
        ("free.csv", "0.5 -1\n0.5 1.5\n"),
        ("twice.csv", "1 0\n6 0\n1 0\n"),
    ] {
        run.write(name, points);
    }
    run.goes_well("a.state --route through.csv").prints(&[
        "door 0 at (2.9",
        "do not wait, go round: ",
        " more (expected loss",
    ]);
    let advice = |key: &str| run.summary().at(&format!("/crossings/0/advice/{key}")).as_f64();
    // 6 m more at most, at 0.5 m/s.
    assert!((4.0..14.0).contains(&advice("detour_s").unwrap()) && advice("patience_s") == Some(0.0));
    assert!(advice("loss_s") <= advice("detour_s"));
    run.goes_well("a.state --route through.csv --speed 0.05").prints(&["wait at most ", ", then go round: "]);
    assert!(advice("patience_s").unwrap() > 30.0 && advice("loss_s").unwrap() < 60.0);
    run.goes_well("a.state --route through.csv --radius 0.49")
        .prints(&["wait until the way is free; no way round is known within 20 m"]);
    assert_eq!((advice("detour_s"), advice("patience_s")), (None, None));
    run.goes_well("a.state --route inside.csv").prints(&["the route starts inside it"]);
    run.goes_well("a.state --route wall.csv").prints(&["a wall at (", "blocked: 100.0 %: not passable"]);
    run.goes_well("a.state --route free.csv");
    assert_eq!(*run.summary().at("/crossings"), json!([]));
    // The door is reported once, and the way back is no way round.
    run.goes_well("a.state --route twice.csv");
    assert_eq!(run.summary().at("/crossings").as_array().unwrap().len(), 1);
    assert!(advice("detour_s").unwrap() > 4.0);
}

#[test]
fn what_cannot_be_predicted_is_refused_with_a_sentence() {
    let (run, many) = (with_state(), "0 0\n".repeat(100_001));
    let wrong_files = [
        ("way.csv", "0,0\n1,up\n"),
        ("far.csv", "0 0\n200000000 0\n"),
        ("late.csv", "1 0 0\ninf 1 0\n"),
        ("many.csv", many.as_str()),
        ("back.csv", "1,0,0\n2,1,0\n1.5,1,1\n"),
        ("g.json", "{\"features\": 3}"),
    ];
    wrong_files.iter().for_each(|(name, text)| run.write(name, text));
    let time = "a time must be a finite number of seconds, not before that of the point before, found";
    for (arguments, says) in [
        (
            "a.state --at teatime",
            "error: --at: `teatime`: must be a time as +10m, 17:10, \"Tue 17:10\", 2024-01-30T17:10 or 2024-01-30T17:10Z\n",
        ),
        ("a.state --place 99,0", "--place 99,0: it is outside of the map, x from "),
        ("way.csv", "way.csv: this is not a state file"),
        // Nothing is predicted for the past.
        (
            "a.state --at +1h --at 2024-01-15T22:10",
            "error: --at: `2024-01-15T22:10`: must not be before the last reading, 2024-01-15T22:10:19 (CET)\n",
        ),
        ("a.state --route way.csv", "way.csv, line 2: a point is `x y` or `time x y`"),
        (
            "a.state --route far.csv",
            "far.csv, line 2: x and y must be numbers from -1000000 to 1000000 m, found 200000000 and 0\n",
        ),
        ("a.state --route late.csv", &format!("late.csv, line 2: {time} inf\n")),
        ("a.state --route back.csv", &format!("back.csv, line 3: {time} 1.5\n")),
        ("a.state --route many.csv", "many.csv, line 100001: a route has at most 100000 points"),
        ("a.state --graph g.json", "g.json: this is no graph of nav2_route: it has no list `features`"),
    ] {
        let message = run.refuses(arguments);
        assert!(message.contains(says), "{arguments}: {message}");
    }
}

#[test]
fn a_state_keeps_its_time_zone_and_an_earlier_one_gets_one() {
    let run = Run::of("map_log");
    run.write("a.log", &standing_log(1.7e9, 60));
    run.goes_well(&format!("a.log --time-zone Europe/Berlin {SAVED}"));
    let before = fs::read(run.path("a.state")).unwrap();
    insta::assert_snapshot!(run.refuses(&format!("a.log --time-zone UTC {SAVED}")), @"error: a.state: the state is of another run: `survey.mapper.time_zone` is `Europe/Berlin` there, and `UTC` here");
    assert!(fs::read(run.path("a.state")).unwrap() == before);
    run.goes_well(&format!("a.log {SAVED}"));
    assert_eq!(run.summary().text("/settings/mapper/time_zone"), "Europe/Berlin");
    let refused = run.refuses("a.log --time-zone Europe/Berlim");
    assert!(refused.contains("perhaps Europe/Berlin;"), "{refused}");

    // A log without a date has no hours.
    run.write("b.log", &standing_log(10.0, 60));
    run.goes_well("b.log --quiet --no-rrd --state b.state");
    assert_eq!(run.summary().text("/hours"), "none: b.log does not say when it was recorded");
    let run = run.with("predict");
    let refused = run.refuses("b.state --at 17:10");
    let says = "the state knows no hours (b.log does not say when it was recorded)";
    assert!(refused.contains(says), "{refused}");
    run.goes_well("b.state --at +10m --place 1,0");
    assert_eq!(run.summary().at("/places/0/expected").as_array().unwrap().len(), 1);
}

/// A world with a calendar has dates: its first week begins on Monday, 2024-01-01. The door of the page on worlds is open from 8 to 18 on
/// weekdays, and closed at night.
#[test]
fn a_simulated_week_is_asked_for_days_and_hours() {
    let page = include_str!("../../docs/worlds.md");
    let begin = page.find("name = \"two rooms\"").unwrap();
    let world = page[begin..begin + page[begin..].find("```").unwrap()].replace("beams = 360", "beams = 180");
    let run = Run::new();
    run.write("rooms.toml", &world.replace("battery_s = 300.0", "battery_s = 180.0"));
    let week = "--world rooms.toml --patrol 0.03 --seed 1 --quiet --no-rrd";
    run.goes_well(&format!("{week} --duration 3d --state week.state"));
    let end_s = run.summary().number("/simulated_s");
    fs::remove_dir_all(run.path("out")).unwrap();
    let run = run.with("predict");
    let ended = run.goes_well("week.state --at 2024-01-11T03:00 --at 2024-01-11T13:00Z --at +1h");
    ended.prints(&["last reading: Thu 2024-01-04 "]);
    let summary = run.summary();
    // Monday, 7:00, is the beginning.
    let begin_s = MONDAY_S + 3600.0 + 7.0 * 3600.0;
    assert!((summary.number("/last_reading_s") - begin_s - end_s).abs() < 1e-3);
    assert!((summary.number("/times_s/1") - MONDAY_S - 3600.0 - 10.0 * DAY_S - 13.0 * 3600.0).abs() < 1e-3);
    let open = |number: usize| summary.number(&format!("/places/0/expected/{number}/probability"));
    assert!(open(0) + 0.15 < open(1), "at night {}, at noon {}", open(0), open(1));
    // By its weekday, in words.
    let mut command = run.command("week.state --place 4.05,1.95");
    let ended = Ended::from(command.args(["--at", "Tue 14:00"]).output().unwrap());
    ended.prints(&["  Tue 2024-01-09 14:00 UTC: open with a probability of "]);
}
