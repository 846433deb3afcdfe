//! Sentences for the error output, each one once in a while.

use crate::message::Log;
use std::collections::{BTreeMap, VecDeque};
use std::time::{Duration, Instant};

/// The time until the same sentence is written again.
const REPEAT: Duration = Duration::from_secs(60);
/// Maximum number of different sentences that are remembered: names come from the network.
const MAX_REMEMBERED: usize = 1000;

/// Where sentences go.
pub(crate) type Output = Box<dyn FnMut(&str) + Send>;

/// Sentences that wait for the log of all nodes; of more, the oldest are dropped.
const MAX_UNSENT: usize = 100;

/// Writes sentences. A sentence that differs from an earlier one only in numbers is written once a minute.
pub(crate) struct Notes {
    output: Output,
    written: BTreeMap<String, (Instant, u64)>,
    unsent: VecDeque<(u8, String)>,
}

impl Notes {
    pub(crate) fn new(output: Output) -> Self {
        Self { output, written: BTreeMap::new(), unsent: VecDeque::new() }
    }

    /// Writes a sentence that is said once.
    pub(crate) fn say(&mut self, text: &str) {
        self.write(Log::INFO, text);
    }

    /// Writes a sentence that is said once, and at which a user should look.
    pub(crate) fn warn(&mut self, text: &str) {
        self.write(Log::WARNING, text);
    }

    /// The sentences since the last call with their levels, for the log of all nodes.
    pub(crate) fn take_unsent(&mut self) -> VecDeque<(u8, String)> {
        std::mem::take(&mut self.unsent)
    }

    fn write(&mut self, level: u8, text: &str) {
        let text = interfaces::printable(text);
        (self.output)(&text);
        if self.unsent.len() >= MAX_UNSENT {
            self.unsent.pop_front();
        }
        self.unsent.push_back((level, text.to_string()));
    }

    /// Writes a sentence that may be said often.
    pub(crate) fn note(&mut self, text: &str, now: Instant) {
        let kind: String = text.chars().filter(|c| !c.is_ascii_digit() && *c != '.' && *c != '-').collect();
        let again = match self.written.get_mut(&kind) {
            Some((last, unwritten)) if now.duration_since(*last) < REPEAT => {
                *unwritten += 1;
                return;
            }
            Some((_, unwritten)) => *unwritten,
            None => 0,
        };
        if self.written.len() >= MAX_REMEMBERED {
            self.written.clear();
        }
        self.written.insert(kind, (now, 0));
        match again {
            0 => self.warn(text),
            again => self.warn(&format!("{text} ({again} times more since the last time)")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::{Arc, Mutex};

    #[test]
    fn a_sentence_is_written_once_a_minute() {
        let written = Arc::new(Mutex::new(Vec::new()));
        let to = written.clone();
        let mut notes = Notes::new(Box::new(move |text| to.lock().unwrap().push(text.to_owned())));
        let start = Instant::now();
        for step in 0..130 {
            notes.note(&format!("{step} scans are not valid"), start + Duration::from_secs(step));
        }
        notes.note("other\x1b[31m", start);
        let expected = [
            "0 scans are not valid",
            "60 scans are not valid (59 times more since the last time)",
            "120 scans are not valid (59 times more since the last time)",
        ];
        let written = written.lock().unwrap();
        assert_eq!(written[..3], expected);
        assert!(!written[3].contains('\x1b'));
        let unsent = notes.take_unsent();
        assert_eq!(unsent.len(), 4);
        assert_eq!(unsent[0], (Log::WARNING, expected[0].to_owned()));
    }
}
