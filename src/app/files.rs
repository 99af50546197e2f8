//! Saving and opening, away from the window's thread: writing happens on the render thread, which has the film,
//! and reading on a thread of its own.

use super::dialogs::{Chosen, Dialog, PathBox, Purpose};
use super::document::{Document, Origin, Source, Stop};
use super::inspector::Pixel;
use super::paths::Listed;
use super::window::Window;
use crate::describe::describe;
use crate::film::{checkpoint, key, replace_file};
use crate::output::{OutputFormat, read_description, write_image};
use crate::progressive::Reference;
use crate::recipe::{Recipe, file};
use crate::stages::Stage;
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

/// What was in a file.
pub struct Opened {
    path: PathBuf,
    recipe: Recipe,
    source: Option<Source>,
    stage: Option<&'static Stage>,
    /// A film and the seconds that it took, if it says so.
    film: Option<(crate::film::Film, Option<f64>)>,
    samples: Option<u64>,
}

impl Window {
    /// Does with a path what it was asked for.
    pub(super) fn use_path(&mut self, purpose: Purpose, path: PathBuf, context: &egui::Context) {
        if let Some(directory) = path.parent().filter(|directory| !directory.as_os_str().is_empty()) {
            self.remembered.directory = Some(directory.to_owned());
        }
        match purpose {
            Purpose::Open => self.open(path, Some(context)),
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
    pub(super) fn open(&mut self, path: PathBuf, context: Option<&egui::Context>) {
        let (sender, context) = (self.messages.0.clone(), context.cloned());
        self.in_background(move || {
            let _ = sender.send(Message::Opened(read(&path).map(Box::new)));
            if let Some(context) = context {
                context.request_repaint();
            }
        });
    }

    fn load_reference(&mut self, path: PathBuf, context: &egui::Context) {
        let (sender, context) = (self.messages.0.clone(), context.clone());
        self.in_background(move || {
            let outcome = checkpoint::load(&path)
                .map(|read| (path, Reference::of(&read.film)))
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
        let Opened { path, recipe, source, stage, film, samples } = opened;
        let origin = match source {
            Some(source) => Origin::new(recipe.clone(), source),
            None => Origin::guess(&recipe, stage),
        };
        let mut document = Document::new(origin);
        document.camera = recipe.camera;
        document.settings = recipe.settings;
        document.stop = match samples {
            // A picture is restored as it was; a film goes on.
            Some(samples) if film.is_none() => Stop { samples: Some(samples), seconds: None, noise: None },
            _ => Stop::for_recipe(&recipe),
        };
        self.document = document;
        self.inspector.forget();
        self.paths.forget();
        self.toasts.good(format!("Opened {}", path.display()));
        if let Some((film, seconds)) = film {
            self.adopt(film, seconds);
        }
    }
}

/// Reads a file of any kind that can be opened.
fn read(path: &Path) -> Result<Opened, String> {
    let is_scene = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
    if is_scene {
        let recipe = file::load(path).map_err(|error| error.to_string())?;
        let source = Some(Source::File(path.to_owned()));
        return Ok(Opened { path: path.to_owned(), recipe, source, stage: None, film: None, samples: None });
    }
    let is_film = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("exr"));
    let (description, film) = if is_film {
        let read = checkpoint::load(path).map_err(|error| error.to_string())?;
        (read.description, Some(read.film))
    } else {
        (read_description(path).map_err(|error| error.to_string())?, None)
    };
    let label = path.display().to_string();
    let mut recipe = file::parse(description.recipe(), &label).map_err(|error| error.to_string())?;
    let job = recipe.job().map_err(|error| error.to_string())?;
    if let Some(film) = &film
        && (film.width(), film.height(), film.halves().len())
            != (job.settings().width, job.settings().height, job.settings().half_count())
    {
        return Err(format!("{label} holds a film of another shape than its recipe says"));
    }
    let stem = path.file_stem().map_or_else(|| label.clone(), |stem| stem.to_string_lossy().into_owned());
    recipe.name = description.get(key::SCENE).map_or(stem, str::to_owned);
    let number = |key| description.get(key).and_then(|value| value.parse::<f64>().ok());
    Ok(Opened {
        path: path.to_owned(),
        source: None,
        stage: description.get(key::STAGE).and_then(|id| Stage::find(id).ok()),
        film: film.map(|film| (film, number(key::SECONDS))),
        samples: description.get(key::SAMPLES).and_then(|value| value.parse().ok()).filter(|n| *n > 0),
        recipe,
    })
}
