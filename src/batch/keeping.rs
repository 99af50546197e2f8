//! Checkpoints: the film is written at intervals during a render, so a crash loses only the samples since the last one.

use super::files::Files;
use crate::film::Film;
use crate::progressive::{Progressive, Status};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, TryRecvError};
use std::thread::Builder;
use std::time::Instant;

/// Writes the film at intervals, from a copy and on a separate thread. Without memory for a copy, the tracer waits for
/// the write.
pub(super) struct Keeper {
    files: Arc<Files>,
    /// When the last write ended.
    last: Instant,
    /// Samples per pixel in the film last sent for writing.
    asked: u64,
    /// Outcome of the write in progress.
    pending: Option<Receiver<Outcome>>,
}

/// A note for the user, or why the write failed.
type Outcome = Result<Option<String>, String>;

impl Keeper {
    /// Keeps the film in the checkpoint.
    pub fn new(files: &Arc<Files>) -> Keeper {
        let (files, asked) = (Arc::clone(files), files.held_before);
        Keeper { files, last: Instant::now(), asked, pending: None }
    }

    /// Starts a write if it is time. Returns a warning if the last one failed.
    pub fn look(&mut self, progressive: &Progressive, status: &Status) -> Option<String> {
        let warning = match self.pending.as_ref().map(Receiver::try_recv) {
            Some(Err(TryRecvError::Empty)) => return None,
            Some(outcome) => {
                self.note(outcome.unwrap_or_else(|_| Err("a checkpoint was not written".to_owned())))
            }
            None => None,
        };
        if self.last.elapsed() >= self.files.options.every && status.samples_per_pixel > self.asked {
            self.asked = status.samples_per_pixel;
            let (sender, receiver) = mpsc::channel();
            self.pending = Some(receiver);
            let (files, status) = (Arc::clone(&self.files), status.clone());
            // The render may be over, and the outcome unread.
            let keep = Arc::new(move |film: &Film| drop(sender.send(files.save_checkpoint(film, &status))));
            progressive.inspect(move |film| {
                let own = Arc::clone(&keep);
                let spawn = |copy| Builder::new().name("keep".to_owned()).spawn(move || own(&copy));
                if film.try_copy().is_ok_and(|copy| spawn(copy).is_ok()) {
                    return;
                }
                keep(film);
            });
        }
        warning
    }

    /// Waits until the current checkpoint is written. If that fails, the last write will say so.
    pub fn finish(self) {
        let _ = self.pending.map(|pending| pending.recv());
    }

    fn note(&mut self, outcome: Outcome) -> Option<String> {
        (self.pending, self.last) = (None, Instant::now());
        outcome.unwrap_or_else(|reason| {
            // Retry even without new samples.
            self.asked = 0;
            Some(format!("{reason}; rendering continues, and the write will be retried"))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::tests::options;
    use crate::film::checkpoint;
    use crate::progressive::{Phase, Plan, RenderRequest};
    use std::time::Duration;

    #[test]
    fn failed_checkpoint_writes_are_retried() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("kept/film.exr");
        let flags = ["--checkpoint", path.to_str().unwrap(), "--every", "0.1s", "--samples", "4294967296"];
        let render = options(&flags);
        let mut keeper = Keeper::new(&Arc::new(Files::lock(render.clone(), Duration::ZERO).unwrap()));
        let mut progressive = Progressive::spawn().unwrap();
        let backend = crate::backends::BackendChoice::Reference { threads: Some(1) };
        let mut warnings = Vec::new();
        let status = progressive.watch(
            RenderRequest::new(render.job.clone(), backend, Plan::endless()),
            |progressive, status| {
                if let Some(warning) = keeper.look(progressive, status) {
                    // The directory is missing at first.
                    let _ = std::fs::create_dir(directory.path().join("kept"));
                    warnings.push(warning);
                }
                if path.exists() || status.elapsed > Duration::from_secs(60) {
                    progressive.stop();
                }
            },
        );
        assert!(matches!(status.phase, Phase::Done(_)), "{status:?}");
        assert!(warnings[0].contains("will be retried"), "{warnings:?}");
        keeper.finish();
        let kept = checkpoint::load(&path).unwrap().film.sample_count();
        assert!(kept > 0 && kept <= progressive.take_film().unwrap().sample_count());
    }
}
