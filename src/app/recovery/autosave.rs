//! Writes the film of a long render beside the window's other files, again and again.

use crate::app::model::document::Document;
use crate::app::tracer::Tracer;
use crate::film::{Film, checkpoint};
use crate::job::recipe::Recipe;
use crate::progressive::Status;
use crate::progressive::describe::describe;
use crate::stages::Stage;
use eframe::egui::Context;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread::Builder;
use std::time::{Duration, Instant};

/// Writing a film takes at most one part in this many of the time.
const SHARE: u32 = 20;

/// A film that was written.
#[derive(Clone, Debug)]
pub struct Saved {
    /// Its picture.
    pub document: Document,
    /// Its samples per pixel.
    pub samples: u64,
}

/// What is written besides the film.
struct Words {
    recipe: Recipe,
    stage: Option<&'static Stage>,
    status: Status,
    held_before: u64,
    seconds_before: Option<f64>,
}

impl Words {
    fn of(document: &Document, status: &Status, seconds_before: Option<f64>) -> Words {
        Words {
            recipe: document.recipe(),
            stage: document.stage().filter(|_| !document.has_changed_scene()),
            held_before: status.samples_per_pixel.saturating_sub(status.added()),
            status: status.clone(),
            seconds_before,
        }
    }

    fn write(mut self, path: &Path, film: &Film) -> Result<u64, String> {
        let samples = film.sample_count();
        let status = self.status.of_film(film, self.held_before);
        self.recipe.samples_per_pixel = samples.max(1);
        let description = describe(&self.recipe, self.stage, film, &status, self.seconds_before);
        checkpoint::save(path, film, &description).map_err(|error| error.to_string())?;
        log::info!("autosave: {samples} samples per pixel in {}", path.display());
        Ok(samples)
    }
}

/// Writes the film of `document` to `path` and returns its samples per pixel.
///
/// # Errors
/// Why it cannot be written.
pub fn write_film(
    path: &Path,
    film: &Film,
    (document, status): (&Document, &Status),
    seconds_before: Option<f64>,
) -> Result<u64, String> {
    Words::of(document, status, seconds_before).write(path, film)
}

struct UnderWay {
    document: Document,
    begun: Instant,
    outcome: Receiver<Result<u64, String>>,
}

/// Has the film written at intervals.
pub struct Autosave {
    every: Duration,
    /// When the next film may be written.
    due: Instant,
    under_way: Option<UnderWay>,
    saved: Option<Saved>,
    has_failed: bool,
}

impl Autosave {
    /// Films that took longer than `every` are written, and again each `every`.
    pub fn new(every: Duration) -> Self {
        Autosave { every, due: Instant::now(), under_way: None, saved: None, has_failed: false }
    }

    /// The film that was written last.
    pub fn saved(&self) -> Option<&Saved> {
        self.saved.as_ref()
    }

    /// Notes that the file holds this film.
    pub fn holds(&mut self, saved: Option<Saved>) {
        self.saved = saved;
        self.due = Instant::now() + self.every;
    }

    /// Whether the film of `document` is worth recovery: tracing it has taken long enough.
    pub fn is_long(
        &self,
        document: &Document,
        main: &Tracer,
        status: &Status,
        seconds_before: Option<f64>,
    ) -> bool {
        let seconds = seconds_before.unwrap_or(f64::INFINITY) + status.trace.as_secs_f64();
        main.is_full(document) && status.samples_per_pixel > 0 && seconds >= self.every.as_secs_f64()
    }

    /// Has the film written to `path` if it is time. The render thread only copies it, if there is room for a copy.
    /// Returns why the last film could not be written, once.
    pub fn look(
        &mut self,
        context: &Context,
        path: &Path,
        (document, main): (&Document, &Tracer),
        status: &Status,
        seconds_before: Option<f64>,
    ) -> Option<String> {
        let words = self.take_outcome();
        let has_all = self.saved.as_ref().is_some_and(|saved| {
            saved.samples >= status.samples_per_pixel && saved.document.has_same_film(document)
        });
        if self.under_way.is_some() || has_all || !self.is_long(document, main, status, seconds_before) {
            return words;
        }
        let wait = self.due.saturating_duration_since(Instant::now());
        if !wait.is_zero() {
            context.request_repaint_after(wait);
            return words;
        }
        let (sender, outcome) = channel();
        self.under_way = Some(UnderWay { document: document.clone(), begun: Instant::now(), outcome });
        let writing = Writing {
            words: Words::of(document, status, seconds_before),
            path: path.to_owned(),
            sender,
            context: context.clone(),
        };
        main.inspect(move |film| writing.begin(film));
        words
    }

    /// Waits for a film that is being written.
    pub fn finish(&mut self) {
        if let Some(under_way) = self.under_way.take() {
            // It is dropped unanswered if there was no film.
            let outcome = under_way.outcome.recv();
            self.note(under_way, outcome.ok());
        }
    }

    fn take_outcome(&mut self) -> Option<String> {
        let under_way = self.under_way.take()?;
        match under_way.outcome.try_recv() {
            Ok(outcome) => self.note(under_way, Some(outcome)),
            Err(TryRecvError::Disconnected) => self.note(under_way, None),
            Err(TryRecvError::Empty) => {
                self.under_way = Some(under_way);
                None
            }
        }
    }

    fn note(&mut self, under_way: UnderWay, outcome: Option<Result<u64, String>>) -> Option<String> {
        self.due = Instant::now() + self.every.max(under_way.begun.elapsed() * SHARE);
        match outcome? {
            Ok(samples) => {
                self.saved = Some(Saved { document: under_way.document, samples });
                self.has_failed = false;
                None
            }
            Err(reason) => {
                let is_news = !std::mem::replace(&mut self.has_failed, true);
                is_news.then(|| {
                    format!("Not autosaved: {reason}; rendering continues, and saving is tried again")
                })
            }
        }
    }
}

/// A film to be written, on whatever thread.
struct Writing {
    words: Words,
    path: PathBuf,
    sender: Sender<Result<u64, String>>,
    context: Context,
}

impl Writing {
    /// Runs on the render thread.
    fn begin(self, film: &Film) {
        if film.sample_count() == 0 {
            return;
        }
        let Some(copy) = film.try_copy().ok() else {
            self.write(film);
            return;
        };
        let (hand, taken) = channel::<Writing>();
        let thread = Builder::new().name("autosave".to_owned()).spawn(move || {
            if let Ok(writing) = taken.recv() {
                writing.write(&copy);
            }
        });
        match thread {
            Ok(_) => _ = hand.send(self),
            // Without a thread, the tracer writes the film and waits for it.
            Err(_) => self.write(film),
        }
    }

    fn write(self, film: &Film) {
        let outcome = self.words.write(&self.path, film);
        // If the window was closed, nobody receives it.
        let _ = self.sender.send(outcome);
        self.context.request_repaint();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::origin::Origin;
    use crate::app::tests::{sleep_after, until, window};
    use crate::app::window::Window;

    #[test]
    fn slow_writing_takes_a_small_share_of_the_time() {
        let every = Duration::from_secs(60);
        let wait_after = |seconds: u64| {
            let mut autosave = Autosave::new(every);
            let begun = Instant::now().checked_sub(Duration::from_secs(seconds)).unwrap();
            let (_, outcome) = channel();
            let document = Document::new(Origin::usual());
            assert_eq!(autosave.note(UnderWay { document, begun, outcome }, Some(Ok(7))), None);
            assert_eq!(autosave.saved().unwrap().samples, 7);
            autosave.due.saturating_duration_since(Instant::now()).as_secs_f64().round()
        };
        assert_eq!(wait_after(0), 60.0);
        assert_eq!(wait_after(10), 200.0, "20 times as long as writing took");
    }

    #[test]
    fn the_same_fault_is_told_once() {
        let mut autosave = Autosave::new(Duration::ZERO);
        let mut tell = |outcome: Result<u64, &str>| {
            let (_, receiver) = channel();
            let document = Document::new(Origin::usual());
            let under_way = UnderWay { document, begun: Instant::now(), outcome: receiver };
            autosave.note(under_way, Some(outcome.map_err(str::to_owned)))
        };
        let told = tell(Err("the disk is full")).unwrap();
        assert!(told.starts_with("Not autosaved: the disk is full"), "{told}");
        assert_eq!(tell(Err("the disk is full")), None);
        assert_eq!(tell(Ok(1)), None);
        assert!(tell(Err("the disk is full")).is_some(), "again after it worked");
    }

    /// A window with a finished picture of 4 samples per pixel.
    fn finished(context: &Context) -> Window {
        let mut window = window("weekender --stage glass-schlick --size 16x9 --samples 4 --device cpu");
        let is_over =
            |window: &Window| window.main.has_samples(window.document()) && window.status().phase.is_over();
        until(&mut window, context, "the end", is_over);
        window
    }

    #[test]
    fn a_film_is_written_unless_all_of_it_was() {
        let (context, directory) = (Context::default(), tempfile::tempdir().unwrap());
        let (window, path) = (finished(&context), directory.path().join("film.exr"));
        let (document, status) = (window.document().clone(), window.status());
        let mut other = document.clone();
        other.settings.seed += 1;
        for (held, is_written) in [
            (None, true),
            (Some((&document, 3)), true),
            (Some((&document, 4)), false),
            (Some((&document, 5)), false),
            (Some((&other, 4)), true),
            (Some((&other, 100)), true),
        ] {
            let mut autosave = Autosave::new(Duration::ZERO);
            autosave.holds(held.map(|(document, samples)| Saved { document: document.clone(), samples }));
            assert_eq!(autosave.look(&context, &path, (&document, &window.main), status, Some(0.0)), None);
            autosave.finish();
            let saved = autosave.saved().unwrap();
            assert!(saved.document.has_same_film(&document));
            assert_eq!(std::fs::remove_file(&path).is_ok(), is_written, "{:?}", held.map(|(_, held)| held));
            assert!(!is_written || saved.samples == 4);
        }
    }

    #[test]
    fn a_film_is_not_written_again_before_its_time() {
        let (context, directory) = (Context::default(), tempfile::tempdir().unwrap());
        let (window, path) = (finished(&context), directory.path().join("film.exr"));
        let (document, status) = (window.document().clone(), window.status());
        let hour = Duration::from_secs(3600);
        let mut autosave = Autosave::new(hour);
        autosave.holds(Some(Saved { document: document.clone(), samples: 3 }));
        let begin = Instant::now();
        for (due, samples) in [(begin + hour, 3), (begin, 4)] {
            autosave.due = due;
            let look = |context: &Context| {
                let shown = (&document, &window.main);
                assert_eq!(autosave.look(context, &path, shown, status, Some(1e6)), None);
                autosave.finish();
            };
            let sleep = sleep_after(&context, look);
            assert_eq!((autosave.saved().unwrap().samples, path.exists()), (samples, samples == 4));
            assert!(samples == 4 || sleep <= hour, "it is looked at again");
        }
        assert!(autosave.due >= begin + hour);
    }
}
