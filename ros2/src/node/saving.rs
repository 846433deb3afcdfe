//! The state of the node, and those who ask for it to be saved.

use super::CuriousNode;
use crate::link::{Answer, Link};
use crate::saves::{Asker, Saves};

fn refused(text: &str) -> Answer {
    Answer { is_done: false, text: text.to_owned() }
}

impl<L: Link> CuriousNode<L> {
    /// Begins to save the state; `None` without a file, or before the first reading.
    pub(super) fn save(&mut self) -> Option<std::io::Result<()>> {
        let (stamp, _) = self.last.filter(|_| self.saves.is_some())?;
        self.settle();
        self.saves.as_mut().map(|saves| saves.save(stamp, &mut self.robot))
    }

    /// Saves the state for someone who has asked for it. The answer comes when the file is written.
    pub(super) fn save_for(&mut self, asker: Asker) {
        match &mut self.saves {
            None => {
                self.answer(asker, refused("there is no state file: start the node with --state FILE"));
            }
            Some(_) if self.last.is_none() => {
                self.answer(asker, refused("there is nothing to save before the first reading"));
            }
            Some(saves) => {
                // While a map is being learned again, the state waits for it, and the robot does not.
                saves.must_save = true;
                saves.askers.push(asker);
            }
        }
    }

    /// Answers those who wait for the file, when it is written.
    pub(super) fn answer_askers(&mut self) {
        let is_written = |saves: &&mut Saves| !saves.must_save && !saves.file.is_writing();
        if self.saves.as_mut().filter(is_written).is_some_and(|saves| !saves.askers.is_empty()) {
            self.answer_all();
        }
    }

    /// Waits until the file is written, and answers those who wait for it.
    pub(super) fn answer_all(&mut self) -> Answer {
        let Some(saves) = &mut self.saves else { return refused("") };
        let (name, askers) = (saves.name(), std::mem::take(&mut saves.askers));
        let answer = match saves.file.wait() {
            Ok(()) => Answer { is_done: true, text: format!("the state is saved in {name}") },
            Err(why) => refused(&format!("{name}: cannot save the state: {why}")),
        };
        for asker in askers {
            self.answer(asker, answer.clone());
        }
        answer
    }

    fn answer(&mut self, asker: Asker, answer: Answer) {
        match asker {
            None => self.notes.say(&answer.text),
            Some(request) => self.link.answer(request, answer),
        }
    }
}
