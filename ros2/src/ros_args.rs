//! The arguments that every node of ROS has: `--ros-args -p name:=value -r from:=to --params-file FILE`.

use crate::params_file;
use crate::value::Given;
use anyhow::{Context, anyhow, bail};
use std::ffi::OsString;
use std::path::Path;

/// What `--ros-args` says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RosArgs {
    /// The parameters in the order of the command line, and of the lines in a file.
    parameters: Vec<Given>,
    /// The files of parameters.
    files: Vec<String>,
    /// The names that are replaced: for which node, from and to.
    pub remaps: Vec<(Option<String>, String, String)>,
}

impl RosArgs {
    /// Takes the arguments of ROS out of a command line. The other ones are returned.
    ///
    /// # Errors
    ///
    /// When an argument after `--ros-args` is not valid.
    pub fn split(all: impl IntoIterator<Item = OsString>) -> anyhow::Result<(Vec<OsString>, Self)> {
        let text = |argument: OsString| {
            argument
                .into_string()
                .map_err(|other| anyhow!("`{}` after --ros-args is not valid UTF-8", other.to_string_lossy()))
        };
        let (mut others, mut ros) = (Vec::new(), Self::default());
        let mut all = all.into_iter();
        while let Some(argument) = all.next() {
            if argument != "--ros-args" {
                others.push(argument);
                continue;
            }
            let mut next = || all.next().map(text).transpose();
            while let Some(flag) = next()?.filter(|flag| flag != "--") {
                // Launch files write it again before each group of arguments.
                if flag != "--ros-args" {
                    ros.take(&flag, &mut next)?;
                }
            }
        }
        Ok((others, ros))
    }

    fn take(
        &mut self,
        flag: &str,
        next: impl FnOnce() -> anyhow::Result<Option<String>>,
    ) -> anyhow::Result<()> {
        match flag {
            "-p" | "--param" => {
                let (node, name, value) = rule(flag, next()?, "name:=value")?;
                // The name of a node without its namespace.
                let nodes =
                    node.map_or("/**".to_owned(), |node| format!("/**/{}", node.trim_start_matches('/')));
                let value = Some(params_file::value_of(&value));
                self.parameters.push(Given { nodes, name, value, place: None });
            }
            "--params-file" => {
                let file = next()?.with_context(|| format!("{flag} needs a file"))?;
                self.parameters.extend(params_file::read(Path::new(&file))?);
                self.files.push(file);
            }
            "-r" | "--remap" => {
                let (node, from, to) = rule(flag, next()?, "from:=to")?;
                self.remaps.push((node, from, to));
            }
            // How a node logs is not a matter of this project's nodes: they write sentences to the error output.
            "--log-level" | "--log-config-file" | "-e" | "--enclave" => {
                next()?.with_context(|| format!("{flag} needs a value"))?;
            }
            _ if flag.starts_with("--enable-") || flag.starts_with("--disable-") => {}
            _ => bail!(
                "`{flag}` after --ros-args is not known: there are -p name:=value, -r from:=to, --params-file FILE, and -- at \
                 the end"
            ),
        }
        Ok(())
    }

    /// The values for a node with this name and namespace, in their order: later ones replace earlier ones.
    pub fn parameters_of<'a>(&'a self, full_name: &'a str) -> impl Iterator<Item = &'a Given> {
        self.parameters.iter().filter(|given| params_file::matches(&given.nodes, full_name))
    }

    /// The files that have no parameter for a node: the name of the node in them is probably wrong.
    pub fn files_without(&self, full_name: &str) -> Vec<&str> {
        let has = |file: &str| {
            self.parameters_of(full_name).any(|given| given.place.as_ref().is_some_and(|place| place == file))
        };
        self.files.iter().map(String::as_str).filter(|file| !has(file)).collect()
    }

    /// What a name of a node is replaced by.
    pub fn remapped(&self, node: &str, is_from: impl Fn(&str) -> bool) -> Option<&str> {
        let is_for = |of: &Option<String>| of.as_ref().is_none_or(|of| of.trim_start_matches('/') == node);
        let first = self.remaps.iter().find(|(of, from, _)| is_for(of) && is_from(from));
        first.map(|(_, _, to)| to.as_str())
    }
}

/// Splits `node:left:=right`, where the node may be missing.
fn rule(
    flag: &str,
    text: Option<String>,
    expected: &'static str,
) -> anyhow::Result<(Option<String>, String, String)> {
    let text = text.with_context(|| format!("{flag} needs {expected}"))?;
    let invalid = || format!("`{text}` after {flag} must be {expected}");
    let (left, right) = text.split_once(":=").with_context(invalid)?;
    let (node, left) = match left.split_once(':') {
        Some((node, left)) => (Some(node.to_owned()), left),
        None => (None, left),
    };
    if left.is_empty() {
        bail!(invalid());
    }
    Ok((node, left.to_owned(), right.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::value::Value;

    fn split(line: &str) -> anyhow::Result<(Vec<OsString>, RosArgs)> {
        RosArgs::split(line.split_whitespace().map(OsString::from))
    }

    #[test]
    fn arguments_of_ros_are_taken_out() {
        let line = "node --state s --ros-args -p resolution:=0.1 -r scan:=/front --log-level info -- --mode map \
                    --ros-args -r __ns:=/robot -p other:mode:=explore --param mode:=map";
        let (others, ros) = split(line).unwrap();
        assert_eq!(others, ["node", "--state", "s", "--mode", "map"]);
        let parameters = |node| {
            ros.parameters_of(node).map(|given| (given.name.clone(), given.value.clone())).collect::<Vec<_>>()
        };
        let [resolution, mode] = [("resolution", Value::Float(0.1)), ("mode", Value::Text("map".into()))]
            .map(|(name, value)| (name.to_owned(), Some(value)));
        assert_eq!(parameters("/robot/node"), [resolution, mode]);
        assert_eq!(parameters("/robot/other").len(), 3);
        assert_eq!(ros.remapped("node", |from| from == "scan"), Some("/front"));
        assert_eq!(ros.remapped("node", |from| from == "__ns"), Some("/robot"));
        assert_eq!(ros.remapped("node", |from| from == "map"), None);
    }

    /// As `launch_ros` starts nodes.
    #[test]
    fn the_flag_may_be_repeated() {
        let launched = "node --ros-args --log-level info --ros-args -r __node:=foo --ros-args";
        assert_eq!(
            split(launched).unwrap(),
            split("node --ros-args --log-level info -r __node:=foo").unwrap()
        );
        assert_eq!(split(launched).unwrap().1.remaps.len(), 1);
    }

    #[test]
    fn invalid_arguments_are_named() {
        let error = |line| split(line).unwrap_err().to_string();
        assert_eq!(error("--ros-args -p"), "-p needs name:=value");
        assert_eq!(error("--ros-args --params-file"), "--params-file needs a file");
        let missing = "--ros-args --params-file none/missing.yaml";
        assert!(error(missing).starts_with("cannot read the parameters in none/missing.yaml: "));
        assert_eq!(error("--ros-args -r scan"), "`scan` after -r must be from:=to");
        assert_eq!(error("--ros-args -p :=5"), "`:=5` after -p must be name:=value");
        insta::assert_snapshot!(error("--ros-args --mode map"), @"`--mode` after --ros-args is not known: there are -p name:=value, -r from:=to, --params-file FILE, and -- at the end");
    }

    #[cfg(unix)]
    #[test]
    fn arguments_need_not_be_text() {
        use std::os::unix::ffi::OsStringExt;
        let bytes = || OsString::from_vec(b"\xff.state".to_vec());
        let line = ["node".into(), "--state".into(), bytes()];
        assert_eq!(RosArgs::split(line.clone()).unwrap().0, line);
        for before in [vec![], vec!["-p"], vec!["--params-file"], vec!["--"]] {
            let line = ["--ros-args"].into_iter().chain(before.clone()).map(Into::into).chain([bytes()]);
            let split = RosArgs::split(line).map(|(own, _)| own).map_err(|error| error.to_string());
            let refused = Err("`\u{fffd}.state` after --ros-args is not valid UTF-8".to_owned());
            assert_eq!(split, if before == ["--"] { Ok(vec![bytes()]) } else { refused });
        }
    }
}
