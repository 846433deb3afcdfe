//! The state of the node, and those who ask for it to be saved.

use super::CuriousNode;
use crate::link::{Answer, Link, Request};
use crate::saves::Saves;

/// Who has asked to save the state.
#[derive(Clone, Copy, Debug)]
pub(super) enum Asker {
    Signal,
    Request(Request),
}

impl<L: Link> CuriousNode<L> {
    /// Begins to save the state; `None` without a file, or before the first reading.
    pub(super) fn save(&mut self) -> Option<std::io::Result<()>> {
        self.settle();
        self.must_save = false;
        let Self { mapper, localization, pilot, last, .. } = self;
        let (stamp, _) = (*last)?;
        let saves = self.saves.as_mut()?;
        Some(saves.save(stamp, mapper, localization.as_mut(), pilot))
    }

    /// Begins to save the state for someone who has asked for it. The answer comes when the file is written.
    pub(super) fn save_for(&mut self, asker: Asker) {
        let refused = |text: &str| Answer { is_done: false, text: text.to_owned() };
        if self.saves.is_none() {
            self.answer(asker, refused("there is no state file: start the node with --state FILE"));
            return;
        }
        if self.last.is_none() {
            self.answer(asker, refused("there is nothing to save before the first reading"));
            return;
        }
        // While a map is being learned again, the state waits for it, and the robot does not.
        self.must_save = true;
        self.askers.push(asker);
    }

    /// Answers those who wait for the file, when it is written.
    pub(super) fn answer_askers(&mut self) {
        if self.askers.is_empty() || self.must_save || self.saves.as_ref().is_some_and(Saves::is_writing) {
            return;
        }
        let answer = self.written();
        for asker in std::mem::take(&mut self.askers) {
            self.answer(asker, answer.clone());
        }
    }

    /// Waits until the file is written.
    pub(super) fn written(&mut self) -> Answer {
        let Some(saves) = &mut self.saves else { return Answer { is_done: false, text: String::new() } };
        let name = saves.name();
        match saves.wait() {
            Ok(()) => Answer { is_done: true, text: format!("the state is saved in {name}") },
            Err(why) => Answer { is_done: false, text: format!("{name}: cannot save the state: {why}") },
        }
    }

    pub(super) fn answer(&mut self, asker: Asker, answer: Answer) {
        match asker {
            Asker::Signal => self.notes.say(&answer.text),
            Asker::Request(request) => self.link.answer(request, answer),
        }
    }
}
