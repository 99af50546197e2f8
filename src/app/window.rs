//! The state of the window. Only the files at the top (`layout`, `frame`, `perform`, `receive` and others) know all of it.

use super::changes::Changes;
use super::check::Check;
use super::code::Code;
use super::command::Command;
use super::dialogs::Dialogs;
use super::facts::Facts;
use super::files::Files;
use super::first_steps::Card;
use super::flight::Flight;
use super::frame_log::{FrameLog, FrameTimes};
use super::identity::Identity;
use super::inspector::Inspector;
use super::layers::Layers;
use super::model::Model;
use super::model::crop::Crop;
use super::model::device::{Device, DeviceOptions};
use super::model::document::Document;
use super::model::origin::{Origin, Source};
use super::model::view::ViewState;
use super::packet::Packet;
use super::paths::Paths;
use super::pixel_values::PixelValues;
use super::places::Place;
use super::present::Presenter;
use super::recovery::Recovery;
use super::scene_file::SceneFile;
use super::second::Second;
use super::settings::{Read, SettingsFile};
use super::sight::Sighted;
use super::sizer::Sizer;
use super::slot_files::DISK_LIMIT;
use super::slots::SlotActions;
use super::speed::Speed;
use super::spheres::Spheres;
use super::surfaces::Surfaces;
use super::thumbnails::Thumbnails;
use super::toasts::Toasts;
use super::tone::ToneUi;
use super::tracer::Tracer;
use super::viewport::Viewport;
use crate::cli::WindowOptions;
use crate::film::Film;
use crate::job::output::OutputFormat;
use crate::job::recipe::Recipe;
use crate::job::render::RenderJob;
use crate::job::saved::SavedFilm;
use crate::stages::Stage;
use anyhow::{Context as _, Result};
use eframe::egui::{Context, Event};
use std::path::PathBuf;

/// For how many frames a new window's size is compared with the screen, because the system reports it late.
const FRAMES_TO_FIT: u8 = 120;

/// All state of the window. [`Window::ui_in`] draws a frame; [`Window::perform`] carries out a command.
pub struct Window {
    pub(super) model: Model,
    pub(super) changes: Changes,
    pub(super) main: Tracer,
    pub(super) second: Second,
    pub(super) slot_actions: SlotActions,
    pub(super) layers: Layers,
    pub(super) tone: ToneUi,
    pub(super) values: PixelValues,
    pub(super) surfaces: Surfaces,
    pub(super) identity: Identity,
    pub(super) speed: Speed,
    pub(super) sizer: Sizer,
    pub(super) spheres: Spheres,
    pub(super) viewport: Viewport,
    pub(super) inspector: Inspector,
    pub(super) paths: Paths,
    pub(super) packet: Packet,
    pub(super) code: Code,
    pub(super) check: Check,
    pub(super) files: Files,
    pub(super) scene_file: SceneFile,
    pub(super) dialogs: Dialogs,
    pub(super) toasts: Toasts,
    pub(super) first_steps: Card,
    pub(super) presenter: Presenter,
    pub(super) thumbnails: Thumbnails,
    /// The sight that is shown.
    pub(super) sight: Option<Sighted>,
    pub(super) recovery: Recovery,
    /// Where the settings are remembered.
    pub(super) settings: Option<SettingsFile>,
    /// The flight of the camera, if it moves by itself.
    pub(super) flight: Option<Flight>,
    /// Commands to be carried out.
    pub(super) commands: Vec<Command>,
    /// A film to be read once a frame can be woken, and its job.
    pub(super) pending_resume: Option<(PathBuf, RenderJob)>,
    /// A save that waits until the full-size film has samples.
    pub(super) pending_save: Option<(OutputFormat, PathBuf)>,
    /// A part of the picture to save once the full-size film has samples.
    pub(super) pending_crop: Option<(Crop, PathBuf)>,
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
    /// Events that wait for the next frame.
    pub(super) late_events: Vec<Event>,
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
    pub fn new(options: WindowOptions) -> Result<Self> {
        let (settings, earlier, message) = match options.settings.as_deref().map(SettingsFile::read) {
            Some(Read { file, settings, message }) => (Some(file), settings, message),
            None => (None, None, None),
        };
        let is_first = earlier.is_none();
        let mut remembered = earlier.unwrap_or_default();
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
        let mut window = Window {
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
                presentation: None,
                has_recovered: false,
            },
            main: Tracer::new().context("cannot start the render thread")?,
            second: Second::default(),
            slot_actions: SlotActions::default(),
            layers: Layers::default(),
            tone: ToneUi::default(),
            values: PixelValues::default(),
            surfaces: Surfaces::default(),
            identity: Identity::default(),
            speed: Speed::default(),
            sizer: Sizer::default(),
            spheres: Spheres::default(),
            viewport: Viewport::default(),
            inspector: Inspector::default(),
            paths: Paths::default(),
            packet: Packet::default(),
            code: Code::default(),
            check: Check::default(),
            files: Files::default(),
            scene_file: SceneFile::default(),
            dialogs: Dialogs::default(),
            toasts: Toasts::default(),
            first_steps: Card::default(),
            presenter: Presenter::default(),
            thumbnails: Thumbnails::default(),
            sight: None,
            recovery: Recovery::new(options.autosave_every),
            settings,
            flight: None,
            commands: Vec::new(),
            pending_resume,
            pending_save: None,
            pending_crop: None,
            pending_copy: false,
            pending_film: None,
            seconds_before: Some(0.0),
            invalid: None,
            frame_log,
            frame_times: FrameTimes::default(),
            performed: None,
            had_focus: false,
            late_events: Vec::new(),
            told_messages: (0, 0),
            known_failures: (0, 0),
            panel: None,
            is_dressed: false,
            is_new: is_first && has_first_steps,
            frames_to_fit: FRAMES_TO_FIT,
            crashes_at: options.crashes_at,
        };
        if let Some(message) = message {
            window.toasts.bad(message);
        }
        if let Some(directory) = &options.state_directory {
            let may_restore = !options.is_picture_given && !options.is_fresh;
            let limit = options.kept_limit.unwrap_or(DISK_LIMIT);
            window.begin_recovery(directory, may_restore, (options.stop, limit));
        }
        Ok(window)
    }

    /// Has the settings written soon if they have changed.
    pub(super) fn keep_settings(&mut self, context: &Context) {
        let Some(file) = &mut self.settings else { return };
        if let Some(reason) = file.keep(context, &self.model.remembered) {
            self.toasts.bad(format!("The settings are not kept: {reason}"));
        }
    }

    /// Writes the settings for the last time.
    pub(super) fn finish_settings(&mut self) {
        let Some(mut file) = self.settings.take() else { return };
        if let Err(reason) = file.finish(&self.model.remembered) {
            crate::system::console::note(&format!("weekender: the settings are not kept: {reason}"));
        }
    }

    /// The document that is shown.
    pub fn document(&self) -> &Document {
        &self.model.document
    }

    /// Renders small pictures of all stages while the program has nothing better to do. They are kept in `directory`, if
    /// there is one.
    pub fn show_thumbnails(&mut self, directory: Option<PathBuf>) {
        self.thumbnails.switch_on(directory);
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
            seconds_before: self.seconds_before,
            can_undo: self.changes.can_undo(self.document()),
            can_redo: self.changes.can_redo(self.document()),
            has_pixel: self.inspector.hovered().is_some(),
            has_paths: self.paths.len() > 0,
            has_sight: self.sight.is_some(),
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
        self.show_document(document);
    }

    /// Shows another document.
    pub(super) fn show_document(&mut self, document: Document) {
        self.end_sight();
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
}

fn document_of(options: &WindowOptions) -> Document {
    let WindowOptions { recipe, unchanged, stage, file, stop, .. } = options;
    // Without the changes made by flags, so that these can be reset.
    let origin = match (stage, file, Recipe::builtin(&recipe.name)) {
        // The scene of a film may have been changed since it was made from its stage or name.
        (_, None, _) if options.resume.is_some() => Origin::guess(unchanged, *stage),
        (Some(stage), _, _) => Origin::of_stage(stage),
        (None, Some(path), _) => Origin::new(unchanged.clone(), Source::File(path.clone())),
        (None, None, Some(builtin)) => Origin::of_builtin(builtin),
        (None, None, None) => Origin::guess(unchanged, None),
    };
    let mut document = Document::new(origin);
    document.camera = recipe.camera;
    document.settings = recipe.settings;
    document.has_own_size |= options.is_size_given || options.resume.is_some();
    document.stop = stop.unwrap_or(document.origin.usual_stop());
    document
}

#[cfg(test)]
mod tests;
