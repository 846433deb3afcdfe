//! The names of a node, its topics and services: relative, absolute, private, remapped.

use crate::ros_args::RosArgs;
use anyhow::bail;

/// The names of a node.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Names {
    /// The name of the node.
    pub node: String,
    /// Its namespace.
    pub namespace: String,
}

impl Names {
    /// The names of a node with this default name, after the remapping of `__node` and `__ns`.
    ///
    /// # Errors
    ///
    /// When a name is not valid.
    pub fn new(default_node: &str, ros: &RosArgs) -> anyhow::Result<Self> {
        let special = |long: &str, short: &str| {
            ros.remapped(default_node, |from| from == long || from == short).map(str::to_owned)
        };
        let node = special("__node", "__name").unwrap_or_else(|| default_node.to_owned());
        let namespace = special("__ns", "__ns").unwrap_or_else(|| "/".to_owned());
        if node.contains('/') {
            bail!("`{node}` is not a valid name of a node: it must not contain a slash");
        }
        check("node", &node)?;
        if !namespace.starts_with('/') {
            bail!("`{namespace}` is not a valid name of a namespace: it must begin with a slash");
        }
        if namespace != "/" {
            check("namespace", &namespace)?;
        }
        Ok(Self { node, namespace })
    }

    /// The name with the namespace: `/robot1/curious_node`.
    pub fn full_name(&self) -> String {
        self.full(&self.node)
    }

    /// The full name of a topic or service: `scan` in the namespace, `/scan` as it is, `~/save_state` below the name of the
    /// node; after remapping.
    ///
    /// # Errors
    ///
    /// When the name, or what it is remapped to, is not valid.
    pub fn resolved(&self, kind: &str, name: &str, ros: &RosArgs) -> anyhow::Result<String> {
        let full = self.full(name);
        let to = ros.remapped(&self.node, |from| from == name || self.full(from) == full);
        let full = to.map_or(full, |to| self.full(to));
        check(kind, &full)?;
        Ok(full)
    }

    fn full(&self, name: &str) -> String {
        let namespace = self.namespace.trim_end_matches('/');
        match name.strip_prefix("~/") {
            Some(private) => format!("{namespace}/{}/{private}", self.node),
            None if name.starts_with('/') => name.to_owned(),
            None => format!("{namespace}/{name}"),
        }
    }
}

/// Checks the parts of a name between slashes.
fn check(kind: &str, name: &str) -> anyhow::Result<()> {
    for part in name.strip_prefix('/').unwrap_or(name).split('/') {
        let is_valid = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let why = if part.is_empty() {
            "a part of it is empty"
        } else if !part.chars().all(is_valid) {
            "it may contain letters without accents, digits and underscores"
        } else if part.starts_with(|c: char| c.is_ascii_digit()) {
            "a part of it begins with a digit"
        } else if part.contains("__") {
            "it contains two underscores in a row"
        } else {
            continue;
        };
        bail!("`{name}` is not a valid name of a {kind}: {why}");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ros(line: &str) -> RosArgs {
        let line = format!("--ros-args {line}");
        RosArgs::split(line.split_whitespace().map(Into::into)).unwrap().1
    }

    #[test]
    fn names_are_resolved_as_in_ros() {
        let plain = ros("");
        let names = Names::new("curious_node", &plain).unwrap();
        let resolved = |name| names.resolved("topic", name, &plain).unwrap();
        let found = ["scan", "/scan", "~/save_state"].map(resolved);
        assert_eq!(found, ["/scan", "/scan", "/curious_node/save_state"]);
        assert_eq!(names.namespace, "/");

        let ros = ros("-r __ns:=/robot -r __node:=mapper -r scan:=front/scan -r /tf:=tf -r map:=/map");
        let names = Names::new("curious_node", &ros).unwrap();
        let resolved = |name| names.resolved("topic", name, &ros).unwrap();
        assert_eq!(resolved("scan"), "/robot/front/scan");
        assert_eq!(resolved("/robot/scan"), "/robot/front/scan");
        assert_eq!(resolved("/tf"), "/robot/tf");
        assert_eq!(resolved("map"), "/map");
        assert_eq!(resolved("odom"), "/robot/odom");
        assert_eq!(resolved("~/save_state"), "/robot/mapper/save_state");
    }

    #[test]
    fn invalid_names_are_refused() {
        let error = |line: &str| {
            let ros = ros(line);
            let names = Names::new("curious_node", &ros);
            names.and_then(|names| names.resolved("topic", "scan", &ros)).unwrap_err().to_string()
        };
        assert_eq!(error("-r scan:=/a//b"), "`/a//b` is not a valid name of a topic: a part of it is empty");
        insta::assert_snapshot!(error("-r scan:=é"), @"`/é` is not a valid name of a topic: it may contain letters without accents, digits and underscores");
        insta::assert_snapshot!(error("-r scan:=/2nd"), @"`/2nd` is not a valid name of a topic: a part of it begins with a digit");
        insta::assert_snapshot!(error("-r __ns:=robot"), @"`robot` is not a valid name of a namespace: it must begin with a slash");
        insta::assert_snapshot!(error("-r __node:=a/b"), @"`a/b` is not a valid name of a node: it must not contain a slash");
    }
}
