use super::*;
use crate::RosArgs;
use std::io::Write;

#[test]
fn every_parameter_has_a_name_a_value_and_a_slot() {
    let list = Parameters::default().list();
    assert_eq!(list.len(), 37);
    let mut set = Parameters { seed: 5, mode: Mode::Explore, ..Parameters::default() };
    for (name, value) in &list {
        set.set(name, value).unwrap();
    }
    assert_eq!(set, Parameters::default());
    set.check().unwrap();
}

#[test]
fn invalid_parameters_are_named() {
    for (name, value, says) in [
        ("resolutoin", "1", "there is no parameter `resolutoin`; there are mode, "),
        ("resolution", "fine", "the parameter `resolution` must be a number, not `fine`"),
        ("resolution", "0", "node setting `resolution` must be from 0.005 to 1, not 0"),
        ("mode", "localization", "the parameter `mode` must be map or explore, not `localization`"),
        ("lost_after", "-1", "node setting `lost_after` must be from 0 to 3600, not -1"),
        ("base_frame", "", "the parameter `base_frame` must be the name of a frame, not ``"),
        (
            "transform_publish_period",
            "0.001",
            "node setting `transform_publish_period` must be 0, or from 0.005 to 10, not 0.001",
        ),
    ] {
        let mut parameters = Parameters::default();
        let set = parameters.set(name, &crate::params_file::value_of(value));
        let error = set.and_then(|()| parameters.check()).unwrap_err().to_string();
        assert!(error.starts_with(says), "{error}");
    }
}

/// The file that launch files pass has every parameter, with its default.
#[test]
fn the_shipped_file_has_all_parameters_with_their_defaults() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("config/params.yaml");
    let given = crate::params_file::read(&path).unwrap();
    let mut names: Vec<&str> = given.iter().map(|given| given.name.as_str()).collect();
    let list = Parameters::default().list();
    let mut known: Vec<&str> = list.iter().map(|(name, _)| name.as_str()).collect();
    names.sort_unstable();
    known.sort_unstable();
    assert_eq!(names, known);
    let mut parameters = Parameters { seed: 5, resolution_m: 0.2, ..Parameters::default() };
    parameters.set_all(&given).unwrap();
    assert_eq!(parameters, Parameters::default());
}

/// The parameters of `/robot1/curious_node` with a file and arguments after it.
fn set_by_file(text: &str, then: &[&str]) -> Result<Parameters, String> {
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
    let parameters = set_by_file(text, &["-p", "seed:=9"]).unwrap();
    let expected = Parameters { resolution_m: 0.02, seed: 9, use_sim_time: true, ..Parameters::default() };
    assert_eq!(parameters, expected);
}

#[test]
fn what_is_wrong_is_named_with_its_file() {
    let error = |parameters: &str| {
        set_by_file(&format!("/robot1/curious_node:\n  ros__parameters:\n    {parameters}\n"), &[])
            .unwrap_err()
    };
    assert_eq!(error("seed: 0.5"), "FILE: the parameter `seed` must be a whole number, not `0.5`");
    assert_eq!(error("seed: [1, 2]"), "FILE: the parameter `seed` must be one value, not a list or nothing");
    assert!(error("sede: 1").starts_with("FILE: there is no parameter `sede`; there are mode, "));
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

#[test]
fn strategies_have_names() {
    let policy = |strategy: &str| {
        let parameters = Parameters { strategy: strategy.to_owned(), ..Parameters::default() };
        assert_eq!(parameters.check().is_ok(), parameters.policy().is_ok());
        parameters.policy().map(|policy| policy.name()).map_err(|error| error.to_string())
    };
    assert_eq!(["", "recency"].map(|name| policy(name).unwrap()), ["curious", "recency"]);
    let error = policy("clever").unwrap_err();
    assert!(error.starts_with("the parameter `strategy` must be one of curious, recency, "), "{error}");
    assert!(error.ends_with(", not `clever`"), "{error}");
}
