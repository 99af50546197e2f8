//! Saving and opening, away from the window's thread: writing happens on the render thread, which has the film,
//! and reading on a thread of its own.

use super::dialogs::{Chosen, Dialog, PathBox, Purpose};
use super::document::{Document, Origin, Source};
use super::inspector::Pixel;
use super::paths::Listed;
use super::window::Window;
use crate::describe::describe;
use crate::film::replace_file;
use crate::output::{OutputFormat, write_image};
use crate::progressive::{Reference, Stop};
use crate::recipe::file;
use crate::render::RenderJob;
use crate::saved::{self, Content, Opened, SavedFilm};
use eframe::egui;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What other threads have to say.
pub enum Message {
    /// A file was written, or why not.
    Saved(Result<PathBuf, String>),
    /// A file was read, or why not.
    Opened(Result<Box<Opened>, String>),
    /// The film of the picture with which the window began was read, or why not.
    Resumed(PathBuf, Box<Document>, Result<SavedFilm, String>),
    /// A film to compare with was read, or why not.
    Reference(Result<(PathBuf, Reference), String>),
    /// The other stage's film, for the difference.
    Measured(Reference),
    /// A pixel of the film.
    Pixel(Option<Pixel>),
    /// Paths of a pixel.
    Paths(Listed),
    /// The answer of the system's dialog.
    Chosen(Purpose, Chosen),
}

impl Window {
    /// Does with a path what it was asked for.
    pub(super) fn use_path(&mut self, purpose: Purpose, path: PathBuf, context: &egui::Context) {
        if let Some(directory) = path.parent().filter(|directory| !directory.as_os_str().is_empty()) {
            self.remembered.directory = Some(directory.to_owned());
        }
        match purpose {
            Purpose::Open => self.open(path, context),
            Purpose::Save(format) => self.pending_save = Some((format, path)),
            Purpose::SaveScene => self.save_text(&path, &file::to_toml(&self.document.recipe())),
            Purpose::SavePlot => self.save_text(&path, &super::plot::csv(&self.main.status().history)),
            Purpose::Reference => self.load_reference(path, context),
        }
    }

    /// Writes the film, as it is between two passes.
    pub(super) fn save(&mut self, format: OutputFormat, path: PathBuf) {
        let mut recipe = self.document.recipe();
        let (stage, status) = (self.document.stage(), self.main.status().clone());
        let seconds = self.seconds_before;
        let sender = self.messages.0.clone();
        self.main.inspect(move |film| {
            recipe.samples_per_pixel = film.sample_count().max(1);
            let description = describe(&recipe, stage, film, &status, seconds);
            let outcome = if film.sample_count() == 0 {
                Err("nothing has been traced yet; try again in a moment".to_owned())
            } else if OutputFormat::from_path(&path).is_ok_and(|of_name| of_name == format) {
                write_image(&path, film, recipe.rules.transfer, &description)
                    .map(|()| path)
                    .map_err(|error| error.to_string())
            } else {
                Err(format!("{} does not end in {}", path.display(), format.ending()))
            };
            // A window that has been closed has no one to tell.
            let _ = sender.send(Message::Saved(outcome));
        });
    }

    fn save_text(&self, path: &Path, text: &str) {
        let outcome = replace_file(path, |writer| writer.write_all(text.as_bytes()));
        let _ = self
            .messages
            .0
            .send(Message::Saved(outcome.map(|()| path.to_owned()).map_err(|error| error.to_string())));
    }

    /// Opens a scene file, or restores what a picture shows.
    pub(super) fn open(&mut self, path: PathBuf, context: &egui::Context) {
        let (sender, context) = (self.messages.0.clone(), context.clone());
        self.in_background(move || {
            let opened = saved::open(&path).map(Box::new).map_err(|error| error.to_string());
            let _ = sender.send(Message::Opened(opened));
            context.request_repaint();
        });
    }

    /// Goes on with the film of `job`, which is what the window begins with.
    pub(super) fn resume(&mut self, path: PathBuf, job: RenderJob) {
        let (sender, begun) = (self.messages.0.clone(), Box::new(self.document.clone()));
        self.in_background(move || {
            let outcome = saved::resume(&path, &job).map_err(|error| error.to_string());
            let _ = sender.send(Message::Resumed(path, begun, outcome));
        });
    }

    fn load_reference(&mut self, path: PathBuf, context: &egui::Context) {
        let (sender, context) = (self.messages.0.clone(), context.clone());
        self.in_background(move || {
            let outcome = saved::open_film(&path)
                .map(|(_, read)| (path, Reference::of(&read.film)))
                .map_err(|error| error.to_string());
            let _ = sender.send(Message::Reference(outcome));
            context.request_repaint();
        });
    }

    fn in_background(&mut self, work: impl FnOnce() + Send + 'static) {
        if let Err(error) = std::thread::Builder::new().name("files".into()).spawn(work) {
            self.toasts.bad(format!("the file cannot be read: the system gives no thread ({error})"));
        }
    }

    /// Takes what other threads have sent.
    pub(super) fn receive(&mut self, context: &egui::Context) {
        while let Ok(message) = self.messages.1.try_recv() {
            match message {
                Message::Saved(Ok(path)) => self.toasts.good(format!("Saved {}", path.display())),
                Message::Saved(Err(reason)) => self.toasts.bad(format!("Not saved: {reason}")),
                Message::Opened(Ok(opened)) => self.show_opened(*opened),
                Message::Opened(Err(reason)) => self.toasts.bad(format!("Not opened: {reason}")),
                Message::Resumed(path, begun, Ok(film)) => self.go_on(&path, &begun, film),
                Message::Resumed(_, _, Err(reason)) => self.toasts.bad(format!("Not resumed: {reason}")),
                Message::Reference(outcome) => self.take_reference(outcome),
                Message::Measured(reference) => self.compare.measured(&self.main, reference),
                Message::Pixel(pixel) => self.inspector.learn(pixel),
                Message::Paths(listed) => self.paths.learn(listed),
                Message::Chosen(_, Chosen::NoDialog) => {
                    self.toasts.bad("The system has shown no file dialog; type the file's name in the box");
                }
                Message::Chosen(purpose, Chosen::Path(path)) => {
                    if matches!(self.dialog, Some(Dialog::Path(_))) {
                        self.dialog = None;
                    }
                    match PathBox::chosen(purpose, path) {
                        Ok(path) => self.use_path(purpose, path, context),
                        Err(asks) => self.dialog = Some(Dialog::Path(asks)),
                    }
                }
            }
        }
    }

    fn take_reference(&mut self, outcome: Result<(PathBuf, Reference), String>) {
        let settings = self.document.settings;
        match outcome {
            Err(reason) => self.toasts.bad(format!("No reference: {reason}")),
            Ok((path, reference))
                if (reference.width, reference.height) != (settings.width, settings.height) =>
            {
                self.toasts.bad(format!(
                    "No reference: {} is {}x{}, the picture {}x{}; set the picture's size to that",
                    path.display(),
                    reference.width,
                    reference.height,
                    settings.width,
                    settings.height
                ));
            }
            Ok((path, reference)) => {
                self.compare.reference = Some(Arc::new(reference));
                self.send(super::Command::Show(super::viewport::Show::Difference));
                self.toasts.good(format!("Difference to {}", path.display()));
            }
        }
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
            // A picture is restored as it was; a film goes on.
            document.stop = Stop::at_samples(samples);
        }
        self.document = document;
        self.inspector.forget();
        self.paths.forget();
        self.toasts.good(format!("Opened {}", path.display()));
        if let Content::Film(film) = content {
            self.adopt(film);
        }
    }

    fn go_on(&mut self, path: &Path, begun: &Document, film: SavedFilm) {
        if self.document.has_same_film(begun) {
            self.toasts.good(format!("Goes on with {}", path.display()));
            self.adopt(film);
        } else {
            self.toasts.bad(format!(
                "Not resumed: the picture was changed before {} had been read; open the file to go on with it",
                path.display()
            ));
        }
    }
}
