//! Which crate may depend on which.

use crate::workspace::{needs, packages};

/// Every crate, and the crates of the workspace that it may depend on.
const ALLOWED: &[(&str, &str)] = &[
    ("interfaces", ""),
    ("files", ""),
    ("calendar", "interfaces"),
    ("sim", "interfaces calendar"),
    ("worldfile", "interfaces files calendar sim"),
    ("stage", "interfaces sim worldfile"),
    ("mapper", "interfaces"),
    ("localizer", "interfaces mapper"),
    ("ros", "interfaces"),
    ("logs", "interfaces files ros"),
    ("agent", "interfaces mapper"),
    ("controller", "interfaces"),
    ("robot", "interfaces files calendar mapper localizer agent controller"),
    ("survey", "interfaces mapper localizer logs robot"),
    ("results", "interfaces files mapper"),
    ("evaluation", "interfaces calendar sim mapper localizer agent controller robot results draw"),
    (
        "reports",
        "interfaces files calendar sim worldfile mapper agent robot results draw cli evaluation curious",
    ),
    ("environments", "interfaces sim worldfile evaluation draw"),
    (
        "python",
        "interfaces files sim worldfile stage mapper localizer logs agent robot survey evaluation environments draw",
    ),
    ("draw", "interfaces files mapper agent robot results"),
    ("viewer", "interfaces files mapper localizer agent robot results draw"),
    ("cli", "interfaces files mapper robot ros results"),
    ("owner", "interfaces files mapper controller robot logs survey results draw viewer cli"),
    (
        "curious",
        "interfaces files calendar sim worldfile stage mapper agent controller robot results evaluation draw viewer cli",
    ),
    (
        "ros2",
        "interfaces files sim worldfile mapper localizer ros logs agent controller robot results survey cli",
    ),
    // No part of the product: no other crate may use it.
    ("studies", "interfaces calendar sim worldfile mapper controller agent robot draw evaluation reports"),
];

/// Packages that only these crates may have as a dependency.
const RESERVED: &[(&str, &[&str])] =
    &[("rerun", &["viewer"]), ("rapier2d", &["sim"]), ("ros2-client", &["ros2"])];

/// The crates that may need Rerun.
const WITH_RERUN: [&str; 3] = ["viewer", "owner", "curious"];

#[test]
fn every_crate_uses_only_what_it_may() {
    let packages = packages();
    let is_ours = |name: &String| packages.iter().any(|package| package.name == *name);
    let mut errors = Vec::new();
    for package in &packages {
        let Some((_, allowed)) = ALLOWED.iter().find(|(name, _)| *name == package.name) else {
            errors.push(format!("{} is not in the list of crates", package.name));
            continue;
        };
        let ours = package.dependencies.iter().filter(|name| is_ours(name));
        let forbidden = ours.filter(|name| !allowed.split(' ').any(|allowed| allowed == **name));
        errors.extend(forbidden.map(|name| format!("{} must not use {name}", package.name)));
        for (name, users) in RESERVED {
            if package.dependencies.iter().any(|other| other == name)
                && !users.contains(&package.name.as_str())
            {
                errors.push(format!("{} must not use {name}: only {} may", package.name, users.join(", ")));
            }
        }
    }
    assert!(errors.is_empty(), "{}", errors.join("\n"));
}

#[test]
fn nothing_uses_the_studies() {
    for package in packages() {
        let mut all = package.dependencies.iter().chain(&package.of_tests);
        assert!(all.all(|name| name != "studies"), "{} must not use studies", package.name);
    }
}

#[test]
fn only_the_viewer_and_the_programs_need_rerun() {
    for (name, _) in ALLOWED.iter().filter(|(name, _)| !WITH_RERUN.contains(name)) {
        let needs = needs(name);
        assert_eq!(needs[0], *name);
        let rerun: Vec<&String> =
            needs.iter().filter(|name| *name == "rerun" || name.starts_with("re_")).collect();
        assert!(rerun.is_empty(), "{name} needs {rerun:?}");
    }
    assert!(needs("curious").iter().any(|name| name == "rerun"), "the test sees no rerun anywhere");
}

#[test]
fn a_robot_owner_builds_no_simulator_and_a_simulation_no_logs() {
    for (name, unneeded) in [
        ("owner", &["sim", "worldfile", "rapier2d", "evaluation", "reports"][..]),
        ("curious", &["survey", "logs"]),
    ] {
        let needs = needs(name);
        let found: Vec<_> =
            unneeded.iter().filter(|name| needs.iter().any(|needed| needed == *name)).collect();
        assert!(found.is_empty(), "{name} needs {found:?}");
    }
}
