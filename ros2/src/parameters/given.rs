//! Parameters as the arguments of ROS and files give them.

use super::choices::Slot as _;
use super::{Parameters, invalid};
use crate::value::Given;
use anyhow::anyhow;

impl Parameters {
    /// Sets what is given, in its order. What a file gives to many nodes, and this node does not know, is not an error.
    ///
    /// # Errors
    ///
    /// As [`set`](Self::set), with the file and the line.
    pub fn set_all<'a>(&mut self, all: impl IntoIterator<Item = &'a Given>) -> anyhow::Result<()> {
        for given in all {
            let slot = self.slot(&given.name);
            if slot.is_err() && given.is_for_others_too() {
                continue;
            }
            let set = slot.and_then(|slot| match &given.value {
                Some(value) => slot.set(value).map_err(|expected| invalid(&given.name, expected, value)),
                None => {
                    Err(anyhow!("the parameter `{}` must be one value, not a list or nothing", given.name))
                }
            });
            set.map_err(|error| match &given.place {
                Some(place) => anyhow!("{place}: {error}"),
                None => error,
            })?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RosArgs;
    use std::io::Write;

    /// The parameters of `/robot1/curious_node` with a file and arguments after it.
    fn set(text: &str, then: &[&str]) -> Result<Parameters, String> {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(text.as_bytes()).unwrap();
        let path = file.path().to_str().unwrap();
        let line = ["--ros-args", "--params-file", path].into_iter();
        let (_, ros) = RosArgs::split(line.chain(then.iter().copied()).map(Into::into))
            .map_err(|error| error.to_string())?;
        let mut parameters = Parameters::default();
        let set = parameters.set_all(ros.parameters_of("/robot1/curious_node"));
        set.map_err(|error| error.to_string().replace(path, "FILE"))?;
        Ok(parameters)
    }

    #[test]
    fn a_file_sets_what_is_for_this_node_and_later_arguments_replace_it() {
        let text = "/**:\n  ros__parameters: {resolution: 0.1, use_sim_time: true, yaw_goal_tolerance: 0.1}\n\
                    /robot1/curious_node:\n  ros__parameters: {resolution: 0.02, seed: 5}\n\
                    /robot2/curious_node:\n  ros__parameters: {seed: 6, mode: drive}\n";
        let parameters = set(text, &["-p", "seed:=9"]).unwrap();
        let expected =
            Parameters { resolution_m: 0.02, seed: 9, use_sim_time: true, ..Parameters::default() };
        assert_eq!(parameters, expected);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_file_and_line() {
        let error = |parameters: &str| {
            set(&format!("/robot1/curious_node:\n  ros__parameters:\n    {parameters}\n"), &[]).unwrap_err()
        };
        assert_eq!(
            error("seed: 0.5"),
            "FILE, line 3: the parameter `seed` must be a whole number, not `0.5`"
        );
        assert_eq!(
            error("seed: [1, 2]"),
            "FILE, line 3: the parameter `seed` must be one value, not a list or nothing"
        );
        assert!(error("sede: 1").starts_with("FILE, line 3: there is no parameter `sede`; there are mode, "));
    }

    #[test]
    fn a_file_for_other_nodes_is_noticed() {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(b"other: {ros__parameters: {a: 1}}").unwrap();
        let path = file.path().to_str().unwrap();
        let line = ["--ros-args", "--params-file", path].map(Into::into);
        let (_, ros) = RosArgs::split(line).unwrap();
        assert_eq!(ros.files_without("/curious_node"), [path]);
        assert_eq!(ros.files_without("/other"), Vec::<&str>::new());
    }
}
