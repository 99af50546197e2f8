//! The window's state. Only this file and its extensions (`frame`, `perform`, `receive`) know all of it.

use super::changes::Changes;
use super::check::Check;
use super::code::Code;
use super::command::Command;
use super::dialogs::Dialogs;
use super::facts::Facts;
use super::files::Files;
use super::first_steps::Card;
use super::frame_log::{FrameLog, FrameTimes};
use super::identity::Identity;
use super::inspector::Inspector;
use super::layers::Layers;
use super::model::Model;
use super::model::device::{Device, DeviceOptions};
use super::model::document::Document;
use super::model::origin::{Origin, Source};
use super::model::remembered::Remembered;
use super::model::show::Show;
use super::model::view::ViewState;
use super::packet::Packet;
use super::paths::Paths;
use super::pixel_values::PixelValues;
use super::places::Place;
use super::second::Second;
use super::speed::Speed;
use super::spheres::Spheres;
use super::surfaces::Surfaces;
use super::toasts::Toasts;
use super::tone::ToneUi;
use super::tracer::Tracer;
use super::viewport::Viewport;
use crate::cli::WindowOptions;
use crate::film::Film;
use crate::output::OutputFormat;
use crate::progressive::Status;
use crate::recipe::Recipe;
use crate::render::RenderJob;
use crate::saved::SavedFilm;
use crate::stages::Stage;
use anyhow::{Context as _, Result};
use eframe::egui;
use std::path::PathBuf;

/// Not "window", because eframe uses that key for position and size.
const STORAGE_KEY: &str = "weekender";

/// For how many frames a new window's size is compared with the screen, because the system reports it late.
const FRAMES_TO_FIT: u8 = 120;

/// All state of the window. [`Window::ui_in`] draws a frame; [`Window::perform`] carries out a command.
pub struct Window {
    pub(super) model: Model,
    pub(super) changes: Changes,
    pub(super) main: Tracer,
    pub(super) second: Second,
    pub(super) layers: Layers,
    pub(super) tone: ToneUi,
    pub(super) values: PixelValues,
    pub(super) surfaces: Surfaces,
    pub(super) identity: Identity,
    pub(super) speed: Speed,
    pub(super) spheres: Spheres,
    pub(super) viewport: Viewport,
    pub(super) inspector: Inspector,
    pub(super) paths: Paths,
    pub(super) packet: Packet,
    pub(super) code: Code,
    pub(super) check: Check,
    pub(super) files: Files,
    pub(super) dialogs: Dialogs,
    pub(super) toasts: Toasts,
    pub(super) first_steps: Card,
    /// Commands to be carried out.
    pub(super) commands: Vec<Command>,
    /// A film to be read once a frame can be woken, and its job.
    pub(super) pending_resume: Option<(PathBuf, RenderJob)>,
    /// A save that waits until the full-size film has samples.
    pub(super) pending_save: Option<(OutputFormat, PathBuf)>,
    /// The picture is to be copied once the full-size film has samples.
    pub(super) pending_copy: bool,
    /// A film to continue, until the tracer takes it.
    pub(super) pending_film: Option<Film>,
    /// Tracing time of the film's samples before this run, if known.
    pub(super) seconds_before: Option<f64>,
    /// Why the document cannot be rendered, if so.
    pub(super) invalid: Option<String>,
    pub(super) frame_log: Option<FrameLog>,
    pub(super) frame_times: FrameTimes,
    /// The last command that was carried out.
    pub(super) performed: Option<Command>,
    /// Whether a control, a menu or a dialog had the keyboard focus in the previous frame.
    pub(super) had_focus: bool,
    pub(super) told_messages: (u64, usize),
    /// The run, and how many of its failures are known.
    pub(super) known_failures: (u64, usize),
    /// The panel that has had the focus last.
    pub(super) panel: Option<Place>,
    pub(super) is_dressed: bool,
    /// This is the user's first window, opened without a picture.
    pub(super) is_new: bool,
    pub(super) frames_to_fit: u8,
    /// Samples per pixel at which the window panics, as an injected fault.
    pub(super) crashes_at: Option<u64>,
}

impl Window {
    /// Makes a window that has not been drawn yet.
    ///
    /// # Errors
    /// If the system cannot start a thread, or the frame log cannot be written.
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
        let has_first_steps = !options.is_picture_given && !remembered.first_steps.is_over;
        let document = match Stage::ALL.last().filter(|_| has_first_steps) {
            Some(last) => {
                let document = Document::new(Origin::of_stage(last));
                Document { stop: options.stop.unwrap_or(document.stop), ..document }
            }
            None => document_of(&options),
        };
        if let Some(file) = &options.file {
            remembered.note_recent(file);
        }
        let pending_resume = match options.resume {
            Some(path) => Some((path, options.recipe.job()?)),
            None => None,
        };
        Ok(Window {
            changes: Changes::new(document.clone()),
            model: Model {
                document,
                selected: None,
                view: ViewState::default(),
                remembered,
                devices: DeviceOptions::of(&options.backend),
                is_paused: false,
                is_full_screen: false,
                has_first_steps,
            },
            main: Tracer::new().context("cannot start the render thread")?,
            second: Second::default(),
            layers: Layers::default(),
            tone: ToneUi::default(),
            values: PixelValues::default(),
            surfaces: Surfaces::default(),
            identity: Identity::default(),
            speed: Speed::default(),
            spheres: Spheres::default(),
            viewport: Viewport::default(),
            inspector: Inspector::default(),
            paths: Paths::default(),
            packet: Packet::default(),
            code: Code::default(),
            check: Check::default(),
            files: Files::default(),
            dialogs: Dialogs::default(),
            toasts: Toasts::default(),
            first_steps: Card::default(),
            commands: Vec::new(),
            pending_resume,
            pending_save: None,
            pending_copy: false,
            pending_film: None,
            seconds_before: Some(0.0),
            invalid: None,
            frame_log,
            frame_times: FrameTimes::default(),
            performed: None,
            had_focus: false,
            told_messages: (0, 0),
            known_failures: (0, 0),
            panel: None,
            is_dressed: false,
            is_new: is_first && has_first_steps,
            frames_to_fit: FRAMES_TO_FIT,
            crashes_at: options.crashes_at,
        })
    }

    /// The document that is shown.
    pub fn document(&self) -> &Document {
        &self.model.document
    }

    /// The document that is shown, to be edited like a panel does.
    pub fn document_mut(&mut self) -> &mut Document {
        &mut self.model.document
    }

    /// The status of the render.
    pub fn status(&self) -> &Status {
        self.main.status()
    }

    /// The settings that are kept for the next run.
    pub fn remembered_mut(&mut self) -> &mut Remembered {
        &mut self.model.remembered
    }

    /// The messages that are visible.
    pub fn messages(&self) -> Vec<String> {
        self.toasts.texts().map(str::to_owned).collect()
    }

    /// Samples per pixel of the displayed picture, and the factor by which it is smaller than requested.
    pub fn shown(&self) -> Option<(u64, u32)> {
        self.main.shown().map(|shown| (shown.samples, shown.divisor))
    }

    /// The colour of a pixel of the displayed picture.
    pub fn shown_pixel(&self, at: [u32; 2]) -> Option<[u8; 3]> {
        self.main.shown().and_then(|shown| shown.texture.colour(at))
    }

    /// Whether the displayed picture is of the current document.
    pub fn is_up_to_date(&self) -> bool {
        self.main.shown().is_some_and(|shown| shown.document.has_same_film(self.document()))
    }

    /// The last command that was carried out.
    pub fn performed(&self) -> Option<Command> {
        self.performed
    }

    /// Whether a dialog is open.
    pub fn has_dialog(&self) -> bool {
        self.dialogs.is_open()
    }

    /// Whether two pictures are being compared.
    pub fn is_comparing(&self) -> bool {
        self.model.view.mode().is_some()
    }

    /// Whether a second picture of the current comparison is available.
    pub fn has_other_picture(&self) -> bool {
        self.second.has_picture(self.document(), &self.model.view)
    }

    /// Where the divider of a wipe is, `0..=1` of the picture's width.
    pub fn divider(&self) -> f32 {
        self.model.view.divider
    }

    /// The selected sphere, by its index in the scene.
    pub fn selected(&self) -> Option<usize> {
        self.model.selected
    }

    /// The current view.
    pub fn show(&self) -> Show {
        self.model.view.show()
    }

    /// Samples per pixel of the displayed layer at full size.
    pub fn layer_samples(&self) -> u64 {
        self.show().layer().map_or(0, |layer| self.layers.samples(layer))
    }

    /// Where the picture is drawn, in points.
    pub fn picture_rect(&self) -> egui::Rect {
        self.viewport.placement.rect()
    }

    /// The last pixel under the pointer and its linear radiance, as of the film's last answer.
    pub fn inspected(&self) -> Option<([u32; 2], [f64; 3])> {
        self.inspector.pixel().map(|pixel| (pixel.at, pixel.mean))
    }

    /// Whether the window is in full-screen mode.
    pub fn is_full_screen(&self) -> bool {
        self.model.is_full_screen
    }

    /// The ray of the highlighted path that is explained, counted from 1, and the number of its rays.
    pub fn explained_ray(&self) -> Option<[usize; 2]> {
        self.paths.position()
    }

    /// The steps of the shown packet without and with refill, once they are recorded.
    pub fn packet_steps(&self) -> Option<[usize; 2]> {
        self.packet.steps()
    }

    /// What was found about the reader's picture that is shown.
    pub fn finding(&self) -> Option<&str> {
        self.check.words()
    }

    /// The number of listed paths.
    pub fn listed_paths(&self) -> usize {
        self.paths.len()
    }

    /// Whether tracing is paused.
    pub fn is_paused(&self) -> bool {
        self.model.is_paused
    }

    /// Why a command is disabled, in words; `None` if it is enabled.
    pub fn disabled_reason(&self, command: Command) -> Option<String> {
        self.facts().disabled_reason(command)
    }

    /// Queues a command for the next frame.
    pub fn send(&mut self, command: Command) {
        self.commands.push(command);
    }

    /// A snapshot of the window.
    pub(super) fn facts(&self) -> Facts {
        Facts {
            status: self.main.status().clone(),
            speed: self.speed.paths_per_second(),
            can_undo: self.changes.can_undo(self.document()),
            can_redo: self.changes.can_redo(self.document()),
            has_pixel: self.inspector.hovered().is_some(),
            has_paths: self.paths.len() > 0,
            invalid: self.invalid.clone(),
            model: self.model.clone(),
        }
    }

    /// Shows a picture of another origin.
    pub(super) fn show_origin(&mut self, origin: Origin) {
        let before = self.document();
        let (stop, usual) = (before.stop, before.origin.usual_stop());
        let mut document = Document::new(origin);
        // A stop condition chosen by the user stays in effect for all stages where it makes sense.
        if stop != usual && document.stop.samples.is_none() {
            document.stop = stop;
        }
        self.seconds_before = Some(0.0);
        self.show_document(document);
    }

    /// Shows another document.
    pub(super) fn show_document(&mut self, document: Document) {
        self.model.document = document;
        self.model.selected = None;
        self.inspector.forget();
        self.paths.forget();
    }

    /// Continues a film of the current document.
    pub(super) fn adopt(&mut self, film: SavedFilm) {
        self.pending_film = Some(film.film);
        self.seconds_before = film.seconds;
        self.changes.adopt(&self.model.document);
    }

    /// Saves the settings for the next run.
    pub(super) fn remember(&self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, STORAGE_KEY, &self.model.remembered);
    }
}

fn document_of(options: &WindowOptions) -> Document {
    let WindowOptions { recipe, unchanged, stage, file, stop, .. } = options;
    // Without the changes made by flags, so that these can be reset.
    let origin = match (stage, file, Recipe::builtin(&recipe.name)) {
        // The scene of a film may have been changed since it was made from its stage or name.
        (_, None, _) if options.resume.is_some() => Origin::guess(unchanged, *stage),
        (Some(stage), _, _) => Origin::of_stage(stage),
        (None, Some(path), _) => Origin::new(unchanged.clone(), Source::File(path.clone())),
        (None, None, Some(builtin)) => {
            // A built-in scene that is also a stage is opened as that stage.
            match Stage::find(&builtin.name) {
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
