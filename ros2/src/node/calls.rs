//! The services of the node. Those of parameters, which every node of ROS has, are for `ros2 param`, rqt and launch files.

use super::CuriousNode;
use crate::lifecycle::State;
use crate::link::{Link, Request};
use crate::maps::PublishedMaps;
use crate::message::{Message, ParameterEvent, Topic};
use crate::node_state_file::Asker;
use crate::parameters::{Parameters, When};
use crate::service::wire::{Description, Listed, Parameter, ParameterValue, Prefixes, SetResult};
use crate::service::{Call, Reply, Service};
use crate::value::Value;
use anyhow::Context;
use std::collections::BTreeSet;
use std::time::Instant;

impl<L: Link> CuriousNode<L> {
    /// Answers a call, at once or later.
    pub(super) fn call(&mut self, request: Request, call: Call) {
        let list = self.parameters.list();
        let find = |name: &String| list.iter().find(|(known, _)| known == name);
        let reply = match (request.service, call) {
            (Service::SaveState, _) => return self.save_for(Asker::Save(request)),
            (Service::SerializeMap, Call::Name(name)) => return self.serialize(&name, request),
            (Service::SaveMap, Call::Name(name)) => {
                let saved = self.save_map(&name);
                self.coded(saved)
            }
            (Service::DeserializeMap, Call::Deserialize(asked)) => {
                let loaded = self.deserialize(&asked);
                self.coded(loaded)
            }
            (Service::GetPatience, _) => Reply::Trigger(self.patience()),
            (Service::ChangeState, Call::Transition(asked)) => Reply::Success(self.change_state(&asked)),
            (Service::GetState, _) => Reply::State(self.state.labelled()),
            (Service::GetAvailableStates, _) => Reply::States(State::all()),
            (Service::GetAvailableTransitions, _) => Reply::Transitions(self.state.transitions()),
            (Service::GetTransitionGraph, _) => Reply::Transitions(State::graph()),
            (Service::GetParameters, Call::Names(names)) => {
                let value = |name| find(name).map(|(_, value)| value.into()).unwrap_or_default();
                Reply::Values(names.iter().map(value).collect())
            }
            (Service::GetParameterTypes, Call::Names(names)) => {
                let kind = |name| find(name).map_or(0, |(_, value)| ParameterValue::from(value).kind);
                Reply::Types(names.iter().map(kind).collect())
            }
            (Service::DescribeParameters, Call::Names(names)) => {
                let known = names.iter().filter_map(find);
                Reply::Descriptions(known.map(|(name, value)| description(name, value)).collect())
            }
            (Service::ListParameters, Call::Prefixes(prefixes)) => Reply::Listed(listed(&list, &prefixes)),
            (Service::SetParameters, Call::Parameters(all)) => {
                Reply::Results(all.iter().map(|one| self.set_parameters(std::slice::from_ref(one))).collect())
            }
            (Service::SetParametersAtomically, Call::Parameters(all)) => {
                Reply::Result(self.set_parameters(&all))
            }
            _ => return,
        };
        self.link.answer(request, reply);
    }

    /// Sets all parameters or none.
    fn set_parameters(&mut self, all: &[Parameter]) -> SetResult {
        if let Err(why) = self.try_set_parameters(all) {
            return SetResult { successful: false, reason: why.to_string() };
        }
        for Parameter { name, value } in all {
            if let Some(value) = value.value() {
                self.notes.say(&format!("the parameter `{name}` is {value} now"));
            }
        }
        let (stamp, node) = (self.stamp(Instant::now()), self.link.node().to_owned());
        let changed = all.to_vec();
        let event = ParameterEvent { stamp, node, new: Vec::new(), changed, deleted: Vec::new() };
        self.link.send(Topic::ParameterEvents, Message::ParameterEvent(event));
        SetResult { successful: true, reason: String::new() }
    }

    fn try_set_parameters(&mut self, all: &[Parameter]) -> anyhow::Result<()> {
        let mut next = self.parameters.clone();
        for Parameter { name, value } in all {
            let value = value.value();
            let none = || format!("the parameter `{name}` must be one value, not a list or nothing");
            next.set(name, &value.with_context(none)?)?;
        }
        next.check()?;
        next.check_change(&self.parameters, self.state == State::Unconfigured)?;
        // They are published with the new parameters at once.
        self.published.maps = PublishedMaps::default();
        self.parameters = next;
        Ok(())
    }
}

fn description(name: &str, value: &Value) -> Description {
    let when = match Parameters::when(name) {
        When::Always => Some("It can be set at any time."),
        When::Unconfigured => Some("It can be set while the node is unconfigured."),
        When::Start => None,
    };
    Description {
        name: name.to_owned(),
        kind: ParameterValue::from(value).kind,
        description: Parameters::about(name).to_owned(),
        additional_constraints: when.unwrap_or_default().to_owned(),
        read_only: when.is_none(),
        ..Description::default()
    }
}

/// The names as `rclcpp` lists them: below the prefixes, down to a number of levels.
fn listed(list: &[(String, Value)], Prefixes { prefixes, depth }: &Prefixes) -> Listed {
    let is_within = |rest: &str| *depth == 0 || (rest.matches('.').count() as u64) < *depth;
    let is_below = |rest: &str| rest.is_empty() || rest.starts_with('.') && is_within(rest);
    let is_listed = |name: &&String| {
        let mut below = prefixes.iter().filter_map(|prefix| name.strip_prefix(prefix.as_str()));
        below.any(is_below) || prefixes.is_empty() && is_within(name)
    };
    let names: Vec<String> = list.iter().map(|(name, _)| name).filter(is_listed).cloned().collect();
    let before = names.iter().filter_map(|name| Some(name.rsplit_once('.')?.0.to_owned()));
    let prefixes = BTreeSet::from_iter(before).into_iter().collect();
    Listed { names, prefixes }
}
