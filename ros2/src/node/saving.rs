//! The state of the node in its file and in others, and those who ask for it to be saved.

use super::CuriousNode;
use super::slam_services::{FAILURE, saved_in, with_ending};
use crate::link::{Link, Request};
use crate::message::Time;
use crate::node_state_file::{Asker, NodeStateFile, Saved, open};
use crate::service::Reply;
use crate::service::wire::Trigger;
use anyhow::bail;

impl<L: Link> CuriousNode<L> {
    /// Begins to save the state; `None` without a file, or before the first reading.
    pub(super) fn save(&mut self) -> Option<std::io::Result<()>> {
        let (stamp, _) = self.last.filter(|_| self.state_file.is_some())?;
        self.settle();
        self.state_file.as_mut().map(|file| file.save(stamp, &mut self.robot))
    }

    /// Saves the state for someone who has asked for it. The answer comes when the file is written.
    pub(super) fn save_for(&mut self, asker: Asker) {
        let refusal = match &mut self.state_file {
            None => "there is no state file: start the node with --state FILE",
            Some(_) if self.last.is_none() => "there is nothing to save before the first reading",
            Some(state_file) => return state_file.ask(asker),
        };
        self.answer(asker, Err(refusal.to_owned()));
    }

    /// Writes the state to another file, and answers when it is written.
    pub(super) fn serialize(&mut self, name: &str, request: Request) {
        let asker = Asker::Serialize(request);
        match self.copy(name) {
            Ok(mut copy) => {
                copy.ask(asker);
                self.copies.push(copy);
            }
            Err(why) => self.answer(asker, Err(format!("{why:#}"))),
        }
    }

    fn copy(&self, name: &str) -> anyhow::Result<NodeStateFile> {
        if name.is_empty() || self.last.is_none() {
            bail!("a state has a name, and there is nothing to save before the first reading");
        }
        let path = saved_in(&self.parameters.map_folder, name).map_err(anyhow::Error::msg)?;
        let path = with_ending(path);
        if path.is_symlink() {
            bail!("{}: this is a link, which could lead out of the folder for maps", path.display());
        }
        let own = self.state_file.as_ref().and_then(|own| own.file.path().canonicalize().ok());
        if own.is_some_and(|own| path.canonicalize().is_ok_and(|path| path == own)) {
            bail!("this is the state file of the node: the service `save_state` saves to it");
        }
        let settings = super::setup::settings(&self.parameters);
        let mut copy = NodeStateFile::new(open(&path)?, &settings, &self.parameters)?;
        self.state_file.iter().for_each(|own| copy.go_on_from(own));
        Ok(copy)
    }

    /// Goes on with what others have asked for, and answers those whose file is written. While a map is being learned again, they
    /// wait, and the robot does not. The robot changes to that map for them, since no further scan may come.
    pub(super) fn answer_askers(&mut self) {
        let must_save = self.state_file.iter().chain(&self.copies).any(|file| file.must_save);
        if must_save && self.robot.is_up_to_date() {
            self.settle();
        }
        if self.robot.is_settled() {
            let last = self.last.map_or(Time::default(), |(last, _)| last);
            for copy in self.copies.iter_mut().filter(|copy| copy.must_save) {
                // The error of the writing before: there is none.
                copy.save(last, &mut self.robot).ok();
            }
        }
        let mut written = Vec::new();
        if let Some(own) = self.state_file.as_mut().filter(|own| own.is_answer_due()) {
            written.push(own.wait());
        }
        written.extend(self.copies.extract_if(.., |copy| copy.is_answer_due()).map(|mut copy| copy.wait()));
        for (askers, saved) in written {
            askers.into_iter().for_each(|asker| self.answer(asker, saved.clone()));
        }
    }

    /// Saves the state, and waits until it is written.
    ///
    /// # Errors
    ///
    /// When it cannot be written.
    pub(super) fn save_at_end(&mut self) -> anyhow::Result<()> {
        if self.save().is_none() {
            return Ok(());
        }
        let Some((askers, saved)) = self.state_file.as_mut().map(NodeStateFile::wait) else { return Ok(()) };
        askers.into_iter().for_each(|asker| self.answer(asker, saved.clone()));
        saved.map(drop).map_err(anyhow::Error::msg)
    }

    fn answer(&mut self, asker: Asker, saved: Saved) {
        let is_done = saved.is_ok();
        let (Ok(text) | Err(text)) = saved;
        match asker {
            Asker::Save(request) => self.link.answer(request, Reply::Trigger(Trigger { is_done, text })),
            Asker::Signal => self.notes.say(&text),
            Asker::Serialize(request) => {
                let code = self.coded(if is_done { Ok(text) } else { Err((FAILURE, text)) });
                self.link.answer(request, code);
            }
        }
    }
}
