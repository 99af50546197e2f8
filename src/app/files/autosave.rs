//! The film that the window saves by itself: at intervals, at the end and on a panic. The next window goes on with it.
//! A lock keeps several windows apart; a window that does not end in order leaves it behind.

use super::describer;
use crate::app::model::{CheckedScene, Document, Model, Origin, Source};
use crate::app::toolkit::Answers;
use crate::app::tracing::Tracing;
use crate::film::{Description, Film, checkpoint};
use crate::job::recipe::{Recipe, file};
use crate::job::saved::{self, Saved};
use crate::progressive::Stop;
use crate::progressive::describe::counted;
use crate::stages::Stage;
use crate::system::console;
use crate::system::files::lock_path;
use eframe::egui::Context;
use serde::{Deserialize, Serialize};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Writing a film takes at most one part in this many of the time.
const SHARE: u32 = 20;

/// How long a window waits for another that is about to end.
const PATIENCE: Duration = Duration::from_millis(200);

/// The entry of a film's description with the [`Note`].
const NOTE: &str = "Window";

/// What the window adds to the description of its film, as JSON.
#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
struct Note {
    stage: Option<String>,
    file: Option<String>,
    /// Samples, seconds, error.
    stop: (Option<u64>, Option<f64>, Option<f64>),
    has_own_size: bool,
    is_from_file: bool,
}

impl Note {
    fn of(document: &Document) -> Self {
        let file = match &document.origin.source {
            Source::File(path) => path.to_str().map(str::to_owned),
            _ => None,
        };
        let Stop { samples, seconds, noise, .. } = document.stop;
        Note {
            stage: document.stage().map(|stage| stage.id.to_owned()),
            file,
            stop: (samples, seconds, noise),
            has_own_size: document.has_own_size,
            is_from_file: document.is_from_file,
        }
    }

    fn origin(&self) -> Option<Origin> {
        match (&self.stage, &self.file) {
            (Some(id), _) => Stage::find(id).ok().map(Origin::of_stage),
            (None, Some(path)) => {
                let path = PathBuf::from(path);
                file::load(&path).ok().map(|recipe| Origin::new(recipe, Source::File(path)))
            }
            (None, None) => None,
        }
    }
}

/// The picture of a film, and how many samples per pixel it has.
pub fn picture_of(path: &Path) -> Option<(Document, u64)> {
    let saved = Saved::describe(path).ok()?;
    Some((document_of(&saved, &saved.recipe().ok()?), saved.samples()?))
}

/// The document of a film or picture. One that a window has saved by itself is as it was there.
pub fn document_of(saved: &Saved, recipe: &Recipe) -> Document {
    let note = saved.description.get(NOTE).and_then(|note| serde_json::from_str::<Note>(note).ok());
    let Some(note) = note else { return Document::of_film(recipe, saved.stage()) };
    let origin = note.origin().filter(|origin| origin.recipe.rules == recipe.rules);
    let mut document = Document::new(origin.unwrap_or_else(|| Origin::guess(recipe, saved.stage())));
    if *document.scene() != *recipe.scene {
        document.checked = Arc::new(CheckedScene::new(Arc::clone(&recipe.scene), recipe.rules));
    }
    (document.camera, document.settings) = (recipe.camera, recipe.settings);
    (document.has_own_size, document.is_from_file) = (note.has_own_size, note.is_from_file);
    let (samples, seconds, noise) = note.stop;
    document.stop = Stop { samples, seconds, noise, ..Stop::default() };
    document
}

/// The files of the window that has locked them.
struct Place {
    directory: PathBuf,
    _lock: File,
}

impl Place {
    /// `None` if another window has it, or nothing can be written.
    fn claim(directory: &Path) -> Option<Self> {
        fs::create_dir_all(directory).ok()?;
        let path = lock_in(directory);
        let has_ended_early = path.exists();
        let lock = lock_path(&path, PATIENCE)
            .inspect_err(|error| log::info!("this window does not save its film by itself: {error}"))
            .ok()?;
        let place = Place { directory: directory.to_owned(), _lock: lock };
        if has_ended_early {
            // So that this window's own film does not replace it. There may be none.
            let _ = fs::rename(place.film(), place.left());
        } else {
            let _ = fs::remove_file(place.left());
        }
        Some(place)
    }

    fn film(&self) -> PathBuf {
        self.directory.join("autosave.exr")
    }

    /// The film of a window that ended early.
    fn left(&self) -> PathBuf {
        self.directory.join("recovered.exr")
    }
}

/// A window that ends in order removes it.
fn lock_in(directory: &Path) -> PathBuf {
    directory.join("window.lock")
}

pub struct Autosave {
    place: Option<Place>,
    every: Duration,
    due: Instant,
    /// Run and samples per pixel of the film that was written, or is being written.
    written: (u64, u64),
    begun: Instant,
    outcomes: Answers<()>,
    has_failed: bool,
    /// The film of the last window is read, and must not be replaced before.
    pub is_restoring: bool,
}

impl Autosave {
    /// Films that took longer than `every` are saved in `directory`, and again each `every`.
    pub fn new(directory: Option<&Path>, every: Duration) -> Self {
        Autosave {
            place: directory.and_then(Place::claim),
            every,
            due: Instant::now(),
            written: (0, 0),
            begun: Instant::now(),
            outcomes: Answers::default(),
            has_failed: false,
            is_restoring: false,
        }
    }

    /// The film of the last window, if that ended in order.
    pub fn last(&self) -> Option<PathBuf> {
        self.place.as_ref().map(Place::film).filter(|path| path.exists())
    }

    /// The film of the last window, if that ended early.
    pub fn left(&self) -> Option<PathBuf> {
        self.place.as_ref().map(Place::left).filter(|path| path.exists())
    }

    /// Has the film written if it is time. The render thread only copies it. Returns why it could not be written, once.
    pub fn follow(&mut self, context: &Context, document: &Document, tracing: &Tracing) -> Option<String> {
        let mut told = None;
        while let Some(outcome) = self.outcomes.take() {
            self.due = Instant::now() + self.every.max(self.begun.elapsed() * SHARE);
            let has_failed = std::mem::replace(&mut self.has_failed, outcome.is_err());
            told = outcome.err().filter(|_| !has_failed);
        }
        let place = self.place.as_ref()?;
        let status = tracing.main.status();
        let now = (status.run, status.samples_per_pixel);
        let is_long = tracing.main.has_samples(document)
            && tracing.seconds().is_none_or(|seconds| seconds >= self.every.as_secs_f64());
        if !is_long || self.outcomes.is_open() || now == self.written {
            return told;
        }
        let wait = self.due.saturating_duration_since(Instant::now());
        if !wait.is_zero() {
            context.request_repaint_after(wait);
            return told;
        }
        (self.written, self.begun) = (now, Instant::now());
        let (path, describe) = (place.film(), describe(document, tracing));
        // A film that is gone before it is copied is no failure.
        let answer = self.outcomes.answer(context);
        tracing.main.inspect(move |film| {
            let write = move |film: &Film| write(&path, film, &describe(film));
            match film.try_copy() {
                Ok(copy) => answer.give_from("autosave", move || write(&copy)),
                Err(_) => answer.give(write(film)),
            }
        });
        told
    }

    /// Saves the film at the end of the window. Where it has no place of its own, a panic saves it elsewhere.
    pub fn end(&mut self, model: &Model, tracing: &mut Tracing) {
        let _ = self.outcomes.wait();
        let is_panic = std::thread::panicking();
        let is_kept = self.place.is_some() || is_panic;
        if is_kept && !self.is_restoring && tracing.main.has_samples(&model.document) {
            let describe = describe(&model.document, tracing);
            if let Some(film) = tracing.main.take_film().filter(|film| film.sample_count() > 0) {
                self.save_last(&film, &describe(&film), &model.document.name());
            }
        }
        if let Some(place) = self.place.as_ref().filter(|_| !is_panic) {
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
                    "{words}; the next window offers them, or {}",
                    continued(&place.film())
                ));
            }
            return;
        }
        let outcome = saved::rescue(&[], name, film, description);
        console::note(&outcome.map_or_else(|lost| lost, |path| format!("{words}; {}", continued(&path))));
    }
}

fn describe(document: &Document, tracing: &Tracing) -> impl FnOnce(&Film) -> Description + Send + 'static {
    let note = serde_json::to_string(&Note::of(document)).unwrap_or_default();
    let describe = describer(document, tracing.main.status(), tracing.seconds_before);
    move |film| {
        let mut description = describe(film);
        description.set(NOTE, note);
        description
    }
}

fn write(path: &Path, film: &Film, description: &Description) -> Result<(), String> {
    log::info!("autosave: {} samples per pixel in {}", film.sample_count(), path.display());
    checkpoint::save(path, film, description).map_err(|error| error.to_string())
}
