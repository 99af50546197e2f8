//! The window's state, and a frame of it.

use super::command::Command;
use super::compare::Compare;
use super::device::{Device, DeviceOptions};
use super::dialogs::Dialog;
use super::document::{Document, Origin, Source};
use super::files::Message;
use super::frame_log::{FrameLog, FrameTimes};
use super::inspector::Inspector;
use super::layers::Layers;
use super::paths::Paths;
use super::remembered::Remembered;
use super::toasts::Toasts;
use super::tracer::{Tracer, Want};
use super::viewport::{Show, Viewport};
use super::{menu, panels, plot, stage_text, status_bar, theme, viewport};
use crate::backends::BackendChoice;
use crate::cli::WindowOptions;
use crate::output::OutputFormat;
use crate::progressive::{Phase, Status};
use crate::recipe::Recipe;
use crate::saved::SavedFilm;
use anyhow::{Context as _, Result};
use eframe::egui::{self, util::undoer::Undoer};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender};
use std::time::{Duration, Instant};

/// After this long without a move the picture is rendered at its full size.
const SETTLE: Duration = Duration::from_millis(160);

/// Below this width, points, there is no room for two panels beside the picture.
const NARROW: f32 = 900.0;

/// Not "window": eframe keeps place and size under that name.
const STORAGE_KEY: &str = "weekender";

/// How many frames a new window is looked at for whether it fits on its screen: the system is not quick to tell.
const FRAMES_TO_FIT: u8 = 120;

/// All state of the window. [`Window::ui_in`] draws a frame of it, [`Window::perform`] carries out a command.
pub struct Window {
    pub(super) document: Document,
    pub(super) undo: Undoer<Document>,
    pub(super) remembered: Remembered,
    pub(super) main: Tracer,
    pub(super) compare: Compare,
    pub(super) layers: Layers,
    pub(super) viewport: Viewport,
    pub(super) inspector: Inspector,
    pub(super) paths: Paths,
    pub(super) dialog: Option<Dialog>,
    pub(super) toasts: Toasts,
    pub(super) messages: (Sender<Message>, Receiver<Message>),
    pub(super) queue: Vec<Command>,
    /// A save that waits for the full size.
    pub(super) pending_save: Option<(OutputFormat, PathBuf)>,
    /// A film that goes on, until the tracer has it.
    pub(super) pending_film: Option<crate::film::Film>,
    /// What the film's samples took before this run, if that is known.
    pub(super) seconds_before: Option<f64>,
    /// Why the document cannot be rendered.
    pub(super) invalid: Option<String>,
    pub(super) is_paused: bool,
    pub(super) is_full_screen: bool,
    pub(super) frame_log: Option<FrameLog>,
    frame_times: FrameTimes,
    /// What was carried out last.
    pub(super) performed: Option<Command>,
    backend: BackendChoice,
    device_options: DeviceOptions,
    last_document: Document,
    moved: Option<Instant>,
    /// The changes of this frame belong to a move that has begun before.
    is_in_gesture: bool,
    /// A control or a menu had the keyboard in the frame before.
    pub(super) had_focus: bool,
    told_messages: (u64, usize),
    is_dressed: bool,
    /// A document that was taken back or made again is no change of its own.
    pub(super) is_undoing: bool,
    frames_to_fit: u8,
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
        let document = document_of(&options);
        let frame_log = options
            .frame_log
            .as_deref()
            .map(|path| FrameLog::create(path).with_context(|| format!("cannot write {}", path.display())))
            .transpose()?;
        let mut window = Window {
            undo: Undoer::default(),
            main: Tracer::new().context("cannot start the render thread")?,
            compare: Compare::default(),
            layers: Layers::default(),
            viewport: Viewport::default(),
            inspector: Inspector::default(),
            paths: Paths::default(),
            dialog: None,
            toasts: Toasts::default(),
            messages: std::sync::mpsc::channel(),
            queue: Vec::new(),
            pending_save: None,
            pending_film: None,
            seconds_before: Some(0.0),
            invalid: None,
            is_paused: false,
            is_full_screen: false,
            frame_log,
            frame_times: FrameTimes::default(),
            performed: None,
            device_options: DeviceOptions::of(&options.backend),
            backend: options.backend,
            last_document: document.clone(),
            moved: None,
            is_in_gesture: false,
            had_focus: false,
            told_messages: (0, 0),
            is_dressed: false,
            is_undoing: false,
            frames_to_fit: FRAMES_TO_FIT,
            remembered,
            document,
        };
        if let Some(path) = options.resume {
            window.resume(path, options.recipe.job()?);
        }
        Ok(window)
    }

    /// What is shown.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// What is shown, to be changed as by a panel.
    pub fn document_mut(&mut self) -> &mut Document {
        &mut self.document
    }

    /// The numbers of the render.
    pub fn status(&self) -> &Status {
        self.main.status()
    }

    /// What the window remembers.
    pub fn remembered_mut(&mut self) -> &mut Remembered {
        &mut self.remembered
    }

    /// What is being told to the user.
    pub fn messages(&self) -> Vec<String> {
        self.toasts.texts().map(str::to_owned).collect()
    }

    /// Samples per pixel of the picture on the screen, and by how much it is smaller than asked for.
    pub fn shown(&self) -> Option<(u64, u32)> {
        self.main.shown().map(|shown| (shown.samples, shown.divisor))
    }

    /// What was carried out last.
    pub fn performed(&self) -> Option<Command> {
        self.performed
    }

    /// Whether a dialog is open.
    pub fn has_dialog(&self) -> bool {
        self.dialog.is_some()
    }

    /// Whether two pictures are compared.
    pub fn is_comparing(&self) -> bool {
        self.compare.mode.is_some()
    }

    /// Whether there is a second picture, of what is compared now.
    pub fn has_other_picture(&self) -> bool {
        self.compare.has_picture(&self.document)
    }

    /// What the picture's place shows.
    pub fn show(&self) -> Show {
        self.viewport.show
    }

    /// Samples per pixel of the layer that is shown, at the picture's own size.
    pub fn layer_samples(&self) -> u64 {
        self.viewport.show.layer().map_or(0, |layer| self.layers.samples(layer))
    }

    /// Where the picture is drawn, points.
    pub fn picture_rect(&self) -> egui::Rect {
        self.viewport.rect
    }

    /// Whether the window takes the whole screen.
    pub fn is_full_screen(&self) -> bool {
        self.is_full_screen
    }

    /// How many paths of a pixel are listed.
    pub fn listed_paths(&self) -> usize {
        self.paths.len()
    }

    /// Whether tracing waits.
    pub fn is_paused(&self) -> bool {
        self.is_paused
    }

    /// Asks for a command, to be carried out in the next frame.
    pub fn send(&mut self, command: Command) {
        self.queue.push(command);
    }

    /// Shows another picture.
    pub(super) fn show_origin(&mut self, origin: Origin) {
        let stop = self.document.stop;
        let is_usual = stop == self.document.origin.usual_stop();
        self.document = Document::new(origin);
        // Stop conditions that the user has chosen are his for all stages, where they make sense.
        if !is_usual && self.document.stop.samples.is_none() {
            self.document.stop = stop;
        }
        self.seconds_before = Some(0.0);
        self.inspector.forget();
        self.paths.forget();
    }

    /// Goes on with a film of the document that is shown now.
    pub(super) fn adopt(&mut self, film: SavedFilm) {
        self.pending_film = Some(film.film);
        self.seconds_before = film.seconds;
        self.last_document = self.document.clone();
    }

    /// A change by hand: a preview comes first.
    pub(super) fn note_move(&mut self) {
        self.moved = Some(Instant::now());
    }

    /// A command: what it changes is no part of a move.
    pub(super) fn end_move(&mut self) {
        self.moved = None;
        self.is_in_gesture = false;
    }

    fn is_moving(&self) -> bool {
        self.moved.is_some_and(|at| at.elapsed() < SETTLE)
    }

    /// Draws a frame: what has arrived, what was asked for, what is seen, what is to be rendered.
    pub fn ui_in(&mut self, ui: &mut egui::Ui) {
        let context = ui.ctx().clone();
        self.dress(&context);
        self.fit_on_screen(&context);
        self.receive(&context);
        let begin = Instant::now();
        let pictured = self.main.poll(&context);
        self.frame_times.picture = begin.elapsed();
        if let Some(log) = &mut self.frame_log {
            if let Some(begun) = pictured {
                log.pictured(begun);
            }
            let status = self.main.status();
            if let Some(backend) = status.backend.as_ref().filter(|_| status.samples_per_pixel > 0) {
                log.tracing(status.run, backend.name);
            }
        }
        self.tell_messages();
        self.take_input(&context);
        for command in std::mem::take(&mut self.queue) {
            self.perform(&context, command);
        }
        self.layout(ui);
        self.dialogs(ui);
        for command in std::mem::take(&mut self.queue) {
            self.perform(&context, command);
        }
        self.follow(&context);
        self.had_focus = context.memory(|memory| memory.focused().is_some())
            || egui::Popup::is_any_open(&context)
            || self.dialog.is_some();
    }

    fn dress(&mut self, context: &egui::Context) {
        if !self.is_dressed {
            self.is_dressed = true;
            theme::install(context);
            theme::choose(context, self.remembered.theme);
            self.main.wake(context);
        }
    }

    /// Makes a new window smaller that reaches beyond its screen with its frame: the figures at the bottom are seen.
    fn fit_on_screen(&mut self, context: &egui::Context) {
        if self.frames_to_fit == 0 {
            return;
        }
        self.frames_to_fit -= 1;
        let smaller = context.input(|input| {
            let viewport = input.viewport();
            fitting(viewport.inner_rect?.size(), viewport.outer_rect?.size(), viewport.monitor_size?)
        });
        if let Some(size) = smaller {
            self.frames_to_fit = 0;
            context.send_viewport_cmd(egui::ViewportCommand::InnerSize(size));
        }
    }

    fn layout(&mut self, ui: &mut egui::Ui) {
        let is_narrow = ui.available_width() < NARROW;
        let has_panels = self.remembered.has_panels;
        if has_panels {
            menu::ui(self, ui, is_narrow);
            status_bar::ui(self, ui);
            if self.remembered.has_plot {
                plot::ui(self, ui);
            }
            if self.remembered.has_controls {
                let frame = theme::panel(egui::Margin::ZERO);
                egui::Panel::left("controls")
                    .frame(frame)
                    .default_size(244.0)
                    .size_range(190.0..=380.0)
                    .show(ui, |ui| {
                        egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                            egui::Frame::new().inner_margin(egui::Margin::symmetric(12, 8)).show(ui, |ui| {
                                panels::ui(self, ui);
                                if is_narrow && self.remembered.has_info {
                                    stage_text::ui(self, ui);
                                }
                            });
                        });
                    });
            }
            if self.remembered.has_info && !is_narrow {
                let frame = theme::panel(egui::Margin::ZERO);
                egui::Panel::right("info").frame(frame).default_size(256.0).size_range(190.0..=420.0).show(
                    ui,
                    |ui| {
                        egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                            egui::Frame::new().inner_margin(egui::Margin::symmetric(12, 8)).show(ui, |ui| {
                                stage_text::ui(self, ui);
                            });
                        });
                    },
                );
            }
        }
        egui::CentralPanel::default().frame(egui::Frame::new()).show(ui, |ui| viewport::ui(self, ui));
    }

    /// Notes what has changed, and has it rendered.
    fn follow(&mut self, context: &egui::Context) {
        if self.document != self.last_document {
            // What was before a change, or before a whole gesture, is what undo comes back to.
            if !self.is_in_gesture && !self.is_undoing {
                self.undo.add_undo(&self.last_document);
            }
            let is_by_hand = context.input(|input| input.pointer.any_down());
            if !self.document.has_same_film(&self.last_document) {
                if is_by_hand {
                    self.note_move();
                }
                self.seconds_before = Some(0.0);
                if let Some(log) = &mut self.frame_log {
                    log.changed();
                }
            }
            self.last_document = self.document.clone();
        }
        self.is_undoing = false;
        self.is_in_gesture = self.is_moving() || context.input(|input| input.pointer.any_down());
        let now = context.input(|input| input.time);
        self.undo.feed_state(now, &self.document);

        let is_moving = self.is_moving();
        if is_moving {
            context.request_repaint_after(Duration::from_millis(40));
        }
        self.backend = self.chosen_backend();
        self.leave_useless_show();
        let want = Want {
            document: &self.document,
            backend: &self.backend,
            stop: self.document.stop,
            is_moving,
            is_paused: self.is_paused,
        };
        let outcome = match self.pending_film.take() {
            Some(film) => self.main.go_on_with(film, &want),
            None => self.main.want(&want),
        };
        self.invalid = outcome.err();
        self.compare.follow(context, &want, &self.main, &self.messages.0);
        self.layers.follow(context, self.viewport.show.layer(), &self.document, is_moving);
        if self.main.is_full(&self.document)
            && let Some((format, path)) = self.pending_save.take()
        {
            self.save(format, path);
        }
        self.inspector.follow(&self.document, &self.main, &self.messages.0, context);
        self.paths.follow(&self.document, &self.messages.0, context);
    }

    /// The backend of the chosen device, with lanes and threads as chosen.
    fn chosen_backend(&self) -> BackendChoice {
        let Remembered { device, lanes, threads, .. } = self.remembered;
        device.backend(&self.device_options, lanes, threads)
    }

    /// Passes on what the render thread had to say.
    fn tell_messages(&mut self) {
        let status = self.main.status();
        let (run, told) = self.told_messages;
        let told = if run == status.run { told } else { 0 };
        let news: Vec<String> = status.messages.iter().skip(told).cloned().collect();
        self.told_messages = (status.run, status.messages.len());
        if !news.is_empty() {
            // Whatever failed, the device that goes on is the chosen one now.
            if let Some(info) = &status.backend
                && let Some(device) = Device::ALL.into_iter().find(|device| device.name() == info.name)
            {
                self.remembered.device = device;
            }
            for message in news {
                self.toasts.bad(message);
            }
        }
    }

    /// Whether samples are being added.
    pub(super) fn is_working(&self) -> bool {
        matches!(self.main.status().phase, Phase::Preparing | Phase::Tracing)
    }
}

/// The size of the inside of a window that is too large for its screen, in place of `inner`.
fn fitting(inner: egui::Vec2, outer: egui::Vec2, screen: egui::Vec2) -> Option<egui::Vec2> {
    let excess = (outer - screen).max(egui::Vec2::ZERO);
    (excess != egui::Vec2::ZERO && screen.min_elem() > 0.0).then(|| inner - excess)
}

fn document_of(options: &WindowOptions) -> Document {
    let WindowOptions { recipe, stage, file, stop, .. } = options;
    let origin = match (stage, file, Recipe::builtin(&recipe.name)) {
        // A film's scene may have been changed since it was that of its stage or name.
        (_, None, _) if options.resume.is_some() => Origin::guess(recipe, *stage),
        (Some(stage), _, _) => Origin::of_stage(stage),
        (None, Some(path), _) => {
            // The file as it is, so that the flags are changes that can be reset.
            let recipe = crate::recipe::file::load(path).unwrap_or_else(|_| recipe.clone());
            Origin::new(recipe, Source::File(path.clone()))
        }
        (None, None, Some(builtin)) => {
            // A built-in scene that a stage shows is opened as that stage.
            match crate::stages::Stage::find(&builtin.name) {
                Ok(stage) if stage.recipe().scene == builtin.scene => Origin::of_stage(stage),
                _ => Origin::new(builtin, Source::Builtin),
            }
        }
        (None, None, None) => Origin::guess(recipe, None),
    };
    let mut document = Document::new(origin);
    document.camera = recipe.camera;
    document.settings = recipe.settings;
    document.stop = stop.unwrap_or(document.origin.usual_stop());
    document
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        if let Some(log) = &mut self.frame_log {
            let cpu = Duration::from_secs_f32(frame.info().cpu_usage.unwrap_or_default());
            log.frame(FrameTimes { cpu, ..self.frame_times });
        }
        let begin = Instant::now();
        self.ui_in(ui);
        self.frame_times.ui = begin.elapsed();
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, STORAGE_KEY, &self.remembered);
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::vec2;

    #[test]
    fn a_window_with_its_frame_fits_on_the_screen() {
        let screen = vec2(1280.0, 800.0);
        assert_eq!(fitting(vec2(1280.0, 800.0), vec2(1282.0, 821.0), screen), Some(vec2(1278.0, 779.0)));
        assert_eq!(fitting(vec2(1280.0, 800.0), vec2(1280.0, 800.0), screen), None);
        assert_eq!(fitting(vec2(1280.0, 800.0), vec2(1282.0, 821.0), vec2(1920.0, 1080.0)), None);
        assert_eq!(fitting(vec2(640.0, 400.0), vec2(640.0, 400.0), egui::Vec2::ZERO), None, "not known yet");
    }
}
