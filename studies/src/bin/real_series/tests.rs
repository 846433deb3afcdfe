//! The bench on a series that was made here: a door with opening hours.

use super::*;
use interfaces::{Purpose, RandomStream};

/// Four weeks of a door that is open half of the time from 9 to 17 on working days, for some minutes each time.
fn office_door() -> String {
    let mut rng = RandomStream::new(7, Purpose::Task);
    let mut text = String::from("# split_s=1814400 end_s=2419200\ntime_s,state\n0,0\n");
    let mut is_open = false;
    for minute in 0..28 * 1440 {
        let (day, hour) = (minute / 1440, f64::from(minute % 1440) / 60.0);
        let works = day % 7 < 5 && (9.0..17.0).contains(&hour);
        let changes = if works { rng.bernoulli(0.05) } else { is_open };
        if changes {
            is_open = !is_open;
            text += &format!("{},{}\n", 60 * minute, u8::from(is_open));
        }
    }
    text
}

#[test]
fn the_clock_predicts_an_office_door_better_than_all_baselines() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("office-door.csv");
    std::fs::write(&file, office_door()).unwrap();
    let options = Options::parse_from(["real_series".as_ref(), "--no-curve".as_ref(), file.as_os_str()]);
    let mut out = Vec::new();
    run(&options, &mut out).unwrap();
    let series = [Series::read(&file).unwrap()];
    let cases = evaluate(&series, f64::INFINITY, &Calendar::UTC);
    let models = models::all(&Calendar::UTC);
    let table = Table::new(&cases, &models);
    for (index, model) in models.iter().enumerate().skip(1) {
        let [clock, other] = [0, index].map(|model| table.ratio(model));
        assert!(clock < other, "{}: {clock} against {other}\n{}", model.name, String::from_utf8_lossy(&out));
    }
}

#[test]
fn files_that_are_no_series_are_refused_by_line() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("door.csv");
    for (text, expected) in [
        ("time_s,state\n0,0\n10,2\n", "line 3: expected `time_s,state`"),
        ("time_s,state\n0,0\nx,1\n", "line 3: expected `time_s,state`"),
        ("time_s,state\n10,0\n5,1\n", "line 3: time goes backwards"),
        ("time_s,state\n", "no events"),
        ("time_s,state\n0,0\n1e18,1\n", "line 3: more than ten years after the first line"),
    ] {
        std::fs::write(&file, text).unwrap();
        let error = Series::read(&file).err().unwrap();
        assert!(error.contains(expected) && error.contains("door.csv"), "{error}");
    }
}
