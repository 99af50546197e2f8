//! `weekender plan`: writes a plan and makes the commands for its parts.

use crate::cli::{PlanOptions, program};
use crate::film::Film;
use crate::job::plan::{Commands, Format, Plan, scripts};
use crate::progressive::describe::counted;
use crate::system::console;
use crate::system::failure::Failure;
use crate::system::files::{ShownPath, make_directory};
use crate::system::memory;
use crate::system::shell::{Shell, operand};
use std::process::ExitCode;

/// Writes the plan and makes its commands.
///
/// # Errors
/// [`Failure::Input`] if the plan cannot be written; [`Failure::Run`] if its commands cannot.
pub fn plan(options: &PlanOptions) -> Result<ExitCode, Failure> {
    let (recipe, job, manifest) = options.divided().map_err(Failure::Input)?;
    make_directory(&options.out).map_err(Failure::Input)?;
    let program = &options.program.clone().unwrap_or_else(program);
    let scripts = scripts(options.format, &manifest, program);
    let plan = Plan::write(&options.out, &recipe, &job, manifest, &scripts).map_err(Failure::Input)?;
    console::note(&about(&plan));
    let path = plan.path.to_string_lossy();
    let commands = Commands::new(program, &path, &plan.manifest);
    let lines: String = match (options.format, scripts.first()) {
        (Format::Make, _) => {
            Shell::HERE.line(["make", "-C", &operand(&options.out.to_string_lossy())]) + "\n"
        }
        (_, Some((first, _))) => {
            Shell::HERE.line(["sh", &operand(&plan.beside(first).to_string_lossy())]) + "\n"
        }
        (_, None) => {
            let parts = 0..plan.manifest.parts.len();
            parts.map(|part| commands.part(Shell::HERE, &part.to_string()) + "\n").collect()
        }
    };
    console::write_out(&lines).map_err(Failure::Run)?;
    if options.format == Format::Text {
        let result = options.out.join(&plan.manifest.result);
        console::note(&format!("then: {}", commands.merge(Shell::HERE, &result.to_string_lossy())));
    }
    Ok(ExitCode::SUCCESS)
}

/// The divided picture.
fn about(Plan { path, manifest, recipe, job }: &Plan) -> String {
    let settings = job.settings();
    let lengths = manifest.parts.iter().map(|part| part.samples[1] - part.samples[0]);
    let (parts, each) = (counted(manifest.parts.len() as u64, "part"), lengths.max().unwrap_or_default());
    let film = memory::words(Film::bytes(settings.width, settings.height, settings.half_count()));
    format!(
        "{}: {} of {}x{}, {parts} of at most {} per pixel, in blocks of {}; a part's film takes {film} of memory",
        path.shown(),
        recipe.name,
        settings.width,
        settings.height,
        counted(each, "sample"),
        manifest.block
    )
}
