//! Rendering without a window: pictures go to files, progress goes to standard error, and figures come at the end.

pub mod info;
pub mod merge;

mod files;
mod frames;
mod keeping;
mod part;
mod picture;
mod planning;
mod progress;
mod studio;
mod summary;

pub use frames::render_frames;
pub use part::render_part;
pub use planning::plan;
pub use studio::{Event, Studio};

use crate::backends;
use crate::cli::terminal::{print, print_beside, write_json};
use crate::cli::{BatchOptions, JsonTarget};
use crate::job::recipe::{Recipe, file};
use crate::job::saved;
use crate::scene::builtin::BuiltinScene;
use crate::stages::Stage;
use crate::system::console;
use crate::system::failure::Failure;
use crate::system::files::{STANDARD, ShownPath, check_replaceable, check_writable, write_text};
use crate::system::interrupt::Interrupt;
use anyhow::Context;
use picture::Picture;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use summary::Envelope;

/// Renders and writes everything that the options ask for.
///
/// # Errors
/// [`Failure::Input`] if nothing was rendered or written; [`Failure::BrokeOff`] if a render failed but its samples
/// are in its files; [`Failure::Run`] otherwise.
pub fn run(options: BatchOptions) -> Result<ExitCode, Failure> {
    check_before(&options)?;
    let mut pictures = options.renders.iter().map(Picture::lock).collect::<Result<Vec<_>, _>>()?;
    for picture in &mut pictures {
        if let Some(path) = &picture.render.resume {
            picture.resumed = Some(saved::resume(path, &picture.render.job).map_err(Failure::input)?);
        }
    }
    render_all(&options, pictures)
}

/// Renders the pictures, whose files are locked.
fn render_all(options: &BatchOptions, mut pictures: Vec<Picture>) -> Result<ExitCode, Failure> {
    pictures.iter_mut().try_for_each(Picture::check)?;
    let interrupt = Interrupt::install().map_err(Failure::Run)?;
    let mut studio = Studio::open(&options.backend, &interrupt)?;
    if let (Some(path), [only]) = (&options.save_scene, options.renders.as_slice()) {
        write_text(path, &file::to_toml(&only.recipe)).map_err(Failure::run)?;
    }
    let has_stdout = options.renders.iter().any(|render| render.out == Path::new(STANDARD));
    let beside = if has_stdout { Some(&JsonTarget::StandardOutput) } else { options.json.as_ref() };
    let mut summaries = Vec::new();
    let (mut failure, mut printed) = (None, Ok(()));
    for picture in pictures {
        let (summary, outcome) = picture.render(options, &mut studio, &interrupt);
        // Render the pictures even if the figures cannot be printed.
        printed = printed.and(print_beside(beside, &format!("{summary}\n")));
        summaries.push(summary.json());
        failure = outcome.err();
        if failure.is_some() || interrupt.is_set() {
            break;
        }
    }
    let figures = printed.and(write_figures(options, summaries));
    ended(failure, figures, &interrupt)
}

fn write_figures(options: &BatchOptions, mut summaries: Vec<serde_json::Value>) -> anyhow::Result<()> {
    let Some(target) = &options.json else { return Ok(()) };
    let content = match (&options.directory, summaries.pop()) {
        (None, Some(only)) => only,
        (_, last) => {
            summaries.extend(last);
            serde_json::json!({ "stages": summaries })
        }
    };
    write_json(&Envelope::of(content), target)
}

/// The result of a run. `figures` is the outcome of printing and writing its figures.
fn ended(
    failure: Option<Failure>,
    figures: anyhow::Result<()>,
    interrupt: &Interrupt,
) -> Result<ExitCode, Failure> {
    match (failure, figures) {
        (Some(failure), _) => Err(failure),
        (None, figures) if interrupt.is_set() => {
            if let Err(error) = figures {
                console::note(&format!("error: {error:#}"));
            }
            Ok(interrupt.exit_code())
        }
        (None, figures) => figures.map(|()| ExitCode::SUCCESS).map_err(Failure::Run),
    }
}

/// Writes a scene file.
///
/// # Errors
/// [`Failure::Input`] if the file cannot be written, [`Failure::Run`] if standard output cannot.
pub fn save_scene(recipe: &Recipe, path: &Path) -> Result<ExitCode, Failure> {
    write_text(path, &file::to_toml(recipe)).map_err(Failure::input)?;
    let beside = (path == Path::new(STANDARD)).then_some(&JsonTarget::StandardOutput);
    print_beside(beside, &format!("wrote {}\n", path.shown())).map_err(Failure::Run)?;
    Ok(ExitCode::SUCCESS)
}

/// Checks everything that could otherwise fail after rendering.
fn check_before(options: &BatchOptions) -> Result<(), Failure> {
    if let Some(directory) = &options.directory {
        create_directory(directory)?;
    }
    let pictures = options.renders.iter().flat_map(|render| [Some(&render.out), render.checkpoint.as_ref()]);
    let scene = options.save_scene.as_ref();
    let json = options.json.as_ref().and_then(JsonTarget::file);
    for path in pictures.chain([scene]).flatten().map(PathBuf::as_path).chain(json) {
        let check = if files::is_film(path) { check_replaceable } else { check_writable };
        check(path).map_err(Failure::input)?;
    }
    options.renders.iter().try_for_each(|render| render.job.check_memory(1)).map_err(Failure::input)
}

fn create_directory(directory: &Path) -> Result<(), Failure> {
    let context = || format!("cannot create the directory {}; choose another with --out", directory.shown());
    let created = if directory.as_os_str().is_empty() { Ok(()) } else { std::fs::create_dir_all(directory) };
    created.with_context(context).map_err(Failure::Input)
}

/// Prints the scenes, stages and devices to choose from.
///
/// # Errors
/// [`Failure::Run`] if standard output cannot be written.
pub fn list() -> Result<ExitCode, Failure> {
    let (scenes, stages) = (BuiltinScene::ALL.iter(), Stage::ALL.iter());
    let names = scenes.clone().map(|scene| scene.name).chain(stages.clone().map(|stage| stage.id));
    let width = names.map(str::len).max().unwrap_or(0);
    let mut lines = vec!["Scenes (--scene)".to_owned()];
    lines.extend(scenes.map(|scene| format!("  {:<width$} {}", scene.name, scene.about)));
    lines.push("\nStages (--stage)".to_owned());
    lines.extend(stages.map(|stage| format!("  {:<width$} {:>5}  {}", stage.id, stage.section, stage.title)));
    lines.push("\nDevices (--device)".to_owned());
    lines.extend(backends::list().into_iter().map(|backend| {
        let note = if backend.is_auto { " (auto)" } else { "" };
        format!("  {:<width$} {}{note}", backend.device, backend.about)
    }));
    print(&(lines.join("\n") + "\n")).map_err(Failure::Run)?;
    Ok(ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{RenderOptions, Request, parse};
    use std::sync::atomic::Ordering;

    /// The options of a batch render of 4x3 pixels with these `flags`.
    pub(super) fn batch(flags: &[&str]) -> BatchOptions {
        let arguments = ["weekender", "--batch", "--size", "4x3", "--progress", "off"];
        let arguments = arguments.into_iter().chain(flags.iter().copied());
        let Request::Batch(options) = parse(arguments.map(Into::into)).unwrap() else { panic!("{flags:?}") };
        *options
    }

    /// The options of its picture.
    pub(super) fn options(flags: &[&str]) -> RenderOptions {
        batch(flags).renders.remove(0)
    }

    #[test]
    fn exit_code_precedence() {
        let no_space = || Err(anyhow::anyhow!("no space"));
        for (is_set, code) in [(false, ExitCode::SUCCESS), (true, ExitCode::from(130))] {
            let interrupt = Interrupt::unheard();
            interrupt.flag().store(is_set, Ordering::Relaxed);
            let failure = Failure::BrokeOff(anyhow::anyhow!("it broke"));
            assert!(matches!(ended(Some(failure), no_space(), &interrupt), Err(Failure::BrokeOff(_))));
            assert_eq!(ended(None, Ok(()), &interrupt).unwrap(), code);
            assert_eq!(ended(None, no_space(), &interrupt).is_ok(), is_set);
        }
    }
}
