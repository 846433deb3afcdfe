//! Files of parameters, as launch files and `ros2 run … --params-file` pass them to nodes.
//!
//! ```yaml
//! /**:                   # every node
//!   ros__parameters:
//!     use_sim_time: true
//! curious_node:          # this node without a namespace; /robot1/curious_node or /*/curious_node with one
//!   ros__parameters:
//!     resolution: 0.05
//! ```

use crate::value::{Given, Value};
use anyhow::{anyhow, bail};
use serde::Deserialize;
use serde_json::Value as Yaml;
use std::path::Path;

/// The key below which the parameters of a node are.
const PARAMETERS: &str = "ros__parameters";
/// The maximum length of a file: far more than any node has.
const MAX_BYTES: u64 = 1 << 20;
const EXAMPLE: &str = "as in `curious_node: {ros__parameters: {resolution: 0.05}}`";

/// All parameters of a file; those for all nodes come before those for one.
pub(crate) fn read(path: &Path) -> anyhow::Result<Vec<Given>> {
    let file = path.display().to_string();
    let text = files::read_text(path, MAX_BYTES)
        .map_err(|why| anyhow!("cannot read the parameters in {file}: {why}"))?;
    let found = entries(&text).map_err(|what| anyhow!("{file}{what}"))?;
    Ok(found.into_iter().map(|given| Given { place: Some(file.clone()), ..given }).collect())
}

/// The value of a text on the command line, as YAML has it: `true`, `5`, `0.05`, `"text"`, `text`.
pub(crate) fn value_of(text: &str) -> Value {
    serde_saphyr::from_str(text).unwrap_or_else(|_| Value::Text(text.trim().to_owned()))
}

/// # Errors
///
/// The end of a sentence that begins with the name of the file.
fn entries(text: &str) -> Result<Vec<Given>, String> {
    let root: Yaml = serde_saphyr::from_str(text).map_err(|error| {
        let error = error.without_snippet();
        let line = error.location().map_or(1, |at| at.line());
        let text = error.to_string();
        let what = text.lines().next().unwrap_or_default();
        let what = what.split(" at line ").next().unwrap_or(what);
        format!(", line {line}: {what}; parameters are written {EXAMPLE}")
    })?;
    let mut entries = Vec::new();
    sections(&mut entries, "", &root).map_err(|why| format!(": {why}"))?;
    Ok(entries)
}

/// The parameters of all nodes below a namespace.
fn sections(entries: &mut Vec<Given>, nodes: &str, part: &Yaml) -> anyhow::Result<()> {
    let Some(table) = part.as_object() else {
        let which = if nodes.is_empty() { "this".to_owned() } else { format!("`{nodes}`") };
        bail!("{which} must be a table with `{PARAMETERS}`, {EXAMPLE}");
    };
    for (key, below) in table {
        if key == PARAMETERS && !nodes.is_empty() {
            parameters(entries, nodes, "", below);
        } else if key == PARAMETERS {
            bail!("`{PARAMETERS}` must be below a node, {EXAMPLE}");
        } else {
            sections(entries, &format!("{nodes}/{}", key.trim_matches('/')), below)?;
        }
    }
    Ok(())
}

fn parameters(entries: &mut Vec<Given>, nodes: &str, prefix: &str, part: &Yaml) {
    for (key, below) in part.as_object().into_iter().flatten() {
        parameters(entries, nodes, &format!("{prefix}.{key}"), below);
    }
    let (nodes, name) = (nodes.to_owned(), prefix.trim_start_matches('.').to_owned());
    if !part.is_object() && !name.is_empty() {
        entries.push(Given { nodes, name, value: Value::deserialize(part).ok(), place: None });
    }
}

/// Whether the full name of a node matches a pattern.
pub(crate) fn matches(pattern: &str, node: &str) -> bool {
    fn parts_match(pattern: &[&str], node: &[&str]) -> bool {
        match (pattern, node) {
            ([], []) => true,
            (["**", rest @ ..], _) => (0..=node.len()).any(|skipped| parts_match(rest, &node[skipped..])),
            ([first, pattern @ ..], [name, node @ ..]) => {
                (*first == "*" || first == name) && parts_match(pattern, node)
            }
            _ => false,
        }
    }
    fn parts(name: &str) -> Vec<&str> {
        name.split('/').filter(|part| !part.is_empty()).collect()
    }
    parts_match(&parts(pattern), &parts(node))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_have_nodes_names_and_values() {
        let text = "/**:\n  ros__parameters:\n    use_sim_time: true\n\nrobot1:\n  curious_node:\n    \
                    ros__parameters:\n      resolution: 0.1\n      seed: 7\n      mode: explore\n      \
                    qos_overrides:\n        /scan:\n          subscription: {reliability: reliable}\n      \
                    others: [1.0, 2.0]\n";
        let found = entries(text).unwrap();
        let entry = |nodes: &str, name: &str, value| {
            let (nodes, name) = (nodes.to_owned(), name.to_owned());
            Given { nodes, name, value, place: None }
        };
        let node = "/robot1/curious_node";
        let expected = [
            entry("/**", "use_sim_time", Some(Value::Bool(true))),
            entry(node, "mode", Some(Value::Text("explore".into()))),
            entry(node, "others", None),
            entry(node, "qos_overrides./scan.subscription.reliability", Some(Value::Text("reliable".into()))),
            entry(node, "resolution", Some(Value::Float(0.1))),
            entry(node, "seed", Some(Value::Integer(7))),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn patterns_match_as_in_ros() {
        let nodes = ["/curious_node", "/a/curious_node", "/a/b/curious_node"];
        for (pattern, expected) in [
            ("/**", [true, true, true]),
            ("/curious_node", [true, false, false]),
            ("/*/curious_node", [false, true, false]),
            ("/**/curious_node", [true, true, true]),
            ("/other", [false, false, false]),
        ] {
            assert_eq!(nodes.map(|node| matches(pattern, node)), expected, "{pattern}");
        }
    }

    #[test]
    fn what_is_no_file_of_parameters_is_refused() {
        for (text, says) in [
            (
                "curious_node:\n  resolution: 0.1\n",
                ": `/curious_node/resolution` must be a table with `ros__parameters`,",
            ),
            ("ros__parameters: {a: 1}", ": `ros__parameters` must be below a node,"),
            ("- 1", ": this must be a table with `ros__parameters`,"),
            ("a:\n  b: [1,\nc: 2\n", ", line 2: unclosed bracket '['; parameters are written"),
            ("", ": this must be a table with `ros__parameters`,"),
        ] {
            let example = "as in `curious_node: {ros__parameters: {resolution: 0.05}}`";
            assert_eq!(entries(text).unwrap_err(), format!("{says} {example}"));
        }
    }

    #[test]
    fn values_have_the_types_of_yaml() {
        assert_eq!(value_of("true"), Value::Bool(true));
        assert_eq!(value_of("-5"), Value::Integer(-5));
        assert_eq!(value_of("0.05"), Value::Float(0.05));
        assert_eq!(value_of("1e-3"), Value::Float(0.001));
        assert_eq!(value_of("'5'"), Value::Text("5".into()));
        assert_eq!(value_of("inf"), Value::Text("inf".into()));
        assert_eq!(value_of("/scan"), Value::Text("/scan".into()));
        assert_eq!(value_of("\""), Value::Text("\"".into()));
        assert_eq!(value_of(""), Value::Text(String::new()));
    }
}
