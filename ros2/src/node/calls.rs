//! The services of the node.

use super::CuriousNode;
use crate::lifecycle::State;
use crate::link::{Link, Request};
use crate::message::{Message, ParameterEvent, Topic};
use crate::parameter_services::{self, Parametrized};
use crate::parameters::{Parameters, When};
use crate::service::wire::Parameter;
use crate::service::{Call, Reply, Service};
use crate::value::Value;
use std::time::Instant;

impl<L: Link> CuriousNode<L> {
    /// Answers a call, at once or later.
    pub(super) fn call(&mut self, request: Request, service: Service, call: Call) {
        if let Some((reply, changed)) = parameter_services::answer(self, service, &call) {
            self.link.answer(request, reply);
            return self.publish_changes(changed);
        }
        let reply = match (service, call) {
            (Service::SaveState, _) => return self.save_for(Some(request)),
            (Service::SerializeMap, Call::Name(name)) => return self.serialize(&name, request),
            (Service::SaveMap, Call::Name(name)) => Reply::Code(self.save_map(&name)),
            (Service::DeserializeMap, Call::Deserialize(asked)) => Reply::Code(self.deserialize(&asked)),
            (Service::ChangeState, Call::Transition(asked)) => Reply::Success(self.change_state(&asked)),
            (Service::GetState, _) => Reply::State(self.state.labelled()),
            (Service::GetAvailableStates, _) => Reply::States(State::all()),
            (Service::GetAvailableTransitions, _) => Reply::Transitions(self.state.transitions()),
            (Service::GetTransitionGraph, _) => Reply::Transitions(State::graph()),
            _ => return,
        };
        self.link.answer(request, reply);
    }

    fn publish_changes(&mut self, changed: Vec<Parameter>) {
        if changed.is_empty() {
            return;
        }
        for Parameter { name, value } in &changed {
            if let Some(value) = value.value() {
                self.notes.say(&format!("the parameter `{name}` is {value} now"));
            }
        }
        let (stamp, node) = (self.stamp(Instant::now()), self.link.node().to_owned());
        let event = ParameterEvent { stamp, node, new: Vec::new(), changed, deleted: Vec::new() };
        self.link.send(Topic::ParameterEvents, Message::ParameterEvent(event));
    }
}

impl<L: Link> Parametrized for CuriousNode<L> {
    fn list(&self) -> Vec<(String, Value)> {
        self.parameters.list()
    }

    fn about(&self, name: &str) -> (&'static str, Option<&'static str>) {
        let when = match Parameters::when(name) {
            When::Always => Some("It can be set at any time."),
            When::Unconfigured => Some("It can be set while the node is unconfigured."),
            When::Start => None,
        };
        (Parameters::about(name), when)
    }

    fn set_all(&mut self, all: &[(String, Value)]) -> Result<(), String> {
        let mut next = self.parameters.clone();
        for (name, value) in all {
            next.set(name, value).map_err(|error| error.to_string())?;
        }
        next.check().map_err(|error| error.to_string())?;
        next.check_change(&self.parameters, self.state == State::Unconfigured)?;
        self.published.set(&next);
        if let Some(routes) = &mut self.routes {
            routes.set(&next);
        }
        self.parameters = next;
        Ok(())
    }
}
