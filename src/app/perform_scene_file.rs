//! What becomes of the picture when its scene file changes, and the command line, which names that file.

use super::command::Command;
use super::model::device::{self, Device};
use super::model::origin::Source;
use super::scene_file::{Holds, Reread};
use super::window::Window;
use crate::system::files::FileIdentity;
use eframe::egui::Context;
use std::path::Path;
use std::sync::Arc;

impl Window {
    /// Takes what was found in the scene file, and what was read from it again.
    pub(super) fn follow_scene_file(&mut self, context: &Context) {
        let origin = Arc::clone(&self.model.document.origin);
        self.scene_file.watch(context, &origin);
        if let (Some(holds), Source::File(path)) = (self.scene_file.found(&origin), &origin.source) {
            self.tell_of_file(path, &holds);
        }
        if !matches!(origin.source, Source::File(_)) {
            self.toasts.withdraw(Command::Reload);
        }
        while let Some(outcome) = self.scene_file.reread() {
            match outcome {
                Ok(reread) => self.take_reread(&reread),
                Err(reason) => self.toasts.bad(format!("Not reloaded: {reason}")),
            }
        }
    }

    fn tell_of_file(&mut self, path: &Path, holds: &Holds) {
        self.toasts.withdraw(Command::Reload);
        let path_words = path.display();
        match holds {
            Holds::Same => {}
            // This window has saved the scene there.
            Holds::Other if self.has_saved_to(path) => {}
            Holds::Other => {
                self.toasts.offer(format!("{path_words} was changed by another program"), Command::Reload);
            }
            Holds::Nothing(reason) => {
                let stays = "the picture stays as it is";
                self.toasts.bad(format!("The scene file was changed and cannot be read; {stays}: {reason}"));
            }
            Holds::Gone => self.toasts.bad(format!(
                "{path_words} is no longer there; the picture stays as it is, and can be saved with \
                 File > Save scene file"
            )),
        }
    }

    /// Whether the scene, as it is shown, was saved to this file last.
    fn has_saved_to(&self, path: &Path) -> bool {
        let identities =
            self.document().checked.file().map(|saved| [FileIdentity::of(&saved), FileIdentity::of(path)]);
        matches!(identities, Some([Some(saved), Some(read)]) if saved.is_same_as(&read))
    }

    fn take_reread(&mut self, reread: &Reread) {
        let document = self.document();
        // Another picture may be shown by now.
        let Source::File(path) = &reread.origin.source else { return };
        if !Arc::ptr_eq(&reread.origin, &document.origin) {
            return;
        }
        let path_words = path.display();
        if reread.recipe == reread.origin.recipe {
            reread.note(&reread.origin);
            self.toasts.withdraw(Command::Reload);
            self.toasts.good(format!("{path_words} holds what was read from it before"));
            return;
        }
        let end = if document.has_changed_scene() { "; Undo brings the spheres back" } else { "" };
        let reloaded = document.reloaded(reread.recipe.clone());
        reread.note(&reloaded.origin);
        self.show_document(reloaded);
        self.toasts.withdraw(Command::Reload);
        self.toasts.good(format!("Reloaded {path_words}{end}"));
    }

    /// Copies the command line that renders the picture on the screen.
    pub(super) fn copy_command(&mut self, context: &Context) {
        // As many as a picture saved now would have.
        let subject = self.subject();
        let document = subject.document();
        let samples = match subject.samples() {
            samples @ 1.. if subject.is_full() => samples,
            _ => document.stop.samples.unwrap_or(document.origin.recipe.samples_per_pixel),
        };
        let device = self.model.remembered.device;
        // Software adapters are used only if they are named.
        let is_gpu = matches!(device, Device::Gpu | Device::Both);
        let adapter = device::adapter().ok().filter(|adapter| is_gpu && adapter.is_software);
        let adapter = adapter.map(|adapter| adapter.name.as_str());
        let line = document.command_line(samples.max(1), device.name(), adapter);
        context.copy_text(line);
        let is_saved = document.checked.file().is_some();
        let fault = match &document.origin.source {
            _ if is_saved => None,
            Source::File(path) if !document.has_changed_scene() && !document.origin.is_in_file() => {
                Some(format!("{} no longer holds this picture", path.display()))
            }
            Source::Embedded | Source::Extreme(_) => Some("the scene has no file yet".to_owned()),
            _ => document.has_changed_scene().then(|| "the scene has no file yet".to_owned()),
        };
        self.toasts.good(match fault {
            Some(fault) => format!("Copied; {fault}: save the scene file, which the command reads"),
            None => "Copied: the command line that renders this picture".to_owned(),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::app::model::document::Document;
    use crate::app::model::origin::Origin;
    use crate::app::tests::{until, window};
    use crate::job::recipe::file;
    use crate::stages::Stage;
    use std::path::PathBuf;

    const SPHERE: &str = "radius = 0.5";

    /// A scene file in this directory, and a window that shows it.
    fn shown(directory: &Path, context: &Context) -> (PathBuf, Window) {
        let path = directory.join("mine.toml");
        std::fs::write(&path, file::to_toml(&Stage::find("metal").unwrap().recipe())).unwrap();
        let words = format!("weekender --scene {} --size 16x9 --samples 1 --device cpu", path.display());
        let mut window = window(&words);
        until(&mut window, context, "a picture", |window| window.status().samples_per_pixel == 1);
        (path, window)
    }

    /// Changes the first text of a file to another one, which is longer.
    fn change(path: &Path, from: &str, to: &str) {
        let text = std::fs::read_to_string(path).unwrap();
        assert!(text.contains(from), "{text}");
        std::fs::write(path, text.replacen(from, to, 1)).unwrap();
    }

    fn has_told(words: &'static str) -> impl Fn(&Window) -> bool {
        move |window| window.messages().iter().any(|text| text.contains(words))
    }

    /// The command line that is copied, and what is said about it.
    fn copied(window: &mut Window, context: &Context) -> (String, String) {
        window.copy_command(context);
        let line = window.document().command_line(1, "cpu", None);
        (line, window.messages().pop().unwrap())
    }

    #[test]
    fn a_scene_file_that_was_changed_is_offered_again_and_not_named() {
        let (directory, context) = (tempfile::tempdir().unwrap(), Context::default());
        let (path, mut window) = shown(directory.path(), &context);
        let of_file = format!("--scene={} ", path.display());
        let (line, told) = copied(&mut window, &context);
        assert!(line.contains(&of_file) && told.starts_with("Copied: "), "{line}; {told}");
        window.document_mut().camera.look_from.x = 0.25;
        let camera = window.document().camera;

        change(&path, SPHERE, "radius = 0.0625");
        until(&mut window, &context, "a word about the change", has_told("was changed by another program"));
        let (line, told) = copied(&mut window, &context);
        assert!(
            line.contains("--scene=mine-changed.toml --size=16x9 ") && !line.contains(&of_file),
            "{line}"
        );
        assert!(told.contains("mine.toml no longer holds this picture: save the scene file"), "{told}");

        window.perform(&context, Command::Reload);
        until(&mut window, &context, "the scene of the file", has_told("Reloaded"));
        assert!(!has_told("was changed by another program")(&window), "the offer is gone");
        assert_eq!(window.document().camera, camera, "the user has moved it");
        assert!(window.document().scene().spheres.iter().any(|sphere| sphere.radius == 0.0625));
        let (line, told) = copied(&mut window, &context);
        assert!(line.contains(&of_file) && told.starts_with("Copied: "), "{line}; {told}");
        window.perform(&context, Command::Reload);
        until(&mut window, &context, "the same", has_told("holds what was read from it before"));
        assert_eq!(window.document().camera, camera);
    }

    #[test]
    fn a_file_that_is_broken_or_gone_leaves_the_picture() {
        let (directory, context) = (tempfile::tempdir().unwrap(), Context::default());
        let (path, mut window) = shown(directory.path(), &context);
        let document = window.document().clone();
        change(&path, SPHERE, "radius = [0.5]");
        window.perform(&context, Command::Reload);
        until(&mut window, &context, "a word about the reload", has_told("Not reloaded: "));
        until(&mut window, &context, "a word about the file", has_told("changed and cannot be read"));
        std::fs::remove_file(&path).unwrap();
        until(&mut window, &context, "a word about its end", has_told("is no longer there"));
        assert!(*window.document() == document);
    }

    #[test]
    fn only_a_scene_file_is_reloaded() {
        let mut window = window("weekender --stage metal --size 16x9 --device cpu");
        window.perform(&Context::default(), Command::Reload);
        assert_eq!(
            window.messages(),
            ["Reload the scene file: this picture is not from a scene file; open one first"]
        );
    }

    #[test]
    fn a_scene_that_is_in_no_file_is_to_be_saved_for_its_command() {
        let directory = tempfile::tempdir().unwrap();
        let (path, context) = (directory.path().join("mine.toml"), Context::default());
        let mut window = window("weekender --stage metal --size 16x9 --device cpu");
        let stage = window.document().clone();
        let embedded = Document::new(Origin::new(stage.origin.recipe.clone(), Source::Embedded));
        let changed = Document { checked: Arc::clone(&embedded.checked), ..stage.clone() };
        assert!(changed.has_changed_scene() && !embedded.has_changed_scene());
        let usual = "Copied: the command line that renders this picture";
        let fault = "Copied; the scene has no file yet: save the scene file, which the command reads";
        let mut told_of = |document: &Document| {
            window.model.document = document.clone();
            copied(&mut window, &context).1
        };
        assert_eq!([&stage, &embedded, &changed].map(&mut told_of), [usual, fault, fault]);
        std::fs::write(&path, "").unwrap();
        changed.checked.note_file(&path);
        assert_eq!(told_of(&changed), usual);
    }
}
