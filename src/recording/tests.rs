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
            if std::env::var("NO").is_err() {
                recorder.log(view).unwrap();
            }
            logging += start.elapsed();
        });
    }
    let end = Instant::now();
    let cpu = || {
        let stat = std::fs::read_to_string("/proc/self/stat").unwrap();
        let fields: Vec<&str> = stat.split(' ').collect();
        (fields[13].parse::<f64>().unwrap() + fields[14].parse::<f64>().unwrap()) / 100.0
    };
    println!("cpu {} s", cpu());
    run.with_view(|view| recorder.finish(view)).unwrap();
    println!("{ticks} ticks in {:?}, logging {logging:?}, finish {:?}", start.elapsed(), end.elapsed());
    println!("{} MB", std::fs::metadata(&file).unwrap().len() as f64 / 1e6);
}
