//! Renders missing or outdated stills.

use super::still::{NO_NOISE, Still, file_name, is_fresh, recipe};
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
use crate::system::files::{check_page, check_writable, make_directory};
use crate::system::interrupt::Interrupt;
use anyhow::{Result, bail};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

#[derive(Clone, Debug)]
pub struct Order<'a> {
    /// The directory of the stills, created if missing.
    pub directory: &'a Path,
    /// The page that shows them.
    pub page: &'a Path,
    /// The stages to render; stills of others stay untouched.
    pub stages: &'a [&'static Stage],
    /// Small and visibly noisy, for a first look. A full still satisfies a quick order.
    pub is_quick: bool,
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

/// The stills of an order that are missing, damaged, or made from other settings or by another tracer.
pub struct Work<'a> {
    order: &'a Order<'a>,
    interrupt: &'a Interrupt,
    tasks: Vec<Task>,
    /// `None` if there is nothing to render.
    studio: Option<Studio<'a>>,
}

impl<'a> Work<'a> {
    /// Checks everything that may be refused, and only then makes the directory.
    ///
    /// # Errors
    /// [`Failure::Input`] if the order cannot be carried out.
    pub fn begin(order: &'a Order<'a>, interrupt: &'a Interrupt) -> Result<Self, Failure> {
        if order.page.parent().is_some_and(Path::is_dir) {
            check_page(order.page).map_err(Failure::input)?;
        }
        let tasks = order.tasks().map_err(Failure::Input)?;
        let is_needed = !tasks.is_empty();
        let studio = is_needed.then(|| Studio::open(order.backend, interrupt)).transpose()?;
        make_directory(order.directory).map_err(Failure::Input)?;
        for (stage, _) in &tasks {
            check_writable(&order.path(stage)).map_err(Failure::input)?;
        }
        Ok(Work { order, interrupt, tasks, studio })
    }

    /// Renders the stills, and writes each with its description as soon as it is finished. Ctrl-C drops the still in
    /// progress.
    ///
    /// # Errors
    /// [`Failure::Run`], or [`Failure::BrokeOff`] if some are finished; they are kept.
    pub fn render(self) -> Result<Outcome, Failure> {
        let Work { order, interrupt, tasks, studio } = self;
        let mut rendered = 0;
        if let Some(mut studio) = studio {
            let mut display = Display::new(order.progress, paths(&tasks), TEMPLATE, "", LINE_INTERVAL);
            let outcome = loop {
                if rendered == tasks.len() || interrupt.is_set() {
                    break Ok(());
                }
                match order.render(&tasks, rendered, &mut studio, &mut display, interrupt) {
                    Ok(true) => rendered += 1,
                    Ok(false) => break Ok(()),
                    Err(error) => break Err(error),
                }
                // Counted before, because it stays if printing fails.
                let (stage, _) = &tasks[rendered - 1];
                if let Err(error) = order.print(stage, &mut display) {
                    break Err(error);
                }
            };
            display.clear();
            outcome.map_err(|error| match rendered {
                0 => Failure::Run(error),
                _ => {
                    let kept = counted(rendered as u64, "picture");
                    Failure::BrokeOff(error.context(format!("broke off; kept: {kept}")))
                }
            })?;
        }
        let kept = order.stages.len() - tasks.len();
        Ok(Outcome { rendered, kept, missing: tasks.len() - rendered })
    }
}

impl Order<'_> {
    fn path(&self, stage: &Stage) -> PathBuf {
        self.directory.join(file_name(stage))
    }

    fn tasks(&self) -> Result<Vec<Task>> {
        let mut tasks = Vec::new();
        for stage in self.stages {
            let recipes = [self.is_quick, false].map(|is_quick| recipe(stage, is_quick));
            if !is_fresh(&self.path(stage), &recipes) {
                let [recipe, _] = recipes;
                recipe.job()?.check_memory(1)?;
                tasks.push((*stage, recipe));
            }
        }
        Ok(tasks)
    }

    /// Renders and writes the still of task `number`; `false` after a signal.
    fn render(
        &self,
        tasks: &[Task],
        number: usize,
        studio: &mut Studio,
        display: &mut Display,
        interrupt: &Interrupt,
    ) -> Result<bool> {
        let (stage, recipe) = &tasks[number];
        let planned = recipe.samples_per_pixel;
        let (status, film) = studio.render(recipe.job()?, Studio::plan(planned), None, |event| match event {
            Event::Warning(message) => display.warn(message),
            Event::Stopping => {}
            Event::Status(_, status) => {
                let done = status.samples_per_pixel;
                display.update(paths(&tasks[..number]) + done * pixels(recipe), || {
                    let error = status.error.map(|error| format!(", error {:.1e}", error.rmse));
                    let (number, count, error) = (number + 1, tasks.len(), error.unwrap_or_default());
                    format!("{number} of {count}, {}: {done} of {planned} spp{error}", stage.id)
                });
            }
        });
        if let Phase::Failed(reason) = &status.phase {
            bail!("{}: {reason}", stage.id);
        }
        let Some(film) = film.filter(|film| film.sample_count() >= planned) else { return Ok(false) };
        let path = self.path(stage);
        let writing = interrupt.while_writing(path.display().to_string());
        let mut description = describe(recipe, Some(stage), &film, &status, Some(0.0));
        let error = film.error().filter(|error| error.rmse > 0.0).map(|error| {
            let share = (100.0 * error.rmse_deviation / error.rmse).max(0.1);
            format!("{:.1e} ± {share:.1} %", error.rmse)
        });
        description.set(key::ERROR, error.unwrap_or_else(|| NO_NOISE.to_owned()));
        write_small_png(&path, &film, recipe.rules.transfer, &description)?;
        drop(writing);
        Ok(true)
    }

    fn print(&self, stage: &Stage, display: &mut Display) -> Result<()> {
        let still = Still::read(&self.path(stage)).filter(|_| self.prints_stills);
        still.map_or(Ok(()), |still| display.above(|| print(&still.line(stage))))
    }
}

fn paths(tasks: &[Task]) -> u64 {
    tasks.iter().map(|(_, recipe)| recipe.samples_per_pixel * pixels(recipe)).sum()
}

fn pixels(recipe: &Recipe) -> u64 {
    u64::from(recipe.settings.width) * u64::from(recipe.settings.height)
}
