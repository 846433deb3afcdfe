//! A place as it will be: what is blocked at a time, from a state file.

mod asked;
mod crossing;
mod moment;
mod place;
mod route;

use anyhow::{Context, anyhow, bail};
use asked::Asked;
use clap::Parser;
use cli::flags::{folder, input_file, number, value_of};
use cli::program::{Failure, arguments, input, results_folder, start, state_failure};
use cli::terminal::print;
use crossing::{Crossing, Line};
use draw::layers::Layer;
use draw::pictures::{NamedLine, draw_values};
use files::write_file;
use interfaces::Grid;
use mapper::Door;
use owner::words::length_of;
use place::Place;
use results::numbers::percent;
use results::{raster, ros_map};
use robot::BUILD;
use robot::state::read_state;
use route::{Stop, graph, route};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use survey::{Forecast, MASKS, Travel};

/// The graph of `--graph` with its probabilities.
const GRAPH: &str = "graph.geojson";
/// The version of the layout of `summary.json`; count up when a key is renamed, removed or changes its meaning.
const SCHEMA: u32 = 2;

/// What the program does, in paragraphs that the terminal breaks.
const ABOUT: &str = "Predicts a place from what was learned about it: is that door open at ten past five?

Prints when the doors are usually open, how often they open, and the probability that they are open at the times of --at; for \
a place (--place), the probability that its square of half a meter is blocked. A 90 % interval follows each probability; it needs observations on 14 days.

STATE is a file of `map_log --state`, or of four_rooms in a world with a calendar, whose first week begins on Monday, 2024-01-01, \
in UTC. (Other states of four_rooms, and those of curious_node, have no hours.) A time is
  +10m                after the last reading of the state: s, m or h
  17:10, \"Tue 17:10\"  the next such time after the last reading, in the time zone of the state
  2024-01-30T17:10    a date in this zone; with Z or an offset as +01:00 in that one

For each time of --at, the folder predict_out has the map of the probability that a cell is blocked, as a picture with the doors \
(predicted.png), for the map server of Nav2 (predicted.yaml, in the mode `scale`: 100 is certainly blocked) and as an array for NumPy \
(predicted.npy, rows from the lowest y on, NaN where never seen); and masks for the filters of Nav2: keepout_mask.yaml (100 where a \
door, an object that comes and goes or a group of cells that change is probably blocked then) and speed_mask.yaml (slower where changes are usual at that hour). With several times, the \
files are numbered. Also in the folder: for how long a look at a place counts before its usual hours say more (expiry.png, expiry.npy, \
in hours), and all that is printed, as data (summary.json).

In front of what comes and goes on a route, the robot waits or goes round: the advice follows from how long such things stay. (nav2_route \
only adds costs; it does not wait.)

Hours and weekdays are learned per door and per square of half a meter, and have more weight the longer they were observed.";

/// The command line.
#[derive(Clone, Debug, Parser)]
#[command(
    name = "predict",
    version,
    max_term_width = 100,
    about = ABOUT.split_once('\n').map(|(first, _)| first),
    long_about = ABOUT,
    after_help = "Examples:\n  \
        predict office.state                                         all doors: their hours, and now\n  \
        predict office.state --at \"Tue 17:10\"                        the doors, map and masks on Tuesday at ten past five\n  \
        predict office.state --at +10m --at +1h                      two maps\n  \
        predict office.state --at 17:10 --place 3                    place 3 of the report of map_log\n  \
        predict office.state --at 17:10 --place \"kitchen door\"       the place with this name\n  \
        predict office.state --at 17:10 --place 3.2,-1.5             a point of the map, or the door there\n  \
        predict office.state --at 17:10 --route way.csv              a route, at the times of arrival\n  \
        predict office.state --at 17:10 --graph g.geojson --from 0   a graph of nav2_route with P(open)\n\n\
        Exit codes: 0 success, 1 a file cannot be written, 2 invalid arguments or input."
)]
struct Args {
    /// The state file
    #[arg(value_name = "STATE", value_parser = input_file())]
    state: PathBuf,

    /// A time; several are possible [default: that of the last reading]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    at: Vec<String>,

    /// A place: its number or its name in the report of map_log, or a point of the map, m; several are possible
    #[arg(long, value_name = "NUMBER|NAME|X,Y", value_parser = Asked::parse, allow_hyphen_values = true)]
    place: Vec<Asked>,

    /// A door by its number in things.json; several are possible [default: all doors, without --place, --route and --graph]
    #[arg(long, value_name = "NUMBER")]
    door: Vec<u32>,

    /// A route: lines of `x y` (m) or `time x y` (s, m; as a TUM trajectory). Departure is at the first time of --at. Says in front of
    /// what to wait, for how long at most, and how much longer the way round takes
    #[arg(long, value_name = "FILE", value_parser = input_file())]
    route: Option<PathBuf>,

    /// A graph of routes (GeoJSON of nav2_route): written to graph.geojson in the folder, with open_probability in the metadata
    /// of each edge, and with the expected time of waiting or going round in its cost
    #[arg(long, value_name = "FILE", value_parser = input_file())]
    graph: Option<PathBuf>,

    /// The node of the graph at which the robot departs [default: every edge is met at the first time of --at]
    #[arg(long, value_name = "NODE", requires = "graph")]
    from: Option<u64>,

    /// The speed on routes, m/s
    #[arg(long, value_name = "M/S", default_value_t = 0.5, value_parser = number(0.01..=100.0))]
    speed: f64,

    /// The radius of the robot on routes, m
    #[arg(long, value_name = "METERS", default_value_t = 0.2, value_parser = number(0.0..=5.0))]
    radius: f64,

    /// The folder for all results
    #[arg(long, value_name = "DIR", default_value = "predict_out", value_parser = folder())]
    out: PathBuf,
}

/// The content of `summary.json`.
#[derive(Serialize)]
struct Summary {
    schema: u32,
    build: &'static str,
    arguments: Vec<String>,
    /// Why there are no hours and dates; `null` if there are.
    undated: Option<String>,
    /// The time of the last reading, s, since 1970-01-01 UTC if there are dates.
    last_reading_s: f64,
    /// The times that were asked for, and in words.
    times_s: Vec<f64>,
    times: Vec<String>,
    places: Vec<Place>,
    route: Vec<Stop>,
    /// What the route meets that comes and goes, and what to do in front of it.
    crossings: Vec<Crossing>,
    /// The names of the other files with results, in the same folder.
    files: Vec<String>,
}

fn main() -> ExitCode {
    start(run)
}

fn run(args: &Args) -> Result<ExitCode, Failure> {
    let state = read_state(&args.state).map_err(|why| state_failure(&args.state, why))?;
    let forecast = Forecast::of_state(&state).map_err(|why| state_failure(&args.state, why))?;
    let time = |text: &String| {
        moment::parse(text, &forecast).map_err(|why| input(value_of("--at", anyhow!("`{text}`: {why}"))))
    };
    let mut times_s = args.at.iter().map(time).collect::<Result<Vec<f64>, Failure>>()?;
    if times_s.is_empty() {
        times_s.push(forecast.now_s());
    }
    let travel = Travel { departure_s: times_s[0], speed_m_s: args.speed, radius_m: args.radius };
    let place = |asked: &Asked| asked.find(&forecast, &times_s);
    let mut places = args.place.iter().map(place).collect::<anyhow::Result<Vec<_>>>().map_err(input)?;
    places.extend(doors(args, &forecast, &times_s).map_err(input)?);
    let stops =
        args.route.iter().map(|path| route(path, &forecast, travel)).collect::<anyhow::Result<Vec<_>>>();
    let graph = args.graph.as_ref().map(|path| graph(path, &forecast, travel, args.from));
    let (route, met) = stops.map_err(input)?.pop().unwrap_or_default();
    let graph = graph.transpose().map_err(input)?;
    let line = Line { forecast: &forecast, travel, points: &route };
    let crossings = met.iter().map(|stop| line.crossing(stop)).collect();
    let folder = results_folder(&args.out)?;
    for (number, time_s) in times_s.iter().enumerate() {
        let suffix = if times_s.len() == 1 { String::new() } else { format!("_{}", number + 1) };
        write_time(folder.unfinished(), &suffix, &forecast, *time_s)?;
    }
    let expiry_h = forecast.outlook().expiry(f64::NAN).map(|expiry_s| expiry_s / 3600.0);
    let title = "Hours for which a look counts";
    write_map(folder.unfinished(), "expiry", (Layer::Expiry, title), &forecast, &expiry_h, &[])?;
    if let Some(graph) = graph {
        write_file(&folder.unfinished().join(GRAPH), |file| writeln!(file, "{graph:#}"))?;
    }
    let summary = Summary {
        schema: SCHEMA,
        build: BUILD,
        arguments: arguments(),
        undated: forecast.why_undated().map(str::to_owned),
        last_reading_s: forecast.now_s(),
        times: times_s.iter().map(|time_s| moment::text(*time_s, &forecast)).collect(),
        times_s,
        places,
        route,
        crossings,
        files: folder.results()?,
    };
    let text = serde_json::to_string_pretty(&summary).context("summary.json")?;
    write_file(&folder.unfinished().join("summary.json"), |file| writeln!(file, "{text}"))?;
    let inputs = [Some(&args.state), args.route.as_ref(), args.graph.as_ref()];
    folder.finish(&inputs.into_iter().flatten().map(PathBuf::as_path).collect::<Vec<_>>())?;
    say(&summary, &forecast)?;
    print(format_args!("files: {}", args.out.display()))?;
    Ok(ExitCode::SUCCESS)
}

/// The doors that are asked for; all of them if nothing is.
fn doors(args: &Args, forecast: &Forecast, times_s: &[f64]) -> anyhow::Result<Vec<Place>> {
    let known = forecast.mapper().doors();
    if let Some(id) = args.door.iter().find(|id| known.iter().all(|door| door.id != **id)) {
        let named = |door: &Door| {
            let at = nalgebra::center(&door.closed.ends[0], &door.closed.ends[1]);
            format!("{} at {:.1},{:.1}", door.id, at.x, at.y)
        };
        let doors: Vec<String> = known.iter().map(named).collect();
        bail!(
            "--door {id}: there is no such door; known {}. (The numbers in the report of map_log are those of places: --place)",
            if doors.is_empty() { "is none".to_owned() } else { format!("are {}", doors.join("; ")) }
        );
    }
    let is_all =
        args.door.is_empty() && args.place.is_empty() && args.route.is_none() && args.graph.is_none();
    let asked = known.iter().filter(|door| is_all || args.door.contains(&door.id));
    Ok(asked.map(|door| Place::of_door(forecast, door, times_s)).collect())
}

/// Writes the map and the masks at a time.
fn write_time(folder: &Path, suffix: &str, forecast: &Forecast, time_s: f64) -> Result<(), Failure> {
    let (name, map) = (format!("predicted{suffix}"), forecast.map(time_s));
    let title = format!("P(blocked), {}", moment::text(time_s, forecast));
    write_map(folder, &name, (Layer::PREDICTED[0], &title), forecast, &map, &place::door_lines(forecast))?;
    let percents = map.map(|value| if value.is_nan() { 0 } else { (100.0 * value).round() as u8 });
    ros_map::write_mask(folder, &name, &percents)?;
    for (name, mask) in MASKS.iter().zip(forecast.masks(time_s)) {
        ros_map::write_mask(folder, &format!("{name}{suffix}"), &mask)?;
    }
    Ok(())
}

/// Writes a picture and an array.
fn write_map(
    folder: &Path,
    name: &str,
    (layer, title): (Layer, &str),
    forecast: &Forecast,
    values: &Grid<f64>,
    doors: &[NamedLine],
) -> Result<(), Failure> {
    let picture = folder.join(format!("{name}.png"));
    draw_values(&picture, (layer, title), forecast.mapper(), values, doors).context("cannot draw the map")?;
    raster::write_values(&folder.join(format!("{name}.npy")), values)?;
    Ok(())
}

fn say(summary: &Summary, forecast: &Forecast) -> anyhow::Result<()> {
    let last = moment::text(summary.last_reading_s, forecast);
    match &summary.undated {
        None => print(format_args!("last reading: {last}"))?,
        Some(why) => print(format_args!("no hours and no dates: {why}"))?,
    }
    for place in &summary.places {
        print(format_args!("{}", place.title))?;
        place.text.iter().try_for_each(|line| print(format_args!("  {line}")))?;
    }
    let is_graph = summary.files.iter().any(|file| file == GRAPH);
    if summary.places.is_empty() && summary.route.is_empty() && !is_graph {
        print(format_args!("no door is known; --place NUMBER asks for a place of the report of map_log"))?;
    }
    let begin_s = summary.times_s[0];
    for Stop { x_m, y_m, time_s, blocked, .. } in &summary.route {
        let blocked =
            blocked.map_or("never seen".to_owned(), |blocked| format!("blocked: {}", percent(blocked)));
        print(format_args!("({x_m:.2}, {y_m:.2}) m after {}: {blocked}", length_of(time_s - begin_s)))?;
    }
    for Crossing { title, time_s, blocked, advice, .. } in &summary.crossings {
        let (after, blocked) = (length_of(time_s - begin_s), percent(*blocked));
        print(format_args!("{title}, after {after}: blocked: {blocked}: {}", advice.text))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_sound() {
        Args::command().debug_assert();
    }
}
