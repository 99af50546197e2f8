//! Checkpoints: the film is written at intervals during a render, so a crash loses only the samples since the last one.

use super::files::{SharedPlace, caught, described};
use crate::cli::RenderOptions;
use crate::film::Film;
use crate::progressive::{Progressive, Status};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

/// Has the film written at intervals. The tracer waits only while the film is copied or, if there is no room for a
/// copy, while it is written.
pub(super) struct Keeper {
    every: Duration,
    last: Instant,
    /// Samples in the last copy that was requested.
    asked: u64,
    is_under_way: bool,
    writer: Arc<Writer>,
    snapshots: Option<Sender<Snapshot>>,
    thread: Option<JoinHandle<()>>,
    outcomes: Receiver<Outcome>,
    /// Samples in the file.
    kept: Option<u64>,
}

struct Snapshot {
    film: Film,
    status: Status,
}

/// The result of writing a checkpoint.
struct Outcome {
    samples: Option<u64>,
    words: Option<String>,
}

/// What writing a checkpoint needs besides film and status.
struct Writer {
    place: SharedPlace,
    render: RenderOptions,
    /// Samples per pixel in the film at the start.
    held_before: u64,
    seconds_before: Option<f64>,
    outcomes: Sender<Outcome>,
}

impl Writer {
    /// Has a copy of the film written by the `thread`. If there is no memory for a copy, or no such thread, the film is
    /// written here.
    fn take(&self, film: &Film, status: Status, thread: Option<Sender<Snapshot>>) {
        let copy = thread.and_then(|thread| Some((thread, film.try_copy().ok()?)));
        let is_handed_over = copy.is_some_and(|(thread, film)| {
            let status = status.clone();
            thread.send(Snapshot { film, status }).is_ok()
        });
        if !is_handed_over {
            self.write(film, &status);
        }
    }

    /// Writes the film, and always says what came of it: the next checkpoint waits for that.
    fn write(&self, film: &Film, status: &Status) {
        let path = self.render.checkpoint.as_ref().unwrap_or(&self.render.out);
        let saved = caught(path, || {
            let status = status.of_film(film, self.held_before);
            let description = described(&self.render, film, &status, self.seconds_before);
            self.place.lock().save(film, &description).map_err(|error| error.to_string())
        });
        let outcome = match saved {
            Ok(_) => {
                log::info!("checkpoint: {} samples per pixel in {}", film.sample_count(), path.display());
                Outcome { samples: Some(film.sample_count()), words: None }
            }
            Err(reason) => {
                let words = format!("{reason}; rendering continues, and writing will be tried again");
                Outcome { samples: None, words: Some(words) }
            }
        };
        // Nobody receives this if the render is already over.
        let _ = self.outcomes.send(outcome);
    }
}

impl Keeper {
    /// Keeps the film of `render` in `place`. `held_before` is the number of samples per pixel at the start.
    pub(super) fn new(
        render: &RenderOptions,
        place: SharedPlace,
        held_before: u64,
        seconds_before: Option<f64>,
    ) -> Keeper {
        let (sender, outcomes) = mpsc::channel();
        let writer =
            Arc::new(Writer { place, render: render.clone(), held_before, seconds_before, outcomes: sender });
        let (snapshots, received) = mpsc::channel::<Snapshot>();
        let own = Arc::clone(&writer);
        let write = move || {
            for Snapshot { film, status } in received {
                own.write(&film, &status);
            }
        };
        // If no thread can be started, the tracer writes the film and waits for it.
        let thread = Builder::new().name("keep".to_owned()).spawn(write).ok();
        Keeper {
            every: render.every,
            last: Instant::now(),
            asked: held_before,
            is_under_way: false,
            writer,
            snapshots: thread.is_some().then_some(snapshots),
            thread,
            outcomes,
            kept: None,
        }
    }

    /// Has the film written if it is time. Returns a warning about the last write, if there is one.
    pub(super) fn look(&mut self, progressive: &Progressive, status: &Status) -> Option<String> {
        let words = self.outcomes.try_recv().ok().and_then(|outcome| self.note(outcome));
        if self.is_due(self.last.elapsed(), status.samples_per_pixel) {
            (self.is_under_way, self.asked) = (true, status.samples_per_pixel);
            let (writer, snapshots, status) =
                (Arc::clone(&self.writer), self.snapshots.clone(), status.clone());
            progressive.inspect(move |film| writer.take(film, status, snapshots));
        }
        words
    }

    /// Whether a film of this many samples per pixel is to be written, when the last writing ended `since` ago.
    fn is_due(&self, since: Duration, samples: u64) -> bool {
        !self.is_under_way && since >= self.every && samples > self.asked
    }

    /// Waits until the current checkpoint is written. Returns the samples per pixel in the file, if there is one.
    pub(super) fn finish(mut self) -> Option<u64> {
        self.snapshots = None;
        if let Some(thread) = self.thread.take() {
            // A panic there has already been reported, and the film is written once more anyway.
            let _ = thread.join();
        }
        while let Ok(outcome) = self.outcomes.try_recv() {
            self.note(outcome);
        }
        self.kept
    }

    fn note(&mut self, outcome: Outcome) -> Option<String> {
        (self.is_under_way, self.last) = (false, Instant::now());
        match outcome.samples {
            Some(samples) => self.kept = Some(samples),
            // It was not written, so trying again makes sense even without new samples.
            None => self.asked = 0,
        }
        outcome.words
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::files::Places;
    use crate::batch::tests::options;
    use crate::film::{checkpoint, key};
    use crate::progressive::{Contribution, Plan, RenderRequest};
    use crate::render::BackendInfo;

    #[test]
    fn what_could_not_be_written_is_written_again_even_without_new_samples() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("film.exr");
        let render = options(&["--checkpoint", path.to_str().unwrap()]);
        let mut keeper = Keeper::new(&render, Places::of(&render).unwrap().checkpoint.unwrap(), 0, Some(0.0));
        // The film has one sample per pixel.
        (keeper.asked, keeper.is_under_way) = (1, true);
        let told = keeper.note(Outcome { samples: None, words: Some("the disk is full".to_owned()) });
        assert_eq!((told.as_deref(), keeper.kept), (Some("the disk is full"), None));
        assert!(keeper.asked < 1 && !keeper.is_under_way);
        assert_eq!(keeper.note(Outcome { samples: Some(1), words: None }), None);
        assert_eq!(keeper.kept, Some(1));
    }

    #[test]
    fn a_film_is_due_after_the_pause_if_it_has_grown_and_none_is_being_written() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("film.exr");
        let render = options(&["--checkpoint", path.to_str().unwrap(), "--every", "2s"]);
        let mut keeper = Keeper::new(&render, Places::of(&render).unwrap().checkpoint.unwrap(), 5, None);
        let [early, late] = [1999, 2000].map(Duration::from_millis);
        assert!(keeper.is_due(late, 6));
        assert!(!keeper.is_due(early, 6) && !keeper.is_due(late, 5), "the film was resumed with 5");
        (keeper.asked, keeper.is_under_way) = (6, true);
        assert!(!keeper.is_due(late, 7));
        assert_eq!(keeper.note(Outcome { samples: Some(6), words: None }), None);
        assert!(keeper.is_due(late, 7) && !keeper.is_due(late, 6));
    }

    #[test]
    fn the_film_is_on_disk_while_the_render_goes_on() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("film.exr");
        let render = options(&["--checkpoint", path.to_str().unwrap(), "--every", "0.1s"]);
        let place = Places::of(&render).unwrap().checkpoint.unwrap();
        let mut keeper = Keeper::new(&render, place, 0, Some(0.0));
        let mut progressive = Progressive::spawn().unwrap();
        let backend = crate::backends::BackendChoice::Cpu(crate::render_cpu::CpuOptions::default());
        progressive.start(RenderRequest::new(render.job.clone(), backend, Plan::endless()));
        let mut seen = Vec::new();
        let begin = Instant::now();
        while seen.len() < 3 && begin.elapsed() < Duration::from_secs(60) {
            let status = progressive.wait(Duration::from_millis(20));
            assert_eq!(keeper.look(&progressive, &status), None);
            if let Some(kept) = keeper.kept
                && seen.last() != Some(&kept)
            {
                seen.push(kept);
                let film = checkpoint::load(&path).unwrap().film;
                assert!(film.sample_count() >= kept && film.error().is_some());
            }
        }
        assert_eq!(seen.len(), 3, "{seen:?}");
        assert!(begin.elapsed() >= 2 * render.every, "there is a pause between two writings");
        drop(progressive);
        assert!(keeper.finish() >= seen.last().copied());
        assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 1);
    }

    #[test]
    fn without_a_thread_for_it_the_film_is_written_at_once() {
        for has_thread in [true, false] {
            let directory = tempfile::tempdir().unwrap();
            let path = directory.path().join("film.exr");
            let render = options(&["--checkpoint", path.to_str().unwrap()]);
            let keeper = Keeper::new(&render, Places::of(&render).unwrap().checkpoint.unwrap(), 0, Some(0.0));
            let mut film = render.job.new_film();
            film.record(0..6, 0).unwrap();
            // A thread that has ended listens no more.
            let (ended, _) = mpsc::channel();
            keeper.writer.take(&film, Status::default(), has_thread.then_some(ended));
            assert_eq!(keeper.finish(), Some(6));
            assert!(checkpoint::load(&path).unwrap().film == film);
        }
    }

    #[test]
    fn a_checkpoint_tells_the_seconds_of_the_film_that_is_in_it() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("film.exr");
        let render = options(&["--checkpoint", path.to_str().unwrap()]);
        let keeper = Keeper::new(&render, Places::of(&render).unwrap().checkpoint.unwrap(), 2, Some(1.0));
        let mut film = render.job.new_film();
        film.record(0..6, 0).unwrap();
        let backend = BackendInfo { name: "cpu", device: String::new(), lanes: 8, threads: 1 };
        // The status was read when there were four samples more.
        let status = Status {
            backend: Some(backend.clone()),
            contributions: vec![Contribution { backend, samples_per_pixel: 8 }],
            trace: Duration::from_secs(16),
            ..Status::default()
        };
        keeper.writer.write(&film, &status);
        assert_eq!(keeper.finish(), Some(6));
        let description = checkpoint::load(&path).unwrap().description;
        assert_eq!(description.get(key::SECONDS), Some("9"));
    }
}
