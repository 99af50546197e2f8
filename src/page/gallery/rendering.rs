//! Renders missing or outdated stills.

use super::quality::Quality;
use super::still::{NO_NOISE, Still, file_name, is_fresh};
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
use crate::system::files::{check_writable, make_directory};
use crate::system::interrupt::Interrupt;
use anyhow::{Result, bail};
use std::path::{Path, PathBuf};
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
    make_directory(order.directory).map_err(Failure::Input)?;
    let tasks = tasks(order).map_err(Failure::Input)?;
    for (stage, _) in &tasks {
        check_writable(&order.path(stage)).map_err(Failure::input)?;
    }
    let kept = order.stages.len() - tasks.len();
    let mut rendered = 0;
    if !tasks.is_empty() {
        let studio = Studio::open(order.backend, interrupt)?;
        let display = Display::new(order.progress, paths(&tasks), TEMPLATE, "", LINE_INTERVAL);
        let mut work = Work { order, interrupt, studio, display };
        let outcome = work.render_all(&tasks, &mut rendered);
        work.display.clear();
        outcome.map_err(|error| match rendered {
            0 => Failure::Run(error),
            _ => {
                let kept = counted(rendered as u64, "picture");
                Failure::BrokeOff(error.context(format!("broke off; kept: {kept}")))
            }
        })?;
    }
    Ok(Outcome { rendered, kept, missing: tasks.len() - rendered })
}

fn tasks(order: &Order<'_>) -> Result<Vec<Task>> {
    let mut tasks = Vec::new();
    for stage in order.stages {
        let recipes = [order.quality, Quality::Full].map(|quality| quality.recipe(stage));
        if !is_fresh(&order.path(stage), &recipes) {
            let [recipe, _] = recipes;
            recipe.job()?.check_memory(1)?;
            tasks.push((*stage, recipe));
        }
    }
    Ok(tasks)
}

impl Order<'_> {
    fn path(&self, stage: &Stage) -> PathBuf {
        self.directory.join(file_name(stage))
    }
}

struct Work<'a> {
    order: &'a Order<'a>,
    interrupt: &'a Interrupt,
    studio: Studio<'a>,
    display: Display,
}

impl Work<'_> {
    /// Counts the finished stills in `rendered`. A signal ends it early.
    fn render_all(&mut self, tasks: &[Task], rendered: &mut usize) -> Result<()> {
        while *rendered < tasks.len() && !self.interrupt.is_set() && self.render(tasks, *rendered)? {
            let (stage, _) = &tasks[*rendered];
            *rendered += 1;
            if let Some(still) = Still::read(&self.order.path(stage)).filter(|_| self.order.prints_stills) {
                self.display.above(|| print(&still.line(stage)))?;
            }
        }
        Ok(())
    }

    /// Renders and writes the still of task `number`; `false` after a signal.
    fn render(&mut self, tasks: &[Task], number: usize) -> Result<bool> {
        let (stage, recipe) = &tasks[number];
        let planned = recipe.samples_per_pixel;
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
        let Some(film) = film.filter(|film| film.sample_count() >= planned) else { return Ok(false) };
        let path = self.order.path(stage);
        let _writing = self.interrupt.while_writing(path.display().to_string());
        let mut description = describe(recipe, Some(stage), &film, &status, Some(0.0));
        let error = film.error().filter(|error| error.rmse > 0.0).map(|error| {
            let share = (100.0 * error.rmse_deviation / error.rmse).max(0.1);
            format!("{:.1e} ± {share:.1} %", error.rmse)
        });
        description.set(key::ERROR, error.unwrap_or_else(|| NO_NOISE.to_owned()));
        write_small_png(&path, &film, recipe.rules.transfer, &description)?;
        Ok(true)
    }
}

fn paths(tasks: &[Task]) -> u64 {
    tasks.iter().map(|(_, recipe)| recipe.samples_per_pixel * pixels(recipe)).sum()
}

fn pixels(recipe: &Recipe) -> u64 {
    u64::from(recipe.settings.width) * u64::from(recipe.settings.height)
}
