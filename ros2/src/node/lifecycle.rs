//! What the node does at the transitions of the managed lifecycle.

use super::CuriousNode;
use super::publishing::Published;
use super::setup::Parts;
use crate::lifecycle::State;
use crate::link::Link;
use crate::message::{Message, Topic, TransitionEvent, header};
use crate::node_state_file::open;
use crate::service::wire::Labelled;
use std::time::Instant;

impl<L: Link> CuriousNode<L> {
    pub(super) fn is_active(&self) -> bool {
        self.state == State::Active
    }

    /// Changes the state, if the transition begins in the present one, and succeeds.
    pub(super) fn change_state(&mut self, asked: &Labelled) -> bool {
        let Some((to, transition)) = self.state.after(asked) else {
            let (state, name) = (self.state.labelled().label, &asked.label);
            self.notes.warn(&format!("the node is {state}: the transition {} {name} is refused", asked.id));
            return false;
        };
        let done = match (self.state, to) {
            (State::Unconfigured, State::Inactive) => self.configure(true),
            (State::Inactive, State::Active) => {
                self.activate();
                Ok(())
            }
            (_, State::Inactive) => {
                self.deactivate();
                Ok(())
            }
            _ => self.clean_up(),
        };
        if let Err(why) = done {
            self.notes.warn(&format!("the node stays {}: {why:#}", self.state.labelled().label));
            return false;
        }
        self.state = to;
        self.notes.say(&format!("the node is {}", to.labelled().label));
        let event = TransitionEvent {
            timestamp: u64::try_from(self.stamp(Instant::now()).ns()).unwrap_or(0),
            transition,
        };
        self.link.send(Topic::TransitionEvents, Message::TransitionEvent(event));
        true
    }

    /// Makes what the parameters say; `loads`: with what was learned in earlier runs.
    fn configure(&mut self, loads: bool) -> anyhow::Result<()> {
        let state = self.state_path.as_deref().filter(|_| loads).map(open).transpose()?;
        let Parts { robot, state_file, continued } = Parts::new(&self.parameters, state, &mut self.notes)?;
        self.source.configure(super::setup::frames(&self.parameters));
        (self.robot, self.state_file, self.continued) = (robot, state_file, continued);
        (self.published, self.last, self.seat) = (Published::default(), None, None);
        Ok(())
    }

    /// Begins to use scans, and shows the map that was learned before.
    pub(super) fn activate(&mut self) {
        let now = Instant::now();
        self.next_silence = now + super::SILENCE;
        if let Some(last) = self.continued {
            let header = header(last, &self.parameters.map_frame);
            let (parameters, mapper) = (&self.parameters, &self.robot.mapper);
            let name = |topic| self.link.name(topic);
            let maps = self.published.maps.after(parameters, mapper, &header, now, name);
            for (topic, message) in maps {
                self.link.send(topic, message);
            }
            let readings = self.robot.mapper.readings();
            self.notes.say(&format!("the map goes on from {readings} readings"));
        }
    }

    /// Leaves the robot alone. When the node is activated again, the time until then counts as not observed, and the pose is searched
    /// for in the map.
    fn deactivate(&mut self) {
        self.leave_robot();
        self.published.map_to_odom = None;
        if let Some((last, _)) = self.last {
            self.continued = Some(last);
        }
    }

    /// Saves the state and forgets the map.
    fn clean_up(&mut self) -> anyhow::Result<()> {
        self.leave_robot();
        self.save_at_end()?;
        self.configure(false)
    }

    pub(super) fn leave_robot(&mut self) {
        self.stop_robot();
        self.link.navigate(None);
    }
}
