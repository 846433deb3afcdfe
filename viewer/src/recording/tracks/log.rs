//! The messages of a run.

use super::{Start, Track};
use crate::recording::path;
use crate::recording::rows::{Line, Now, Rows, Target};
use crate::view::View;
use rerun::{RecordingStreamResult, TextLogLevel};
use robot::Level;

pub(super) struct Log(Rows<Line>);

impl Log {
    /// A log that begins with the name of the world, so that the log of a run without messages is not empty.
    pub(super) fn new(start: Start) -> Self {
        let mut rows = Rows::new(path::LOG);
        let text = format!("the run in {} starts", start.scene.title);
        let now = Now { time: start.view.time, step: start.view.step };
        rows.push(now, [Line { text, level: TextLogLevel::INFO }]);
        Self(rows)
    }
}

impl Track for Log {
    fn push(&mut self, now: Now, view: &View, _: bool) {
        for message in view.measured.messages {
            let level = match message.level {
                Level::Decision => TextLogLevel::INFO,
                Level::Event => TextLogLevel::WARN,
                Level::Trouble => TextLogLevel::ERROR,
            };
            self.0.push(now, [Line { text: message.text.clone(), level }]);
        }
    }

    fn flush(&mut self, to: Target) -> RecordingStreamResult<()> {
        self.0.flush(to)
    }
}
