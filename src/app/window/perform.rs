//! What commands do that need more than one part of the window.

use super::Window;
use crate::app::commands::table::Command;
use crate::app::dialogs::{
    Dialog, LargeSize, Outcome, Purpose, SaveBox, What, default_folder, file_name, samples_wanted,
};
use crate::app::files::autosave::picture_of;
use crate::app::model::navigation;
use crate::app::model::spheres::grip::new_body;
use crate::app::model::spheres::{self, Selected};
use crate::app::model::{
    Body, Bookmark, Device, Dock, Document, Edit, Mode, Origin, Presentation, Remembered, Show, Source,
    ViewState, With, companion, device,
};
use crate::app::viewport::sight::Sighted;
use crate::film::Film;
use crate::job::output::OutputFormat;
use crate::measure::grouped;
use eframe::egui::{self, Context, ViewportCommand};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::Arc;

impl Window {
    /// Carries out a command. A disabled command shows why it is disabled.
    pub fn perform(&mut self, context: &Context, command: Command) {
        self.shell.performed = Some(command);
        let facts = self.facts();
        if let Some(log) = &mut self.shell.frame_log {
            log.command(&facts.name(command));
        }
        self.changes.end_move();
        if command != Command::Blank
            && let Some(presentation) = &mut self.model.presentation
        {
            presentation.is_blank = false;
        }
        match facts.disabled_reason(command) {
            Some(reason) => {
                self.refuse(&facts.name(command), &reason);
            }
            None => command.run(self, context),
        }
    }

    fn refuse(&mut self, name: &str, reason: &str) {
        let mut letters = reason.chars();
        let reason: String = letters.next().into_iter().flat_map(char::to_lowercase).chain(letters).collect();
        self.shell.toasts.good(format!("{}: {reason}", name.trim_end_matches('…')));
    }

    /// Leaves the innermost thing that can be left.
    pub(in crate::app) fn escape(&mut self) {
        let Window { model, tools, display, commands, .. } = self;
        if model.presentation.is_some() {
            commands.push(Command::Present);
        } else if model.view.looked().is_some() {
            model.view.end_look();
        } else if tools.paths.len() > 0 {
            commands.push(Command::ClearPaths);
        } else if display.sight.is_some() {
            commands.push(Command::ShowMe);
        } else if model.view.mode().is_some() || model.view.show() != Show::Picture {
            model.view.choose(Show::Picture);
        } else if model.selected.is_some() {
            model.selected = None;
        } else if model.has_first_steps {
            commands.push(Command::FirstSteps);
        } else if model.remembered.dock.is_some() {
            model.remembered.dock = None;
        } else if model.is_full_screen {
            commands.push(Command::FullScreen);
        }
    }

    // The picture that is shown

    /// Shows another picture. The user's own way to stop stays, unless the picture has its own.
    pub(in crate::app) fn show_origin(&mut self, origin: Origin) {
        let mut document = Document::new(origin);
        if let Some(stop) = self.model.own_stop.filter(|_| document.stop.samples.is_none()) {
            document.stop = stop;
        }
        let before = self.document();
        if before.is_changed() && !before.is_from_file {
            let words = format!("Your changes to {} are kept in Undo", before.place());
            self.shell.toasts.good_with(words, &[Command::Undo]);
        }
        self.show_document(document);
    }

    pub(in crate::app) fn show_document(&mut self, document: Document) {
        self.end_sight();
        self.model.document = document;
        self.model.selected = None;
        self.tools.forget();
    }

    pub(in crate::app) fn step_stage(&mut self, is_next: bool) {
        if let Some(stage) = self.facts().neighbour(is_next) {
            self.show_origin(Origin::of_stage(stage));
        }
    }

    pub(in crate::app) fn start_fresh(&mut self) {
        let kept = std::mem::take(&mut self.model.view.kept);
        self.model.view = ViewState::default();
        self.model.view.kept = kept;
        self.display.viewport.placement.fit();
        self.model.is_paused = false;
        self.show_document(Document::new(Origin::usual()));
    }

    // Undo

    pub(in crate::app) fn undo(&mut self) {
        let words = format!("Undone: {}", self.facts().undo.unwrap_or_default());
        self.change(|window| window.changes.undo(&mut window.model.document));
        self.shell.toasts.withdraw(Command::Redo);
        self.shell.toasts.good_with(words, &[Command::Redo]);
    }

    pub(in crate::app) fn redo(&mut self) {
        self.shell.toasts.withdraw(Command::Redo);
        self.change(|window| window.changes.redo(&mut window.model.document));
    }

    /// Changes the document. With other spheres, the selection would be another one.
    pub(in crate::app) fn change(&mut self, change: impl FnOnce(&mut Self)) {
        let scene = |window: &Self| {
            let document = window.document();
            (Arc::as_ptr(&document.origin), document.scene().spheres.len())
        };
        let before = scene(self);
        change(self);
        if scene(self) != before {
            self.model.selected = None;
        }
    }

    // Camera and spheres

    pub(in crate::app) fn add_bookmark(&mut self) {
        let (document, bookmarks) = (&self.model.document, &mut self.model.remembered.bookmarks);
        let is_free = |name: &String| bookmarks.iter().all(|bookmark| bookmark.name != *name);
        let place = document.place();
        let name = (1..).map(|number| format!("{place} view {number}")).find(is_free).unwrap_or_default();
        bookmarks.push(Bookmark { name, camera: document.camera });
        self.shell.toasts.good("Bookmarked; View > Bookmarks jumps back to it");
    }

    pub(in crate::app) fn edit(&mut self, edit: Edit) {
        if let Err(reason) = spheres::edit(&mut self.model, edit) {
            self.shell.toasts.bad(reason);
        }
    }

    pub(in crate::app) fn add_sphere(&mut self) {
        let (document, place) = (self.document(), self.display.viewport.aim());
        let body =
            new_body(document.pick(&document.camera, place), &document.camera, document.aspect(), place);
        self.edit(Edit::Add(body));
    }

    /// Puts a copy to the right of the selected sphere.
    pub(in crate::app) fn duplicate_sphere(&mut self) {
        if let Some(Selected { body, .. }) = Selected::of(&self.model) {
            let center = body.center + 2.2 * body.radius * self.document().camera.basis().u;
            self.edit(Edit::Add(Body { center, ..body }));
        }
    }

    pub(in crate::app) fn focus_sphere(&mut self) {
        let Some(selected) = Selected::of(&self.model) else { return };
        let camera = self.document().camera;
        let towards = (camera.look_from - selected.body.center).normalize_or_zero();
        let nearest = selected.body.center + selected.body.radius * towards;
        let is_ahead = camera.depth_of(nearest) > 0.0;
        let point = if is_ahead { nearest } else { selected.body.center };
        self.model.document.camera = navigation::focus(&camera, point);
        if camera.defocus_angle_degrees == 0.0 {
            self.shell.toasts.good("A pinhole is sharp everywhere; set a defocus angle");
        }
    }

    // View

    /// Compares with the other stage; a picture that is no stage, with the book's arithmetic.
    pub(in crate::app) fn compare(&mut self, mode: Mode) {
        let is_by_book = self.document().stage().is_none() || self.model.view.with() == With::Book;
        self.model.view.toggle(mode, if is_by_book { With::Book } else { With::Stage });
    }

    /// Leaves views and comparisons that the picture of now cannot have.
    pub(in crate::app) fn leave_useless_views(&mut self) {
        let show = self.model.view.show();
        if let Some(reason) = self.facts().useless_show(show).filter(|_| show != Show::Picture) {
            self.refuse(show.name(), &reason);
            self.model.view.leave_show();
        }
        let is_kept_difference =
            self.model.view.mode() == Some(Mode::Difference) && self.model.view.compared_kept().is_some();
        if let Some(reason) = self.facts().not_subtractable().filter(|_| is_kept_difference) {
            self.shell.toasts.good(reason);
            self.model.view.end_comparison();
        }
        let Some(sight) = &self.display.sight else { return };
        if sight.is_of_another(&self.model.document) {
            self.end_sight();
        } else if !sight.lasts(&self.model.document, &self.model.view) {
            self.display.sight = None;
        }
    }

    pub(in crate::app) fn toggle_sight(&mut self) {
        if self.display.sight.is_some() {
            self.end_sight();
            return;
        }
        let Some(stage) = self.document().stage() else { return };
        let (document, view) = (&mut self.model.document, &mut self.model.view);
        self.display.sight =
            Some(Sighted::begin(stage, document, view, &mut self.display.viewport.placement));
    }

    pub(in crate::app) fn end_sight(&mut self) {
        if let Some(sight) = self.display.sight.take() {
            let (document, view) = (&mut self.model.document, &mut self.model.view);
            sight.end(document, view, &mut self.display.viewport.placement);
        }
    }

    pub(in crate::app) fn list_paths(&mut self, context: &Context) {
        if let Some(pixel) = self.tools.inspector.hovered {
            self.tools.paths.list(&self.model.document, pixel, context);
            self.model.remembered.dock = Some(Dock::Path);
        }
    }

    // Panels

    /// Shows or hides a panel. If all are hidden, shows them with this one.
    pub(in crate::app) fn toggle(&mut self, panel: impl FnOnce(&mut Remembered) -> &mut bool) {
        let remembered = &mut self.model.remembered;
        let had_panels = std::mem::replace(&mut remembered.has_panels, true);
        let panel = panel(remembered);
        *panel = !*panel || !had_panels;
    }

    pub(in crate::app) fn toggle_dock(&mut self, dock: Dock) {
        let remembered = &mut self.model.remembered;
        let is_open = remembered.has_panels && remembered.dock == Some(dock);
        remembered.has_panels = true;
        remembered.dock = if is_open { None } else { Some(dock) };
    }

    pub(in crate::app) fn toggle_panels(&mut self) {
        if let Some(presentation) = &mut self.model.presentation {
            presentation.has_captions = !presentation.has_captions;
            return;
        }
        let has_panels = &mut self.model.remembered.has_panels;
        *has_panels = !*has_panels;
        if !*has_panels {
            self.shell.toasts.good("Tab brings the panels back");
        }
    }

    pub(in crate::app) fn fill_screen(&mut self, context: &Context, is_full: bool) {
        if self.model.is_full_screen != is_full {
            self.model.is_full_screen = is_full;
            context.send_viewport_cmd(ViewportCommand::Fullscreen(is_full));
        }
    }

    pub(in crate::app) fn toggle_presentation(&mut self, context: &Context) {
        match self.model.presentation.take() {
            Some(presentation) => {
                self.display.viewport.placement = self.display.viewport.parked.clone();
                self.fill_screen(context, presentation.was_full_screen);
            }
            None => {
                self.display.viewport.parked = self.display.viewport.placement.clone();
                let was_full_screen = self.model.is_full_screen;
                self.model.presentation =
                    Some(Presentation { was_full_screen, has_captions: true, is_blank: false });
                self.model.view.end_look();
                self.fill_screen(context, true);
            }
        }
    }

    // Tracing

    pub(in crate::app) fn pause_or_go_on(&mut self, context: &Context) {
        if let Some(stop) = self.facts().further() {
            self.model.document.stop = stop;
            return;
        }
        self.model.is_paused = !self.model.is_paused;
        if self.model.is_paused {
            self.tracing.pause(context);
        } else {
            self.tracing.resume();
        }
    }

    // Kept pictures

    /// Tests whether the shown picture and the chosen kept one differ by noise alone.
    pub(in crate::app) fn ask_only_noise(&mut self, context: &Context) {
        let Window { model, tracing, display, .. } = self;
        if let Some(kept) = model.view.kept.meant() {
            display.kept.verdict.ask(context, kept, (&model.document, &tracing.main));
            model.remembered.dock = Some(Dock::Kept);
        }
    }

    /// Goes on with the chosen kept picture.
    pub(in crate::app) fn go_on_from_kept(&mut self) {
        let Some(kept) = self.model.view.kept.meant().cloned() else { return };
        match kept.film.try_copy() {
            Ok(film) => {
                self.show_document(Document { has_own_size: true, ..kept.document.clone() });
                self.model.view.end_comparison();
                self.adopt(film, kept.seconds);
            }
            Err(error) => self.shell.toasts.bad(error.to_string()),
        }
    }

    /// Goes on with this film of the document.
    pub(in crate::app) fn adopt(&mut self, film: Film, seconds: Option<f64>) {
        (self.tracing.film, self.tracing.seconds_before) = (Some(film), seconds);
        self.changes.last = self.model.document.clone();
    }

    // Files

    pub(in crate::app) fn ask_path(&mut self, context: &Context, purpose: Purpose) {
        let from = self.folder();
        self.shell.dialogs.system.ask(context, purpose, from);
    }

    /// Opens the dialog of saving with this format chosen.
    pub(in crate::app) fn ask_save(&mut self, format: OutputFormat) {
        let (name, what) = (file_name(self.document()), What::Picture(format));
        let save = SaveBox::new(&name, self.folder(), what, self.document().size());
        self.shell.dialogs.open(Dialog::Save(save));
    }

    /// The folder in which the user is at work.
    fn folder(&self) -> PathBuf {
        let last = self.model.remembered.recent.first().and_then(|path| path.parent());
        let last = last.filter(|folder| folder.is_dir()).map(Path::to_owned);
        last.or_else(default_folder).or_else(|| std::env::current_dir().ok()).unwrap_or_default()
    }

    pub(in crate::app) fn end_dialog(&mut self, context: &Context, outcome: Outcome) {
        match outcome {
            Outcome::Named(Purpose::Check, path) => self.tools.check.begin(context, &path, None),
            Outcome::Named(_, path) => self.files.open(context, path),
            Outcome::Save(what, size, path) => {
                // If this fails, writing the file tells why.
                let _ = path.parent().map(std::fs::create_dir_all);
                self.save_as(context, what, size, path);
            }
            Outcome::Size(size) => {
                self.tracing.sizer.accepted = Some(size);
                self.model.document.give_size(size);
            }
            Outcome::Stay | Outcome::Close => {}
        }
    }

    fn save_as(&mut self, context: &Context, what: What, size: [u32; 2], path: PathBuf) {
        let document = &self.model.document;
        match what {
            What::Scene => self.files.save_scene(context, path, document),
            What::Picture(format) if size == document.size() => {
                self.files.pending_save = Some((format, path));
            }
            What::Picture(format) => {
                let samples = samples_wanted(document, self.tracing.main.status());
                let mut document = document.clone();
                document.give_size(size);
                let backend = self.model.backend();
                let named = (format, path);
                let begun = self.files.save_rendered(context, (document, samples), backend, named);
                if let Err(reason) = begun {
                    self.shell.toasts.bad(format!("Not saved: {reason}"));
                }
            }
        }
    }

    /// Asks before a size is rendered that needs much memory or time. Until then the picture has the size of before.
    pub(in crate::app) fn ask_about_size(&mut self) {
        let (size, before) = (self.document().size(), &self.changes.last);
        if size == before.size() || self.tracing.film.is_some() || self.tracing.sizer.accepted == Some(size) {
            return;
        }
        let before = if Arc::ptr_eq(&before.origin, &self.document().origin) {
            (before.size(), before.has_own_size)
        } else {
            let room = self.display.viewport.room_pixels;
            (self.document().origin.size_in(room).unwrap_or(before.size()), true)
        };
        if let Some(large) = LargeSize::of(&self.facts(), size, before.0) {
            self.model.document.set_size(before.0);
            self.model.document.has_own_size = before.1;
            self.shell.dialogs.open(Dialog::Large(large));
        }
    }

    /// Offers the film of a window that ended early.
    pub(in crate::app) fn offer_left(&mut self) {
        let Some((document, samples)) = self.autosave.left().and_then(|path| picture_of(&path)) else {
            return;
        };
        let (name, samples) = (document.place(), grouped(samples));
        let words =
            format!("The last window ended early. {name} with {samples} samples per pixel was saved.");
        self.shell.toasts.offer(words, &[Command::Recover]);
    }

    pub(in crate::app) fn open_recent(&mut self, context: &Context, place: usize) {
        let recent = &mut self.model.remembered.recent;
        let Some(path) = recent.get(place).cloned() else { return };
        if path.exists() {
            self.files.open(context, path);
        } else {
            recent.remove(place);
            self.shell.toasts.bad(format!("{} is no longer there; the list drops it", path.display()));
        }
    }

    pub(in crate::app) fn show_in_folder(&mut self, context: &Context) {
        let Some(folder) = self.model.remembered.recent.first().and_then(|path| path.parent()) else {
            return;
        };
        let manager = match std::env::consts::OS {
            "windows" => "explorer",
            "macos" => "open",
            _ => "xdg-open",
        };
        let has_desktop = self.shell.dialogs.system.is_there;
        if !has_desktop || process::Command::new(manager).arg(folder).spawn().is_err() {
            self.open_url(context, companion::file_url(folder));
        }
    }

    /// Opens a page in the browser, or tells its address. Returns whether there is a browser.
    pub(in crate::app) fn open_url(&mut self, context: &Context, url: String) -> bool {
        let has_browser = !self.shell.dialogs.system.is_there || webbrowser::Browser::is_available();
        if has_browser {
            context.open_url(egui::OpenUrl::new_tab(url));
        } else {
            self.shell.toasts.bad(format!("No browser could be started; the page is {url}"));
        }
        has_browser
    }

    pub(in crate::app) fn write_companion(&mut self, context: &Context, is_quick: bool) {
        match self.files.write_companion(context, is_quick) {
            Ok(()) => {
                let time = if is_quick { "about 3 s" } else { "some minutes" };
                let words = format!("Writing the companion, {time}…");
                self.shell.toasts.offer(words, &[Command::StopCompanion]);
            }
            Err(reason) => self.shell.toasts.bad(reason),
        }
    }

    /// Opens the companion that was written at the stage that is shown.
    pub(in crate::app) fn show_companion(&mut self, context: &Context, written: Result<bool, String>) {
        let is_stopped = self.files.end_companion();
        self.shell.toasts.withdraw(Command::StopCompanion);
        let Some(folder) = self.files.companion_folder() else { return };
        match written {
            Ok(_) if is_stopped => {}
            Ok(true) => self.shell.toasts.good("The full companion is written; reload it in your browser"),
            Ok(false) => {
                let url = companion::url(&folder.join("index.html"), self.document().stage());
                if self.open_url(context, url) {
                    let words = "The companion is open in your browser";
                    self.shell.toasts.good_with(words, &[Command::WholeCompanion]);
                }
            }
            Err(reason) => self.shell.toasts.bad(format!("The companion was not written: {reason}")),
        }
    }

    /// Copies the command that renders the picture, and says what it needs.
    pub(in crate::app) fn copy_command(&mut self, context: &Context) {
        let (document, main) = (&self.model.document, &self.tracing.main);
        let samples = match main.status().samples_per_pixel {
            samples @ 1.. if main.is_full(document) => samples,
            _ => document.stop.samples.unwrap_or(document.origin.recipe.samples_per_pixel),
        };
        let device = self.model.remembered.device;
        let is_gpu = matches!(device, Device::Gpu | Device::Both);
        let adapter = device::adapter().ok().filter(|adapter| is_gpu && adapter.is_software);
        let adapter = adapter.map(|adapter| adapter.name.as_str());
        context.copy_text(document.command_line(samples.max(1), device.name(), adapter));
        let needs_file = document.has_changed_scene()
            || matches!(document.origin.source, Source::Embedded | Source::Extreme(_));
        let is_saved = document.checked.file().is_some();
        self.shell.toasts.good(if needs_file && !is_saved {
            "Copied; the scene has no file yet: save it, since the command reads it"
        } else {
            "Copied: the command line that renders this picture"
        });
    }
}
