//! The layouts of `summary.json` and `report.json` have versions: `tests/schemas` lists the keys of each.
//!
//! After a renamed, removed or added key, count up `SCHEMA` beside the type, and write the next list:
//! `cargo test --test it write_the_schemas -- --ignored`

use crate::map_log::standing_log;
use crate::run::Run;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

/// The results whose keys are listed: a name, and the file of a short run.
fn results() -> [(&'static str, Value); 4] {
    let robot = Run::new();
    robot.goes_well("--world house --duration 20 --pose localized --quiet --no-rrd");
    let logs = Run::of("map_log");
    logs.write("a.log", &standing_log(1.7e9, 120));
    logs.goes_well("a.log --quiet --no-rrd --state a.state");
    let logged = logs.summary().0;
    let predicted = logs.with("predict");
    predicted.write("way.csv", "0.5 0\n2 0\n");
    predicted.goes_well("a.state --place 1,0 --route way.csv --at +1m");
    let trials = Run::of("grid_world");
    trials.goes_well("--quiet --steps 200 --trials 2 --strategy recency --strategy random --estimator paper");
    let read = |run: &Run, file: &str| serde_json::from_slice(&fs::read(run.out(file)).unwrap()).unwrap();
    [
        ("four_rooms", read(&robot, "summary.json")),
        ("map_log", logged),
        ("predict", predicted.summary().0),
        ("report", read(&trials, "report.json")),
    ]
}

/// The paths of all keys, with `[]` for the elements of a list and the kind of each value.
fn keys(path: &str, value: &Value, found: &mut BTreeSet<String>) {
    let kind = match value {
        Value::Object(fields) => {
            fields.iter().for_each(|(name, value)| keys(&format!("{path}/{name}"), value, found));
            return;
        }
        Value::Array(values) => {
            values.iter().for_each(|value| keys(&format!("{path}/[]"), value, found));
            "list"
        }
        Value::String(_) => "text",
        Value::Bool(_) => "yes or no",
        Value::Number(_) | Value::Null => "number or null",
    };
    found.insert(format!("{path} {kind}\n"));
}

fn list(name: &str, value: &Value) -> (PathBuf, String) {
    let mut found = BTreeSet::new();
    keys("", value, &mut found);
    let file = format!("tests/schemas/{name}-{}.txt", value["schema"]);
    (PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(file), found.into_iter().collect())
}

#[test]
fn other_keys_have_another_schema() {
    for (name, value) in results() {
        let (path, keys) = list(name, &value);
        let listed = fs::read_to_string(&path).unwrap_or_default();
        assert_eq!(
            keys,
            listed,
            "{}: a key is new: write the list again; one is missing: count up the schema as well",
            path.display()
        );
    }
}

#[test]
#[ignore = "writes the lists of keys"]
fn write_the_schemas() {
    for (name, value) in results() {
        let (path, keys) = list(name, &value);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, keys).unwrap();
    }
}
