//! What is known of one place, in sentences and as data.

use crate::moment;
use curious::week::usual_hours;
use curious::words::length_of;
use interfaces::CellState;
use mapper::{UsualChange, UsualSlot, Week};
use nalgebra::Point2;
use results::numbers::percent;
use serde::Serialize;
use survey::Forecast;

/// A place is where something changes at most this far from a point, m.
const NEAR_M: f64 = 0.5;

/// A place: the tile of half a meter at, or beside, a point.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Place {
    pub(crate) x_m: f64,
    pub(crate) y_m: f64,
    /// The probability that something is there, by time; `None` if the place was never seen.
    pub(crate) blocked: Vec<(f64, Option<f64>)>,
    /// The days and the half hours with a look at the place while it was known to change.
    pub(crate) days: u32,
    pub(crate) half_hours: f64,
    /// For how long a look says more than the usual hours, s; `None` if this is longer than four weeks.
    pub(crate) expiry_s: Option<f64>,
    /// What is usual at these times; empty unless usual hours are known.
    pub(crate) usual: Vec<UsualSlot>,
    /// The times of the week at which it usually becomes blocked or free.
    pub(crate) usual_changes: Vec<UsualChange>,
    /// The same in sentences.
    pub(crate) text: Vec<String>,
}

impl Place {
    /// The place at a point, at times in seconds. `None` outside of the map.
    pub(crate) fn new(forecast: &Forecast, at: Point2<f64>, times_s: &[f64]) -> Option<Self> {
        let mapper = forecast.mapper();
        let frame = mapper.frame();
        let own = frame.index(frame.cell_at(&at))?;
        // The place that changes is perhaps beside the point.
        let far_m = |index: &usize| (frame.center(frame.cell(*index)) - at).norm();
        let near = mapper.changed().filter(|index| far_m(index) <= NEAR_M);
        let index = near.min_by(|a, b| far_m(a).total_cmp(&far_m(b))).unwrap_or(own);
        let cell = frame.cell(index);
        let tile = mapper.tile(index).filter(|tile| tile.last().is_some());
        let probability = |time_s: f64| match tile {
            Some(tile) => Some(tile.clock().probability(time_s, mapper.calendar())),
            None => forecast.blocked(cell, time_s),
        };
        let week = tile.and_then(|tile| tile.clock().week(mapper.calendar()));
        let usual = |week: &Week| {
            let slot = |time_s: &f64| usual_at(week, forecast, *time_s);
            times_s.iter().filter_map(slot).collect()
        };
        let mut place = Self {
            x_m: at.x,
            y_m: at.y,
            blocked: times_s.iter().map(|time_s| (*time_s, probability(*time_s))).collect(),
            days: tile.map_or(0, |tile| tile.clock().days()),
            half_hours: tile.map_or(0.0, |tile| tile.clock().half_hours()),
            expiry_s: tile.and_then(|tile| tile.clock().expiry_s(mapper.calendar())),
            usual: week.as_ref().map(usual).unwrap_or_default(),
            usual_changes: week.as_ref().map(Week::usual_changes).unwrap_or_default(),
            text: Vec::new(),
        };
        let state = mapper.states().cells()[index];
        place.text = match tile {
            _ if state == CellState::Unknown && tile.is_none() => vec!["It was never seen.".to_owned()],
            None if mapper.map_changes(index) > 0 => place
                .predictions(forecast)
                .chain(["Of this cell alone: its place has no clock yet.".to_owned()])
                .collect(),
            None => {
                let state = if state == CellState::Blocked { "blocked" } else { "free" };
                vec![format!("Nothing ever changed within half a meter: it was always {state}.")]
            }
            Some(_) => place.sentences(forecast, week.as_ref()),
        };
        Some(place)
    }

    /// What is predicted, a sentence for each time.
    fn predictions(&self, forecast: &Forecast) -> impl Iterator<Item = String> {
        self.blocked.iter().enumerate().map(|(number, (time_s, probability))| {
            let probability = percent(probability.unwrap_or(0.5));
            let when = moment::text(*time_s, forecast);
            let usual = self.usual.get(number).map(|slot| {
                let [low, high] = slot.interval_90.map(percent);
                format!(
                    "; usual then: {} ({low} to {high}, seen on {} such days)",
                    percent(slot.probability),
                    slot.days
                )
            });
            format!("{when}: blocked with a probability of {probability}{}", usual.unwrap_or_default())
        })
    }

    fn sentences(&self, forecast: &Forecast, week: Option<&Week>) -> Vec<String> {
        let mut lines: Vec<String> = self.predictions(forecast).collect();
        lines.push(format!("Seen in {:.0} half hours, on {} days.", self.half_hours, self.days));
        lines.push(match self.expiry_s {
            Some(expiry_s) => {
                format!("A look counts for {}; after that the usual hours say more.", length_of(expiry_s))
            }
            None => "A look says more than the usual hours for four weeks and longer.".to_owned(),
        });
        match week {
            None if forecast.why_undated().is_some() => {
                lines.push(format!("Usual hours: none, as {}.", forecast.why_undated().unwrap_or_default()));
            }
            None => {
                lines.push(format!("Usual hours: not known yet; they need looks on {} days.", Week::MIN_DAYS))
            }
            Some(week) => lines.push(format!("Usually {}.", usual_hours(week, "blocked"))),
        }
        lines
    }
}

/// The half hour of the week at a time.
fn usual_at(week: &Week, forecast: &Forecast, time_s: f64) -> Option<UsualSlot> {
    let hour = forecast.mapper().calendar().hour_of_week(time_s)?;
    week.slots().get((hour * week.slots().len() as f64 / 168.0) as usize).copied()
}
