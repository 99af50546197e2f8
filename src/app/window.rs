//! The window's state. Only this file and those that carry it on (`frame`, `perform`, `receive`) know all of it.

use super::changes::Changes;
use super::command::Command;
use super::dialogs::Dialogs;
use super::facts::Facts;
use super::files::Files;
use super::frame_log::{FrameLog, FrameTimes};
use super::inspector::Inspector;
use super::layers::Layers;
use super::model::Model;
use super::model::device::{Device, DeviceOptions};
use super::model::document::Document;
use super::model::origin::{Origin, Source};
use super::model::remembered::Remembered;
use super::model::show::Show;
use super::model::view::ViewState;
use super::paths::Paths;
use super::second::Second;
use super::toasts::Toasts;
use super::tracer::Tracer;
use super::viewport::Viewport;
use crate::cli::WindowOptions;
use crate::film::Film;
use crate::output::OutputFormat;
use crate::progressive::Status;
use crate::recipe::Recipe;
use crate::render::RenderJob;
use crate::saved::SavedFilm;
use anyhow::{Context as _, Result};
use eframe::egui;
use std::path::PathBuf;

/// Not "window": eframe keeps place and size under that name.
const STORAGE_KEY: &str = "weekender";

/// How many frames a new window is looked at for whether it fits on its screen: the system is not quick to tell.
const FRAMES_TO_FIT: u8 = 120;

/// All state of the window. [`Window::ui_in`] draws a frame of it, [`Window::perform`] carries out a command.
pub struct Window {
    pub(super) model: Model,
    pub(super) changes: Changes,
    pub(super) main: Tracer,
    pub(super) second: Second,
    pub(super) layers: Layers,
    pub(super) viewport: Viewport,
    pub(super) inspector: Inspector,
    pub(super) paths: Paths,
    pub(super) files: Files,
    pub(super) dialogs: Dialogs,
    pub(super) toasts: Toasts,
    /// What was asked for and is not carried out yet.
    pub(super) commands: Vec<Command>,
    /// A film that is read as soon as there is a frame to wake, and its job.
    pub(super) pending_resume: Option<(PathBuf, RenderJob)>,
    /// A save that waits for samples at the full size.
    pub(super) pending_save: Option<(OutputFormat, PathBuf)>,
    /// A film that goes on, until the tracer has it.
    pub(super) pending_film: Option<Film>,
    /// What the film's samples took before this run, if that is known.
    pub(super) seconds_before: Option<f64>,
    /// Why the document cannot be rendered.
    pub(super) invalid: Option<String>,
    pub(super) frame_log: Option<FrameLog>,
    pub(super) frame_times: FrameTimes,
    /// What was carried out last.
    pub(super) performed: Option<Command>,
    /// A control, a menu or a dialog had the keyboard in the frame before.
    pub(super) had_focus: bool,
    pub(super) told_messages: (u64, usize),
    pub(super) is_dressed: bool,
    pub(super) frames_to_fit: u8,
}

impl Window {
    /// A window that has not been drawn yet.
    ///
    /// # Errors
    /// If the system gives no thread, or the frame log cannot be written.
    pub fn new(options: WindowOptions, storage: Option<&dyn eframe::Storage>) -> Result<Self> {
        let earlier: Option<Remembered> = storage.and_then(|storage| eframe::get_value(storage, STORAGE_KEY));
        let is_first = earlier.is_none();
        let mut remembered = earlier.unwrap_or_default().mended();
        if is_first || options.is_device_given {
            remembered.device = Device::of(&options.backend);
        }
        let frame_log = options
            .frame_log
            .as_deref()
            .map(|path| FrameLog::create(path).with_context(|| format!("cannot write {}", path.display())))
            .transpose()?;
        let document = document_of(&options);
        let pending_resume = match options.resume {
            Some(path) => Some((path, options.recipe.job()?)),
            None => None,
        };
        Ok(Window {
            changes: Changes::new(document.clone()),
            model: Model {
                document,
                view: ViewState::default(),
                remembered,
                devices: DeviceOptions::of(&options.backend),
                is_paused: false,
                is_full_screen: false,
            },
            main: Tracer::new().context("cannot start the render thread")?,
            second: Second::default(),
            layers: Layers::default(),
            viewport: Viewport::default(),
            inspector: Inspector::default(),
            paths: Paths::default(),
            files: Files::default(),
            dialogs: Dialogs::default(),
            toasts: Toasts::default(),
            commands: Vec::new(),
            pending_resume,
            pending_save: None,
            pending_film: None,
            seconds_before: Some(0.0),
            invalid: None,
            frame_log,
            frame_times: FrameTimes::default(),
            performed: None,
            had_focus: false,
            told_messages: (0, 0),
            is_dressed: false,
            frames_to_fit: FRAMES_TO_FIT,
        })
    }

    /// What is shown.
    pub fn document(&self) -> &Document {
        &self.model.document
    }

    /// What is shown, to be changed as by a panel.
    pub fn document_mut(&mut self) -> &mut Document {
        &mut self.model.document
    }

    /// The numbers of the render.
    pub fn status(&self) -> &Status {
        self.main.status()
    }

    /// What the window remembers.
    pub fn remembered_mut(&mut self) -> &mut Remembered {
        &mut self.model.remembered
    }

    /// What is being told to the user.
    pub fn messages(&self) -> Vec<String> {
        self.toasts.texts().map(str::to_owned).collect()
    }

    /// Samples per pixel of the picture on the screen, and by how much it is smaller than asked for.
    pub fn shown(&self) -> Option<(u64, u32)> {
        self.main.shown().map(|shown| (shown.samples, shown.divisor))
    }

    /// Whether the picture on the screen is that of the document as it is now.
    pub fn is_up_to_date(&self) -> bool {
        self.main.shown().is_some_and(|shown| shown.document.has_same_film(self.document()))
    }

    /// What was carried out last.
    pub fn performed(&self) -> Option<Command> {
        self.performed
    }

    /// Whether a dialog is open.
    pub fn has_dialog(&self) -> bool {
        self.dialogs.is_open()
    }

    /// Whether two pictures are compared.
    pub fn is_comparing(&self) -> bool {
        self.model.view.mode().is_some()
    }

    /// Whether there is a second picture, of what is compared now.
    pub fn has_other_picture(&self) -> bool {
        self.second.has_picture(self.document(), &self.model.view)
    }

    /// What the picture's place shows.
    pub fn show(&self) -> Show {
        self.model.view.show()
    }

    /// Samples per pixel of the layer that is shown, at the picture's own size.
    pub fn layer_samples(&self) -> u64 {
        self.show().layer().map_or(0, |layer| self.layers.samples(layer))
    }

    /// Where the picture is drawn, points.
    pub fn picture_rect(&self) -> egui::Rect {
        self.viewport.placement.rect()
    }

    /// The pixel that the pointer was over last and its linear radiance, as far as the film has answered.
    pub fn inspected(&self) -> Option<([u32; 2], [f64; 3])> {
        self.inspector.pixel().map(|pixel| (pixel.at, pixel.mean))
    }

    /// Whether the window takes the whole screen.
    pub fn is_full_screen(&self) -> bool {
        self.model.is_full_screen
    }

    /// How many paths of a pixel are listed.
    pub fn listed_paths(&self) -> usize {
        self.paths.len()
    }

    /// Whether tracing waits.
    pub fn is_paused(&self) -> bool {
        self.model.is_paused
    }

    /// Why a command can do nothing now, in words; `None` if it can.
    pub fn disabled_reason(&self, command: Command) -> Option<String> {
        self.facts().disabled_reason(command)
    }

    /// Asks for a command, to be carried out in the next frame.
    pub fn send(&mut self, command: Command) {
        self.commands.push(command);
    }

    /// The window as it is now.
    pub(super) fn facts(&self) -> Facts {
        Facts {
            status: self.main.status().clone(),
            can_undo: self.changes.can_undo(self.document()),
            can_redo: self.changes.can_redo(self.document()),
            invalid: self.invalid.clone(),
            model: self.model.clone(),
        }
    }

    /// Shows another picture.
    pub(super) fn show_origin(&mut self, origin: Origin) {
        let before = self.document();
        let (stop, usual) = (before.stop, before.origin.usual_stop());
        let mut document = Document::new(origin);
        // Stop conditions that the user has chosen are his for all stages, where they make sense.
        if stop != usual && document.stop.samples.is_none() {
            document.stop = stop;
        }
        self.seconds_before = Some(0.0);
        self.show_document(document);
    }

    /// Shows another document.
    pub(super) fn show_document(&mut self, document: Document) {
        self.model.document = document;
        self.inspector.forget();
        self.paths.forget();
    }

    /// Goes on with a film of the document that is shown now.
    pub(super) fn adopt(&mut self, film: SavedFilm) {
        self.pending_film = Some(film.film);
        self.seconds_before = film.seconds;
        self.changes.adopt(&self.model.document);
    }

    /// What is kept for the next run.
    pub(super) fn remember(&self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, STORAGE_KEY, &self.model.remembered);
    }
}

fn document_of(options: &WindowOptions) -> Document {
    let WindowOptions { recipe, unchanged, stage, file, stop, .. } = options;
    // Without what flags have changed, so that these are changes that can be reset.
    let origin = match (stage, file, Recipe::builtin(&recipe.name)) {
        // A film's scene may have been changed since it was that of its stage or name.
        (_, None, _) if options.resume.is_some() => Origin::guess(unchanged, *stage),
        (Some(stage), _, _) => Origin::of_stage(stage),
        (None, Some(path), _) => Origin::new(unchanged.clone(), Source::File(path.clone())),
        (None, None, Some(builtin)) => {
            // A built-in scene that a stage shows is opened as that stage.
            match crate::stages::Stage::find(&builtin.name) {
                Ok(stage) if stage.recipe().scene == builtin.scene => Origin::of_stage(stage),
                _ => Origin::new(builtin, Source::Builtin),
            }
        }
        (None, None, None) => Origin::guess(unchanged, None),
    };
    let mut document = Document::new(origin);
    document.camera = recipe.camera;
    document.settings = recipe.settings;
    document.stop = stop.unwrap_or(document.origin.usual_stop());
    document
}
