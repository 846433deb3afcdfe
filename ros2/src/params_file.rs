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
use anyhow::anyhow;
use serde::de::{Deserialize, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_saphyr::{NonFiniteFloatPolicy, Spanned, from_str_with_options, options};
use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// The key below which the parameters of a node are.
const PARAMETERS: &str = "ros__parameters";
/// The maximum length of a file: far more than any node has.
const MAX_BYTES: u64 = 1 << 20;
const EXAMPLE: &str = "as in `curious_node: {ros__parameters: {resolution: 0.05}}`";

/// All parameters of a file in the order of their lines.
pub(crate) fn read(path: &Path) -> anyhow::Result<Vec<Given>> {
    let file = path.display();
    let text = text(path).map_err(|why| anyhow!("cannot read the parameters in {file}: {why}"))?;
    let found = entries(&text).map_err(|(line, what)| anyhow!("{file}, line {line}: {what}"))?;
    let placed = |(given, line)| Given { place: Some(format!("{file}, line {line}")), ..given };
    Ok(found.into_iter().map(placed).collect())
}

/// The value of a text on the command line, as YAML has it: `true`, `5`, `0.05`, `"text"`, `text`.
pub(crate) fn value_of(text: &str) -> Value {
    match from_str_with_options(text, options! { non_finite_float_policy: NonFiniteFloatPolicy::PassThrough })
    {
        Ok(Yaml::Value(value)) => value,
        _ => Value::Text(text.trim().to_owned()),
    }
}

fn text(path: &Path) -> io::Result<String> {
    let mut text = String::new();
    File::open(path)?.take(MAX_BYTES + 1).read_to_string(&mut text)?;
    if text.len() as u64 > MAX_BYTES {
        return Err(io::Error::other("it is longer than 1 MiB"));
    }
    Ok(text)
}

/// # Errors
///
/// The line, and what is wrong there.
fn entries(text: &str) -> Result<Vec<(Given, u64)>, (u64, String)> {
    // What is no number for a parameter is an error of that parameter.
    let options = options! { non_finite_float_policy: NonFiniteFloatPolicy::PassThrough };
    let root: Spanned<Yaml> = from_str_with_options(text, options).map_err(|error| {
        let error = error.without_snippet();
        let line = error.location().map_or(1, |at| at.line());
        let text = error.to_string();
        let what = text.lines().next().unwrap_or_default();
        let what = what.split(" at line ").next().unwrap_or(what);
        (line, format!("{what}; parameters are written {EXAMPLE}"))
    })?;
    let mut entries = Vec::new();
    sections(&mut entries, "", &root)?;
    Ok(entries)
}

/// The parameters of all nodes below a namespace.
fn sections(entries: &mut Vec<(Given, u64)>, nodes: &str, part: &Spanned<Yaml>) -> Result<(), (u64, String)> {
    let line = part.referenced.line();
    let Yaml::Table(table) = &part.value else {
        let which = if nodes.is_empty() { "this".to_owned() } else { format!("`{nodes}`") };
        return Err((line, format!("{which} must be a table with `{PARAMETERS}`, {EXAMPLE}")));
    };
    for (key, below) in table {
        if key == PARAMETERS && !nodes.is_empty() {
            parameters(entries, nodes, "", below);
        } else if key == PARAMETERS {
            return Err((below.referenced.line(), format!("`{PARAMETERS}` must be below a node, {EXAMPLE}")));
        } else {
            sections(entries, &format!("{nodes}/{}", key.trim_matches('/')), below)?;
        }
    }
    Ok(())
}

fn parameters(entries: &mut Vec<(Given, u64)>, nodes: &str, prefix: &str, part: &Spanned<Yaml>) {
    let value = match &part.value {
        Yaml::Table(table) => {
            for (key, below) in table {
                let name = if prefix.is_empty() { key.clone() } else { format!("{prefix}.{key}") };
                parameters(entries, nodes, &name, below);
            }
            return;
        }
        Yaml::Value(value) => Some(value.clone()),
        Yaml::Other => None,
    };
    let (nodes, name) = (nodes.to_owned(), prefix.to_owned());
    if !name.is_empty() {
        entries.push((Given { nodes, name, value, place: None }, part.referenced.line()));
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

/// What can be in such a file.
#[derive(Debug)]
enum Yaml {
    Value(Value),
    Table(Vec<(String, Spanned<Yaml>)>),
    /// A list, or nothing: no parameter of this project's nodes has such a value.
    Other,
}

impl<'de> Deserialize<'de> for Yaml {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Any;
        impl<'de> Visitor<'de> for Any {
            type Value = Yaml;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("parameters")
            }
            fn visit_bool<E>(self, value: bool) -> Result<Yaml, E> {
                Ok(Yaml::Value(Value::Bool(value)))
            }
            fn visit_i64<E>(self, value: i64) -> Result<Yaml, E> {
                Ok(Yaml::Value(Value::Integer(value)))
            }
            fn visit_u64<E>(self, value: u64) -> Result<Yaml, E> {
                Ok(Yaml::Value(i64::try_from(value).map_or(Value::Float(value as f64), Value::Integer)))
            }
            fn visit_f64<E>(self, value: f64) -> Result<Yaml, E> {
                Ok(Yaml::Value(Value::Float(value)))
            }
            fn visit_str<E>(self, value: &str) -> Result<Yaml, E> {
                Ok(Yaml::Value(Value::Text(value.to_owned())))
            }
            fn visit_unit<E>(self) -> Result<Yaml, E> {
                Ok(Yaml::Other)
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Yaml, A::Error> {
                while list.next_element::<IgnoredAny>()?.is_some() {}
                Ok(Yaml::Other)
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Yaml, A::Error> {
                let mut table = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    table.push(entry);
                }
                Ok(Yaml::Table(table))
            }
        }
        deserializer.deserialize_any(Any)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_have_nodes_names_values_and_lines() {
        let text = "/**:\n  ros__parameters:\n    use_sim_time: true\n\nrobot1:\n  curious_node:\n    \
                    ros__parameters:\n      resolution: 0.1\n      seed: 7\n      mode: explore\n      \
                    qos_overrides:\n        /scan:\n          subscription: {reliability: reliable}\n      \
                    others: [1.0, 2.0]\n";
        let found: Vec<_> = entries(text)
            .unwrap()
            .into_iter()
            .map(|(Given { nodes, name, value, .. }, line)| (nodes, name, value, line))
            .collect();
        let entry = |nodes: &str, name: &str, value, line| (nodes.to_owned(), name.to_owned(), value, line);
        let node = "/robot1/curious_node";
        assert_eq!(
            found,
            [
                entry("/**", "use_sim_time", Some(Value::Bool(true)), 3),
                entry(node, "resolution", Some(Value::Float(0.1)), 8),
                entry(node, "seed", Some(Value::Integer(7)), 9),
                entry(node, "mode", Some(Value::Text("explore".into())), 10),
                entry(
                    node,
                    "qos_overrides./scan.subscription.reliability",
                    Some(Value::Text("reliable".into())),
                    13
                ),
                entry(node, "others", None, 14),
            ]
        );
    }

    #[test]
    fn patterns_match_as_in_ros() {
        assert!(matches("/**", "/curious_node") && matches("/**", "/a/b/curious_node"));
        assert!(matches("/curious_node", "/curious_node") && !matches("/curious_node", "/a/curious_node"));
        assert!(
            matches("/*/curious_node", "/a/curious_node") && !matches("/*/curious_node", "/curious_node")
        );
        assert!(
            matches("/**/curious_node", "/curious_node") && matches("/**/curious_node", "/a/b/curious_node")
        );
        assert!(!matches("/other", "/curious_node"));
    }

    #[test]
    fn what_is_no_file_of_parameters_is_refused_with_its_line() {
        let error = |text| entries(text).unwrap_err();
        let example = "as in `curious_node: {ros__parameters: {resolution: 0.05}}`";
        assert_eq!(
            error("curious_node:\n  resolution: 0.1\n"),
            (2, format!("`/curious_node/resolution` must be a table with `ros__parameters`, {example}"))
        );
        assert_eq!(
            error("ros__parameters: {a: 1}").1,
            format!("`ros__parameters` must be below a node, {example}")
        );
        assert_eq!(error("- 1").1, format!("this must be a table with `ros__parameters`, {example}"));
        let unclosed = "unclosed bracket '['; parameters are written";
        assert_eq!(error("a:\n  b: [1,\nc: 2\n"), (2, format!("{unclosed} {example}")));
        assert_eq!(error("").1, format!("this must be a table with `ros__parameters`, {example}"));
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
