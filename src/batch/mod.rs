//! Rendering without a window: pictures go to files, progress goes to standard error, and figures come at the end.

mod existing;
mod files;
mod frames;
mod frames_summary;
mod keeping;
mod listing;
mod outcome;
mod part;
mod planning;
mod progress;
mod summary;

pub use frames::render_frames;
pub use listing::list;
pub use part::render_part;
pub use planning::plan;

use crate::backends;
use crate::cli::{BatchOptions, JsonTarget, RenderOptions, SaveSceneOptions};
use crate::console;
use crate::failure::Failure;
use crate::files::{ShownPath, check_replaceable, check_writable, write_text};
use crate::film::Film;
use crate::interrupt::Interrupt;
use crate::journal;
use crate::progressive::{Phase, Progressive, RenderRequest, Status};
use crate::recipe::{Recipe, file};
use crate::render::{Renderer, panic_text};
use crate::saved::{self, SavedFilm};
use crate::terminal::{print, print_beside, write_json};
use anyhow::Context;
use files::{Places, SharedPlace};
use keeping::Keeper;
use outcome::outcome;
use progress::Progress;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;
use summary::{Summary, SummaryJson};

/// Renders and writes everything that the options ask for.
///
/// # Errors
/// [`Failure::Input`] if nothing was rendered or written; [`Failure::BrokeOff`] if a render failed but its samples
/// are in its files; [`Failure::Run`] otherwise.
pub fn run(options: BatchOptions) -> Result<ExitCode, Failure> {
    check_before(&options)?;
    let places =
        options.renders.iter().map(Places::of).collect::<Result<Vec<_>, _>>().map_err(Failure::input)?;
    // Checked now, because the film of a resumed render is read before kernels are built.
    let resumed = match options.renders.as_slice() {
        [RenderOptions { resume: Some(path), job, .. }] => {
            Some(saved::resume(path, job).map_err(Failure::input)?)
        }
        _ => None,
    };
    let film = resumed.as_ref().map(|resumed| &resumed.film);
    let mut warnings: Vec<String> = options.renders.iter().flat_map(|render| render.notes.clone()).collect();
    for (render, places) in options.renders.iter().zip(&places) {
        warnings.extend(existing::check(render, places, film)?);
    }
    render_all(options, &places, resumed, &warnings)
}

/// Renders what the options ask for into these places. One picture may go on with a film. `warnings` are told with the
/// first picture.
fn render_all(
    options: BatchOptions,
    places: &[Places],
    mut resumed: Option<SavedFilm>,
    mut warnings: &[String],
) -> Result<ExitCode, Failure> {
    if let ([render], [places], Some(resumed)) = (options.renders.as_slice(), places, &resumed) {
        places.go_on(render, &resumed.film);
    }
    let mut renderer = Some(backends::create(&options.backend).map_err(Failure::input)?);
    let interrupt = Interrupt::install().map_err(Failure::Run)?;
    let mut progressive =
        Progressive::spawn().context("cannot start the render thread").map_err(Failure::Run)?;
    if let Some(save) = &options.save_scene {
        write_scene(&save.recipe, &save.path).map_err(Failure::Run)?;
    }

    let mut summaries = Vec::with_capacity(options.renders.len());
    let (mut failure, mut printed) = (None, Ok(()));
    for (render, places) in options.renders.iter().zip(places) {
        let warnings = std::mem::take(&mut warnings);
        let begun = Begun { options: &options, interrupt: &interrupt, places, warnings };
        let (summary, outcome) = begun.render(render, &mut progressive, renderer.take(), resumed.take());
        // The pictures are rendered even if the figures cannot be printed.
        printed = printed.and(print_beside(options.json.as_ref(), &format!("{summary}\n")));
        summaries.push(summary);
        if let Err(error) = outcome {
            failure = Some(error);
            break;
        }
        if interrupt.is_set() {
            break;
        }
    }
    let figures = printed.and(write_figures(&options, summaries));
    ended(failure, figures, &interrupt)
}

/// The end of a run. `figures` is the outcome of printing and writing its figures.
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
pub fn save_scene(options: &SaveSceneOptions) -> Result<ExitCode, Failure> {
    write_scene(&options.recipe, &options.path).map_err(Failure::Input)?;
    print(&format!("wrote {}\n", options.path.shown())).map_err(Failure::Run)?;
    Ok(ExitCode::SUCCESS)
}

fn write_scene(recipe: &Recipe, path: &Path) -> anyhow::Result<()> {
    Ok(write_text(path, &file::to_toml(recipe))?)
}

/// Checks for everything that could otherwise fail after rendering.
fn check_before(options: &BatchOptions) -> Result<(), Failure> {
    if let Some(directory) = &options.directory {
        std::fs::create_dir_all(directory)
            .with_context(|| {
                format!("cannot create the directory {}; choose another with --out", directory.shown())
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
        let check = if files::is_film(path) { check_replaceable } else { check_writable };
        check(path).map_err(Failure::input)?;
    }
    for render in &options.renders {
        render.job.check_memory(1).map_err(Failure::input)?;
    }
    Ok(())
}

/// A batch in progress.
struct Begun<'a> {
    options: &'a BatchOptions,
    interrupt: &'a Interrupt,
    places: &'a Places,
    /// What the user must know before it begins.
    warnings: &'a [String],
}

impl Begun<'_> {
    /// Renders a picture and writes its files. On any failure, the samples rendered so far are kept.
    fn render(
        &self,
        render: &RenderOptions,
        progressive: &mut Progressive,
        renderer: Option<Box<dyn Renderer>>,
        resumed: Option<SavedFilm>,
    ) -> (Summary, Result<(), Failure>) {
        let (film, seconds_before) = match resumed {
            Some(SavedFilm { film, seconds, .. }) => (Some(film), seconds),
            None => (None, Some(0.0)),
        };
        let held_before = film.as_ref().map_or(0, Film::sample_count);
        let keeper = |place: &SharedPlace| Keeper::new(render, place.clone(), held_before, seconds_before);
        let mut keeper = self.places.checkpoint.as_ref().map(keeper);
        let mut progress = Progress::new(self.options.progress, render);
        for warning in self.warnings {
            progress.say(&format!("warning: {warning}"));
        }
        let request = RenderRequest {
            job: render.job.clone(),
            backend: self.options.backend.clone(),
            renderer,
            plan: render.plan.clone(),
            film,
        };
        let watched = catch_unwind(AssertUnwindSafe(|| {
            self.watch(progressive, request, &mut progress, keeper.as_mut())
        }));
        let mut status = watched.unwrap_or_else(|payload| {
            progressive.stop();
            while progressive.status().phase.is_working() {
                progressive.wait(Progressive::LOOK);
            }
            let phase = Phase::Failed(format!("the program failed ({})", panic_text(payload.as_ref())));
            Status { phase, ..progressive.status() }
        });
        let mut names: Vec<String> = [render.checkpoint.as_ref(), Some(&render.out)]
            .into_iter()
            .flatten()
            .map(ShownPath::shown)
            .collect();
        names.dedup();
        let writing = self.interrupt.while_writing(names.join(" and "));
        let film = progressive.take_film();
        let begin = Instant::now();
        let kept = keeper.and_then(Keeper::finish);
        let mut written = match &film {
            Some(film) if film.sample_count() > 0 => {
                files::write(render, self.places, film, &status, seconds_before, |path| {
                    progress.writing(path)
                })
            }
            _ => files::Written::default(),
        };
        drop(writing);
        for path in &written.files {
            log::info!("wrote {}", path.display());
        }
        for note in &written.notes {
            progress.say(&format!("warning: {note}"));
        }
        let told = std::mem::take(&mut status.messages).into_iter().chain(std::mem::take(&mut written.notes));
        status.messages = self.warnings.iter().cloned().chain(told).collect();
        progress.finish();
        if matches!(status.phase, Phase::Failed(_)) {
            journal::write_report();
        }
        let outcome = outcome(render, &status, film.as_ref(), &written, kept);
        (Summary::new(render, &status, film.as_ref(), written.files, begin.elapsed()), outcome)
    }

    fn watch(
        &self,
        progressive: &mut Progressive,
        request: RenderRequest,
        progress: &mut Progress,
        mut keeper: Option<&mut Keeper>,
    ) -> Status {
        let mut is_stopping = false;
        let mut told = 0;
        progressive.watch(request, |progressive, status| {
            for message in status.messages.iter().skip(told) {
                progress.say(&format!("warning: {message}"));
            }
            told = status.messages.len();
            if status.phase.is_over() {
                return;
            }
            if self.options.crashes_at.is_some_and(|samples| status.samples_per_pixel >= samples) {
                panic!("injected fault");
            }
            if self.interrupt.is_set() && !is_stopping {
                is_stopping = true;
                let hint = if self.interrupt.is_by_hand() {
                    "; press Ctrl-C again to exit at once without writing"
                } else {
                    ""
                };
                progress.say(&format!("finishing the current samples and writing the files{hint}"));
                progressive.stop();
            }
            if let Some(words) = keeper.as_mut().and_then(|keeper| keeper.look(progressive, status)) {
                progress.say(&format!("warning: {words}"));
            }
            progress.update(status);
        })
    }
}

fn write_figures(options: &BatchOptions, mut summaries: Vec<Summary>) -> anyhow::Result<()> {
    let Some(target) = &options.json else { return Ok(()) };
    match (&options.directory, summaries.pop()) {
        (None, Some(summary)) => write_json(&SummaryJson::of_one(summary), target),
        (_, last) => {
            summaries.extend(last);
            write_json(&SummaryJson::of_all(summaries), target)
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::backends::BackendChoice;
    use crate::cli::{Request, parse};
    use crate::film::checkpoint;
    use crate::render::{BackendInfo, RenderError, RenderJob, Stats};
    use crate::render_cpu::CpuOptions;
    use std::ops::Range;
    use std::sync::atomic::{AtomicBool, Ordering};

    /// The options of a small render with these `flags`.
    pub(crate) fn options(flags: &[&str]) -> RenderOptions {
        batch(flags).renders.remove(0)
    }

    fn batch(flags: &[&str]) -> BatchOptions {
        let words = ["weekender", "--batch", "--size", "4x3", "--progress", "off"];
        let words = words.into_iter().chain(flags.iter().copied());
        let Request::Batch(options) = parse(words.map(Into::into)).unwrap() else { panic!("{flags:?}") };
        *options
    }

    /// A renderer that fails after four samples.
    struct Failing;

    impl Renderer for Failing {
        fn info(&self) -> BackendInfo {
            BackendInfo { name: "failing", device: String::new(), lanes: 1, threads: 1 }
        }

        fn prepare(&mut self, _: &RenderJob, _: &AtomicBool) -> Result<(), RenderError> {
            Ok(())
        }

        fn accumulate(
            &mut self,
            _: &RenderJob,
            samples: Range<u64>,
            film: &mut Film,
            _: &AtomicBool,
        ) -> Result<Stats, RenderError> {
            if samples.end > 4 {
                return Err(RenderError::Backend { backend: "failing", reason: "it broke".to_owned() });
            }
            film.record(samples, 0)?;
            Ok(Stats::default())
        }
    }

    #[test]
    fn a_render_that_breaks_off_has_an_exit_code_of_its_own_and_its_files() {
        let directory = tempfile::tempdir().unwrap();
        let [out, film] = ["a.png", "a.exr"].map(|name| directory.path().join(name));
        let options = batch(&[
            "--samples",
            "64",
            "--out",
            out.to_str().unwrap(),
            "--checkpoint",
            film.to_str().unwrap(),
        ]);
        let options = BatchOptions { backend: BackendChoice::Cpu(CpuOptions::default()), ..options };
        let render = &options.renders[0];
        let mut progressive = Progressive::with_factory(Box::new(|_| Ok(Box::new(Failing)))).unwrap();
        let interrupt = Interrupt::unheard();
        let places = Places::of(render).unwrap();
        let begun = Begun { options: &options, interrupt: &interrupt, places: &places, warnings: &[] };
        let (_, outcome) = begun.render(render, &mut progressive, None, None);
        let failure = outcome.unwrap_err();
        let told = failure.to_string();
        assert!(matches!(failure, Failure::BrokeOff(_)), "{told}");
        assert!(told.contains("it broke") && told.contains("4 samples") && told.contains("a.exr"), "{told}");
        assert_eq!(checkpoint::load(&film).unwrap().film.sample_count(), 4);
        assert!(out.exists());
    }

    #[test]
    fn a_failure_counts_more_than_a_signal_and_a_signal_more_than_figures_that_cannot_be_written() {
        let no_space = || Err(anyhow::anyhow!("no space"));
        for (is_set, code) in [(false, ExitCode::SUCCESS), (true, ExitCode::from(130))] {
            let interrupt = Interrupt::unheard();
            interrupt.flag().store(is_set, Ordering::Relaxed);
            let failure = Failure::BrokeOff(anyhow::anyhow!("it broke"));
            assert!(matches!(ended(Some(failure), no_space(), &interrupt), Err(Failure::BrokeOff(_))));
            assert_eq!(ended(None, Ok(()), &interrupt).unwrap(), code);
            match ended(None, no_space(), &interrupt) {
                Ok(found) => assert!(is_set && found == code),
                Err(failure) => assert!(!is_set && matches!(failure, Failure::Run(_))),
            }
        }
    }
}
