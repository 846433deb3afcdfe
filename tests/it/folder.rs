//! The folder of the results holds one run.

use crate::run::{Run, names};

#[test]
fn nothing_of_an_earlier_run_stays() {
    let run = Run::new();
    run.goes_well("--quiet --world house --duration 2");
    assert!(run.out("house.rrd").exists());
    run.write("out/notes.txt", "of the user");
    run.goes_well("--quiet --duration 2 --rrd out/own.rrd");
    assert!(!run.out("house.rrd").exists() && run.out("own.rrd").exists());
    run.goes_well("--quiet --no-rrd --duration 2");
    let files = names(&run.path("out"));
    assert_eq!(files.len(), 14, "{files:?}");
    assert!(files.iter().all(|name| !name.ends_with(".rrd")), "{files:?}");
    assert_eq!(run.summary().text("/world"), "four rooms");
    let listed = run.summary().at("/files").as_array().unwrap().len();
    assert_eq!(listed, 12, "all but the summary and the notes");
}

#[test]
fn worlds_of_an_earlier_run_stay_if_they_are_the_input() {
    let run = Run::grid();
    let arguments = "--quiet --steps 100 --trials 1 --strategy recency --estimator paper";
    run.goes_well(&format!("{arguments} --generate 2 --save-worlds"));
    let worlds = || names(&run.path("out")).into_iter().filter(|name| name.ends_with(".toml"));
    let [first, second] = &worlds().collect::<Vec<_>>()[..] else { panic!("not two worlds") };
    run.goes_well(&format!("{arguments} --world out/{second}"));
    assert_eq!(worlds().collect::<Vec<_>>(), [second.as_str()], "{first} is of the earlier run");
}

#[test]
fn a_run_that_fails_leaves_the_earlier_one() {
    let run = Run::new();
    run.goes_well("--quiet --duration 2");
    let before = std::fs::read(run.out("summary.json")).unwrap();
    let files = names(&run.path("out"));
    assert_eq!(run.ends("--duration 2 --seed 1 --rrd no/such/folder.rrd").code, Some(1));
    assert_eq!(std::fs::read(run.out("summary.json")).unwrap(), before);
    assert_eq!(names(&run.path("out")), files);
}

#[test]
fn a_second_run_into_the_same_folder_is_refused() {
    let run = Run::new();
    let mut first = run.starts("--duration 1h --speed 1 --quiet");
    let is_open = || run.out("unfinished_run/.lock").exists();
    assert!((0..1200).any(|_| {
        std::thread::sleep(std::time::Duration::from_millis(50));
        is_open()
    }));
    let second = run.ends("--duration 2 --no-rrd");
    first.kill().unwrap();
    first.wait().unwrap();
    assert_eq!(second.code, Some(1), "{second:?}");
    insta::assert_snapshot!(second.stderr, @"error: cannot write out: another run is writing there; wait for it, or give this one another folder by --out");
    run.goes_well("--duration 2 --no-rrd");
}
