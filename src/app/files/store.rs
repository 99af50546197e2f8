//! What outlives its picture and the window: films that took long, each in a file named by its job, and the last edits.
//! A thread writes them, again and again until it succeeds, and finds the film of a picture that comes back.

use super::describer;
use super::edits::{self, STEPS};
use crate::app::commands::Films;
use crate::app::model::changes::Changes;
use crate::app::model::{Document, Model, Sizing};
use crate::app::toolkit::{Answer, Answers, caught};
use crate::app::tracing::Tracing;
use crate::app::tracing::tracer::Left;
use crate::film::{Checksum, Description, Film, checkpoint, key};
use crate::job::recipe::{Recipe, file};
use crate::job::render::RenderJob;
use crate::job::saved::{self, SavedFilm};
use crate::system::console;
use crate::system::files::{lock_path, write_text};
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

const EDITS: &str = "edits.json";

/// What the last window was at.
#[derive(Default)]
pub struct Last {
    /// The last steps of its history, with the picture at its end.
    pub steps: Vec<Document>,
    pub has_ended_early: bool,
    /// It ended in its first seconds.
    pub has_hardly_begun: bool,
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
    tasks: Sender<Task>,
    thread: Option<JoinHandle<()>>,
    /// The right to save edits, which the first window has. Its file is there until the window ends in order, and has a
    /// byte during the first seconds.
    lock: Option<(PathBuf, File)>,
    /// The end of the first seconds, until it is over.
    early: Option<Instant>,
    every: Duration,
    /// When a film that is traced is written again.
    due: Instant,
    /// The run and the samples of the film that was written last while it was traced.
    copied: (u64, u64),
    /// The edits that were saved last.
    saved: Option<Document>,
    /// The picture whose film was sought last.
    pub sought: Option<Document>,
    /// The film of the command line, and its job.
    pub named: Option<(PathBuf, RenderJob)>,
    pub found: Answers<Found>,
    /// The first of several failures in a row, and the success after them.
    pub outcomes: Answers<()>,
    films: Arc<Mutex<Films>>,
}

type Task = Box<dyn FnOnce(&mut Shelf) + Send>;

impl Store {
    /// A store in `directory`; without one, films are in memory. Films that are traced are written at least `every` so
    /// often. Returns also what the last window was at.
    pub fn open(directory: Option<&Path>, every: Duration) -> (Self, Last) {
        let (mut last, mut lock) = (Last::default(), None);
        if let Some(directory) = directory.filter(|directory| fs::create_dir_all(directory).is_ok()) {
            let path = directory.join("window.lock");
            let left = fs::metadata(&path).ok();
            lock = lock_path(&path, PATIENCE).ok().map(|file| (path, file));
            if let Some((_, file)) = &lock {
                last = Last {
                    steps: edits::read(&directory.join(EDITS)),
                    has_ended_early: left.is_some(),
                    has_hardly_begun: left.is_some_and(|left| left.len() > 0),
                };
                let _ = file.set_len(1);
            }
        }
        let ((tasks, receiver), films, now) = (channel(), Arc::default(), Instant::now());
        let shelf = Shelf {
            directory: directory.map(Path::to_owned),
            limit: LIMIT,
            waiting: Vec::new(),
            pause: every.clamp(Duration::from_millis(50), RETRY),
            next: now,
            films: Arc::clone(&films),
            told: None,
            has_failed: false,
            is_over: false,
        };
        let store = Store {
            tasks,
            thread: thread::Builder::new().name("store".to_owned()).spawn(move || shelf.run(&receiver)).ok(),
            early: lock.as_ref().map(|_| now + FIRST_SECONDS),
            lock,
            every,
            due: now,
            copied: (0, 0),
            saved: last.steps.last().cloned(),
            sought: None,
            named: None,
            found: Answers::default(),
            outcomes: Answers::default(),
            films,
        };
        (store, last)
    }

    fn task(&self, task: impl FnOnce(&mut Shelf) + Send + 'static) {
        // Without a thread nothing is kept.
        let _ = self.tasks.send(Box::new(task));
    }

    /// Tells outcomes from now on.
    pub fn begin(&mut self, context: &Context) {
        let told = self.outcomes.answer(context);
        self.task(|shelf| shelf.told = Some(told));
    }

    /// The films in the folder.
    pub fn films(&self) -> Films {
        *self.films.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Deletes the film of a picture, or all films.
    pub fn delete(&self, of: Option<Document>) {
        self.task(|shelf| shelf.delete(of.map(|document| name(&document)).as_deref()));
    }

    /// Keeps edits and films, and asks for the film of a picture that comes back.
    pub fn follow(&mut self, context: &Context, model: &Model, changes: &Changes, tracing: &mut Tracing) {
        if let (Some(early), Some((_, file))) = (self.early, &self.lock) {
            let left = early.saturating_duration_since(Instant::now());
            context.request_repaint_after(left);
            self.early = (!left.is_zero() || file.set_len(0).is_err()).then_some(early);
        }
        self.keep(tracing.take_left());
        if !changes.is_in_gesture && self.saved.as_ref() != Some(&model.document) {
            self.save_edits(&model.document, changes);
        }
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
                shelf.put(name(&document), Content::Film(film, description));
            });
        }
    }

    fn save_edits(&mut self, document: &Document, changes: &Changes) {
        let steps = changes.last_steps(document, STEPS);
        if self.lock.is_some() {
            self.task(move |shelf| shelf.put(EDITS.to_owned(), Content::Edits(edits::to_text(&steps))));
        }
        self.saved = Some(document.clone());
    }

    fn seek(&mut self, context: &Context, model: &Model) {
        if self.sought.as_ref().is_some_and(|sought| sought.has_same_film(&model.document)) {
            return;
        }
        let (document, answer) = (model.document.clone(), self.found.answer(context));
        let before = self.sought.replace(document.clone());
        if let Some((path, job)) = self.named.take() {
            self.task(move |_| {
                let film = saved::resume(&path, &job).map_err(|error| error.to_string());
                answer.give(film.map(|film| Found { document, film, named: Some(path) }));
            });
            return;
        }
        // A picture that has been given another size is meant to have that.
        let is_resized = before.is_some_and(|before| before.is_same_at_another_size(&document));
        let fits = model.remembered.sizing == Sizing::Viewport && model.presentation.is_none();
        let is_any_size = fits && !document.has_own_size && !is_resized;
        self.task(move |shelf| {
            if let Some(film) = shelf.find(&document, is_any_size) {
                answer.give(Ok(Found { document, film, named: None }));
            }
        });
    }

    /// Keeps everything, at the end of the window. What cannot be written is saved elsewhere.
    pub fn end(&mut self, document: &Document, changes: &Changes, tracing: &mut Tracing) {
        self.save_edits(document, changes);
        tracing.leave();
        self.keep(tracing.take_left());
        self.task(|shelf| shelf.end());
        let _ = self.thread.take().map(JoinHandle::join);
        if let Some((path, _)) = self.lock.as_ref().filter(|_| !thread::panicking()) {
            let _ = fs::remove_file(path);
        }
    }
}

enum Content {
    Film(Film, Description),
    Edits(String),
}

impl Content {
    /// Writes it. A film does not replace one that has as many samples.
    fn write(&self, path: &Path) -> Result<(), String> {
        let folder = path.parent().unwrap_or(path);
        fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        let written = match self {
            Content::Edits(text) => write_text(path, text),
            Content::Film(film, _)
                if checkpoint::read_head(path)
                    .is_ok_and(|there| there.samples.count() >= film.sample_count()) =>
            {
                Ok(())
            }
            Content::Film(film, description) => checkpoint::save(path, film, description),
        };
        written.map_err(|error| error.to_string())
    }
}

/// The thread's side of the store.
struct Shelf {
    directory: Option<PathBuf>,
    /// Bytes of all films.
    limit: u64,
    /// What is not written yet, by the name of its file, the next one first.
    waiting: Vec<(String, Content)>,
    /// How long to wait after a failure, and until when.
    pause: Duration,
    next: Instant,
    films: Arc<Mutex<Films>>,
    told: Option<Answer<()>>,
    has_failed: bool,
    is_over: bool,
}

impl Shelf {
    fn run(mut self, tasks: &Receiver<Task>) {
        self.note(Duration::ZERO);
        while !self.is_over {
            let task = if self.waiting.is_empty() || self.directory.is_none() {
                tasks.recv().map_err(RecvTimeoutError::from)
            } else {
                tasks.recv_timeout(self.next.saturating_duration_since(Instant::now()))
            };
            let done = match task {
                Ok(task) => caught(|| task(&mut self)),
                Err(RecvTimeoutError::Timeout) => caught(|| self.write()),
                Err(RecvTimeoutError::Disconnected) => return,
            };
            done.unwrap_or_else(|reason| self.tell(Err(reason)));
        }
    }

    /// Takes what is to be written, in place of an earlier state of it.
    fn put(&mut self, name: String, content: Content) {
        self.waiting.retain(|(other, _)| *other != name);
        self.waiting.push((name, content));
        let bytes = |(_, content): &(String, Content)| match content {
            Content::Film(film, _) => Film::bytes(film.width(), film.height()),
            Content::Edits(_) => 0,
        };
        while self.waiting.len() > 1 && self.waiting.iter().map(bytes).sum::<u64>() > self.limit {
            self.waiting.remove(0);
        }
    }

    /// Writes what has waited longest.
    fn write(&mut self) {
        let Some(directory) = &self.directory else { return };
        let (name, content) = self.waiting.remove(0);
        let (begin, outcome) = (Instant::now(), content.write(&directory.join(&name)));
        if outcome.is_ok() {
            self.note(begin.elapsed());
        } else {
            self.waiting.push((name, content));
            self.next = Instant::now() + self.pause;
        }
        self.tell(outcome);
    }

    fn tell(&mut self, outcome: Result<(), String>) {
        // After a success, something else may still fail.
        let is_news = outcome.is_err() != self.has_failed && (outcome.is_err() || self.waiting.is_empty());
        if let Some(told) = self.told.as_ref().filter(|_| is_news) {
            self.has_failed = outcome.is_err();
            told.give(outcome);
        }
    }

    /// The films in the folder, newest first: when each was written, its bytes and its path.
    fn films(&self) -> Vec<(SystemTime, u64, PathBuf)> {
        let entries =
            self.directory.as_ref().and_then(|directory| fs::read_dir(directory.join("films")).ok());
        let mut films: Vec<_> = entries
            .into_iter()
            .flatten()
            .filter_map(|entry| {
                let (path, about) = (entry.as_ref().ok()?.path(), entry.ok()?.metadata().ok()?);
                let is_film = path.extension().is_some_and(|ending| ending == "exr");
                is_film.then_some((about.modified().ok()?, about.len(), path))
            })
            .collect();
        films.sort_by(|a, b| b.cmp(a));
        films
    }

    /// Deletes the oldest films that are too many, and notes what is left.
    fn note(&mut self, took: Duration) {
        let mut films = Films { took, ..Films::default() };
        for (_, bytes, path) in self.films() {
            if films.count == 0 || films.bytes + bytes <= self.limit || fs::remove_file(path).is_err() {
                films = Films { count: films.count + 1, bytes: films.bytes + bytes, took };
            }
        }
        *self.films.lock().unwrap_or_else(PoisonError::into_inner) = films;
    }

    /// Deletes the film of this name, or all films.
    fn delete(&mut self, name: Option<&str>) {
        self.waiting.retain(|(other, _)| other == EDITS || name.is_some_and(|name| name != other));
        for (.., path) in self.films() {
            if name.is_none_or(|name| path.ends_with(name)) {
                let _ = fs::remove_file(path);
            }
        }
        self.note(Duration::ZERO);
    }

    /// The film of a document; if there is none, and `is_any_size`, the newest one of the same picture.
    fn find(&self, document: &Document, is_any_size: bool) -> Option<SavedFilm> {
        let (own, picture) = (name(document), fingerprint(document));
        let waiting = self.waiting.iter().rev().map(|(name, _)| PathBuf::from(name));
        let films = self.films().into_iter().map(|(.., path)| path);
        let is_it =
            |path: &PathBuf| path.ends_with(&own) || is_any_size && path.to_string_lossy().contains(&picture);
        let mut paths: Vec<_> = waiting.chain(films).filter(is_it).collect();
        paths.sort_by_key(|path| !path.ends_with(&own));
        paths.iter().find_map(|path| self.read(path, document.clone()))
    }

    fn read(&self, path: &Path, mut document: Document) -> Option<SavedFilm> {
        let waiting = self.waiting.iter().find(|(name, _)| path == Path::new(name));
        if let Some((_, Content::Film(film, description))) = waiting {
            let seconds = description.get(key::SECONDS).and_then(|seconds| seconds.parse().ok());
            return Some(SavedFilm { film: film.try_copy().ok()?, seconds });
        }
        let saved = saved::open(path).ok()?;
        document.set_size([saved.recipe.settings.width, saved.recipe.settings.height]);
        saved.check_same(&document.job(1).ok()?).ok()?;
        saved.film().ok()
    }

    /// Writes what is left once more, or saves it elsewhere.
    fn end(&mut self) {
        self.is_over = true;
        for (name, content) in std::mem::take(&mut self.waiting) {
            let path = self.directory.as_ref().map(|directory| directory.join(&name));
            let outcome = path.map_or(Err("there is no folder".to_owned()), |path| content.write(&path));
            console::note(&match (outcome, content) {
                (Ok(()), _) => continue,
                (Err(reason), Content::Edits(_)) => format!("weekender: edits not saved: {reason}"),
                (Err(_), Content::Film(film, description)) => {
                    match saved::rescue(
                        &[],
                        description.get(key::SCENE).unwrap_or("film"),
                        &film,
                        &description,
                    ) {
                        Ok(path) => format!("the picture's samples were saved in {}", path.display()),
                        Err(lost) => lost,
                    }
                }
            });
        }
        self.note(Duration::ZERO);
    }
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

/// The name of the file of a document's film.
fn name(document: &Document) -> String {
    let [width, height] = document.size();
    format!("films/{}-{width}x{height}.exr", fingerprint(document))
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

    fn shelf(directory: &Path, limit: u64) -> Shelf {
        Shelf {
            directory: Some(directory.to_owned()),
            limit,
            waiting: Vec::new(),
            pause: Duration::ZERO,
            next: Instant::now(),
            films: Arc::default(),
            told: None,
            has_failed: false,
            is_over: false,
        }
    }

    fn put(shelf: &mut Shelf, document: &Document, samples: u64) {
        let mut film = Film::new(document.size()[0], document.size()[1]);
        film.record(0..samples, 0).unwrap();
        let description = Description::new(&file::to_picture_toml(&document.recipe()));
        shelf.put(name(document), Content::Film(film, description));
    }

    fn found(shelf: &Shelf, document: &Document, is_any_size: bool) -> Option<u64> {
        shelf.find(document, is_any_size).map(|found| found.film.sample_count())
    }

    #[test]
    fn a_film_is_found_by_its_job_whether_it_is_written_or_not() {
        let directory = tempfile::tempdir().unwrap();
        let mut shelf = shelf(directory.path(), LIMIT);
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
        shelf.delete(Some(&name(&other)));
        assert_eq!(found(&shelf, &metal, false), Some(8));
        shelf.delete(Some(&name(&metal)));
        assert_eq!(found(&shelf, &metal, true), None);
    }

    #[test]
    fn the_oldest_films_go_when_there_are_too_many() {
        let directory = tempfile::tempdir().unwrap();
        let mut shelf = shelf(directory.path(), LIMIT);
        let documents = ["metal", "metal-fuzzy", "glass-schlick"].map(document);
        for (age, document) in documents.iter().enumerate() {
            put(&mut shelf, document, 8);
            shelf.write();
            let file = File::options().write(true).open(directory.path().join(name(document))).unwrap();
            file.set_modified(SystemTime::now() - Duration::from_secs(100 - age as u64)).unwrap();
        }
        shelf.note(Duration::ZERO);
        let all = *shelf.films.lock().unwrap();
        assert_eq!(all.count, 3);
        shelf.limit = all.bytes - 1;
        shelf.note(Duration::ZERO);
        assert_eq!(
            documents.each_ref().map(|document| found(&shelf, document, false)),
            [None, Some(8), Some(8)]
        );
        shelf.limit = 0;
        shelf.note(Duration::ZERO);
        assert_eq!(shelf.films.lock().unwrap().count, 1, "the newest one stays");
    }
}
