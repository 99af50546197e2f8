//! The scene file of the picture: noticing that another program has changed it, and reading it again.

use super::answers::Answers;
use super::command::Command;
use super::model::checked::stamp_of;
use super::model::origin::{Origin, Source};
use super::window::Window;
use crate::job::recipe::{Recipe, file};
use eframe::egui::Context;
use std::path::Path;
use std::sync::{Arc, Weak};
use std::thread;
use std::time::Duration;

const LOOKS_APART: Duration = Duration::from_millis(500);

/// What was read again from the file of an origin.
pub struct Reread {
    origin: Arc<Origin>,
    recipe: Recipe,
}

#[derive(Default)]
pub struct SceneFile {
    /// The origin whose file is watched, until the token is dropped.
    watched: Option<(Arc<Origin>, Arc<()>)>,
    changed: Answers<Arc<Origin>>,
    reread: Answers<Result<Reread, String>>,
}

impl SceneFile {
    fn watch(&mut self, context: &Context, origin: &Arc<Origin>) {
        if self.watched.as_ref().is_some_and(|(watched, _)| Arc::ptr_eq(watched, origin)) {
            return;
        }
        self.watched = None;
        let Source::File(path) = &origin.source else { return };
        let token = Arc::new(());
        let (path, answer) = (path.clone(), self.changed.answer(context));
        let (watched, needed) = (Arc::clone(origin), Arc::downgrade(&token));
        let look = move || look_repeatedly(&path, &needed, || answer.give_one(Arc::clone(&watched)));
        if let Err(error) = thread::Builder::new().name("scene file".to_owned()).spawn(look) {
            log::warn!("changes of the scene file will not be noticed: {error}");
        }
        self.watched = Some((Arc::clone(origin), token));
    }

    /// Reads the file of the origin again.
    pub fn reload(&self, context: &Context, origin: &Arc<Origin>) {
        let Source::File(path) = &origin.source else { return };
        let (path, origin) = (path.clone(), Arc::clone(origin));
        let work = move || {
            let recipe = file::load(&path).map_err(|error| error.to_string())?;
            recipe.job().map_err(|error| error.to_string())?;
            Ok(Reread { origin, recipe })
        };
        self.reread.ask("files", context, work, Err);
    }
}

/// Reports each change of the file once it has settled.
fn look_repeatedly(path: &Path, needed: &Weak<()>, report: impl Fn()) {
    let (mut known, mut last) = (stamp_of(path), stamp_of(path));
    while needed.strong_count() > 0 {
        thread::sleep(LOOKS_APART);
        let now = stamp_of(path);
        if now == last && now != known && now.is_some() {
            known.clone_from(&now);
            report();
        }
        last = now;
    }
}

impl Window {
    /// Watches the scene file, and takes what was read from it again.
    pub(super) fn follow_scene_file(&mut self, context: &Context) {
        let origin = Arc::clone(&self.document().origin);
        self.files.scene_file.watch(context, &origin);
        let Source::File(path) = &origin.source else {
            self.shell.toasts.withdraw(Command::Reload);
            return;
        };
        let name = path.file_name().unwrap_or(path.as_os_str()).display();
        while let Some(changed) = self.files.scene_file.changed.take() {
            let is_own = self.document().checked.file().is_some_and(|saved| saved == *path);
            if Arc::ptr_eq(&changed, &origin) && !is_own {
                self.shell.toasts.offer(format!("{name} has changed"), &[Command::Reload]);
            }
        }
        while let Some(outcome) = self.files.scene_file.reread.take() {
            self.shell.toasts.withdraw(Command::Reload);
            match outcome {
                Ok(reread) if Arc::ptr_eq(&reread.origin, &origin) => {
                    let reloaded = self.document().reloaded(reread.recipe);
                    self.show_document(reloaded);
                    self.shell.toasts.good(format!("Reloaded {name}"));
                }
                Ok(_) => {}
                Err(reason) => self.shell.toasts.bad(format!(
                    "Not reloaded: {reason}. The picture shows the last version that could be read"
                )),
            }
        }
    }
}
