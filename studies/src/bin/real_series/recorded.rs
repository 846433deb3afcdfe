/// No recording is longer, years.
const MAX_YEARS: f64 = 10.0;
const YEAR_S: f64 = 365.25 * 86_400.0;

/// The time of a change, s, and the new state: blocked (open, occupied) or not, `None` while nothing was recorded.
pub(crate) type Change = (f64, Option<bool>);

/// What a real thing did: a file of comma-separated values `time_s,state`, one line per change. A first line with neither a
/// time nor a state holds titles.
///
/// A state is 0, 1 or nan (not recorded). Lines that begin with `#` are comments.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Recording {
    /// The changes in the order of time; at least one.
    pub(crate) changes: Vec<Change>,
}

impl Recording {
    /// Reads the text of a file.
    ///
    /// # Errors
    ///
    /// When a line is not `time_s,state`, time goes backwards, the recording is longer than ten years or has no change. The
    /// message names the line, and what is valid.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let changes = changes(text)?;
        if changes.is_empty() {
            return Err("no events".to_owned());
        }
        Ok(Self { changes })
    }
}

/// The changes in a file, by time.
fn changes(text: &str) -> Result<Vec<Change>, String> {
    let mut changes: Vec<Change> = Vec::new();
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .flexible(true)
        .from_reader(text.as_bytes());
    for (number, record) in reader.records().enumerate() {
        let record = record.map_err(|error| error.to_string())?;
        let line = record.position().map_or(0, csv::Position::line);
        let wrong = || {
            let found = record.iter().collect::<Vec<_>>().join(",");
            format!("line {line}: expected `time_s,state` with a state of 0, 1 or nan, found `{found}`")
        };
        let time_s = record.get(0).and_then(|field| field.parse::<f64>().ok());
        let state = match record.get(1) {
            Some("0") => Some(false),
            Some("1") => Some(true),
            Some("nan") => None,
            // Titles.
            _ if number == 0 && time_s.is_none() => continue,
            _ => return Err(wrong()),
        };
        let time_s = time_s.filter(|time_s| time_s.is_finite()).ok_or_else(wrong)?;
        let first_s = changes.first().map_or(time_s, |first| first.0);
        if changes.last().is_some_and(|(last_s, _)| time_s < *last_s) {
            return Err(format!("line {line}: time goes backwards"));
        }
        if time_s - first_s > MAX_YEARS * YEAR_S {
            return Err(format!("line {line}: more than ten years after the first line"));
        }
        changes.push((time_s, state));
    }
    Ok(changes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles_are_optional() {
        let events = "0,1\n60,0\n120,nan\n";
        let changes = vec![(0.0, Some(true)), (60.0, Some(false)), (120.0, None)];
        for title in ["", "time_s,state\n", "# a door\n", "# a door\ntime_s,state\n", "\u{feff}", "time\n"] {
            let recording = Recording::parse(&format!("{title}{events}")).unwrap();
            assert_eq!(recording.changes, changes, "{title:?}");
        }
    }

    #[test]
    fn an_invalid_first_event_is_no_title() {
        for (first, found) in
            [("x,1", "x,1"), ("0,2", "0,2"), ("inf,0", "inf,0"), ("time_s,state\nx,y", "x,y")]
        {
            let error = Recording::parse(&format!("{first}\n60,0\n")).unwrap_err();
            assert!(
                error.contains("expected `time_s,state`") && error.ends_with(&format!("`{found}`")),
                "{error}"
            );
        }
    }
}
