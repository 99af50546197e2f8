//! Renders missing or outdated stills.

use super::quality::Quality;
use super::still::{self, INDEX, Still, Stills, fingerprint};
use crate::backends::BackendChoice;
use crate::batch::{Event, Studio};
use crate::cli::ProgressChoice;
use crate::cli::terminal::{Display, print};
use crate::film::key;
use crate::job::output::write_small_png;
use crate::job::recipe::Recipe;
use crate::progressive::Phase;
use crate::progressive::describe::{counted, describe};
use crate::stages::Stage;
use crate::system::console;
use crate::system::failure::Failure;
use crate::system::files::check_writable;
use crate::system::interrupt::Interrupt;
use anyhow::{Context, Result, bail};
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

#[derive(Clone, Debug)]
pub struct Order<'a> {
    /// The directory of the stills, created if missing.
    pub directory: &'a Path,
    /// The stages to render; stills of others stay untouched.
    pub stages: &'a [&'static Stage],
    /// The effort per still. A full still satisfies a quick order.
    pub quality: Quality,
    pub backend: &'a BackendChoice,
    pub progress: ProgressChoice,
    /// Whether to print each finished still on a line.
    pub prints_stills: bool,
}

#[derive(Debug)]
pub struct Outcome {
    /// All stills of the directory.
    pub stills: Stills,
    /// How many were rendered.
    pub rendered: usize,
    /// How many of the ordered ones were up to date.
    pub kept: usize,
    /// How many are missing because of a signal.
    pub missing: usize,
}

impl Outcome {
    /// Reports what was done, and where the page is or how to continue.
    pub fn report(&self, page: &Path, interrupt: &Interrupt) -> Result<ExitCode, Failure> {
        if self.missing > 0 {
            let missing = counted(self.missing as u64, "picture");
            console::note(&format!("interrupted: {missing} missing; run the same command again to go on"));
            return Ok(interrupt.exit_code());
        }
        let rendered = counted(self.rendered as u64, "picture");
        print(&format!("{rendered} rendered, {} unchanged\nopen {}\n", self.kept, page.display()))
            .map_err(Failure::Run)?;
        Ok(ExitCode::SUCCESS)
    }
}

/// A still to render.
type Task = (&'static Stage, Recipe);

/// Interval of progress lines without a terminal.
const LINE_INTERVAL: Duration = Duration::from_secs(5);

/// The progress bar, which counts paths.
const TEMPLATE: &str = "[{bar:24}] {eta} left, {wide_msg}";

/// Renders the ordered stills that are missing, damaged, or made from other settings or by another tracer, and writes
/// each with its description as soon as it is finished. Ctrl-C drops the still in progress.
///
/// [`Failure::Input`] if nothing was rendered, otherwise [`Failure::BrokeOff`] or [`Failure::Run`]. Finished stills are
/// kept.
pub fn render(order: &Order<'_>, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    let directory = order.directory;
    std::fs::create_dir_all(directory)
        .with_context(|| {
            format!("cannot create the directory {}; choose another with --out", directory.display())
        })
        .map_err(Failure::Input)?;
    let mut stills = Stills::read(directory);
    let tasks = tasks(order, &stills).map_err(Failure::Input)?;
    for file in tasks.iter().map(|(stage, _)| Still::file_name(stage)).chain([INDEX.to_owned()]) {
        check_writable(&directory.join(file)).map_err(Failure::input)?;
    }
    let kept = order.stages.len() - tasks.len();
    let mut rendered = 0;
    if !tasks.is_empty() {
        let studio = Studio::open(order.backend, interrupt)?;
        let display = Display::new(order.progress, paths(&tasks), TEMPLATE, "", LINE_INTERVAL);
        let mut work = Work { order, interrupt, studio, display };
        let outcome = work.render_all(&tasks, &mut stills, &mut rendered);
        work.display.clear();
        outcome.map_err(|error| match rendered {
            0 => Failure::Run(error),
            _ => {
                let kept = counted(rendered as u64, "picture");
                Failure::BrokeOff(error.context(format!("broke off; kept: {kept}")))
            }
        })?;
    }
    Ok(Outcome { stills, rendered, kept, missing: tasks.len() - rendered })
}

fn tasks(order: &Order<'_>, stills: &Stills) -> Result<Vec<Task>> {
    let mut tasks = Vec::new();
    for stage in order.stages {
        let [recipe, full] = [order.quality, Quality::Full].map(|quality| quality.recipe(stage));
        if !stills.is_fresh(stage, &[fingerprint(&recipe), fingerprint(&full)]) {
            recipe.job()?.check_memory(1)?;
            tasks.push((*stage, recipe));
        }
    }
    Ok(tasks)
}

struct Work<'a> {
    order: &'a Order<'a>,
    interrupt: &'a Interrupt,
    studio: Studio<'a>,
    display: Display,
}

impl Work<'_> {
    /// Counts the finished stills in `rendered`. A signal ends it early.
    fn render_all(&mut self, tasks: &[Task], stills: &mut Stills, rendered: &mut usize) -> Result<()> {
        while *rendered < tasks.len() && !self.interrupt.is_set() {
            let Some(still) = self.render(tasks, *rendered)? else { break };
            let line = still.line();
            stills.set(still);
            stills.write()?;
            *rendered += 1;
            if self.order.prints_stills {
                self.display.above(|| print(&line))?;
            }
        }
        Ok(())
    }

    /// Renders and writes the still of task `number`; `None` after a signal.
    fn render(&mut self, tasks: &[Task], number: usize) -> Result<Option<Still>> {
        let (stage, recipe) = &tasks[number];
        let (settings, planned) = (&recipe.settings, recipe.samples_per_pixel);
        let display = &mut self.display;
        let (status, film) =
            self.studio.render(recipe.job()?, Studio::plan(planned), None, |event| match event {
                Event::Warning(message) => display.say(&format!("warning: {message}")),
                Event::Stopping => {}
                Event::Status(_, status) => {
                    let done = status.samples_per_pixel;
                    display.update(paths(&tasks[..number]) + done * pixels(recipe), || {
                        let error = status
                            .error
                            .map_or_else(String::new, |error| format!(", error {:.1e}", error.rmse));
                        format!(
                            "{} of {}, {}: {done} of {planned} spp{error}",
                            number + 1,
                            tasks.len(),
                            stage.id
                        )
                    });
                }
            });
        if let Phase::Failed(reason) = &status.phase {
            bail!("{}: {reason}", stage.id);
        }
        let Some(film) = film.filter(|film| film.sample_count() >= planned) else { return Ok(None) };

        let path = self.order.directory.join(Still::file_name(stage));
        let _writing = self.interrupt.while_writing(path.display().to_string());
        let description = describe(recipe, Some(stage), &film, &status, Some(0.0));
        write_small_png(&path, &film, recipe.rules.transfer, &description)?;
        let error = film.error();
        Ok(Some(Still {
            stage: stage.id.to_owned(),
            file: Still::file_name(stage),
            width: settings.width,
            height: settings.height,
            max_depth: settings.max_depth,
            sampler: settings.sampler.name().to_owned(),
            seed: settings.seed,
            samples_per_pixel: planned,
            trace_seconds: status.trace.as_secs_f64(),
            rmse_estimate: error.map(|error| error.rmse),
            rmse_deviation: error.map(|error| error.rmse_deviation),
            backend: description.get(key::BACKEND).unwrap_or_default().to_owned(),
            fingerprint: fingerprint(recipe),
            checksum: still::checksum(&path)?,
        }))
    }
}

fn paths(tasks: &[Task]) -> u64 {
    tasks.iter().map(|(_, recipe)| recipe.samples_per_pixel * pixels(recipe)).sum()
}

fn pixels(recipe: &Recipe) -> u64 {
    u64::from(recipe.settings.width) * u64::from(recipe.settings.height)
}
