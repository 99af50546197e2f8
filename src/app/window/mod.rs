//! The window: its parts, and the order of a frame. Only this file and those that extend it
//! know all parts.

mod input;
mod layout;
mod perform;
mod pictures;
mod receive;
mod saving;
mod shell;

use crate::app::commands::{Command, Snapshot};
use crate::app::files::Files;
use crate::app::files::store::{Last, Store};
use crate::app::model::changes::Changes;
use crate::app::model::{Device, Document, Model, Origin, Source, Stored, Tab, ViewState, middle_of};
use crate::app::toolkit::theme;
use crate::app::tools::Tools;
use crate::app::tracing::Tracing;
use crate::app::tracing::subject::Subject;
use crate::app::viewport::display::Display;
use crate::cli::WindowOptions;
use crate::job::recipe::Recipe;
use anyhow::{Context as _, Result};
use eframe::egui;
use shell::Shell;
use std::time::Duration;

/// The window of the program.
#[doc(hidden)]
pub struct Window {
    /// The user's choices.
    pub model: Model,
    /// The undo history.
    pub changes: Changes,
    pub tracing: Tracing,
    pub display: Display,
    pub tools: Tools,
    pub files: Files,
    pub store: Store,
    pub shell: Shell,
    /// Commands to run in this frame.
    pub commands: Vec<Command>,
}

impl Window {
    /// A window of these options, without a display.
    ///
    /// # Errors
    /// If the render thread cannot be started.
    pub fn new(options: WindowOptions) -> Result<Self> {
        Window::with(options, None)
    }

    /// A window of these options that begins where the last one ended.
    ///
    /// # Errors
    /// Those of [`Window::new`].
    pub fn with(options: WindowOptions, storage: Option<&dyn eframe::Storage>) -> Result<Self> {
        let (mut remembered, view) = Stored::read(storage);
        let directory = options.state_directory.as_deref();
        let (mut store, Last { steps, lock }) = Store::open(directory, options.autosave_every);
        let has_hardly_begun = lock > Some(0);
        if has_hardly_begun {
            (remembered.device, remembered.mine) = (Device::default(), None);
        }
        if options.is_device_given {
            remembered.device = Device::of(&options.backend);
        }
        if let Some(file) = &options.file {
            remembered.note_recent(file);
        }
        if options.mine.is_some() {
            remembered.mine.clone_from(&options.mine);
            remembered.mine_stage = None;
            (remembered.hides_info, remembered.tab) = (false, Tab::Check);
        }
        let is_asked_for = options.is_fresh || options.is_picture_given;
        let goes_on = !is_asked_for && !has_hardly_begun;
        let mut document = match steps.last() {
            Some(document) if goes_on => document.clone(),
            _ if options.is_picture_given => document_of(&options),
            _ => Document::new(Origin::usual()),
        };
        document.stop = options.stop.unwrap_or(document.stop);
        if let Some(path) = options.resume {
            store.named = Some((path, options.recipe.job()?));
        }
        let mut shell = Shell::default();
        if has_hardly_begun && !is_asked_for {
            let words = "The last window ended soon after it began. This one begins without its picture";
            shell.toasts.offer(words, &[Command::Undo]);
        } else if lock.is_some() && goes_on && !steps.is_empty() {
            shell.toasts.good("The last window ended early. This is the picture that it showed");
        }
        let view = if goes_on { view } else { ViewState::default() };
        Ok(Window {
            changes: Changes::of_steps(&steps, document.clone()),
            model: Model {
                document,
                own_stop: options.stop.filter(|stop| stop.samples.is_none()),
                selected: None,
                view,
                remembered,
                given: options.backend,
                is_paused: false,
                playing: None,
                hides_panels: false,
                is_full_screen: false,
                presentation: None,
            },
            tracing: Tracing::new().context("cannot start the render thread")?,
            display: Display::default(),
            tools: Tools::default(),
            files: Files::default(),
            store,
            shell,
            commands: Vec::new(),
        })
    }

    pub(super) fn document(&self) -> &Document {
        &self.model.document
    }

    /// Carries out a command in the next frame.
    pub fn send(&mut self, command: Command) {
        self.commands.push(command);
    }

    /// The state of the window now.
    pub fn snapshot(&self) -> Snapshot {
        let [undo, redo] = self.changes.labels(self.document());
        let is_own = |at| !self.model.view.is_other(middle_of(at, self.document().size())[0]);
        Snapshot {
            status: self.tracing.main.status().clone(),
            other: self.tracing.other_status(&self.model),
            verdict: self.display.kept.verdict(&self.model, &self.tracing),
            seconds_before: self.tracing.main.seconds_before,
            films: self.store.films(),
            undo,
            redo,
            is_coarse: self.tracing.main.is_coarse(),
            has_picture: self.tracing.main.has_picture(self.document()),
            is_moving: self.changes.is_in_gesture,
            is_held: self.tracing.main.is_held(),
            has_pixel: self.tools.inspector.hovered.is_some_and(is_own),
            has_paths: self.tools.paths.len() > 0,
            has_sight: self.display.sight.is_some(),
            invalid: self.tracing.invalid.clone(),
            model: self.model.clone(),
        }
    }

    /// Draws a frame.
    pub fn ui_in(&mut self, ui: &mut egui::Ui) {
        let context = ui.ctx().clone();
        self.dress(&context);
        self.tracing.main.poll(&context);
        self.receive(&context);
        self.follow_close(&context);
        self.take_input(&context);
        self.play(&context);
        self.perform_all(&context);
        self.layout(ui);
        self.perform_all(&context);
        self.finish_document(&context);
        self.follow(&context);
        theme::paint_focus(&context);
        self.shell.had_focus = context.memory(|memory| memory.focused().is_some())
            || egui::Popup::is_any_open(&context)
            || self.shell.dialogs.is_open();
    }

    /// Sets fonts and colours, before the first frame.
    pub(super) fn dress(&mut self, context: &egui::Context) {
        if std::mem::replace(&mut self.shell.is_dressed, true) {
            return;
        }
        theme::install(context);
        context.set_theme(self.model.remembered.theme);
        // A frame can take long while the device prepares a large scene.
        context.options_mut(|options| options.input_options.max_click_duration = 5.0);
        self.tracing.main.wake(context);
    }

    fn take_input(&mut self, context: &egui::Context) {
        let dropped = input::dropped(context);
        if let Some(path) = dropped.first() {
            self.files.open(context, path.clone());
        }
        if dropped.len() > 1 {
            self.shell.toasts.good("Only the first of the files is opened");
        }
        if self.shell.dialogs.is_open() {
            return;
        }
        let is_presenting = self.model.presentation.is_some();
        if !input::take_keys(context, is_presenting, &mut self.commands) {
            return;
        }
        let is_escape =
            || context.input_mut(|input| input.consume_key(egui::Modifiers::NONE, egui::Key::Escape));
        if !self.shell.had_focus && is_escape() {
            self.escape();
        }
        let before = self.model.document.camera;
        if !self.model.view.is_hidden() && input::fly(context, &mut self.model.document.camera) {
            if let Some(reason) = self.document().no_rays() {
                self.model.document.camera = before;
                self.shell.toasts.good(reason);
            } else {
                self.changes.note_move();
            }
        }
    }

    /// Closes the window once everything is saved, or at once if it is closed again.
    fn follow_close(&mut self, context: &egui::Context) {
        let is_asked = context.input(|input| input.viewport().close_requested());
        let is_first = is_asked && !self.shell.leaves_when_saved && !self.shell.is_interrupted();
        if is_first && self.files.unsaved().is_some() {
            context.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            self.shell.leaves_when_saved = true;
        } else if self.shell.leaves_when_saved && !self.files.is_saving() {
            self.shell.leaves_when_saved = false;
            context.send_viewport_cmd(egui::ViewportCommand::Close);
        }
    }

    fn perform_all(&mut self, context: &egui::Context) {
        for command in std::mem::take(&mut self.commands) {
            self.perform(context, command);
        }
    }

    /// The last changes of the document in this frame.
    fn finish_document(&mut self, context: &egui::Context) {
        // The selection may be of another scene.
        let count = self.document().scene().spheres.len();
        self.model.selected = self.model.selected.filter(|sphere| *sphere < count);
        if let Err(error) = self.document().camera.validate() {
            self.shell.toasts.good(error.to_string());
            self.model.document.camera = self.changes.last.camera;
        }
        let room = self.display.viewport.room_pixels;
        // The dock opens when devices are compared, but their films stay.
        let needs_film = self.files.needs_film() || self.model.other_device().is_some();
        self.tracing.follow_size(context, &mut self.model, room, needs_film);
        self.follow_check();
        self.leave_useless_views();
    }

    /// Starts what the changes of this frame ask for.
    fn follow(&mut self, context: &egui::Context) {
        let changed = self.changes.look(&self.model);
        self.shell.toasts.follow(&self.model.document);
        if changed.picture {
            self.shell.toasts.end_refusals();
            self.tools.forget();
        }
        if changed.stop {
            self.model.own_stop = Some(self.model.document.stop).filter(|stop| stop.samples.is_none());
        }
        if changed.film {
            self.model.view.end_look();
        }
        let is_visit = self.display.check.as_ref().is_some_and(|[_, of]| *of == self.model.document);
        self.changes.follow(context, &self.model.document, changed, is_visit);
        if self.changes.is_moving() {
            context.request_repaint_after(Duration::from_millis(40));
        }
        let has_second = self.tracing.follow(context, &self.model, &self.changes);
        self.store.follow(context, &self.model, &self.changes, &mut self.tracing);
        let Window { model, tracing, display, tools, files, shell, .. } = self;
        display.follow(context, model, &mut shell.toasts);
        if let Some(found) = display.denoising.follow(context, &Subject { model, tracing }) {
            model.view.denoised = Some(found);
        }
        let subject = Subject { model, tracing };
        let lost = files.follow(context, &subject);
        files.follow_making(context, &mut shell.toasts, shell.leaves_when_saved);
        tools.follow(context, &subject);
        if !has_second {
            model.view.end_comparison();
        }
        display.kept.follow(context, model, tracing, changed);
        if let Some((document, named)) = lost {
            let samples = document.stop.samples.unwrap_or(document.origin.recipe.samples_per_pixel);
            let backend = self.model.backend();
            let begun = self.files.save_rendered(context, (document, samples), backend, named);
            begun.unwrap_or_else(|reason| self.shell.toasts.bad(format!("Not saved: {reason}")));
        }
    }
}

/// The document that the command line asks for.
fn document_of(options: &WindowOptions) -> Document {
    let WindowOptions { recipe, unchanged, stage, file, stop, .. } = options;
    let origin = match (stage, file, Recipe::builtin(&recipe.name)) {
        (_, None, _) if options.is_saved => Origin::guess(unchanged, *stage),
        (Some(stage), _, _) => Origin::of_stage(stage),
        (None, Some(path), _) => Origin::new(unchanged.clone(), Source::File(path.clone())),
        (None, None, Some(builtin)) => Origin::of_builtin(builtin),
        (None, None, None) => Origin::guess(unchanged, None),
    };
    let mut document = Document::new(origin);
    document.camera = recipe.camera;
    document.settings = recipe.settings;
    document.has_own_size |= options.is_size_given || options.is_saved || options.resume.is_some();
    document.stop = stop.unwrap_or(document.origin.usual_stop());
    document
}

impl Drop for Window {
    /// A panic does not lose the film.
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.end();
        }
    }
}

impl Window {
    fn end(&mut self) {
        self.stop_play();
        self.files.end();
        self.end_check();
        self.store.end(&self.model.document, &self.changes, &mut self.tracing);
    }
}

impl eframe::App for Window {
    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        let view = self.display.sight.as_ref().map_or(&self.model.view, |sight| &sight.view);
        Stored::write(self.model.remembered.clone(), view.clone(), storage);
    }

    fn on_exit(&mut self, _: Option<&eframe::glow::Context>) {
        self.end();
    }

    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.ui_in(ui);
    }

    fn logic(&mut self, context: &egui::Context, _: &mut eframe::Frame) {
        if self.shell.is_interrupted() {
            context.send_viewport_cmd(egui::ViewportCommand::Close);
        }
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }
}
