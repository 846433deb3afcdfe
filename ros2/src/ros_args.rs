//! The arguments that every node of ROS has: `--ros-args -p name:=value -r from:=to`.

use crate::value::Value;

/// The error for arguments after `--ros-args`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RosArgsError {
    /// An argument needs another one.
    #[error("{0} needs {1}")]
    Missing(String, &'static str),
    /// The text after `-p` or `-r` has no `:=`.
    #[error("`{text}` after {flag} must be {expected}")]
    Rule {
        /// The argument before it.
        flag: String,
        /// The text.
        text: String,
        /// What would be valid.
        expected: &'static str,
    },
    /// The argument is not known.
    #[error("`{0}` after --ros-args is not known: there are -p name:=value, -r from:=to, and -- at the end")]
    Unknown(String),
}

/// What `--ros-args` says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RosArgs {
    /// The parameters in the order of the command line: for which node (`None`: for all), name and value.
    pub parameters: Vec<(Option<String>, String, Value)>,
    /// The names that are replaced: for which node, from and to.
    pub remaps: Vec<(Option<String>, String, String)>,
}

impl RosArgs {
    /// Takes the arguments of ROS out of a command line. The other ones are returned.
    ///
    /// # Errors
    ///
    /// When an argument after `--ros-args` is not valid.
    pub fn split(all: impl IntoIterator<Item = String>) -> Result<(Vec<String>, Self), RosArgsError> {
        let (mut others, mut ros) = (Vec::new(), Self::default());
        let mut all = all.into_iter();
        while let Some(argument) = all.next() {
            if argument != "--ros-args" {
                others.push(argument);
                continue;
            }
            while let Some(flag) = all.next() {
                if flag == "--" {
                    break;
                }
                ros.take(&flag, || all.next())?;
            }
        }
        Ok((others, ros))
    }

    fn take(&mut self, flag: &str, next: impl FnOnce() -> Option<String>) -> Result<(), RosArgsError> {
        match flag {
            "-p" | "--param" => {
                let (node, name, value) = rule(flag, next(), "name:=value")?;
                self.parameters.push((node, name, Value::parse(&value)));
            }
            "-r" | "--remap" => {
                let (node, from, to) = rule(flag, next(), "from:=to")?;
                self.remaps.push((node, from, to));
            }
            // How a node logs is not a matter of this project's nodes: they write sentences to the error output.
            "--log-level" | "--log-config-file" | "-e" | "--enclave" => {
                next().ok_or_else(|| RosArgsError::Missing(flag.to_owned(), "a value"))?;
            }
            _ if flag.starts_with("--enable-") || flag.starts_with("--disable-") => {}
            _ => return Err(RosArgsError::Unknown(flag.to_owned())),
        }
        Ok(())
    }

    /// The values for a node, in their order: later ones replace earlier ones.
    pub fn parameters_of<'a>(&'a self, node: &'a str) -> impl Iterator<Item = (&'a str, &'a Value)> {
        let mine = move |(of, ..): &&(Option<String>, String, Value)| is_for(of, node);
        self.parameters.iter().filter(mine).map(|(_, name, value)| (name.as_str(), value))
    }

    /// What a name of a node is replaced by.
    pub fn remapped(&self, node: &str, is_from: impl Fn(&str) -> bool) -> Option<&str> {
        let first = self.remaps.iter().find(|(of, from, _)| is_for(of, node) && is_from(from));
        first.map(|(_, _, to)| to.as_str())
    }
}

fn is_for(of: &Option<String>, node: &str) -> bool {
    of.as_ref().is_none_or(|of| of.trim_start_matches('/') == node)
}

/// Splits `node:left:=right`, where the node may be missing.
fn rule(
    flag: &str,
    text: Option<String>,
    expected: &'static str,
) -> Result<(Option<String>, String, String), RosArgsError> {
    let text = text.ok_or_else(|| RosArgsError::Missing(flag.to_owned(), expected))?;
    let invalid = || RosArgsError::Rule { flag: flag.to_owned(), text: text.clone(), expected };
    let (left, right) = text.split_once(":=").ok_or_else(invalid)?;
    let (node, left) = match left.split_once(':') {
        Some((node, left)) => (Some(node.to_owned()), left),
        None => (None, left),
    };
    if left.is_empty() {
        return Err(invalid());
    }
    Ok((node, left.to_owned(), right.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(line: &str) -> Result<(Vec<String>, RosArgs), RosArgsError> {
        RosArgs::split(line.split_whitespace().map(str::to_owned))
    }

    #[test]
    fn arguments_of_ros_are_taken_out() {
        let line = "node --state s --ros-args -p resolution:=0.1 -r scan:=/front --log-level info -- --mode map \
                    --ros-args -r __ns:=/robot -p other:mode:=explore --param mode:=map";
        let (others, ros) = split(line).unwrap();
        assert_eq!(others, ["node", "--state", "s", "--mode", "map"]);
        let parameters: Vec<_> = ros.parameters_of("node").collect();
        assert_eq!(parameters, [("resolution", &Value::Float(0.1)), ("mode", &Value::Text("map".into()))]);
        assert_eq!(ros.parameters_of("other").count(), 3);
        assert_eq!(ros.remapped("node", |from| from == "scan"), Some("/front"));
        assert_eq!(ros.remapped("node", |from| from == "__ns"), Some("/robot"));
        assert_eq!(ros.remapped("node", |from| from == "map"), None);
    }

    #[test]
    fn invalid_arguments_are_named() {
        let error = |line| split(line).unwrap_err().to_string();
        assert_eq!(error("--ros-args -p"), "-p needs name:=value");
        assert_eq!(error("--ros-args -r scan"), "`scan` after -r must be from:=to");
        assert_eq!(error("--ros-args -p :=5"), "`:=5` after -p must be name:=value");
        assert_eq!(
            error("--ros-args --mode map"),
            "`--mode` after --ros-args is not known: there are -p name:=value, -r from:=to, and -- at the end"
        );
    }
}
