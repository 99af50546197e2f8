//! One picture: rendered, kept at intervals, and written with its film.

use super::BatchOptions;
use super::files::{Files, Written};
use super::keeping::Keeper;
use super::studio::Studio;
use crate::film::{Film, checkpoint};
use crate::progressive::describe::seconds;
use crate::progressive::{EndReason, Phase, Plan, Status};
use crate::system::failure::Failure;
use crate::system::files::ShownPath;
use crate::system::interrupt::Interrupt;
use crate::system::journal;
use crate::system::terminal::Display;
use anyhow::anyhow;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What a person sees of a run.
pub(super) struct Screen {
    pub display: Display,
    /// What was said.
    pub warnings: Vec<String>,
    /// Whether warnings that differ only in numbers are the same, as those of frames are.
    is_animation: bool,
}

impl Screen {
    /// Progress in `steps`. Without a terminal, there is a line every five seconds.
    pub fn new(options: &BatchOptions, steps: u64) -> Screen {
        let bar = "{prefix} [{bar:24}] {wide_msg}";
        let interval = Duration::from_secs(5);
        let display = Display::new(options.progress, steps, bar, &options.recipe.name, interval);
        let mut screen = Screen { display, warnings: Vec::new(), is_animation: steps != STEPS };
        if options.recipe.scene.spheres.is_empty() && options.stage.is_none() {
            screen.warn(
                "the scene has no spheres, so the picture is the sky; a scene file lists them as [[spheres]], or names a \
                 table above its first [table]: spheres = \"FILE.csv\"",
            );
        }
        screen
    }

    /// Says a warning once.
    pub fn warn(&mut self, warning: &str) {
        let is_number = |c: char| self.is_animation && c.is_ascii_digit();
        let is_known = |known: &String| known.replace(is_number, "") == warning.replace(is_number, "");
        if !self.warnings.iter().any(is_known) {
            self.display.warn(warning);
            self.warnings.push(warning.to_owned());
        }
    }
}

/// A picture that was rendered and written.
pub(super) struct Rendered {
    pub status: Status,
    pub film: Option<Film>,
    pub written: Written,
    pub writing: Duration,
}

/// Renders a picture, from the film to continue, and writes its files. On any failure, the samples rendered so far are
/// kept; of a frame, nothing is. `show` gets the state now and then. Returns the picture, and whether all went well.
pub(super) fn render(
    files: &Arc<Files>,
    film: Option<Film>,
    screen: &mut Screen,
    studio: &mut Studio,
    interrupt: &Interrupt,
    mut show: impl FnMut(&mut Display, &Status),
) -> (Rendered, Result<(), Failure>) {
    let options = &files.options;
    let mut keeper = options.checkpoint().map(|_| Keeper::new(files));
    let mut is_stopping = false;
    let (job, plan) = (options.job.clone(), options.plan.clone());
    let (status, film) = studio.render(job, plan, film, |progressive, status| {
        status.messages.iter().for_each(|message| screen.warn(message));
        if status.phase.is_over() {
            return;
        }
        if interrupt.is_set() && !is_stopping {
            is_stopping = true;
            let hint = "; press Ctrl-C again to exit at once without writing";
            let hint = if interrupt.is_by_hand() { hint } else { "" };
            let end = match options.frame {
                Some(frame) => format!("dropping frame {frame}; the others are complete"),
                None => "finishing the current samples and writing the files".to_owned(),
            };
            screen.display.say(&format!("{}: {end}{hint}", interrupt.cause()));
        }
        let warning = keeper.as_mut().and_then(|keeper| keeper.look(progressive, status));
        warning.iter().for_each(|warning| screen.display.warn(warning));
        show(&mut screen.display, status);
    });
    let names: Vec<String> = options.outputs.iter().map(|output| output.path.shown()).collect();
    let guard = interrupt.while_writing(names.join(" and "));
    let begin = Instant::now();
    keeper.into_iter().for_each(Keeper::finish);
    let mut written = Written::default();
    let is_whole = matches!(status.phase, Phase::Done(reason) if reason != EndReason::Stopped);
    let is_written = |film: &&Film| film.sample_count() > 0 && (is_whole || options.frame.is_none());
    if let Some(film) = film.as_ref().filter(is_written) {
        let say = |path: &Path| screen.display.announce(STEPS, || format!("writing {}", path.shown()));
        written = files.write(film, &status, say);
    }
    drop(guard);
    written.files.iter().for_each(|path| log::info!("wrote {}", path.display()));
    written.notes.iter().for_each(|note| screen.warn(note));
    if matches!(status.phase, Phase::Failed(_)) {
        journal::write_report();
    }
    let done = Rendered { status, film, written, writing: begin.elapsed() };
    let outcome = outcome(options, &done);
    (done, outcome)
}

/// The result of a render and of writing its files.
fn outcome(options: &BatchOptions, done: &Rendered) -> Result<(), Failure> {
    let Rendered { status, film, written, .. } = done;
    let failures = written.failures.join("; ");
    let Phase::Failed(reason) = &status.phase else {
        return if failures.is_empty() { Ok(()) } else { Err(Failure::Run(anyhow!(failures))) };
    };
    let files: Vec<String> = written.files.iter().map(ShownPath::shown).collect();
    let now = film.as_ref().filter(|_| !files.is_empty()).map(|film| (film.sample_count(), files.join(", ")));
    let before = |path: &Path| Some((checkpoint::read_head(path).ok()?.samples.count(), path.shown()));
    Err(match now.or_else(|| before(options.checkpoint()?)) {
        _ if !failures.is_empty() => Failure::Run(anyhow!("{reason}; {failures}")),
        Some((held, files)) => {
            Failure::BrokeOff(anyhow!("{reason}; {held} samples per pixel are in {files}"))
        }
        None => Failure::Run(anyhow!("{reason}")),
    })
}

/// Steps of the bar of a picture.
pub(super) const STEPS: u64 = 1000;

/// Shows the state of a render that has taken `elapsed` so far.
pub(super) fn show(display: &mut Display, plan: &Plan, status: &Status, elapsed: Duration) {
    let (left, done) = (seconds_left(plan, status), elapsed.as_secs_f64());
    // The first step until the end can be predicted.
    let share = left.map_or(0.0, |left| done / (done + left).max(f64::MIN_POSITIVE));
    display.update((share * STEPS as f64) as u64, || {
        if status.phase == Phase::Preparing {
            return "preparing the scene".to_owned();
        }
        let error = status.error.map_or_else(String::new, |e| format!("error {:.2e}, ", e.rmse));
        let left = left.map_or_else(String::new, |left| format!("{} left, ", seconds(left)));
        let (samples, speed) = (status.samples_per_pixel, status.paths_per_second() / 1e6);
        format!("{error}{samples} spp, {left}{}, {speed:.1} Mpaths/s", seconds(done))
    });
}

/// Seconds until the first stop condition is met, if that can be predicted.
fn seconds_left(plan: &Plan, status: &Status) -> Option<f64> {
    if status.added() == 0 {
        return None;
    }
    let per_sample = status.seconds_per_sample();
    let held = status.samples_per_pixel as f64;
    let by_samples = (status.planned_samples_per_pixel as f64 - held) * per_sample;
    let by_time = plan.stop.time_limit().map(|limit| limit.saturating_sub(status.elapsed).as_secs_f64());
    // The error falls at least with the square root of the samples.
    let by_noise = plan
        .stop
        .noise
        .zip(status.error)
        .map(|(target, error)| held * ((error.rmse / target).powi(2) - 1.0).max(0.0) * per_sample);
    [Some(by_samples), by_time, by_noise].into_iter().flatten().reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::film::{ErrorEstimate, checkpoint};
    use crate::job::render::tests::Scripted;
    use crate::job::render::{BackendInfo, RenderError};

    #[test]
    fn failed_render_has_its_own_exit_code_and_files() {
        let directory = tempfile::tempdir().unwrap();
        let [out, film] = ["a.png", "a.exr"].map(|name| directory.path().join(name));
        let files = ["--out", out.to_str().unwrap(), "--checkpoint", film.to_str().unwrap()];
        let options =
            crate::batch::tests::options(&[&["--samples", "64", "--device", "cpu"], &files[..]].concat());
        let interrupt = Interrupt::unheard();
        let failing = || {
            Scripted::boxed(|_, samples, film, _| match samples.end {
                0..5 => Ok(film.record(samples, 0)?),
                _ => Err(RenderError::Backend { backend: "scripted", reason: "it broke".to_owned() }),
            })
        };
        let mut studio = Studio::with_factory(Box::new(move |_| Ok(failing())), &options.backend, &interrupt);
        let files = Arc::new(Files::lock(options.clone(), Duration::ZERO).unwrap());
        let mut screen = Screen::new(&options, STEPS);
        let (_, outcome) = render(&files, None, &mut screen, &mut studio, &interrupt, |_, _| {});
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

    #[test]
    fn time_left_is_that_of_the_first_condition() {
        let mut status = Status {
            samples_per_pixel: 100,
            planned_samples_per_pixel: 1100,
            trace: Duration::from_secs(10),
            elapsed: Duration::from_secs(10),
            error: Some(ErrorEstimate { rmse: 0.02, rmse_deviation: 0.0, rel_mse: 0.1 }),
            ..Status::default()
        };
        let mut plan = Plan::samples(1100);
        assert_eq!(seconds_left(&plan, &status), None);
        let info = BackendInfo { name: "cpu", device: String::new(), lanes: 1, threads: 1 };
        status.contributions =
            vec![crate::progressive::Contribution { backend: info, samples_per_pixel: 100 }];
        assert_eq!(seconds_left(&plan, &status), Some(100.0));
        // Samples of earlier runs took none of this run's time.
        status.contributions[0].samples_per_pixel = 50;
        assert_eq!(seconds_left(&plan, &status), Some(200.0));
        status.contributions[0].samples_per_pixel = 100;
        plan.stop.seconds = Some(60.0);
        assert_eq!(seconds_left(&plan, &status), Some(50.0));
        plan.stop.noise = Some(0.01);
        assert!((seconds_left(&plan, &status).unwrap() - 30.0).abs() < 1e-9);
        // The last pass has met the condition.
        plan.stop.noise = Some(0.05);
        assert_eq!(seconds_left(&plan, &status), Some(0.0));
        (plan.stop.noise, status.elapsed) = (None, Duration::from_secs(61));
        assert_eq!(seconds_left(&plan, &status), Some(0.0));
    }
}
