//! Rendering without a window: pictures to files, progress to standard error, figures at the end.

mod files;
mod listing;
mod merging;
mod progress;
mod resuming;
mod summary;

pub use listing::list;
pub use merging::merge;

use crate::backends;
use crate::cli::{BatchOptions, JsonTarget, RenderOptions, SaveSceneOptions};
use crate::failure::{Failure, INTERRUPTED};
use crate::film::{Film, check_writable, write_text};
use crate::interrupt::Interrupt;
use crate::progressive::{Phase, Progressive, Status, Work};
use crate::recipe::{Recipe, file};
use crate::render::Renderer;
use crate::terminal::{print, print_beside, write_json};
use anyhow::{Context, anyhow};
use progress::Progress;
use resuming::Resumed;
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use summary::{Report, Summary};

/// Renders and writes everything that is asked for.
///
/// # Errors
/// [`Failure::Input`] before anything is rendered or written; [`Failure::Run`] later.
pub fn run(options: BatchOptions) -> Result<ExitCode, Failure> {
    check_before(&options)?;
    // Found out now, the film of a resumed render is read before a kernel is built.
    let mut resumed = match options.renders.as_slice() {
        [only] => resuming::load(only).map_err(Failure::Input)?,
        _ => None,
    };
    let mut renderer = Some(backends::create(&options.backend).map_err(Failure::input)?);
    let interrupt = Interrupt::install().map_err(Failure::Run)?;
    let mut progressive =
        Progressive::spawn().context("cannot start the render thread").map_err(Failure::Run)?;
    if let Some(save) = &options.save_scene {
        write_scene(&save.recipe, &save.path).map_err(Failure::Run)?;
    }

    let mut summaries = Vec::with_capacity(options.renders.len());
    let mut failure = None;
    for render in &options.renders {
        let begun = Begun { options: &options, interrupt: &interrupt };
        let (summary, outcome) = begun.render(render, &mut progressive, renderer.take(), resumed.take());
        print_beside(options.json.as_ref(), &format!("{summary}\n"));
        summaries.push(summary);
        if let Err(error) = outcome {
            failure = Some(error);
            break;
        }
        if interrupt.is_set() {
            break;
        }
    }
    let json = write_figures(&options, summaries);
    match (failure, json) {
        (Some(error), _) | (None, Err(error)) => Err(Failure::Run(error)),
        _ if interrupt.is_set() => Ok(ExitCode::from(INTERRUPTED)),
        _ => Ok(ExitCode::SUCCESS),
    }
}

/// Writes a scene file.
///
/// # Errors
/// [`Failure::Input`] if it cannot be written.
pub fn save_scene(options: &SaveSceneOptions) -> Result<ExitCode, Failure> {
    write_scene(&options.recipe, &options.path).map_err(Failure::Input)?;
    print(&format!("wrote {}\n", options.path.display()));
    Ok(ExitCode::SUCCESS)
}

fn write_scene(recipe: &Recipe, path: &Path) -> anyhow::Result<()> {
    Ok(write_text(path, &file::to_toml(recipe))?)
}

/// Finds out what would fail after the rendering.
fn check_before(options: &BatchOptions) -> Result<(), Failure> {
    if let Some(directory) = &options.directory {
        std::fs::create_dir_all(directory)
            .with_context(|| {
                format!("cannot make the directory {}; choose another --out", directory.display())
            })
            .map_err(Failure::Input)?;
    }
    let pictures = options.renders.iter().flat_map(|render| [Some(&render.out), render.checkpoint.as_ref()]);
    let json = match &options.json {
        Some(JsonTarget::File(path)) => Some(path),
        _ => None,
    };
    let scene = options.save_scene.as_ref().map(|save| &save.path);
    for path in pictures.chain([json, scene]).flatten() {
        check_writable(path).map_err(Failure::input)?;
    }
    for render in &options.renders {
        render.job.check_memory(1).map_err(Failure::input)?;
    }
    Ok(())
}

/// A batch under way.
struct Begun<'a> {
    options: &'a BatchOptions,
    interrupt: &'a Interrupt,
}

impl Begun<'_> {
    /// Renders a picture and writes its files. Whatever goes wrong, what has been rendered is kept.
    fn render(
        &self,
        render: &RenderOptions,
        progressive: &mut Progressive,
        renderer: Option<Box<dyn Renderer>>,
        resumed: Option<Resumed>,
    ) -> (Summary, anyhow::Result<()>) {
        let (film, seconds_before) = match resumed {
            Some(Resumed { film, seconds }) => (Some(film), seconds),
            None => (None, Some(0.0)),
        };
        let mut progress = Progress::new(self.options.progress, render);
        progressive.start(Work {
            job: render.job.clone(),
            backend: self.options.backend.clone(),
            renderer,
            plan: render.plan.clone(),
            film,
        });
        let status = self.watch(progressive, &mut progress);
        let film = progressive.take_film();
        let begin = Instant::now();
        progress.writing();
        let written = match &film {
            Some(film) if film.sample_count() > 0 => files::write(render, film, &status, seconds_before),
            _ => files::Written::default(),
        };
        progress.finish();
        let outcome = outcome(&status, film.as_ref(), written.failure);
        let files = written.files;
        (Summary::new(render, &status, film.as_ref(), files, begin.elapsed()), outcome)
    }

    fn watch(&self, progressive: &Progressive, progress: &mut Progress) -> Status {
        let mut is_stopping = false;
        let mut told = 0;
        loop {
            let status = progressive.wait(Duration::from_millis(50));
            for message in status.messages.iter().skip(told) {
                progress.say(&format!("warning: {message}"));
            }
            told = status.messages.len();
            if status.phase.is_over() {
                return status;
            }
            if self.interrupt.is_set() && !is_stopping {
                is_stopping = true;
                progress.say("stopping after these samples; press Ctrl-C again to exit at once");
                progressive.stop();
            }
            progress.update(&status);
        }
    }
}

fn outcome(status: &Status, film: Option<&Film>, writing: Option<anyhow::Error>) -> anyhow::Result<()> {
    if let Phase::Failed(reason) = &status.phase {
        return Err(match film.map_or(0, Film::sample_count) {
            0 => anyhow!("{reason}"),
            kept => anyhow!("{reason}; {kept} samples per pixel were kept"),
        });
    }
    writing.map_or(Ok(()), Err)
}

fn write_figures(options: &BatchOptions, mut summaries: Vec<Summary>) -> anyhow::Result<()> {
    let Some(target) = &options.json else { return Ok(()) };
    match (&options.directory, summaries.pop()) {
        (None, Some(summary)) => write_json(&Report::of_one(summary), target),
        (_, last) => {
            summaries.extend(last);
            write_json(&Report::of_all(summaries), target)
        }
    }
}
