//! Autosave: every edit at once, as text; long films at intervals, on exit and on a panic. The next window restores them.
//! Only the window that holds the lock saves. A window that crashes leaves the lock file behind.

use super::describer;
use super::edits::{self, STEPS};
use crate::app::model::changes::Changes;
use crate::app::model::{Document, Model};
use crate::app::toolkit::Answers;
use crate::app::tracing::Tracing;
use crate::film::{Description, Film, checkpoint};
use crate::job::saved;
use crate::progressive::describe::counted;
use crate::system::console;
use crate::system::files::{lock_path, write_text};
use eframe::egui::Context;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Writing films takes at most 1 / `SHARE` of the time.
const SHARE: u32 = 20;

/// Edits of scenes with up to this many spheres are written without delay.
const AT_ONCE: usize = 10_000;

/// How long to wait for the lock of a window that is closing.
const PATIENCE: Duration = Duration::from_millis(200);

/// A film that took so long is not replaced by that of another picture, seconds of tracing.
const WORTH_SECONDS: f64 = 60.0;

/// File name prefix of recovered files that wait for the user's decision.
const LEFT: &str = "recovered";

/// The picture of a film, and how many samples per pixel it has.
pub fn picture_of(path: &Path) -> Option<(Document, u64)> {
    let saved = saved::open(path).ok()?;
    Some((Document::of_film(&saved.recipe, saved.stage()), saved.samples()?))
}

/// The document at the size of the film at `path`, if the film is one of this document.
fn with_film(document: &Document, path: &Path) -> Option<Document> {
    let theirs = saved::open(path).ok()?.recipe;
    let mut document = document.clone();
    if !document.has_own_size {
        document.set_size([theirs.settings.width, theirs.settings.height]);
    }
    (document.job(1).ok()? == theirs.job().ok()?).then_some(document)
}

/// The autosave directory, locked by this window.
struct Place {
    directory: PathBuf,
    _lock: File,
}

impl Place {
    /// Locks the directory, and tells whether the last window crashed. `None` if another window holds the lock or the
    /// directory is not writable.
    fn claim(directory: &Path) -> Option<(Self, bool)> {
        fs::create_dir_all(directory).ok()?;
        let path = lock_in(directory);
        let has_ended_early = path.exists();
        let lock = lock_path(&path, PATIENCE)
            .inspect_err(|error| log::info!("autosave is off in this window: {error}"))
            .ok()?;
        Some((Place { directory: directory.to_owned(), _lock: lock }, has_ended_early))
    }

    fn film(&self) -> PathBuf {
        self.directory.join("autosave.exr")
    }

    fn edits(&self) -> PathBuf {
        self.directory.join("edits.json")
    }

    /// Renames a file so that it stays until the user decides.
    fn set_aside(&self, path: &Path) {
        let ending = path.extension().unwrap_or_default().display();
        let named = |number: u32| self.directory.join(format!("{LEFT}-{number}.{ending}"));
        if let Some(free) = (1..).map(named).find(|free| !free.exists())
            && path.exists()
            && let Err(error) = fs::rename(path, &free)
        {
            log::warn!("{} cannot be kept as {}: {error}", path.display(), free.display());
        }
    }
}

/// Removed when a window exits cleanly.
fn lock_in(directory: &Path) -> PathBuf {
    directory.join("window.lock")
}

/// A file that is written in the background, with the key of its last or current content.
struct Writing<K> {
    written: Option<K>,
    begun: Instant,
    due: Instant,
    outcomes: Answers<()>,
    has_failed: bool,
}

impl<K> Default for Writing<K> {
    fn default() -> Self {
        let (begun, due) = (Instant::now(), Instant::now());
        Writing { written: None, begun, due, outcomes: Answers::default(), has_failed: false }
    }
}

impl<K: PartialEq> Writing<K> {
    /// Takes the outcomes. Reports the first of several failures in a row.
    fn follow(&mut self, pause: impl Fn(Duration) -> Duration) -> Option<String> {
        let mut told = None;
        while let Some(outcome) = self.outcomes.take() {
            self.due = Instant::now() + pause(self.begun.elapsed());
            let has_failed = std::mem::replace(&mut self.has_failed, outcome.is_err());
            told = outcome.err().filter(|_| !has_failed);
        }
        told
    }

    /// Whether `now` has to be written now.
    fn is_due(&mut self, context: &Context, now: K) -> bool {
        if self.outcomes.is_open() || self.written.as_ref() == Some(&now) {
            return false;
        }
        let wait = self.due.saturating_duration_since(Instant::now());
        if !wait.is_zero() {
            context.request_repaint_after(wait);
            return false;
        }
        (self.written, self.begun) = (Some(now), Instant::now());
        true
    }
}

/// What the last window was at.
#[derive(Default)]
pub struct Last {
    /// The last steps of its history, with the picture at its end.
    pub steps: Vec<Document>,
    /// The film of that picture.
    pub film: Option<PathBuf>,
    pub has_ended_early: bool,
}

pub struct Autosave {
    place: Option<Place>,
    every: Duration,
    /// By run and samples per pixel.
    films: Writing<(u64, u64)>,
    edits: Writing<Document>,
    /// The recovered file that is being offered, and those that the user has accepted.
    offered: Option<PathBuf>,
    answered: Vec<PathBuf>,
    /// Whether the last window's film is still being read and must not be overwritten.
    pub is_restoring: bool,
}

impl Autosave {
    /// Saves edits in `directory` at once, and films of renders longer than `every` at that interval. Returns the last
    /// window's document if `goes_on`; otherwise, its film is kept if it took long, and all of its files if it crashed.
    pub fn new(directory: Option<&Path>, every: Duration, goes_on: bool) -> (Self, Last) {
        let claimed = directory.and_then(Place::claim);
        let mut last = Last::default();
        if let Some((place, has_ended_early)) = &claimed {
            let (film, mut steps) = (place.film(), edits::read(&place.edits()));
            if steps.is_empty() {
                steps.extend(picture_of(&film).map(|(document, _)| document));
            }
            let with_film = steps.last().and_then(|document| with_film(document, &film));
            let is_long = || {
                let seconds = saved::open(&film).ok().and_then(|saved| saved.seconds());
                seconds.is_some_and(|seconds| seconds >= WORTH_SECONDS)
            };
            if !(goes_on && with_film.is_some()) && (*has_ended_early || is_long()) {
                place.set_aside(&film);
            }
            if !goes_on && *has_ended_early && with_film.is_none() && steps.iter().any(Document::is_changed) {
                place.set_aside(&place.edits());
            }
            if goes_on {
                last.film = with_film.is_some().then_some(film);
                if let (Some(shown), Some(with_film)) = (steps.last_mut(), with_film) {
                    *shown = with_film;
                }
                (last.steps, last.has_ended_early) = (steps, *has_ended_early);
            }
        }
        let autosave = Autosave {
            place: claimed.map(|(place, _)| place),
            every,
            films: Writing::default(),
            edits: Writing { written: last.steps.last().cloned(), ..Writing::default() },
            offered: None,
            answered: Vec::new(),
            is_restoring: last.film.is_some(),
        };
        (autosave, last)
    }

    /// The newest recovered file that the user has not decided about: its document, and the samples per pixel if it is a
    /// film.
    pub fn offer(&mut self) -> Option<(Document, Option<u64>)> {
        let entries = fs::read_dir(&self.place.as_ref()?.directory).ok()?;
        let is_left = |path: &PathBuf| {
            let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
            name.starts_with(LEFT) && !self.is_answered(path)
        };
        let mut paths: Vec<_> = entries.flatten().map(|entry| entry.path()).filter(is_left).collect();
        paths.sort_by_key(|path| fs::metadata(path).and_then(|found| found.modified()).ok());
        let offer = |path: PathBuf| {
            let film = picture_of(&path).map(|(document, samples)| (document, Some(samples)));
            Some((film.or_else(|| Some((edits::read(&path).pop()?, None)))?, path))
        };
        let (found, path) = paths.into_iter().rev().find_map(offer)?;
        self.offered = Some(path);
        Some(found)
    }

    /// Whether the user has accepted this recovered file.
    pub fn is_answered(&self, path: &Path) -> bool {
        self.answered.iter().any(|answered| answered == path)
    }

    /// Accepts the offered file, which is deleted when this window exits cleanly.
    pub fn take_offered(&mut self) -> Option<PathBuf> {
        let path = self.offered.take()?;
        self.answered.push(path.clone());
        Some(path)
    }

    /// Deletes the offered file.
    pub fn delete_offered(&mut self) {
        self.offered.take().into_iter().for_each(|path| drop(fs::remove_file(path)));
    }

    /// Whether the last write failed.
    pub fn has_failed(&self) -> bool {
        self.films.has_failed || self.edits.has_failed
    }

    /// Saves new edits, and the film if it is due. Reports each failure once.
    pub fn follow(
        &mut self,
        context: &Context,
        (document, changes): (&Document, &Changes),
        tracing: &Tracing,
    ) -> Option<String> {
        let is_small = document.scene().spheres.len() <= AT_ONCE;
        let told = self.edits.follow(|took| if is_small { Duration::ZERO } else { took * SHARE });
        if let Some(place) = self.place.as_ref().filter(|_| !changes.is_in_gesture)
            && self.edits.is_due(context, document.clone())
        {
            let (path, steps) = (place.edits(), changes.last_steps(document, STEPS));
            self.edits.outcomes.ask("edits", context, move || write_edits(&path, &steps));
        }
        if self.is_restoring { told } else { self.follow_film(context, document, tracing).or(told) }
    }

    /// Writes the film in the background if it is due. The render thread only copies it.
    fn follow_film(&mut self, context: &Context, document: &Document, tracing: &Tracing) -> Option<String> {
        let every = self.every;
        let told = self.films.follow(|took| every.max(took * SHARE));
        let place = self.place.as_ref()?;
        let status = tracing.main.status();
        let is_long = tracing.main.has_samples(document)
            && tracing.seconds().is_none_or(|seconds| seconds >= self.every.as_secs_f64());
        if !is_long || !self.films.is_due(context, (status.run, status.samples_per_pixel)) {
            return told;
        }
        let (path, describe) =
            (place.film(), describer(document, tracing.main.status(), tracing.seconds_before));
        // The film may be gone before it is copied; that is not a failure.
        let answer = self.films.outcomes.answer(context);
        tracing.main.inspect(move |film| {
            let write = move |film: &Film| write(&path, film, &describe(film));
            match film.try_copy() {
                Ok(copy) => answer.give_from("autosave", move || write(&copy)),
                Err(_) => answer.give(write(film)),
            }
        });
        told
    }

    /// Saves edits and film on exit. Without a lock, a panic saves the film elsewhere.
    pub fn end(&mut self, model: &Model, changes: &Changes, tracing: &mut Tracing) {
        let _ = (self.films.outcomes.wait(), self.edits.outcomes.wait());
        let is_panic = std::thread::panicking();
        if let Some(place) =
            self.place.as_ref().filter(|_| self.edits.written.as_ref() != Some(&model.document))
        {
            let _ = write_edits(&place.edits(), &changes.last_steps(&model.document, STEPS));
        }
        let is_kept = self.place.is_some() || is_panic;
        if is_kept && !self.is_restoring {
            // A film may still wait for the run that continues it.
            let (film, status) = match tracing.film.take() {
                Some(film) => (Some(film), Arc::default()),
                None if tracing.main.has_samples(&model.document) => {
                    let status = Arc::clone(tracing.main.status());
                    (tracing.main.take_film(), status)
                }
                None => (None, Arc::default()),
            };
            if let Some(film) = film.filter(|film| film.sample_count() > 0) {
                let describe = describer(&model.document, &status, tracing.seconds_before);
                self.save_last(&film, &describe(&film), &model.document.name());
            }
        }
        if let Some(place) = self.place.as_ref().filter(|_| !is_panic) {
            self.answered.iter().for_each(|path| drop(fs::remove_file(path)));
            let _ = fs::remove_file(lock_in(&place.directory));
        }
    }

    fn save_last(&self, film: &Film, description: &Description, name: &str) {
        let words = format!("the picture's {} per pixel were saved", counted(film.sample_count(), "sample"));
        let continued = |path: &Path| format!("continue with --resume {}", path.display());
        if let Some(place) = &self.place
            && write(&place.film(), film, description).is_ok()
        {
            if std::thread::panicking() {
                console::note(&format!(
                    "{words}; the next window continues with them, or {}",
                    continued(&place.film())
                ));
            }
            return;
        }
        let outcome = saved::rescue(&[], name, film, description);
        console::note(&outcome.map_or_else(|lost| lost, |path| format!("{words}; {}", continued(&path))));
    }
}

fn write_edits(path: &Path, steps: &[Document]) -> Result<(), String> {
    write_text(path, &edits::to_text(steps)).map_err(|error| error.to_string())
}

fn write(path: &Path, film: &Film, description: &Description) -> Result<(), String> {
    log::info!("autosave: {} samples per pixel in {}", film.sample_count(), path.display());
    checkpoint::save(path, film, description).map_err(|error| error.to_string())
}
