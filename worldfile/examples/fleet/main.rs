//! The speed of the simulator with many robots.
//!
//! ```text
//! cargo run --release -p curious-worldfile --example fleet -- --robots 10 --seconds 60
//! ```
//!
//! Four rooms of 12 × 12 m (`--tiles 4`: 4 × 4 of these), walls of 0.05 m. Robot 1 drives in a circle, the others
//! wander; each has a radius of 0.15 m and a laser with 360 beams (`--rays`) over 360°, with a range of 10 m, at 10
//! Hz. The physics runs at 20 Hz, as in the shipped worlds. With `--sonars`, every robot has a ring of sonars at 10 Hz
//! instead and drives by them: its laser is never read. With `--corners`, its footprint is a polygon. See
//! docs/performance.md.

mod place;
mod sonars;
mod usage;

use clap::Parser;
use place::Wish;
use sim::physics::{Controller, Fleet};
use sonars::BySonars;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// The speed of the simulator with many robots.
#[derive(Parser)]
struct Args {
    /// The number of robots
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=100_000), allow_negative_numbers = true)]
    robots: u32,
    /// The simulated time, s
    #[arg(long, default_value_t = 60.0, value_parser = seconds, allow_negative_numbers = true)]
    seconds: f64,
    /// The number of beams of each laser
    #[arg(long, default_value_t = 360, value_parser = clap::value_parser!(u32).range(2..=10_000), allow_negative_numbers = true)]
    rays: u32,
    /// The number of sonars of each robot, which then drives by them; 0: by the laser
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=64), allow_negative_numbers = true)]
    sonars: u32,
    /// The number of corners of each robot; 0: round
    #[arg(long, default_value_t = 0, value_parser = corners, allow_negative_numbers = true)]
    corners: u32,
    /// The number of houses along each side
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=16), allow_negative_numbers = true)]
    tiles: u32,
    /// The seed of all random streams
    #[arg(long, default_value_t = 0, allow_negative_numbers = true)]
    seed: u64,
    /// The number of threads that simulate lasers
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=256), allow_negative_numbers = true)]
    threads: u32,
    /// Print one line of JSON
    #[arg(long)]
    json: bool,
}

/// A simulated time, s.
fn seconds(text: &str) -> Result<f64, String> {
    let time_s = text.parse::<f64>().ok().filter(|time_s| *time_s > 0.0 && time_s.is_finite());
    time_s.ok_or_else(|| "must be a time above 0, s".to_owned())
}

/// A number of corners.
fn corners(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(corners @ (0 | 3..=64)) => Ok(corners),
        _ => Err("a robot has 3 to 64 corners, or 0 if it is round".to_owned()),
    }
}

/// Progress is reported if a run takes longer than this.
const SILENCE: Duration = Duration::from_secs(2);

fn main() -> ExitCode {
    let args = Args::parse();
    let wish = Wish {
        robots: args.robots as usize,
        rays: args.rays as usize,
        sonars: args.sonars,
        corners: args.corners,
        tiles: args.tiles as usize,
        seed: args.seed,
    };
    if let Err(error) = place::has_room(&wish) {
        eprintln!("{error}");
        return ExitCode::from(2);
    }
    // Each robot is compared with each other robot: this takes a while.
    if args.robots > 10_000 {
        eprintln!("placing {} robots", args.robots);
    }
    let spec = match place::place(&wish) {
        Ok(spec) => spec,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::from(2);
        }
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(args.threads as usize).build();
    let pool = match pool {
        Ok(pool) => pool,
        Err(error) => {
            eprintln!("cannot start {} threads: {error}", args.threads);
            return ExitCode::FAILURE;
        }
    };

    let start = Instant::now();
    let mut fleet = Fleet::new(&spec, args.seed);
    fleet.set_parallel_lasers(args.threads > 1);
    let load_s = start.elapsed().as_secs_f64();
    let cpu_before_s = usage::cpu_s();
    let start = Instant::now();
    pool.install(|| match args.sonars {
        0 => run(&mut fleet, args.seconds, &mut ()),
        _ => run(&mut fleet, args.seconds, &mut BySonars),
    });
    let wall_s = start.elapsed().as_secs_f64();
    let cpu_s = usage::cpu_s().zip(cpu_before_s).map_or(f64::NAN, |(after, before)| after - before);

    // A scan every 0.1 s from time 0 on, the last before the end.
    let scans = (fleet.time_s() / 0.1 - 1e-6).ceil() * f64::from(args.robots);
    let readings = if args.sonars > 0 { args.sonars } else { args.rays };
    let rays_per_s = scans * f64::from(readings) / wall_s;
    let figures = [
        ("robots", f64::from(args.robots), 0),
        ("simulated_s", fleet.time_s(), 1),
        ("wall_s", wall_s, 4),
        ("real_time_factor", fleet.time_s() / wall_s, 2),
        ("rays_per_s", rays_per_s, 0),
        ("peak_mib", usage::peak_mib().unwrap_or(f64::NAN), 1),
        ("load_s", load_s, 4),
        ("cpu_s", cpu_s, 4),
    ];
    print(&figures, args.json);
    ExitCode::SUCCESS
}

/// Prints figures, each with a name and a number of decimals.
fn print(figures: &[(&str, f64, usize)], as_json: bool) {
    if as_json {
        // JSON has no NaN.
        let value = |value: f64, digits: usize| {
            if value.is_finite() { format!("{value:.digits$}") } else { "null".to_owned() }
        };
        let pairs =
            figures.iter().map(|(name, figure, digits)| format!("\"{name}\": {}", value(*figure, *digits)));
        println!("{{{}}}", pairs.collect::<Vec<_>>().join(", "));
    } else {
        for (name, figure, digits) in figures {
            println!("{name:>16}  {figure:.digits$}");
        }
    }
}

/// Simulates the robots for some seconds.
fn run(fleet: &mut Fleet, seconds: f64, controller: &mut impl Controller) {
    let mut printed = Instant::now();
    // As many steps as `run_until` the end would take.
    while fleet.time_s() < seconds - 5e-7 {
        fleet.step(controller);
        if printed.elapsed() > SILENCE {
            eprintln!("{:.2} of {seconds} s", fleet.time_s());
            printed = Instant::now();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn every_flag_refuses_a_wrong_value_by_its_name() {
        for argument in
            Args::command().get_arguments().filter(|argument| argument.get_action().takes_values())
        {
            let Some(flag) = argument.get_long() else { continue };
            let Err(error) = Args::try_parse_from(["fleet", &format!("--{flag}"), "-1"]) else {
                panic!("--{flag}")
            };
            assert!(error.exit_code() == 2 && error.to_string().contains(&format!("--{flag} ")), "{error}");
        }
    }
}
