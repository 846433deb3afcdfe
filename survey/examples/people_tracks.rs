//! Changes against people whose tracks were marked by hand, for a laser that stands: how many of the events lie where a
//! person walked, and whether the rates agree with counts by hand.
//!
//! TRACKS.csv has a line per marked point, `person,time_s,x_m,y_m`, in the frame of the laser, with times since the first
//! scan; between the points of a person the track is straight. Without COUNTS.csv, 20 cells are printed: those that the
//! tracks cross most often, at least 0.6 m apart. COUNTS.csv has a line per cell, `x_m,y_m,intervals`: how often the cell was
//! occupied, counted by hand from the raw scans.
//!
//! ```text
//! cargo run -p curious-survey --example people_tracks -- LOG TRACKS.csv [COUNTS.csv]
//! ```

use interfaces::PoseMode;
use logs::{Log, TopicChoice};
use mapper::Mapper;
use nalgebra::Point2;
use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use survey::{LogEntry, Survey, SurveySettings};

/// An event belongs to a person at most this far away, m.
const NEAR_M: f64 = 0.3;
/// A foot stands before the body comes and after it has gone, and the map notices some scans later: the time between an
/// event and a person at its place, s.
const AROUND_S: f64 = 1.0;
/// A track crosses a cell when it comes nearer than this, m, and has left it beyond twice the distance.
const CROSSED_M: f64 = 0.15;
const CELLS: usize = 20;
const APART_M: f64 = 0.6;
const MASS: f64 = 0.9;
/// The time between two positions of a track, s.
const STEP_S: f64 = 0.05;

type Track = Vec<(f64, Point2<f64>)>;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, tracks, counts @ ..] = &arguments[..] else {
        return Err("usage: people_tracks LOG TRACKS.csv [COUNTS.csv]".into());
    };
    let mut people: BTreeMap<u32, Track> = BTreeMap::new();
    for row in rows::<4>(tracks)? {
        people.entry(row[0] as u32).or_default().push((row[1], Point2::new(row[2], row[3])));
    }
    let tracks: Vec<Track> = people.into_values().collect();

    let log = Log::open(Path::new(file), &TopicChoice::default())?;
    let entry = LogEntry::of(file.clone(), &log, &TopicChoice::default())?;
    let mut survey = Survey::new(SurveySettings::of(PoseMode::Exact), true);
    survey.first_pass(&log, entry, false, |_| ControlFlow::Continue(()))?;
    let mut replay = survey.replay(0, &log)?.ok_or("the log has no reading")?;
    let mut events: Vec<(f64, Point2<f64>)> = Vec::new();
    while survey.turn(&mut replay)?.is_some() {
        let mapper = survey.mapper().ok_or("the log has no reading")?;
        let changed = mapper.transitions().iter().filter(|change| change.event().is_some());
        events.extend(changed.map(|change| (mapper.time(), mapper.frame().center(change.cell))));
    }
    let mapper = survey.mapper().ok_or("the log has no reading")?;

    let share = |around_s: f64| {
        let near = |(time_s, at): &&(f64, Point2<f64>)| {
            let steps = (around_s / STEP_S).round() as i32;
            let mut times_s = (-steps..=steps).map(|step| time_s + f64::from(step) * STEP_S);
            times_s.any(|time_s| {
                tracks.iter().filter_map(|track| position(track, time_s)).any(|of| (of - at).norm() <= NEAR_M)
            })
        };
        100.0 * events.iter().filter(near).count() as f64 / events.len().max(1) as f64
    };
    println!("noise {:.3} m", survey.settings_of(0).mapper.steady.range_noise_std_m);
    println!("{} events of cells; within {NEAR_M} m of a track:", events.len());
    println!("  where it is at this time {:.1} %", share(0.0));
    println!("  where it is within {AROUND_S} s of this time {:.1} %", share(AROUND_S));
    let trodden = |at: &Point2<f64>| along(&tracks).any(|of| (of - at).norm() <= NEAR_M);
    let ever = events.iter().filter(|(_, at)| trodden(at)).count() as f64 / events.len().max(1) as f64;
    let centers =
        || (0..mapper.frame().len()).map(|index| (index, mapper.frame().center(mapper.frame().cell(index))));
    let seen: Vec<Point2<f64>> =
        centers().filter(|(index, _)| mapper.was_ever_seen(*index)).map(|(_, at)| at).collect();
    let walked = seen.iter().filter(|at| trodden(at)).count() as f64 / seen.len().max(1) as f64;
    println!("  at any time {:.1} %; of the cells seen, {:.1} % are there", 100.0 * ever, 100.0 * walked);

    match counts {
        [] => most_crossed(mapper, &tracks),
        [counts, ..] => compare(mapper, log.summary().duration_s, &rows::<3>(counts)?)?,
    }
    Ok(())
}

/// The numbers of a CSV file, without its first line.
fn rows<const N: usize>(file: &str) -> Result<Vec<[f64; N]>, Box<dyn Error>> {
    let text = fs::read_to_string(file).map_err(|why| format!("{file}: {why}"))?;
    let row = |(number, line): (usize, &str)| {
        let values: Result<Vec<f64>, _> = line.split(',').map(|value| value.trim().parse()).collect();
        let values = values.ok().and_then(|values| <[f64; N]>::try_from(values).ok());
        values.ok_or_else(|| format!("{file}:{}: not {N} numbers", number + 1).into())
    };
    text.lines().enumerate().skip(1).filter(|(_, line)| !line.trim().is_empty()).map(row).collect()
}

/// Where a person is at a time; `None` before and after the track.
fn position(track: &Track, time_s: f64) -> Option<Point2<f64>> {
    let next = track.partition_point(|(at_s, _)| *at_s < time_s);
    let (after_s, after) = track.get(next)?;
    let Some((before_s, before)) = next.checked_sub(1).map(|index| track[index]) else {
        return (*after_s == time_s).then_some(*after);
    };
    let share = (time_s - before_s) / (after_s - before_s).max(1e-9);
    Some(before + (after - before) * share)
}

/// The positions of all people.
fn along(tracks: &[Track]) -> impl Iterator<Item = Point2<f64>> {
    tracks.iter().flat_map(positions)
}

fn positions(track: &Track) -> impl Iterator<Item = Point2<f64>> {
    let (begin_s, end_s) = (track[0].0, track[track.len() - 1].0);
    let steps = ((end_s - begin_s) / STEP_S) as usize;
    (0..=steps).filter_map(move |step| position(track, begin_s + step as f64 * STEP_S))
}

/// Prints the cells that the tracks cross most often; of equal ones, the nearer to the laser first.
fn most_crossed(mapper: &Mapper, tracks: &[Track]) {
    let frame = mapper.frame();
    let crossings = |at: &Point2<f64>| {
        let (mut count, mut is_near) = (0, false);
        for track in tracks {
            for of in positions(track) {
                let distance_m = (of - at).norm();
                count += usize::from(!is_near && distance_m < CROSSED_M);
                is_near = distance_m < CROSSED_M || is_near && distance_m < 2.0 * CROSSED_M;
            }
            is_near = false;
        }
        count
    };
    let cells = (0..frame.len()).filter(|index| mapper.was_ever_seen(*index));
    let mut cells: Vec<(usize, Point2<f64>)> = cells
        .map(|index| frame.center(frame.cell(index)))
        .map(|at| (crossings(&at), at))
        .filter(|(count, _)| *count > 0)
        .collect();
    cells.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.coords.norm().total_cmp(&b.1.coords.norm())));
    let mut chosen: Vec<(usize, Point2<f64>)> = Vec::new();
    for (count, at) in cells {
        if chosen.len() < CELLS && chosen.iter().all(|(_, other)| (other - at).norm() >= APART_M) {
            chosen.push((count, at));
        }
    }
    println!("x_m,y_m,crossings");
    chosen.iter().for_each(|(count, at)| println!("{:.3},{:.3},{count}", at.x, at.y));
}

/// Compares the rates of cells with counts by hand.
fn compare(mapper: &Mapper, duration_s: f64, counts: &[[f64; 3]]) -> Result<(), Box<dyn Error>> {
    let mut inside = 0;
    println!(
        "cell (m): intervals by hand, by the map; cycles per minute by hand, by the map with its 90 % interval"
    );
    for [x_m, y_m, intervals] in counts {
        let index = mapper.frame().index(mapper.frame().cell_at(&Point2::new(*x_m, *y_m)));
        let index = index.ok_or_else(|| format!("({x_m}, {y_m}) is not in the map"))?;
        let [by_hand, rate] = [intervals / duration_s, mapper.rate(index)].map(|rate| 60.0 * rate);
        let (low, high) = mapper.credible_interval(index, MASS);
        let (low, high) = (60.0 * low, 60.0 * high);
        let is_inside = (low..=high).contains(&by_hand);
        inside += usize::from(is_inside);
        let seen = mapper.statistics(index);
        println!(
            "({x_m:6.3}, {y_m:6.3}): {intervals:2}, {:2}; {by_hand:5.2}, {rate:5.2} ({low:.2} to {high:.2}){}",
            seen.events().div_ceil(2),
            if is_inside { "" } else { "  outside" }
        );
    }
    println!("{inside} of {} within the interval", counts.len());
    Ok(())
}
