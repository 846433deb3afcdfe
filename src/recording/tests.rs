use super::*;
use crate::fake::FakeRun;

#[test]
#[ignore = "writes a recording to look at, and says what it cost"]
fn look() {
    let file = std::env::temp_dir().join("look.rrd");
    let ticks: u64 = std::env::var("TICKS").map_or(12_000, |ticks| ticks.parse().unwrap());
    let mut run = FakeRun::new();
    let options = RecordingOptions { file: Some(file.clone()), ..Default::default() };
    let mut recorder = Recorder::new(&options, run.scene.clone()).unwrap();
    let (mut logging, start) = (Duration::ZERO, Instant::now());
    for _ in 0..ticks {
        run.step();
        run.with_view(|view| {
            let start = Instant::now();
            recorder.log(view).unwrap();
            logging += start.elapsed();
        });
    }
    let end = Instant::now();
    run.with_view(|view| recorder.finish(view)).unwrap();
    println!("{ticks} ticks in {:?}, logging {logging:?}, finish {:?}", start.elapsed(), end.elapsed());
    println!("{} MB", std::fs::metadata(&file).unwrap().len() as f64 / 1e6);
}
