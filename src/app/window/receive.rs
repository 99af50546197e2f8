//! Takes the answers of background threads.

use super::Window;
use crate::app::commands::Command;
use crate::app::files::store::Found;
use crate::app::files::{Made, Opened, name_of};
use crate::app::model::{Document, Kept, Origin, Partner, Source};
use crate::job::saved::Kind;
use crate::progressive::Stop;
use crate::progressive::describe::counted;
use eframe::egui::Context;
use std::path::Path;
use std::sync::Arc;

impl Window {
    /// Takes all answers that have arrived.
    pub(super) fn receive(&mut self, context: &Context) {
        while let Some(outcome) = self.files.take_made() {
            match self.settle("Not saved", outcome) {
                Some(Made::File(path, scene)) => {
                    scene.iter().for_each(|saved| self.take_file(&path, saved));
                    self.model.remembered.note_recent(&path);
                    let folder = path.parent().unwrap_or(&path).display();
                    self.shell.toasts.good(format!("Saved {} in {folder}", name_of(&path)));
                }
                Some(Made::Frames(count, folder)) => {
                    let frames = counted(count.into(), "frame");
                    self.shell.toasts.good(format!("Saved {frames} in {}", folder.display()));
                }
                None => {
                    self.shell.leaves_when_saved = false;
                    self.shell.toasts.add_offers(&[Command::Save]);
                }
            }
        }
        while let Some(outcome) = self.files.opened.take() {
            match self.settle("Not opened", outcome) {
                Some(Ok(opened)) => self.show_opened(opened),
                // A picture of another program is the user's own, to be checked.
                Some(Err(path)) => self.tools.check.begin(context, &path, None),
                None => {}
            }
        }
        if self.tools.check.follow(context, &mut self.model.remembered) {
            self.take_checked();
        }
        while let Some(Ok((picture, what))) = self.files.copied.take() {
            self.shell.toasts.good(format!("Copied the {what}"));
            context.copy_image(picture);
        }
        while let Some(outcome) = self.display.kept.copied.take() {
            self.settle("Not kept", outcome).into_iter().for_each(|kept| self.add_kept(kept));
        }
        while let Some(outcome) = self.display.kept.files.take() {
            if let Some(kept) = self.settle("Not compared", outcome) {
                let partner = Partner::Kept(kept.number);
                self.model.view.keep(kept);
                self.model.view.compare_with(partner);
            }
        }
        while let Some(Ok(kept)) = self.store.kept.take() {
            self.model.view.kept.add(kept);
        }
        while let Some(outcome) = self.store.found.take() {
            self.settle("Not resumed", outcome).into_iter().for_each(|found| self.go_on(found));
        }
        while let Ok(outcome) = self.store.outcomes.try_recv() {
            self.settle("Film not kept", outcome);
        }
        while let Some(outcome) = self.store.edits.take() {
            if self.settle("Edits not kept", outcome).is_none() {
                self.store.retry_edits();
            }
        }
        if let Some(outcome) = self.shell.dialogs.chosen() {
            self.end_dialog(context, outcome);
        }
        self.files.scene_file.watch(context, &self.model.document.origin);
        while let Some(Ok(path)) = self.files.scene_file.changes.take() {
            self.files.open(context, path);
        }
        let device = &mut self.model.remembered.device;
        self.tracing.report(device, &mut self.shell.toasts);
    }

    /// A success ends the error about `subject`, and a failure is one.
    fn settle<T>(&mut self, subject: &str, outcome: Result<T, String>) -> Option<T> {
        match &outcome {
            Ok(_) if subject.starts_with("Not ") => self.shell.toasts.end_refusals(),
            Ok(_) => self.shell.toasts.end_error(subject),
            Err(reason) => self.shell.toasts.bad(format!("{subject}: {reason}")),
        }
        outcome.ok()
    }

    fn show_opened(&mut self, (saved, film): Opened) {
        let source = Source::File(saved.path.clone());
        let mut document = match saved.kind {
            Kind::Scene if source == self.document().origin.source => {
                self.document().reloaded(saved.recipe.clone())
            }
            Kind::Scene => Document::new(Origin::new(saved.recipe.clone(), source)),
            _ => Document::of_film(&saved.recipe, saved.stage()),
        };
        document.has_own_size = true;
        if let Some(samples) = saved.samples().filter(|_| film.is_none()) {
            document.stop = Stop::at_samples(samples);
        }
        let path = saved.path;
        self.show_document(document);
        self.model.remembered.note_recent(&path);
        self.shell.toasts.good(format!("Opened {}", name_of(&path)));
        film.into_iter().for_each(|film| self.adopt(film));
    }

    /// Goes on with a film, unless the picture has been changed meanwhile or has more samples.
    fn go_on(&mut self, Found { document: sought, film, named }: Found) {
        let (document, main) = (&mut self.model.document, &self.tracing.main);
        let size = [film.film.width(), film.film.height()];
        let is_same = document.has_same_film(&sought)
            || size != sought.size() && !document.has_own_size && document.is_same_at_another_size(&sought);
        let has_more = !main.is_full(document) || film.film.sample_count() >= main.status().samples_per_pixel;
        if is_same && (has_more || named.is_some()) {
            document.set_size(size);
            self.adopt(film);
        }
        if let Some(path) = named {
            let place = self.document().place();
            self.shell.toasts.good(match is_same {
                true => format!("Resumed {place}"),
                false => format!("The picture has changed meanwhile; open {} to continue it", name_of(&path)),
            });
            self.model.remembered.note_recent(&path);
        }
    }

    fn add_kept(&mut self, kept: Kept) {
        let kept = self.model.view.keep(kept);
        let place = self.model.view.kept.place(&kept);
        self.store.pin(kept);
        self.shell.toasts.good(format!("Kept; Compare with has it as number {}", place + 1));
    }

    /// From now on, a picture whose scene was saved is that file, unless it is a stage as in the book.
    fn take_file(&mut self, path: &Path, saved: &Document) {
        if saved.stage().is_none() || saved.is_changed() {
            let origin = Arc::new(saved.saved_in(path));
            for document in self.changes.all_mut().chain([&mut self.model.document]) {
                if Arc::ptr_eq(&document.origin, &saved.origin) {
                    document.origin = Arc::clone(&origin);
                }
            }
        }
    }
}
