//! Checks world files: describes them, draws them, and reports every error.

mod inspection;

use anyhow::bail;
use clap::Parser;
use cli::flags::folder;
use cli::program::{Failure, start};
use cli::terminal::{print_lines, say};
use draw::pictures::draw_plan;
use files::{check_output, make_folder, write_file};
use inspection::{Content, Inspection, as_world_file, inspect};
use interfaces::printable;
use std::collections::BTreeSet;
use std::io::stderr;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Checks world files: describes them, draws them, and reports all errors at once, except errors that follow
/// from other errors.
///
/// The program reads physics worlds and grid worlds (TOML), Stage files (.world) with all the files that they
/// include, and ROS maps (map.yaml). Descriptions go to the standard output, warnings and errors to the error
/// output.
#[derive(Clone, Debug, Parser)]
#[command(
    name = "check_world",
    version,
    max_term_width = 100,
    after_help = "Examples:\n  \
        check_world my_house.toml                  describe the world, or report its errors\n  \
        check_world --png four_rooms two_blocks    draw shipped worlds to four_rooms.png, two_blocks.png\n  \
        check_world --png --out plans lab.world    draw a Stage world to plans/lab.world.png\n  \
        check_world --toml lab.world rooms-7       write lab.world.toml and rooms-7.toml, for four_rooms\n\n\
        Exit codes: 0 all files are valid (with or without warnings), 1 a file cannot be written, 2 a file is \
        invalid."
)]
struct Args {
    /// World files, or names of shipped worlds or of generated buildings (house-7, rooms-7)
    #[arg(required = true, value_name = "FILE|NAME")]
    files: Vec<String>,

    /// Draw each valid world to FILE.png
    #[arg(long)]
    png: bool,

    /// Write each valid Stage world or generated building as a world file, FILE.toml
    #[arg(long)]
    toml: bool,

    /// The folder for the written files; created if it does not exist
    #[arg(long, value_name = "DIR", default_value = ".", value_parser = folder())]
    out: PathBuf,
}

fn main() -> ExitCode {
    start(check)
}

/// Checks every file, and writes what is asked for. Standard output that cannot be written is an error at the end.
fn check(args: &Args) -> Result<ExitCode, Failure> {
    let endings = [(args.png, ".png"), (args.toml, ".toml")];
    for (_, ending) in endings.iter().filter(|(is_asked, _)| *is_asked) {
        args.files.iter().try_for_each(|file| check_output(&result(args, file, ending), None))?;
    }
    let (mut code, mut written, mut printed) = (ExitCode::SUCCESS, BTreeSet::new(), Ok(()));
    for file in &args.files {
        let inspection = inspect(file);
        for message in inspection.warnings.iter().chain(&inspection.errors) {
            say(stderr(), format_args!("{message}\n"));
        }
        let mut lines = describe(&inspection);
        let outcome = match &inspection.content {
            Some(content) => write(content, file, args, &mut written, &mut lines),
            None => {
                code = ExitCode::from(2);
                Ok(())
            }
        };
        printed = printed.and(print_lines(lines.join("\n")));
        outcome?;
    }
    printed?;
    Ok(code)
}

/// The content of a valid file, or the number of its errors, as lines.
fn describe(inspection: &Inspection) -> Vec<String> {
    let Inspection { file, content, error_count, .. } = inspection;
    let Some(Content { kind, description, lines, scene, .. }) = content else {
        let plural = if *error_count == 1 { "" } else { "s" };
        return vec![format!("{file}: invalid, {error_count} error{plural}")];
    };
    let first = format!("{file}: valid, a {kind} named `{}`", scene.title);
    let description = description.split_whitespace().collect::<Vec<_>>().join(" ");
    let second = (!description.is_empty()).then(|| format!("  {}", printable(&description)));
    let others = lines.iter().map(|(name, what)| format!("  {name:<9} {what}"));
    [first].into_iter().chain(second).chain(others).collect()
}

/// The file of a result. Its name is the name of the input with one more extension: with the extension
/// replaced, the picture could have the name of the floor plan that the world file uses.
fn result(args: &Args, file: &str, ending: &str) -> PathBuf {
    let mut name = Path::new(file).file_name().unwrap_or_default().to_owned();
    name.push(ending);
    args.out.join(name)
}

/// Writes the picture and the world file, and adds their names to the `lines` for the user.
fn write(
    content: &Content,
    file: &str,
    args: &Args,
    written: &mut BTreeSet<PathBuf>,
    lines: &mut Vec<String>,
) -> anyhow::Result<()> {
    let mut path_with = |ending: &str| {
        let path = result(args, file, ending);
        if !written.insert(path.clone()) {
            bail!(
                "two results would be written to {}; check the files one by one, with --out",
                path.display()
            );
        }
        make_folder(&args.out)?;
        Ok(path)
    };
    if args.png {
        let picture = path_with(".png")?;
        draw_plan(&picture, &content.scene)?;
        lines.push(format!("  picture   {}", printable(&picture.display().to_string())));
    }
    if args.toml {
        let Some(text) = as_world_file(file) else {
            lines.push("  world     not written: only Stage worlds and generated buildings can be".into());
            return Ok(());
        };
        let world_file = path_with(".toml")?;
        write_file(&world_file, |to| to.write_all(text.as_bytes()))?;
        lines.push(format!("  world     {}", printable(&world_file.display().to_string())));
        if content.scene.robots.iter().filter(|robot| robot.is_driven).count() != 1 {
            let hint =
                "            to use the file with four_rooms, give exactly one robot `kind = \"driven\"`";
            lines.push(hint.into());
        }
    }
    Ok(())
}
