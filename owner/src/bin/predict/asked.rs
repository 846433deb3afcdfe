//! `--place`: a place as a person names it.

use crate::place::Place;
use anyhow::{Context, bail};
use nalgebra::Point2;
use survey::Forecast;

/// A place that is asked for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Asked {
    /// A point of the map, m.
    Point(Point2<f64>),
    /// The number of a place in the report of `map_log`.
    Number(u32),
    /// The name of a place, as it was given to `map_log`.
    Name(String),
}

impl Asked {
    /// Two numbers are a point, one is the number of a place, and other text is a name.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.trim().parse().ok().filter(|number: &f64| number.is_finite());
        let point = text.split_once(',').and_then(|(x, y)| Some(Point2::new(number(x)?, number(y)?)));
        match (point, text.trim().parse()) {
            (Some(point), _) => Ok(Self::Point(point)),
            (None, Ok(number)) => Ok(Self::Number(number)),
            (None, Err(_)) if text.chars().any(char::is_alphabetic) && number(text).is_none() => {
                Ok(Self::Name(text.trim().to_owned()))
            }
            _ => Err(FORMS.to_owned()),
        }
    }

    /// What is known of this place, at times in seconds.
    pub(crate) fn find(&self, forecast: &Forecast, times_s: &[f64]) -> anyhow::Result<Place> {
        let is_asked = |place: &&survey::Place| match self {
            Self::Point(_) => false,
            Self::Number(number) => place.number == *number,
            Self::Name(name) => place.name.as_ref() == Some(name),
        };
        let shown = match self {
            Self::Point(at) => {
                let outside =
                    || format!("--place {},{}: it is outside of the map, {}", at.x, at.y, extent(forecast));
                return Place::new(forecast, *at, times_s).with_context(outside);
            }
            Self::Number(number) => number.to_string(),
            Self::Name(name) => format!("\"{name}\""),
        };
        let reported = forecast.places();
        match reported.iter().find(is_asked) {
            Some(place) => Place::of_report(forecast, place, times_s).context("the place has no cells"),
            None if reported.is_empty() => {
                bail!(
                    "--place {shown}: the state has no places with numbers or names; give a point, as --place 3.2,-1.5"
                )
            }
            None => {
                let mut known: Vec<_> = reported.iter().map(|place| (place.number, &place.name)).collect();
                known.sort_unstable();
                let named = |(number, name): (u32, &Option<String>)| match name {
                    Some(name) => format!("{number} ({name})"),
                    None => number.to_string(),
                };
                let known: Vec<String> = known.into_iter().map(named).collect();
                bail!("--place {shown}: there is no such place; known are {}", known.join(", "))
            }
        }
    }
}

/// What a place can be given as.
const FORMS: &str = "must be the number of a place, its name, or two coordinates, as 3.2,-1.5";

/// The extent of the map in words.
fn extent(forecast: &Forecast) -> String {
    let frame = forecast.mapper().frame();
    let (from, cell_m) = (frame.origin(), frame.resolution_m());
    let to = [from.x + frame.width() as f64 * cell_m, from.y + frame.height() as f64 * cell_m];
    format!("x from {:.1} to {:.1} m, y from {:.1} to {:.1} m", from.x, to[0], from.y, to[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_numbers_and_names_are_told_apart() {
        assert_eq!(Asked::parse("3.2, -1.5"), Ok(Asked::Point(Point2::new(3.2, -1.5))));
        assert_eq!(Asked::parse("3"), Ok(Asked::Number(3)));
        assert_eq!(Asked::parse("kitchen door"), Ok(Asked::Name("kitchen door".to_owned())));
        assert!(["", "-1", "1.5", "1;2", "1,2,3"].iter().all(|text| Asked::parse(text).is_err()));
    }
}
