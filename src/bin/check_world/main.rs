//! Says what is in world files, draws them, and tells all that is wrong with them.

mod inspection;

use anyhow::bail;
use clap::Parser;
use evaluation::output::{make_folder, say, write_file};
use inspection::{Content, Inspection, as_world_file, inspect};
use std::collections::BTreeSet;
use std::io::{stderr, stdout};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use viewer::pictures::draw_plan;

/// Checks world files: says what is in them, draws them, and tells everything that is wrong at once, but for what
/// hangs on something that is wrong.
///
/// It reads physics worlds and grid worlds (TOML), world files of the simulator Stage (.world) with all that
/// they include, and maps of ROS (map.yaml). What is in a file goes to the standard output, warnings and errors
/// to the error output.
#[derive(Clone, Debug, Parser)]
#[command(
    name = "check_world",
    version,
    max_term_width = 100,
    after_help = "Examples:\n  \
        check_world my_house.toml                  what is in it, or what is wrong with it\n  \
        check_world --png four_rooms two_blocks    shipped worlds, drawn to four_rooms.png, two_blocks.png\n  \
        check_world --png --out plans lab.world    a world of Stage, drawn to plans/lab.world.png\n  \
        check_world --toml lab.world               the same as a world file for four_rooms, lab.world.toml\n\n\
        Exit codes: 0 all are right (warnings or not), 1 a file cannot be written, 2 a file is wrong."
)]
struct Args {
    /// World files, or names of worlds that ship
    #[arg(required = true, value_name = "FILE|NAME")]
    files: Vec<String>,

    /// Draw each world that is right to FILE.png
    #[arg(long)]
    png: bool,

    /// Write each world of Stage that is right as a world file, FILE.toml
    #[arg(long)]
    toml: bool,

    /// The folder for what is drawn and written; made unless it exists
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
}

fn main() -> ExitCode {
    let args = Args::parse();
    let (mut code, mut written) = (ExitCode::SUCCESS, BTreeSet::new());
    for file in &args.files {
        let inspection = inspect(file);
        tell(&inspection);
        let Some(content) = &inspection.content else {
            code = ExitCode::from(2);
            continue;
        };
        if let Err(error) = leave(content, file, &args, &mut written) {
            say(stderr(), format_args!("error: {error:#}"));
            return ExitCode::FAILURE;
        }
    }
    code
}

fn tell(inspection: &Inspection) {
    for message in inspection.warnings.iter().chain(&inspection.errors) {
        say(stderr(), format_args!("{message}\n"));
    }
    match &inspection.content {
        Some(Content { kind, name, description, lines, .. }) => {
            say(stdout(), format_args!("{}: right, a {kind} called `{name}`", inspection.file));
            if !description.is_empty() {
                say(stdout(), format_args!("  {description}"));
            }
            for (name, what) in lines {
                say(stdout(), format_args!("  {name:<9} {what}"));
            }
        }
        None => {
            let errors = inspection.error_count;
            let many = if errors == 1 { "" } else { "s" };
            say(stdout(), format_args!("{}: wrong, {errors} error{many}", inspection.file));
        }
    }
}

/// Draws and writes what was asked for, to files that are called as the world's with another ending behind it:
/// in its place that could be the name of the picture that its walls come from.
fn leave(content: &Content, file: &str, args: &Args, written: &mut BTreeSet<PathBuf>) -> anyhow::Result<()> {
    let name = Path::new(file).file_name().unwrap_or_default();
    let mut place = |ending: &str| {
        let mut name = name.to_owned();
        name.push(ending);
        let path = args.out.join(name);
        if !written.insert(path.clone()) {
            bail!("two files would be written to {}; check them one by one, with --out", path.display());
        }
        make_folder(&args.out)?;
        Ok(path)
    };
    if args.png {
        let picture = place(".png")?;
        draw_plan(&picture, &content.scene)?;
        say(stdout(), format_args!("  picture   {}", picture.display()));
    }
    if args.toml {
        let Some(text) = as_world_file(file) else {
            say(stdout(), "  world     none written: only those of Stage can be");
            return Ok(());
        };
        let world_file = place(".toml")?;
        write_file(&world_file, |to| to.write_all(text.as_bytes()))?;
        say(stdout(), format_args!("  world     {}", world_file.display()));
        if content.scene.robots.iter().filter(|robot| robot.is_driven).count() != 1 {
            say(stdout(), "            for four_rooms give exactly one robot `kind = \"driven\"` there");
        }
    }
    Ok(())
}
