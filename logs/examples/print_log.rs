//! What a log contains, and its readings as lines of text.
//!
//! ```text
//! cargo run -p curious-logs --example print_log -- LOG [readings]
//! ```
//!
//! With `readings`, a line per reading: time, pose and mount (x, y, heading), linear and angular velocity,
//! first angle, angle between beams, duration, the number of velocities, and the ranges. All figures are such that they can
//! be read back without loss.

use interfaces::{LaserReading, heading_rad};
use logs::{Log, LogError, TopicChoice};
use std::io::{BufWriter, Write};
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some(path) = arguments.first() else {
        return Err("usage: print_log LOG [readings]".into());
    };
    if let Err(error) = print(Path::new(path), arguments.len() > 1) {
        eprintln!("error: {error}");
        std::process::exit(2);
    }
    Ok(())
}

fn print(path: &Path, with_readings: bool) -> Result<(), LogError> {
    let log = Log::open(path, &TopicChoice::default())?;
    let mut out = BufWriter::new(std::io::stdout());
    let io = |why| LogError::Io { file: "standard output".to_owned(), why };
    if !with_readings {
        return writeln!(out, "{:#?}", log.summary()).map_err(io);
    }
    for reading in log.readings()? {
        print_reading(&mut out, &reading?).map_err(io)?;
    }
    out.flush().map_err(io)
}

fn print_reading(out: &mut impl Write, reading: &LaserReading) -> std::io::Result<()> {
    let LaserReading { time_s, pose, twist, velocities, mount, scan } = reading;
    write!(out, "{time_s}")?;
    for pose in [pose, mount] {
        write!(out, " {} {} {}", pose.translation.x, pose.translation.y, heading_rad(pose))?;
    }
    write!(out, " {} {}", twist.linear_mps, twist.angular_radps)?;
    write!(out, " {} {} {}", scan.angle_min_rad, scan.angle_increment_rad, scan.sweep_s)?;
    write!(out, " {}", velocities.len())?;
    for range_m in &scan.ranges_m {
        write!(out, " {range_m}")?;
    }
    writeln!(out)
}
