//! What the window saves by itself: each edit at once, as text, and long films at intervals, at the end and on a panic. The
//! next window goes on with them. A lock keeps several windows apart; a window that does not end in order leaves it behind.

use super::describer;
use super::edits::{self, STEPS};
use crate::app::model::changes::Changes;
use crate::app::model::{Document, Model};
use crate::app::toolkit::Answers;
use crate::app::tracing::Tracing;
use crate::film::{Description, Film, checkpoint};
use crate::job::saved::{self, Saved};
use crate::progressive::describe::counted;
use crate::system::console;
use crate::system::files::{lock_path, write_text};
use eframe::egui::Context;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Writing a film takes at most one part in this many of the time.
const SHARE: u32 = 20;

/// Edits of scenes with at most so many spheres are written at once, however busy the machine is.
const AT_ONCE: usize = 10_000;

/// How long a window waits for another that is about to end.
const PATIENCE: Duration = Duration::from_millis(200);

/// What the names of files begin with that wait for the user's answer.
const LEFT: &str = "recovered";

/// The picture of a film, and how many samples per pixel it has.
pub fn picture_of(path: &Path) -> Option<(Document, u64)> {
    let saved = Saved::describe(path).ok()?;
    Some((Document::of_film(&saved.recipe().ok()?, saved.stage()), saved.samples()?))
}

/// The document at the size of the film in the file at `path`, if that is its film.
fn with_film(document: &Document, path: &Path) -> Option<Document> {
    let saved = Saved::describe(path).ok()?;
    let theirs = saved.recipe().ok()?;
    let mut document = document.clone();
    if !document.has_own_size {
        document.set_size([theirs.settings.width, theirs.settings.height]);
    }
    (document.job(1).ok()? == theirs.job().ok()?).then_some(document)
}

/// The files of the window that has locked them.
struct Place {
    directory: PathBuf,
    _lock: File,
}

impl Place {
    /// With whether the last window ended early. `None` if another window has it, or nothing can be written.
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

    /// Keeps a file until the user has answered what to do with it.
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

/// A window that ends in order removes it.
fn lock_in(directory: &Path) -> PathBuf {
    directory.join("window.lock")
}

/// A file that is written in the background, and what of it was written last, or is being written.
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
    /// Takes the outcomes. Returns why the last was none, once.
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
    /// The file of a window that ended early that is offered, and those with which the user goes on.
    offered: Option<PathBuf>,
    answered: Vec<PathBuf>,
    /// The film of the last window is read, and must not be replaced before.
    pub is_restoring: bool,
}

impl Autosave {
    /// Edits are saved in `directory` at once, and films that took longer than `every` each `every`. What the last window
    /// was at is returned if this one goes on with it; if the last one ended early, it is kept otherwise.
    pub fn new(directory: Option<&Path>, every: Duration, goes_on: bool) -> (Self, Last) {
        let claimed = directory.and_then(Place::claim);
        let mut last = Last::default();
        if let Some((place, has_ended_early)) = &claimed {
            let (film, mut steps) = (place.film(), edits::read(&place.edits()));
            if steps.is_empty() {
                steps.extend(picture_of(&film).map(|(document, _)| document));
            }
            let with_film = steps.last().and_then(|document| with_film(document, &film));
            if *has_ended_early && !(goes_on && with_film.is_some()) {
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

    /// The next file of windows that ended early about which the user has said nothing yet, newest first: its document, and
    /// samples per pixel if it is a film.
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

    /// Whether the user goes on with this file of a window that ended early.
    pub fn is_answered(&self, path: &Path) -> bool {
        self.answered.iter().any(|answered| answered == path)
    }

    /// The user goes on with the file that was offered. It is deleted when this window ends in order.
    pub fn take_offered(&mut self) -> Option<PathBuf> {
        let path = self.offered.take()?;
        self.answered.push(path.clone());
        Some(path)
    }

    /// The user wants the file deleted that was offered.
    pub fn delete_offered(&mut self) {
        self.offered.take().into_iter().for_each(|path| drop(fs::remove_file(path)));
    }

    /// Whether the last try to write something has failed.
    pub fn has_failed(&self) -> bool {
        self.films.has_failed || self.edits.has_failed
    }

    /// Saves what has been edited, and the film if it is time. Returns why something could not be written, once.
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

    /// Has the film written if it is time. The render thread only copies it.
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
        // A film that is gone before it is copied is no failure.
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

    /// Saves edits and film at the end of the window. Where it has no place of its own, a panic saves the film elsewhere.
    pub fn end(&mut self, model: &Model, changes: &Changes, tracing: &mut Tracing) {
        let _ = (self.films.outcomes.wait(), self.edits.outcomes.wait());
        let is_panic = std::thread::panicking();
        if let Some(place) =
            self.place.as_ref().filter(|_| self.edits.written.as_ref() != Some(&model.document))
        {
            let _ = write_edits(&place.edits(), &changes.last_steps(&model.document, STEPS));
        }
        let is_kept = self.place.is_some() || is_panic;
        if is_kept && !self.is_restoring && tracing.main.has_samples(&model.document) {
            let describe = describer(&model.document, tracing.main.status(), tracing.seconds_before);
            if let Some(film) = tracing.main.take_film().filter(|film| film.sample_count() > 0) {
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
                    "{words}; the next window goes on with them, or {}",
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
