//! One picture: rendered, kept at intervals, and written with its film.

use super::files::{Files, Written};
use super::keeping::Keeper;
use super::options::BatchOptions;
use super::progress::{STEPS, display, show};
use super::studio::{Event, Studio};
use super::summary::Summary;
use crate::film::Film;
use crate::progressive::{Phase, Status};
use crate::system::failure::Failure;
use crate::system::files::ShownPath;
use crate::system::interrupt::Interrupt;
use crate::system::journal;
use anyhow::anyhow;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Renders a picture, from the film to continue, and writes its files. On any failure, the samples rendered so far are
/// kept. `warnings` are printed before it begins.
pub(super) fn render<'a>(
    files: &'a Arc<Files>,
    film: Option<Film>,
    warnings: &[String],
    studio: &mut Studio,
    interrupt: &Interrupt,
) -> (Summary<'a>, Result<(), Failure>) {
    let options = &files.options;
    let mut keeper = options.checkpoint().map(|_| Keeper::new(files));
    let mut display = display(options.progress, STEPS, &options.recipe.name);
    let begin = Instant::now();
    warnings.iter().for_each(|warning| display.warn(warning));
    let (mut status, film) =
        studio.render(options.job.clone(), options.plan.clone(), film, |event| match event {
            Event::Warning(warning) => display.warn(warning),
            Event::Stopping => {
                let hint = "; press Ctrl-C again to exit at once without writing";
                let hint = if interrupt.is_by_hand() { hint } else { "" };
                display.say(&format!("finishing the current samples and writing the files{hint}"));
            }
            Event::Status(_, status) if status.phase.is_over() => {}
            Event::Status(progressive, status) => {
                let warning = keeper.as_mut().and_then(|keeper| keeper.look(progressive, status));
                warning.iter().for_each(|warning| display.warn(warning));
                show(&mut display, &options.plan, status, begin.elapsed());
            }
        });
    let names: Vec<String> = options.outputs.iter().map(|output| output.path.shown()).collect();
    let writing = interrupt.while_writing(names.join(" and "));
    let begin = Instant::now();
    let kept = keeper.and_then(Keeper::finish);
    let mut written = Written::default();
    if let Some(film) = film.as_ref().filter(|film| film.sample_count() > 0) {
        let say = |path: &Path| display.announce(STEPS, || format!("writing {}", path.shown()));
        written = files.write(film, &status, say);
    }
    drop(writing);
    written.files.iter().for_each(|path| log::info!("wrote {}", path.display()));
    written.notes.iter().for_each(|note| display.warn(note));
    status.messages = [warnings, &status.messages, &written.notes].concat();
    display.clear();
    if matches!(status.phase, Phase::Failed(_)) {
        journal::write_report();
    }
    let outcome = outcome(options, &status, film.as_ref(), &written, kept);
    let samples = film.map(|film| film.samples().to_string());
    let (denoised, writing) = (written.denoised, begin.elapsed());
    (Summary { render: options, samples, status, denoised, files: written.files, writing }, outcome)
}

/// The result of a render and of writing its files. `kept` is the number of samples per pixel in the checkpoint.
fn outcome(
    options: &BatchOptions,
    status: &Status,
    film: Option<&Film>,
    written: &Written,
    kept: Option<u64>,
) -> Result<(), Failure> {
    let failures = written.failures.join("; ");
    let Phase::Failed(reason) = &status.phase else {
        return if failures.is_empty() { Ok(()) } else { Err(Failure::Run(anyhow!(failures))) };
    };
    let held = film.map_or(0, Film::sample_count);
    Err(match (kept, options.checkpoint()) {
        _ if !failures.is_empty() => Failure::Run(anyhow!("{reason}; {failures}")),
        _ if held > 0 => {
            let files = written.files.iter().map(ShownPath::shown).collect::<Vec<_>>().join(", ");
            Failure::BrokeOff(anyhow!(
                "{reason}; the {held} samples per pixel rendered before are in {files}"
            ))
        }
        (Some(kept), Some(path)) => {
            Failure::BrokeOff(anyhow!("{reason}; {kept} samples per pixel are in {}", path.shown()))
        }
        _ => Failure::Run(anyhow!("{reason}")),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::film::checkpoint;
    use crate::job::render::{BackendInfo, Control, Outcome, RenderError, RenderJob, Renderer, Stats};
    use std::ops::Range;
    use std::sync::atomic::AtomicBool;

    /// A renderer that fails after four samples.
    struct Failing;

    impl Renderer for Failing {
        fn info(&self) -> BackendInfo {
            BackendInfo { name: "failing", device: String::new(), lanes: 1, threads: 1 }
        }

        fn prepare(&mut self, _: &RenderJob, _: &AtomicBool) -> Result<(), RenderError> {
            Ok(())
        }

        fn advance(
            &mut self,
            _: &RenderJob,
            samples: Range<u64>,
            film: &mut Film,
            _: &Control,
        ) -> Result<Outcome, RenderError> {
            if samples.end > 4 {
                return Err(RenderError::Backend { backend: "failing", reason: "it broke".to_owned() });
            }
            film.record(samples, 0)?;
            Ok(Stats::default().into())
        }
    }

    #[test]
    fn failed_render_has_its_own_exit_code_and_files() {
        let directory = tempfile::tempdir().unwrap();
        let [out, film] = ["a.png", "a.exr"].map(|name| directory.path().join(name));
        let files = ["--out", out.to_str().unwrap(), "--checkpoint", film.to_str().unwrap()];
        let options =
            crate::batch::tests::options(&[&["--samples", "64", "--device", "cpu"], &files[..]].concat());
        let interrupt = Interrupt::unheard();
        let mut studio =
            Studio::with_factory(Box::new(|_| Ok(Box::new(Failing))), &options.backend, &interrupt);
        let files = Arc::new(Files::lock(options.clone()).unwrap());
        let (_, outcome) = render(&files, None, &[], &mut studio, &interrupt);
        let failure = outcome.unwrap_err();
        let message = failure.to_string();
        assert!(matches!(failure, Failure::BrokeOff(_)), "{message}");
        assert!(
            message.contains("it broke") && message.contains("4 samples") && message.contains("a.exr"),
            "{message}"
        );
        assert_eq!(checkpoint::load(&film).unwrap().film.sample_count(), 4);
        assert!(out.exists());
    }
}
