//! Says what is in world files, draws them, and tells all that is wrong with them.

use clap::Parser;
use curious::inspection::{Content, Inspection, inspect};
use curious::output::{make_folder, say};
use curious::pictures::draw_plan;
use std::io::{stderr, stdout};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Checks world files: says what is in them, draws them, and tells everything that is wrong at once.
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
        check_world --png --out plans lab.world    a world of Stage, drawn to plans/lab.png\n\n\
        Exit codes: 0 all are right (warnings or not), 1 a picture cannot be written, 2 a file is wrong."
)]
struct Args {
    /// World files, or names of worlds that ship
    #[arg(required = true, value_name = "FILE|NAME")]
    files: Vec<String>,

    /// Draw each world that is right to NAME.png
    #[arg(long)]
    png: bool,

    /// The folder for the pictures; made unless it exists
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
}

fn main() -> ExitCode {
    let args = Args::parse();
    let mut code = ExitCode::SUCCESS;
    for file in &args.files {
        let inspection = inspect(file);
        tell(&inspection);
        let Some(content) = &inspection.content else {
            code = ExitCode::from(2);
            continue;
        };
        if args.png {
            match draw(content, file, &args.out) {
                Ok(picture) => say(stdout(), format_args!("  picture   {}", picture.display())),
                Err(error) => {
                    say(stderr(), format_args!("error: {error:#}"));
                    return ExitCode::FAILURE;
                }
            }
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
            let errors = inspection.errors.len();
            let many = if errors == 1 { "" } else { "s" };
            say(stdout(), format_args!("{}: wrong, {errors} error{many}", inspection.file));
        }
    }
}

/// Draws a world to a file that is called as the world's, in `folder`.
fn draw(content: &Content, file: &str, folder: &Path) -> anyhow::Result<PathBuf> {
    make_folder(folder)?;
    let name = Path::new(file).file_stem().unwrap_or_default();
    let picture = folder.join(name).with_extension("png");
    draw_plan(&picture, content)?;
    Ok(picture)
}
