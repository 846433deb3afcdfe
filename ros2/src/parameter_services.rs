//! The services of parameters, which every node of ROS has: `ros2 param`, rqt and launch files use them.

use crate::service::wire::{Description, Labelled, Listed, Parameter, ParameterValue, Prefixes, SetResult};
use crate::service::{Call, Reply, Service};
use crate::value::Value;

/// What has parameters.
pub(crate) trait Parametrized {
    /// All parameters with their values.
    fn list(&self) -> Vec<(String, Value)>;

    /// What a parameter means, and when it can be set; `None`: it cannot be set while the node runs.
    fn about(&self, name: &str) -> (&'static str, Option<&'static str>);

    /// Sets all parameters or none.
    ///
    /// # Errors
    ///
    /// When one has no such value, or cannot be set now: one sentence.
    fn set_all(&mut self, all: &[(String, Value)]) -> Result<(), String>;
}

/// The answer to a call of a service of parameters, and what has changed; `None` for other services.
pub(crate) fn answer(
    of: &mut impl Parametrized,
    service: Service,
    call: &Call,
) -> Option<(Reply, Vec<Parameter>)> {
    let list = of.list();
    let find = |name: &String| list.iter().find(|(known, _)| known == name);
    let reply = match (service, call) {
        (Service::GetParameters, Call::Names(names)) => {
            let value = |name| find(name).map(|(_, value)| value.into()).unwrap_or_default();
            Reply::Values(names.iter().map(value).collect())
        }
        (Service::GetParameterTypes, Call::Names(names)) => {
            let kind = |name| find(name).map_or(0, |(_, value)| ParameterValue::from(value).kind());
            Reply::Types(names.iter().map(kind).collect())
        }
        (Service::DescribeParameters, Call::Names(names)) => {
            let known = names.iter().filter_map(find);
            Reply::Descriptions(known.map(|(name, value)| description(of, name, value)).collect())
        }
        (Service::ListParameters, Call::Prefixes(prefixes)) => Reply::Listed(listed(&list, prefixes)),
        (Service::SetParameters, Call::Parameters(all)) => {
            let results: Vec<SetResult> = all.iter().map(|one| set(of, std::slice::from_ref(one))).collect();
            let done = all.iter().zip(&results).filter(|(_, result)| result.successful);
            let changed = done.map(|(parameter, _)| parameter.clone()).collect();
            return Some((Reply::Results(results), changed));
        }
        (Service::SetParametersAtomically, Call::Parameters(all)) => {
            let result = set(of, all);
            let changed = if result.successful { all.clone() } else { Vec::new() };
            return Some((Reply::Result(result), changed));
        }
        _ => return None,
    };
    Some((reply, Vec::new()))
}

fn set(of: &mut impl Parametrized, all: &[Parameter]) -> SetResult {
    let value = |Parameter { name, value }: &Parameter| match value.value() {
        Some(value) => Ok((name.clone(), value)),
        None => Err(format!("the parameter `{name}` must be one value, not a list or nothing")),
    };
    let all: Result<Vec<_>, String> = all.iter().map(value).collect();
    match all.and_then(|all| of.set_all(&all)) {
        Ok(()) => SetResult { successful: true, reason: String::new() },
        Err(reason) => SetResult { successful: false, reason },
    }
}

fn description(of: &impl Parametrized, name: &str, value: &Value) -> Description {
    let (text, when) = of.about(name);
    Description {
        name: name.to_owned(),
        kind: ParameterValue::from(value).kind(),
        description: text.to_owned(),
        additional_constraints: when.unwrap_or_default().to_owned(),
        read_only: when.is_none(),
        ..Description::default()
    }
}

/// The names as `rclcpp` lists them: below the prefixes, down to a number of levels.
fn listed(list: &[(String, Value)], Prefixes { prefixes, depth }: &Prefixes) -> Listed {
    let is_within = |rest: &str| *depth == 0 || (rest.matches('.').count() as u64) < *depth;
    let is_below = |name: &str, prefix: &String| {
        name == prefix
            || name
                .strip_prefix(prefix.as_str())
                .and_then(|rest| rest.strip_prefix('.'))
                .is_some_and(|rest| is_within(&format!(".{rest}")))
    };
    let mut found = Listed::default();
    for (name, _) in list {
        let is_all = prefixes.is_empty() && is_within(name);
        if is_all || prefixes.iter().any(|prefix| is_below(name, prefix)) {
            found.names.push(name.clone());
            if let Some((before, _)) = name.rsplit_once('.')
                && !found.prefixes.iter().any(|known| known == before)
            {
                found.prefixes.push(before.to_owned());
            }
        }
    }
    found
}

/// A number and a name on the wire.
pub(crate) fn labelled(id: u8, label: &str) -> Labelled {
    Labelled { id, label: label.to_owned() }
}
