//! The information of cargo about the workspace.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Libraries whose packages have another name than `curious-` and theirs: that name was taken, or is that of the programs.
const RENAMED: [(&str, &str); 2] = [("curious", "curious-robot"), ("robot", "curious-robot-loop")];

/// A crate of the workspace.
pub(crate) struct Package {
    /// The name of the library.
    pub(crate) name: String,
    /// Normal and build dependencies, by the name of the package.
    pub(crate) dependencies: Vec<String>,
    /// The dependencies of its tests, examples and benches.
    pub(crate) of_tests: Vec<String>,
    /// The name and the root file of the library and of each program.
    pub(crate) targets: Vec<(String, PathBuf)>,
}

pub(crate) fn packages() -> Vec<Package> {
    let metadata = cargo(&["metadata", "--format-version=1", "--no-deps"]);
    let metadata: Value = serde_json::from_str(&metadata).unwrap();
    list(&metadata, "packages").iter().map(package).collect()
}

fn package(package: &Value) -> Package {
    let name = short(&text(package, "name"));
    let (of_tests, of_users): (Vec<&Value>, _) =
        list(package, "dependencies").iter().partition(|dependency| dependency["kind"] == "dev");
    let [dependencies, of_tests] = [of_users, of_tests]
        .map(|all| all.iter().map(|dependency| short(&text(dependency, "name"))).collect());
    let is_product = |target: &&Value| ["lib", "bin"].iter().any(|kind| target["kind"][0] == *kind);
    let targets = list(package, "targets").iter().filter(is_product).map(|target| {
        let is_program = target["kind"][0] == "bin";
        let name = if is_program { format!("{name}/{}", text(target, "name")) } else { name.clone() };
        (name, PathBuf::from(text(target, "src_path")))
    });
    Package { dependencies, of_tests, targets: targets.collect(), name }
}

/// All packages that a crate needs to build, the crate itself included; without those of tests.
pub(crate) fn needs(package: &str) -> Vec<String> {
    let renamed = RENAMED.iter().find(|(short, _)| *short == package);
    let package = renamed.map_or_else(|| format!("curious-{package}"), |(_, name)| (*name).to_owned());
    let tree = cargo(&["tree", "-p", &package, "-e", "normal,build", "--prefix", "none", "--all-features"]);
    tree.lines().filter_map(|line| line.split_whitespace().next()).map(short).collect()
}

/// The name of a package of the workspace as its folder and its library have it; of another package, its name.
fn short(name: &str) -> String {
    let renamed = RENAMED.iter().find(|(_, package)| *package == name);
    renamed.map_or(name.strip_prefix("curious-").unwrap_or(name), |(short, _)| short).to_owned()
}

fn cargo(arguments: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO"));
    command.args(arguments).args(["--locked"]).current_dir(root());
    let output = command.output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "cargo {}: {errors}", arguments.join(" "));
    String::from_utf8(output.stdout).unwrap()
}

/// The folder of the workspace.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

fn text(value: &Value, key: &str) -> String {
    value[key].as_str().unwrap().to_owned()
}

fn list<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value[key].as_array().unwrap()
}
