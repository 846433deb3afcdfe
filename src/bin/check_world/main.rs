//! Checks world files: describes them, draws them, and reports every error.

mod inspection;

use anyhow::bail;
use clap::Parser;
use evaluation::output::{make_folder, say, write_file};
use inspection::{Content, Inspection, as_world_file, inspect};
use interfaces::printable;
use std::collections::BTreeSet;
use std::io::{stderr, stdout};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use viewer::pictures::draw_plan;

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
        check_world --toml lab.world               convert a Stage world to lab.world.toml, for four_rooms\n\n\
        Exit codes: 0 all files are valid (with or without warnings), 1 a file cannot be written, 2 a file is \
        invalid."
)]
struct Args {
    /// World files, or names of shipped worlds
    #[arg(required = true, value_name = "FILE|NAME")]
    files: Vec<String>,

    /// Draw each valid world to FILE.png
    #[arg(long)]
    png: bool,

    /// Convert each valid Stage world to a world file, FILE.toml
    #[arg(long)]
    toml: bool,

    /// The folder for the written files; created if it does not exist
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
}

fn main() -> ExitCode {
    let args = Args::parse();
    let (mut code, mut written) = (ExitCode::SUCCESS, BTreeSet::new());
    for file in &args.files {
        let inspection = inspect(file);
        report(&inspection);
        let Some(content) = &inspection.content else {
            code = ExitCode::from(2);
            continue;
        };
        if let Err(error) = write(content, file, &args, &mut written) {
            say(stderr(), format_args!("error: {}", printable(&format!("{error:#}"))));
            return ExitCode::FAILURE;
        }
    }
    code
}

fn report(inspection: &Inspection) {
    for message in inspection.warnings.iter().chain(&inspection.errors) {
        say(stderr(), format_args!("{message}\n"));
    }
    match &inspection.content {
        Some(Content { kind, description, lines, scene }) => {
            say(stdout(), format_args!("{}: valid, a {kind} named `{}`", inspection.file, scene.title));
            if !description.is_empty() {
                let words: Vec<&str> = description.split_whitespace().collect();
                say(stdout(), format_args!("  {}", printable(&words.join(" "))));
            }
            for (name, what) in lines {
                say(stdout(), format_args!("  {name:<9} {what}"));
            }
        }
        None => {
            let errors = inspection.error_count;
            let plural = if errors == 1 { "" } else { "s" };
            say(stdout(), format_args!("{}: invalid, {errors} error{plural}", inspection.file));
        }
    }
}

/// Writes the picture and the world file. Their names are the name of the input with one more extension: with
/// the extension replaced, the picture could overwrite the floor plan that the world file uses.
fn write(content: &Content, file: &str, args: &Args, written: &mut BTreeSet<PathBuf>) -> anyhow::Result<()> {
    let name = Path::new(file).file_name().unwrap_or_default();
    let mut path_with = |ending: &str| {
        let mut name = name.to_owned();
        name.push(ending);
        let path = args.out.join(name);
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
        say(stdout(), format_args!("  picture   {}", printable(&picture.display().to_string())));
    }
    if args.toml {
        let Some(text) = as_world_file(file) else {
            say(stdout(), "  world     not written: only Stage worlds can be converted");
            return Ok(());
        };
        let world_file = path_with(".toml")?;
        write_file(&world_file, |to| to.write_all(text.as_bytes()))?;
        say(stdout(), format_args!("  world     {}", printable(&world_file.display().to_string())));
        if content.scene.robots.iter().filter(|robot| robot.is_driven).count() != 1 {
            say(
                stdout(),
                "            to use the file with four_rooms, give exactly one robot `kind = \"driven\"`",
            );
        }
    }
    Ok(())
}
