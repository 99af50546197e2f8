//! Rendering without a window: pictures go to files, progress goes to standard error, and figures come at the end.

pub mod info;
pub mod merge;

mod files;
mod frames;
mod keeping;
mod picture;
mod studio;
mod summary;

pub use frames::{FrameNames, FramesOptions, render_frames, write_frames};
pub use studio::Studio;
pub use summary::{Line, aligned, lines};

use crate::backends::{self, BackendChoice};
use crate::denoise;
use crate::film::CheckpointError;
use crate::job::output::OutputFormat;
use crate::job::recipe::{Recipe, file};
use crate::job::render::RenderJob;
use crate::job::saved::{self, OpenError, SavedFilm};
use crate::progressive::{Plan, Status};
use crate::scene::builtin::BuiltinScene;
use crate::stages::Stage;
use crate::system::console;
use crate::system::failure::Failure;
use crate::system::files::{FileLock, STANDARD, ShownPath, check_replaceable, check_writable, write_text};
use crate::system::interrupt::Interrupt;
use crate::system::terminal::{self, Display, ProgressChoice, print, print_beside};
use anyhow::Context;
use files::Files;
use picture::{STEPS, Screen, show};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};
use summary::{PICTURE, figures};

/// Options of `--batch`.
#[derive(Clone, Debug)]
pub struct BatchOptions {
    pub recipe: Recipe,
    /// The validated job of the recipe.
    pub job: RenderJob,
    /// The stage that it comes from.
    pub stage: Option<&'static Stage>,
    /// Which samples, and when to stop.
    pub plan: Plan,
    /// Whether the picture is denoised.
    pub denoise: bool,
    /// The files of the picture and of its film, in the order in which they are written: a film is worth most.
    pub outputs: Vec<Output>,
    /// Interval at which the checkpoint is written.
    pub every: Duration,
    /// The film to resume.
    pub resume: Option<PathBuf>,
    /// A scene file to write as well.
    pub save_scene: Option<PathBuf>,
    pub backend: BackendChoice,
    pub progress: ProgressChoice,
    pub json: Option<PathBuf>,
    /// The command line, as files record it; empty in the window.
    pub command: String,
    /// The number of the picture in an animation.
    pub frame: Option<u32>,
}

/// A file of a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    pub path: PathBuf,
    pub format: OutputFormat,
    /// Whether it is written at intervals, too, and replaces only the film that the render continues.
    pub is_checkpoint: bool,
}

impl BatchOptions {
    pub fn checkpoint(&self) -> Option<&Path> {
        self.outputs.iter().find(|output| output.is_checkpoint).map(|output| output.path.as_path())
    }

    /// When the render ends and what is made of it.
    fn until(&self) -> String {
        format!("{:?}, denoised: {}", self.plan.stop, self.denoise)
    }
}

/// Renders and writes everything that the options ask for.
///
/// # Errors
/// [`Failure::Input`] if nothing was rendered or written; [`Failure::BrokeOff`] if a render failed but its samples
/// are in its files; [`Failure::Run`] otherwise.
pub fn run(options: BatchOptions) -> Result<ExitCode, Failure> {
    check_before(&options)?;
    let mut files = Files::lock(options, FileLock::PATIENCE)?;
    let resumed = resumed(&files.options)?;
    let warnings = files.check(resumed.as_ref())?;
    let (files, film) = (Arc::new(files), resumed.map(|saved| saved.film));
    let options = &files.options;
    let interrupt = Interrupt::install().map_err(Failure::Run)?;
    let mut studio = Studio::open(&options.backend, &interrupt)?;
    if let Some(path) = &options.save_scene {
        write_text(path, &file::to_toml(&options.recipe)).map_err(Failure::run)?;
    }
    let (mut screen, begin) = (Screen::new(options, STEPS), Instant::now());
    warnings.iter().for_each(|warning| screen.warn(warning));
    let show = |display: &mut Display, status: &Status| show(display, &options.plan, status, begin.elapsed());
    let (mut done, outcome) = picture::render(&files, film, &mut screen, &mut studio, &interrupt, show);
    screen.display.clear();
    done.status.messages = screen.warnings;
    ended(outcome.err(), report(&figures(options, &done), &PICTURE, options), &interrupt)
}

/// The film to continue. A damaged one of `--continue` is renamed, and rendered again.
fn resumed(options: &BatchOptions) -> Result<Option<SavedFilm>, Failure> {
    let Some(path) = &options.resume else { return Ok(None) };
    match saved::resume(path, &options.job) {
        Err(OpenError::Film(damaged @ CheckpointError::Damaged { .. }))
            if options.checkpoint() == Some(path.as_path()) =>
        {
            let mut aside = path.as_os_str().to_owned();
            aside.push(".damaged");
            let context = || format!("cannot rename {} to {}", path.shown(), aside.shown());
            std::fs::rename(path, &aside).with_context(context).map_err(Failure::Input)?;
            let aside = aside.shown();
            console::note(&format!("warning: {damaged}; it is now {aside}, and is rendered again"));
            Ok(None)
        }
        found => found.map(Some).map_err(Failure::input),
    }
}

/// Version of the JSON. Incremented when a key is removed or changes meaning.
const SCHEMA: u32 = 1;

/// Prints lines about figures, and writes the figures as JSON. If either JSON or a picture takes standard output, the
/// lines go to standard error.
fn report(figures: &Value, table: &[Line], options: &BatchOptions) -> anyhow::Result<()> {
    let json = options.json.as_deref();
    let mut targets = options.outputs.iter().map(|output| output.path.as_path()).chain(json);
    let on_standard = targets.find(|path| *path == Path::new(STANDARD));
    let printed = print_beside(on_standard, &aligned(&lines(figures, table)));
    printed.and(json.map_or(Ok(()), |target| terminal::write_figures(SCHEMA, figures, target)))
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
    print_beside(Some(path), &format!("wrote {}\n", path.shown())).map_err(Failure::Run)?;
    Ok(ExitCode::SUCCESS)
}

/// Checks everything that could otherwise fail after rendering.
fn check_before(options: &BatchOptions) -> Result<(), Failure> {
    for output in &options.outputs {
        let check = if output.format == OutputFormat::Exr { check_replaceable } else { check_writable };
        check(&output.path).map_err(Failure::input)?;
    }
    options
        .save_scene
        .iter()
        .chain(&options.json)
        .try_for_each(|path| check_writable(path))
        .map_err(Failure::input)?;
    let denoising = if options.denoise { denoise::BYTES_PER_PIXEL } else { 0 };
    options.job.check_memory(1, denoising).map_err(Failure::input)
}

/// Prints the scenes, stages and devices to choose from.
///
/// # Errors
/// [`Failure::Run`] if standard output cannot be written.
pub fn list() -> Result<ExitCode, Failure> {
    let scenes = BuiltinScene::ALL.iter().map(|scene| (scene.name, scene.about.to_owned()));
    let stages = Stage::ALL.iter().map(|stage| (stage.id, format!("{:>5}  {}", stage.section, stage.title)));
    let devices = backends::list().into_iter().map(|backend| {
        let note = if backend.is_auto { " (auto)" } else { "" };
        (backend.device, format!("{}{note}", backend.about))
    });
    let lists = [
        ("Scenes (--scene)", scenes.collect::<Vec<_>>()),
        ("Stages (--stage)", stages.collect()),
        ("Devices (--device)", devices.collect()),
    ];
    let indented = |text: String| text.lines().map(|line| format!("  {line}\n")).collect::<String>();
    let lists = lists.map(|(title, lines)| format!("{title}\n{}", indented(aligned(&lines))));
    print(&lists.join("\n")).map_err(Failure::Run)?;
    Ok(ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::Ordering;

    /// The options of a batch render of 4x3 pixels with these `flags`.
    pub(super) fn options(flags: &[&str]) -> BatchOptions {
        crate::cli::tests::batch(&[&["--size", "4x3", "--progress", "off"], flags].concat().join(" "))
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
