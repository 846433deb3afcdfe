//! The state of the node, and those who ask for it to be saved.

use super::CuriousNode;
use crate::link::Link;
use crate::node_state_file::{Asker, NodeStateFile};
use crate::service::Reply;
use crate::service::wire::Trigger;
use anyhow::bail;

fn refused(text: &str) -> Trigger {
    Trigger { is_done: false, text: text.to_owned() }
}

impl<L: Link> CuriousNode<L> {
    /// Begins to save the state; `None` without a file, or before the first reading.
    pub(super) fn save(&mut self) -> Option<std::io::Result<()>> {
        let (stamp, _) = self.last.filter(|_| self.state_file.is_some())?;
        self.settle();
        self.state_file.as_mut().map(|file| file.save(stamp, &mut self.robot))
    }

    /// Saves the state for someone who has asked for it. The answer comes when the file is written.
    pub(super) fn save_for(&mut self, asker: Asker) {
        match &mut self.state_file {
            None => {
                self.answer(asker, refused("there is no state file: start the node with --state FILE"));
            }
            Some(_) if self.last.is_none() => {
                self.answer(asker, refused("there is nothing to save before the first reading"));
            }
            Some(state_file) => {
                // While a map is being learned again, the state waits for it, and the robot does not.
                state_file.must_save = true;
                state_file.askers.push(asker);
            }
        }
    }

    /// Answers those who wait for the file, when it is written.
    pub(super) fn answer_askers(&mut self) {
        let is_written =
            |state_file: &&mut NodeStateFile| !state_file.must_save && !state_file.file.is_writing();
        if self.state_file.as_mut().filter(is_written).is_some_and(|file| !file.askers.is_empty()) {
            self.answer_all();
        }
    }

    /// Waits until the file is written, and answers those who wait for it.
    pub(super) fn answer_all(&mut self) -> Trigger {
        let Some(state_file) = &mut self.state_file else { return refused("") };
        let (name, askers) = (state_file.name(), std::mem::take(&mut state_file.askers));
        let answer = match state_file.file.wait() {
            Ok(()) => Trigger { is_done: true, text: format!("the state is saved in {name}") },
            Err(why) => refused(&format!("{name}: cannot save the state: {why}")),
        };
        for asker in askers {
            self.answer(asker, answer.clone());
        }
        answer
    }

    /// Saves the state, and waits until it is written.
    ///
    /// # Errors
    ///
    /// When it cannot be written.
    pub(super) fn save_at_end(&mut self) -> anyhow::Result<()> {
        if self.save().is_some() {
            let answer = self.answer_all();
            if !answer.is_done {
                bail!(answer.text);
            }
        }
        Ok(())
    }

    fn answer(&mut self, asker: Asker, answer: Trigger) {
        match asker {
            None => self.notes.say(&answer.text),
            Some(request) => self.link.answer(request, Reply::Trigger(answer)),
        }
    }
}
