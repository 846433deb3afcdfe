use super::*;

#[test]
fn every_parameter_has_a_name_a_value_and_a_slot() {
    let list = Parameters::default().list();
    assert_eq!(list.len(), 36);
    let mut set = Parameters { seed: 5, mode: Mode::Explore, ..Parameters::default() };
    for (name, value) in &list {
        set.set(name, value).unwrap();
    }
    assert_eq!(set, Parameters::default());
    set.check().unwrap();
}

#[test]
fn invalid_parameters_are_named() {
    let error = |name, value: &str| {
        let mut parameters = Parameters::default();
        let set = parameters.set(name, &crate::params_file::value_of(value));
        set.and_then(|()| parameters.check()).unwrap_err().to_string()
    };
    assert!(error("resolutoin", "1").starts_with("there is no parameter `resolutoin`; there are mode, "));
    assert_eq!(error("resolution", "fine"), "the parameter `resolution` must be a number, not `fine`");
    assert_eq!(error("resolution", "0"), "node setting `resolution` must be from 0.005 to 1, not 0");
    assert_eq!(
        error("mode", "localization"),
        "the parameter `mode` must be map or explore, not `localization`"
    );
    assert_eq!(error("lost_after", "-1"), "node setting `lost_after` must be from 0 to 3600, not -1");
    assert_eq!(error("base_frame", ""), "the parameter `base_frame` must be the name of a frame, not ``");
    assert_eq!(
        error("transform_publish_period", "0.001"),
        "node setting `transform_publish_period` must be 0, or from 0.005 to 10, not 0.001"
    );
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
