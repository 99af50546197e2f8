//! Handles the answers of background threads.

use super::command::Command;
use super::files::{NotOpened, Resumed};
use super::model::device::Device;
use super::model::document::Document;
use super::model::origin::{Origin, Source};
use super::model::show::Show;
use super::window::Window;
use crate::progressive::{ReferenceMeans, Stop};
use crate::saved::{Content, Opened};
use eframe::egui;
use std::path::PathBuf;
use std::sync::Arc;

impl Window {
    /// Takes all answers that have arrived.
    pub(super) fn receive(&mut self, context: &egui::Context) {
        while let Some(outcome) = self.files.saved.take() {
            match outcome {
                Ok(path) => self.toasts.good(format!("Saved {}", path.display())),
                Err(reason) => self.toasts.bad(format!("Not saved: {reason}")),
            }
        }
        while let Some(outcome) = self.files.opened.take() {
            match outcome {
                Ok(opened) => self.show_opened(opened),
                Err(NotOpened { path, is_picture: true, .. }) if path.exists() => {
                    self.check.begin(context, &path, None);
                }
                Err(NotOpened { reason, .. }) => self.toasts.bad(format!("Not opened: {reason}")),
            }
        }
        if let Some(reason) = self.check.follow() {
            self.toasts.bad(format!("Not checked: {reason}"));
        }
        while let Some(outcome) = self.files.resumed.take() {
            match outcome {
                Ok(resumed) => self.go_on(resumed),
                Err(reason) => self.toasts.bad(format!("Not resumed: {reason}")),
            }
        }
        while let Some(outcome) = self.files.references.take() {
            match outcome {
                Ok((path, reference)) => self.take_reference(path, reference),
                Err(reason) => self.toasts.bad(format!("Reference not loaded: {reason}")),
            }
        }
        while let Some(outcome) = self.dialogs.browsed() {
            match outcome {
                Ok((purpose, path)) => self.use_path(context, purpose, path),
                Err(reason) => self.toasts.bad(reason),
            }
        }
        self.tell_messages();
    }

    fn show_opened(&mut self, opened: Opened) {
        let Opened { path, recipe, stage, content, .. } = opened;
        let origin = match content {
            Content::Scene => Origin::new(recipe.clone(), Source::File(path.clone())),
            _ => Origin::guess(&recipe, stage),
        };
        let mut document = Document::new(origin);
        document.camera = recipe.camera;
        document.settings = recipe.settings;
        if let Content::Picture { samples: Some(samples) } = content {
            // A picture is restored with its stop condition; a film continues.
            document.stop = Stop::at_samples(samples);
        }
        self.show_document(document);
        self.toasts.good(format!("Opened {}", path.display()));
        if let Content::Film(film) = content {
            self.adopt(film);
        }
    }

    fn go_on(&mut self, resumed: Resumed) {
        let path = resumed.path.display();
        if self.document().has_same_film(&resumed.begun) {
            self.toasts.good(format!("Continuing {path}"));
            self.adopt(resumed.film);
        } else {
            self.toasts.bad(format!(
                "Not resumed: the picture was changed before {path} had been read; open the file to continue it"
            ));
        }
    }

    fn take_reference(&mut self, path: PathBuf, reference: ReferenceMeans) {
        let settings = self.document().settings;
        if (reference.width, reference.height) == (settings.width, settings.height) {
            self.model.view.reference = Some(Arc::new(reference));
            self.send(Command::Show(Show::Difference));
            self.toasts.good(format!("Showing the difference from {}", path.display()));
        } else {
            self.toasts.bad(format!(
                "Reference not loaded: {} is {}x{} and the picture is {}x{}; set the picture to that size",
                path.display(),
                reference.width,
                reference.height,
                settings.width,
                settings.height
            ));
        }
    }

    /// Shows the render thread's messages.
    fn tell_messages(&mut self) {
        let status = self.main.status().clone();
        let (run, told) = self.told_messages;
        let told = if run == status.run { told } else { 0 };
        self.told_messages = (status.run, status.messages.len());
        let news: Vec<String> = status.messages.iter().skip(told).cloned().collect();
        if !news.is_empty() {
            // After a failure, the device that continues becomes the chosen one.
            if let Some(info) = &status.backend
                && let Some(device) = Device::ALL.into_iter().find(|device| device.name() == info.name)
            {
                self.model.remembered.device = device;
            }
            for message in news {
                self.toasts.bad(message);
            }
        }
    }
}
