//! The scene file of the picture: other programs may change it while the window shows what was read.

use super::answers::Answers;
use super::model::checked::stamp_of;
use super::model::origin::{Origin, Source};
use super::model::session::SPHERES_LIMIT;
use crate::job::recipe::{Recipe, file};
use crate::system::files::Stamp;
use eframe::egui::Context;
use std::path::Path;
use std::sync::{Arc, Weak};
use std::thread;
use std::time::Duration;

/// How long the file is left alone between two looks at it.
const LOOKS_APART: Duration = Duration::from_millis(500);

/// How long a file must have stayed the same before it is read: others may still be writing it.
const SETTLE: Duration = Duration::from_millis(200);

/// What a scene file holds now.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Holds {
    /// What was read from it.
    Same,
    /// Another scene, camera or settings.
    Other,
    /// Nothing that can be read, for this reason.
    Nothing(String),
    /// There is no such file any more.
    Gone,
}

/// What was found in the scene file of an origin.
struct Found {
    origin: Arc<Origin>,
    holds: Holds,
}

/// A scene file that was read again.
pub struct Reread {
    /// The origin that it was read for.
    pub origin: Arc<Origin>,
    /// What it holds now.
    pub recipe: Recipe,
    stamp: Option<Stamp>,
}

impl Reread {
    /// Notes that the scene file holds what `origin` says.
    pub fn note(&self, origin: &Origin) {
        origin.note_file(self.stamp.clone());
    }
}

/// Looks at the scene file of the picture from time to time, on a thread of its own, and reads it again on request.
#[derive(Default)]
pub struct SceneFile {
    /// The origin whose file is looked at. The thread ends once the second part is gone.
    watched: Option<(Arc<Origin>, Arc<()>)>,
    found: Answers<Found>,
    reread: Answers<Result<Reread, String>>,
}

impl SceneFile {
    /// Looks at the file of `origin`, if it has one, and at no other.
    pub fn watch(&mut self, context: &Context, origin: &Arc<Origin>) {
        if self.watched.as_ref().is_some_and(|(watched, _)| Arc::ptr_eq(watched, origin)) {
            return;
        }
        self.watched = None;
        let Source::File(path) = &origin.source else { return };
        let alive = Arc::new(());
        let (path, answer) = (path.clone(), self.found.answer(context));
        let (own, token) = (Arc::clone(origin), Arc::downgrade(&alive));
        let work = move || {
            let tell = |holds| answer.give_one(Found { origin: Arc::clone(&own), holds });
            look_repeatedly(&path, &own, &token, tell);
        };
        if let Err(error) = thread::Builder::new().name("scene file".to_owned()).spawn(work) {
            log::warn!("nobody looks whether the scene file changes: {error}");
        }
        self.watched = Some((Arc::clone(origin), alive));
    }

    /// What was found last about the file of `origin`.
    pub fn found(&self, origin: &Arc<Origin>) -> Option<Holds> {
        let mut last = None;
        while let Some(found) = self.found.take() {
            if Arc::ptr_eq(&found.origin, origin) {
                last = Some(found.holds);
            }
        }
        last
    }

    /// Reads the file of `origin` again.
    pub fn reload(&self, context: &Context, origin: &Arc<Origin>) {
        let Source::File(path) = &origin.source else { return };
        let (path, origin) = (path.clone(), Arc::clone(origin));
        let work = move || {
            // If it is changed meanwhile, the stamp shows it.
            let stamp = stamp_of(&path);
            let recipe = file::load(&path).map_err(|error| error.to_string())?;
            recipe.job().map_err(|error| error.to_string())?;
            Ok(Reread { origin, recipe, stamp })
        };
        self.reread
            .ask("files", context, work, |reason| Err(format!("the scene file cannot be read: {reason}")));
    }

    /// The file that was read again, or why it was not.
    pub fn reread(&self) -> Option<Result<Reread, String>> {
        self.reread.take()
    }
}

/// Looks at the file until nobody needs it any more, and tells what it holds whenever that may be something else.
fn look_repeatedly(path: &Path, origin: &Origin, needed: &Weak<()>, tell: impl Fn(Holds)) {
    let mut seen = Seen::default();
    while needed.strong_count() > 0 {
        let (holds, pause) = seen.look(path, origin);
        if let Some(holds) = holds {
            tell(holds);
        }
        thread::sleep(pause);
    }
}

/// How a file was when it was looked at; `None` within stands for no file.
#[derive(Default)]
struct Seen {
    /// When it was last found out what it holds.
    known: Option<Option<Stamp>>,
    /// At the last look, if it was another one then.
    next: Option<Option<Stamp>>,
}

impl Seen {
    /// Looks at the file. Returns what it holds if it is another one than before, and how long to wait for the next look.
    fn look(&mut self, path: &Path, origin: &Origin) -> (Option<Holds>, Duration) {
        let stamp = stamp_of(path);
        if self.known.as_ref() == Some(&stamp) {
            self.next = None;
            return (None, LOOKS_APART);
        }
        let is_first = self.known.is_none();
        if !is_first && self.next.as_ref() != Some(&stamp) {
            self.next = Some(stamp);
            return (None, SETTLE);
        }
        (self.known, self.next) = (Some(stamp.clone()), None);
        // A large scene was read a moment ago, and reading it takes seconds.
        let is_trusted = is_first && stamp.is_some() && origin.recipe.scene.spheres.len() > SPHERES_LIMIT;
        let holds = if is_trusted { Holds::Same } else { held(path, stamp.is_some(), &origin.recipe) };
        origin.note_file(stamp.filter(|_| holds == Holds::Same));
        (Some(holds), LOOKS_APART)
    }
}

fn held(path: &Path, is_there: bool, recipe: &Recipe) -> Holds {
    if !is_there {
        return Holds::Gone;
    }
    match file::load(path) {
        Ok(found) if found == *recipe => Holds::Same,
        Ok(_) => Holds::Other,
        Err(error) => Holds::Nothing(error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::Stage;
    use std::time::SystemTime;

    /// Writes a file, `seconds` after the beginning of time.
    fn write(path: &Path, text: &str, seconds: u64) {
        std::fs::write(path, text).unwrap();
        let file = std::fs::File::options().write(true).open(path).unwrap();
        file.set_modified(SystemTime::UNIX_EPOCH + Duration::from_secs(seconds)).unwrap();
    }

    #[test]
    fn a_change_is_told_once_it_is_complete() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("mine.toml");
        let text = file::to_toml(&Stage::find("metal").unwrap().recipe());
        write(&path, &text, 1);
        let origin = Origin::new(file::load(&path).unwrap(), Source::File(path.clone()));
        assert!(origin.is_in_file(), "nobody knows better");
        let mut seen = Seen::default();
        let mut look = || seen.look(&path, &origin);
        assert_eq!(look(), (Some(Holds::Same), LOOKS_APART));
        assert_eq!(look(), (None, LOOKS_APART));

        let other = text.replacen("radius = 0.5", "radius = 0.625", 1);
        assert_ne!(other, text);
        write(&path, &other, 2);
        assert!(!origin.is_in_file(), "before anybody has looked");
        assert_eq!(look(), (None, SETTLE));
        write(&path, &other, 3);
        assert_eq!(look(), (None, SETTLE), "it has been written again");
        assert_eq!(look(), (Some(Holds::Other), LOOKS_APART));
        assert_eq!(look(), (None, LOOKS_APART));
        assert!(!origin.is_in_file());

        write(&path, &text, 4);
        assert!(!origin.is_in_file());
        assert_eq!(look(), (None, SETTLE));
        assert_eq!(look(), (Some(Holds::Same), LOOKS_APART), "it is as it was");
        assert!(origin.is_in_file());

        write(&path, "radius =", 5);
        assert_eq!(look(), (None, SETTLE));
        let (Some(Holds::Nothing(reason)), _) = look() else { panic!("it can be read") };
        assert!(reason.contains("mine.toml"), "{reason}");

        std::fs::remove_file(&path).unwrap();
        assert_eq!(look(), (None, SETTLE));
        assert_eq!(look(), (Some(Holds::Gone), LOOKS_APART));
        assert!(!origin.is_in_file());
    }

    #[test]
    fn only_the_file_of_the_picture_is_looked_at() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("mine.toml");
        std::fs::write(&path, file::to_toml(&Stage::find("metal").unwrap().recipe())).unwrap();
        let of_file = Arc::new(Origin::new(file::load(&path).unwrap(), Source::File(path)));
        let of_stage = Arc::new(Origin::of_stage(Stage::find("metal").unwrap()));
        let (mut scene_file, context) = (SceneFile::default(), Context::default());
        scene_file.watch(&context, &of_stage);
        assert!(scene_file.watched.is_none());
        scene_file.watch(&context, &of_file);
        let needed = Arc::downgrade(&scene_file.watched.as_ref().unwrap().1);
        scene_file.watch(&context, &of_file);
        assert_eq!(needed.strong_count(), 1, "the same thread goes on");
        assert_eq!(scene_file.found.wait().map(|found| found.holds), Some(Holds::Same));
        scene_file.watch(&context, &of_stage);
        assert_eq!(needed.strong_count(), 0, "the thread ends");
        assert_eq!(scene_file.found(&of_file), None);
    }
}
