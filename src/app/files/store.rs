//! What outlives its picture and the window: films that took long, each in a file named by its job, and the last edits.
//! They are written by threads, again and again until it succeeds. The one of the films finds that of a picture that comes
//! back.

use super::describer;
use super::edits::{self, STEPS};
use crate::app::commands::Films;
use crate::app::model::changes::Changes;
use crate::app::model::{Document, Kept, Model, Sizing};
use crate::app::toolkit::{Answers, caught};
use crate::app::tracing::Tracing;
use crate::app::tracing::tracer::{Left, Tracer};
use crate::film::{Checksum, Description, Film, checkpoint, key};
use crate::job::recipe::{Recipe, file};
use crate::job::render::RenderJob;
use crate::job::saved::{self, SavedFilm};
use crate::system::console;
use crate::system::files::{check_writable, lock_path, write_text};
use eframe::egui::Context;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant, SystemTime};

/// The oldest films go as soon as all of them have more bytes than this.
pub const LIMIT: u64 = 2_000_000_000;

/// Writing films while they are traced takes at most 1 / `SHARE` of the time.
const SHARE: u32 = 20;

/// How long to wait for the lock of a window that is closing.
const PATIENCE: Duration = Duration::from_millis(200);

/// A window that ends sooner than this, and not in order, may have ended because of what it restored.
const FIRST_SECONDS: Duration = Duration::from_secs(5);

/// The longest time before something that could not be written is tried again.
const RETRY: Duration = Duration::from_secs(10);

/// The most films that wait to be written, as for a disk that is full.
const WAITING: usize = 32;

/// What the last window was at.
#[derive(Default)]
pub struct Last {
    /// The last steps of its history, with the picture at its end.
    pub steps: Vec<Document>,
    /// The length of its lock, which it has left because it did not end in order: 0 after its first seconds.
    pub lock: Option<u64>,
}

/// The film of a picture that has come back, or the one of the command line.
pub struct Found {
    /// The picture for which it was sought.
    pub document: Document,
    pub film: SavedFilm,
    /// The file that the user has named.
    pub named: Option<PathBuf>,
}

/// The window's side of the store.
pub struct Store {
    /// Until the window ends.
    tasks: Option<Sender<Task>>,
    thread: Option<JoinHandle<()>>,
    /// The right to save edits, which the first window has. Its file is there until the window ends in order, and has a
    /// byte during the first seconds.
    lock: Option<(File, PathBuf)>,
    /// The file of the edits, and what became of it.
    path: PathBuf,
    pub edits: Answers<()>,
    /// The edits that were saved last.
    saved: Option<Document>,
    /// When edits are written again that could not be.
    retry: Instant,
    /// How long to wait after a failure.
    pause: Duration,
    /// The end of the first seconds, until it is over.
    early: Option<Instant>,
    every: Duration,
    /// When a film that is traced is written again.
    due: Instant,
    /// The run and the samples of the film that was written last while it was traced.
    copied: (u64, u64),
    /// The picture whose film was sought last.
    pub sought: Option<Document>,
    /// The film of the command line, and its job.
    pub named: Option<(PathBuf, RenderJob)>,
    pub found: Answers<Found>,
    /// The pictures that earlier windows have kept to compare with.
    pub kept: Answers<Kept>,
    /// Why a film could not be written, and that nothing waits any more.
    pub outcomes: Receiver<Result<(), String>>,
    films: Arc<Mutex<Films>>,
}

type Task = Box<dyn FnOnce(&mut Shelf) + Send>;

impl Store {
    /// A store in `directory`; without one, films are in memory. Films that are traced are written at least `every` so
    /// often. Returns also what the last window was at.
    pub fn open(directory: Option<&Path>, every: Duration) -> (Self, Last) {
        let is_there = |directory: &&Path| fs::create_dir_all(directory).is_ok();
        let path = directory.filter(is_there).map(|directory| directory.join("window.lock"));
        let left = path.as_ref().and_then(|path| fs::metadata(path).ok());
        let lock = path.and_then(|path| Some((lock_path(&path, PATIENCE).ok()?, path)));
        let path = directory.unwrap_or(Path::new("")).join("edits.json");
        let last = lock.as_ref().map_or_else(Last::default, |(file, _)| {
            let _ = file.set_len(1);
            Last { steps: edits::read(&path), lock: left.map(|left| left.len()) }
        });
        let ((tasks, receiver), (told, outcomes), films) = (channel(), channel(), Arc::default());
        let mut shelf = Shelf::new(directory.map(|directory| directory.join("films")), told);
        let pause = every.clamp(Duration::from_millis(50), RETRY);
        (shelf.pause, shelf.kept) = (pause, Arc::clone(&films));
        let store = Store {
            tasks: Some(tasks),
            thread: thread::Builder::new().name("store".to_owned()).spawn(move || shelf.run(&receiver)).ok(),
            early: lock.as_ref().map(|_| Instant::now() + FIRST_SECONDS),
            lock,
            path,
            edits: Answers::default(),
            saved: last.steps.last().cloned(),
            retry: Instant::now(),
            pause,
            every,
            due: Instant::now(),
            copied: (0, 0),
            sought: None,
            named: None,
            found: Answers::default(),
            kept: Answers::default(),
            outcomes,
            films,
        };
        (store, last)
    }

    fn task(&self, task: impl FnOnce(&mut Shelf) + Send + 'static) {
        // Without a thread nothing is kept.
        let _ = self.tasks.as_ref().map(|tasks| tasks.send(Box::new(task)));
    }

    /// The films in the folder.
    pub fn films(&self) -> Films {
        *self.films.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Deletes the film of a picture, or all films.
    pub fn delete(&self, of: Option<Document>) {
        self.task(move |shelf| shelf.delete(of));
    }

    /// Writes a picture that is kept to compare with, until it is deleted.
    pub fn pin(&self, kept: Arc<Kept>) {
        self.task(move |shelf| {
            let Some((path, document)) = shelf.pinned(&kept).zip(kept.document.as_ref()) else { return };
            let about = Description::new(&file::to_picture_toml(&document.recipe()));
            let outcome = write(&path, &kept.film, &about);
            shelf.tell(outcome);
        });
    }

    pub fn unpin(&self, kept: Arc<Kept>) {
        self.task(move |shelf| _ = shelf.pinned(&kept).map(fs::remove_file));
    }

    /// Keeps edits and films, and asks for the film of a picture that comes back.
    pub fn follow(&mut self, context: &Context, model: &Model, changes: &Changes, tracing: &mut Tracing) {
        if let (Some(early), Some((file, _))) = (self.early, &self.lock) {
            let left = early.saturating_duration_since(Instant::now());
            context.request_repaint_after(left);
            self.early = (!left.is_zero()).then_some(early);
            let _ = left.is_zero().then(|| file.set_len(0));
        }
        self.keep(tracing.take_left());
        self.save_edits(context, &model.document, changes);
        let status = tracing.main.status();
        let (now, wait) =
            ((status.run, status.samples_per_pixel), self.due.saturating_duration_since(Instant::now()));
        if now != self.copied && !wait.is_zero() {
            context.request_repaint_after(wait);
        } else if now != self.copied
            && let Some(copy) = tracing.main.copy_long()
        {
            (self.copied, self.due) = (now, Instant::now() + self.every.max(self.films().took * SHARE));
            self.keep(vec![copy]);
            // To see what becomes of it.
            context.request_repaint_after(Duration::from_secs(1));
        }
        if !changes.is_moving() {
            self.seek(context, model);
        }
    }

    fn keep(&self, films: Vec<Left>) {
        for Left { document, seconds_before, film } in films {
            self.task(move |shelf| {
                // The render may have failed.
                let Ok((film, status)) = film.recv() else { return };
                let description = describer(&document, &status, seconds_before)(&film);
                shelf.put(shelf.path(&document), film, description);
            });
        }
    }

    /// Saves edits at once, unless the user is at it or something prevents it.
    fn save_edits(&mut self, context: &Context, document: &Document, changes: &Changes) {
        let is_new = self.saved.as_ref() != Some(document) && !changes.is_in_gesture;
        let wait = self.retry.saturating_duration_since(Instant::now());
        if self.lock.is_none() || !is_new || self.edits.is_open() {
        } else if !wait.is_zero() {
            context.request_repaint_after(wait);
        } else {
            let (path, steps) = (self.path.clone(), changes.last_steps(document, STEPS));
            self.edits.ask("edits", context, move || write_edits(&path, &steps));
            self.saved = Some(document.clone());
        }
    }

    /// Edits could not be saved: tries again after a while.
    pub fn retry_edits(&mut self) {
        (self.saved, self.retry) = (None, Instant::now() + self.pause);
    }

    fn seek(&mut self, context: &Context, model: &Model) {
        if self.sought.as_ref().is_some_and(|sought| sought.has_same_film(&model.document)) {
            return;
        }
        let (document, answer) = (model.document.clone(), self.found.answer(context));
        let before = self.sought.replace(document.clone());
        if before.is_none() {
            let answer = self.kept.answer(context);
            self.task(move |shelf| {
                let kept = shelf.files().into_iter().rev().filter(|(.., path)| is_pin(path));
                let opened = kept.filter_map(|(.., path)| {
                    let saved = saved::open(&path).ok()?;
                    let document = Document::of_film(&saved.recipe, saved.stage());
                    Some(Kept::new(document, saved.film().ok()?.film))
                });
                opened.for_each(|kept| answer.give(Ok(kept)));
            });
        }
        // A picture that has been given another size is meant to have that.
        let is_resized = before.is_some_and(|before| before.is_same_at_another_size(&document));
        let fits = model.remembered.sizing == Sizing::Viewport && model.presentation.is_none();
        let is_any_size = fits && !document.has_own_size && !is_resized;
        let named = self.named.take();
        self.task(move |shelf| {
            if let Some((path, job)) = named {
                let film = saved::resume(&path, &job).map_err(|error| error.to_string());
                answer.give(film.map(|film| Found { document, film, named: Some(path) }));
            } else if let Some(film) = shelf.find(&document, is_any_size) {
                answer.give(Ok(Found { document, film, named: None }));
            }
        });
    }

    /// Keeps everything, at the end of the window. What cannot be written is saved elsewhere.
    pub fn end(&mut self, document: &Document, changes: &Changes, tracing: &mut Tracing) {
        let has_failed = self.edits.wait().is_some_and(|outcome| outcome.is_err());
        if self.lock.is_some() && (has_failed || self.saved.as_ref() != Some(document)) {
            let _ = write_edits(&self.path, &changes.last_steps(document, STEPS));
        }
        tracing.tracers_mut().for_each(Tracer::leave);
        self.keep(tracing.take_left());
        self.tasks = None;
        let _ = self.thread.take().map(JoinHandle::join);
        if let Some((_, path)) = self.lock.as_ref().filter(|_| !thread::panicking()) {
            let _ = fs::remove_file(path);
        }
    }
}

fn write_edits(path: &Path, steps: &[Document]) -> Result<(), String> {
    write_text(path, &edits::to_text(steps)).map_err(|error| error.to_string())
}

/// Writes a film. It does not replace one that has as many samples.
fn write(path: &Path, film: &Film, about: &Description) -> Result<(), String> {
    if checkpoint::read_head(path).is_ok_and(|there| there.samples.count() >= film.sample_count()) {
        return Ok(());
    }
    let folder = path.parent().unwrap_or(path);
    fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    checkpoint::save(path, film, about).map_err(|error| error.to_string())
}

/// The thread's side of the store.
struct Shelf {
    /// The folder of the films. Without one they are in memory.
    folder: Option<PathBuf>,
    /// What is not written yet, the newest first, after it what has failed.
    waiting: Vec<(PathBuf, Film, Description)>,
    /// How long to wait after a failure, and until when.
    pause: Duration,
    next: Instant,
    kept: Arc<Mutex<Films>>,
    told: Sender<Result<(), String>>,
}

impl Shelf {
    fn new(folder: Option<PathBuf>, told: Sender<Result<(), String>>) -> Self {
        let (waiting, pause, next) = (Vec::new(), Duration::ZERO, Instant::now());
        Shelf { folder, waiting, pause, next, kept: Arc::default(), told }
    }

    fn run(mut self, tasks: &Receiver<Task>) {
        // What killed windows have left unfinished goes.
        let _ = self.folder.as_ref().map(|folder| check_writable(&folder.join("film.exr")));
        self.note(Duration::ZERO);
        loop {
            let task = if self.waiting.is_empty() || self.folder.is_none() {
                tasks.recv().map_err(RecvTimeoutError::from)
            } else {
                tasks.recv_timeout(self.next.saturating_duration_since(Instant::now()))
            };
            let done = match task {
                Ok(task) => caught(|| task(&mut self)),
                Err(RecvTimeoutError::Timeout) => caught(|| self.write()),
                Err(RecvTimeoutError::Disconnected) => break,
            };
            done.unwrap_or_else(|reason| self.tell(Err(reason)));
        }
        for (path, film, about) in self.waiting.drain(..).filter(|_| self.folder.is_some()) {
            if write(&path, &film, &about).is_err() {
                let saved = saved::rescue(&[], &film, &about);
                let words = |path: PathBuf| format!("the picture's samples were saved in {}", path.display());
                console::note(&saved.map_or_else(|lost| lost, words));
            }
        }
        self.note(Duration::ZERO);
    }

    /// Takes a film to be written, in place of an earlier state of it.
    fn put(&mut self, path: PathBuf, film: Film, about: Description) {
        self.waiting.retain(|(other, ..)| *other != path);
        self.waiting.insert(0, (path, film, about));
        self.waiting.truncate(WAITING);
        self.next = Instant::now();
    }

    /// Writes the next file.
    fn write(&mut self) {
        let (path, film, about) = self.waiting.remove(0);
        let (begin, outcome) = (Instant::now(), write(&path, &film, &about));
        if outcome.is_ok() {
            self.note(begin.elapsed());
        } else {
            self.waiting.push((path, film, about));
            self.next = Instant::now() + self.pause;
        }
        self.tell(outcome);
    }

    fn tell(&self, outcome: Result<(), String>) {
        // After a success, something else may still fail.
        if outcome.is_err() || self.waiting.is_empty() {
            let _ = self.told.send(outcome);
        }
    }

    /// The films in the folder that go when they are too many.
    fn films(&self) -> Vec<(SystemTime, u64, PathBuf)> {
        self.files().into_iter().filter(|(.., path)| !is_pin(path)).collect()
    }

    /// The films in the folder, newest first: when each was written, its bytes and its path.
    fn files(&self) -> Vec<(SystemTime, u64, PathBuf)> {
        let entries = self.folder.as_ref().and_then(|folder| fs::read_dir(folder).ok());
        let about = |entry: fs::DirEntry| {
            let about = entry.metadata().ok()?;
            Some((about.modified().ok()?, about.len(), entry.path()))
        };
        let films = entries.into_iter().flatten().flatten().filter_map(about);
        let mut films: Vec<_> =
            films.filter(|(.., path)| path.extension().is_some_and(|ending| ending == "exr")).collect();
        films.sort_by(|a, b| b.cmp(a));
        films
    }

    /// Deletes the oldest films that are too many, and notes what is left.
    fn note(&self, took: Duration) {
        let films = thin(self.films(), LIMIT);
        *self.kept.lock().unwrap_or_else(PoisonError::into_inner) = Films { took, ..films };
    }

    /// Deletes the film of a document, or all films.
    fn delete(&mut self, of: Option<Document>) {
        let of = of.map(|document| self.path(&document));
        let is_kept = |path: &Path| of.as_ref().is_some_and(|of| of != path);
        self.waiting.retain(|(path, ..)| is_kept(path));
        let films = self.films().into_iter().filter(|(.., path)| !is_kept(path));
        films.for_each(|(.., path)| drop(fs::remove_file(path)));
        self.note(Duration::ZERO);
    }

    /// The film of a document; if there is none, and `is_any_size`, the newest one of the same picture.
    fn find(&self, document: &Document, is_any_size: bool) -> Option<SavedFilm> {
        let (own, picture) = (self.path(document), fingerprint(document));
        let films = self.films().into_iter().map(|(.., path)| path);
        let paths = self.waiting.iter().map(|(path, ..)| path.clone()).chain(films);
        let is_it = |path: &PathBuf| *path == own || is_any_size && path.to_string_lossy().contains(&picture);
        let mut paths: Vec<_> = paths.filter(is_it).collect();
        paths.sort_by_key(|path| *path != own);
        paths.iter().find_map(|path| self.read(path, document.clone()))
    }

    fn read(&self, path: &Path, mut document: Document) -> Option<SavedFilm> {
        if let Some((_, film, about)) = self.waiting.iter().find(|(other, ..)| path == other) {
            let seconds = about.get(key::SECONDS).and_then(|seconds| seconds.parse().ok());
            return Some(SavedFilm { film: film.try_copy().ok()?, seconds });
        }
        let saved = saved::open(path).ok()?;
        document.set_size([saved.recipe.settings.width, saved.recipe.settings.height]);
        saved.check_same(&document.job(1).ok()?).ok()?;
        saved.film().ok()
    }

    /// The file of a picture that is kept to compare with.
    fn pinned(&self, kept: &Kept) -> Option<PathBuf> {
        let [width, height] = kept.size();
        let name = fingerprint(kept.document.as_ref()?);
        let name = format!("{PIN}{name}-{width}x{height}-{}.exr", kept.samples());
        Some(self.folder.as_ref()?.join(name))
    }

    /// The file of a document's film.
    fn path(&self, document: &Document) -> PathBuf {
        let [width, height] = document.size();
        let name = format!("{}-{width}x{height}.exr", fingerprint(document));
        self.folder.as_deref().unwrap_or(Path::new("")).join(name)
    }
}

/// Deletes the oldest of these films, which begin with the newest, until the others have at most `limit` bytes or only one is
/// left.
fn thin(films: Vec<(SystemTime, u64, PathBuf)>, limit: u64) -> Films {
    let mut left = Films::default();
    for (_, bytes, path) in films {
        if left.count == 0 || left.bytes + bytes <= limit || fs::remove_file(path).is_err() {
            (left.count, left.bytes) = (left.count + 1, left.bytes + bytes);
        }
    }
    left
}

/// How the names of kept pictures begin.
const PIN: &str = "kept-";

fn is_pin(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(PIN))
}

/// What tells a picture from others, apart from its size.
fn fingerprint(document: &Document) -> String {
    let mut recipe = Recipe { samples_per_pixel: 1, ..document.recipe() };
    (recipe.settings.width, recipe.settings.height) = (1, 1);
    recipe.keyframes.clear();
    let mut checksum = Checksum::default();
    checksum.text(file::to_picture_toml(&recipe).as_bytes());
    checksum.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Origin;
    use crate::stages::Stage;

    fn document(stage: &str) -> Document {
        let mut document = Document::new(Origin::of_stage(Stage::find(stage).unwrap()));
        document.set_size([16, 9]);
        document
    }

    fn shelf(directory: &Path) -> Shelf {
        Shelf::new(Some(directory.to_owned()), channel().0)
    }

    fn put(shelf: &mut Shelf, document: &Document, samples: u64) {
        let mut film = Film::new(document.size()[0], document.size()[1]);
        film.record(0..samples, 0).unwrap();
        let description = Description::new(&file::to_picture_toml(&document.recipe()));
        shelf.put(shelf.path(document), film, description);
    }

    fn found(shelf: &Shelf, document: &Document, is_any_size: bool) -> Option<u64> {
        shelf.find(document, is_any_size).map(|found| found.film.sample_count())
    }

    #[test]
    fn a_film_is_found_by_its_job_whether_it_is_written_or_not() {
        let directory = tempfile::tempdir().unwrap();
        let mut shelf = shelf(directory.path());
        let (metal, mut other) = (document("metal"), document("metal"));
        other.settings.seed = 9;
        put(&mut shelf, &metal, 8);
        for _ in 0..2 {
            assert_eq!([&metal, &other].map(|document| found(&shelf, document, false)), [Some(8), None]);
            let mut larger = metal.clone();
            larger.set_size([32, 18]);
            assert_eq!([false, true].map(|is_any| found(&shelf, &larger, is_any)), [None, Some(8)]);
            while !shelf.waiting.is_empty() {
                shelf.write();
            }
        }
        // Fewer samples do not replace more.
        put(&mut shelf, &metal, 4);
        shelf.write();
        assert_eq!(found(&shelf, &metal, false), Some(8));
        shelf.delete(Some(other.clone()));
        assert_eq!(found(&shelf, &metal, false), Some(8));
        shelf.delete(Some(metal.clone()));
        assert_eq!(found(&shelf, &metal, true), None);
    }

    #[test]
    fn the_oldest_films_go_when_there_are_too_many() {
        let directory = tempfile::tempdir().unwrap();
        let mut shelf = shelf(directory.path());
        let documents = ["metal", "metal-fuzzy", "glass-schlick"].map(document);
        for (age, document) in documents.iter().enumerate() {
            put(&mut shelf, document, 8);
            shelf.write();
            let file = File::options().write(true).open(shelf.path(document)).unwrap();
            file.set_modified(SystemTime::now() - Duration::from_secs(100 - age as u64)).unwrap();
        }
        let all = thin(shelf.films(), LIMIT);
        assert_eq!(all.count, 3);
        assert_eq!(thin(shelf.films(), all.bytes - 1).count, 2);
        let left = documents.each_ref().map(|document| found(&shelf, document, false));
        assert_eq!(left, [None, Some(8), Some(8)]);
        assert_eq!(thin(shelf.films(), 0).count, 1, "the newest one stays");
    }
}
