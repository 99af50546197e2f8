//! Carries out commands.

use super::command::Command;
use super::dialogs::{Dialog, Palette, PathBox, Purpose};
use super::facts::neighbour;
use super::model::Model;
use super::model::companion;
use super::model::device::Device;
use super::model::first_steps::Step;
use super::model::origin::Origin;
use super::model::remembered::Bookmark;
use super::model::show::Show;
use super::model::tone::Tone;
use super::model::view::{Mode, With};
use super::places;
use super::plot;
use super::theme;
use super::title_bar;
use super::window::Window;
use super::wording::lower_first;
use crate::job::output::OutputFormat;
use eframe::egui::{self, ViewportCommand};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Where the companion is written, from the working directory.
const COMPANION: &str = "companion/index.html";

/// Longer than the time between two pictures.
const PICTURES_APART: Duration = Duration::from_millis(300);

impl Window {
    /// Carries out a command. A disabled command shows why it is disabled.
    pub fn perform(&mut self, context: &egui::Context, command: Command) {
        self.performed = Some(command);
        if let Some(log) = &mut self.frame_log {
            log.command(&command.name());
        }
        self.changes.end_move();
        if command != Command::Blank {
            self.end_blank();
        }
        if let Some(reason) = self.disabled_reason(command) {
            self.toasts.good(format!("{}: {}", command.name().trim_end_matches('…'), lower_first(&reason)));
            return;
        }
        // What the user looks at by now stays.
        self.recovery.shown_slots = None;
        match command {
            Command::Fresh => self.start_fresh(),
            Command::Open => self.ask_path(Purpose::Open),
            Command::Recent(place) => self.open_recent(context, place),
            Command::Reload => self.scene_file.reload(context, &self.model.document.origin),
            // While a part of the picture is marked, it is what is saved.
            Command::Save(OutputFormat::Png) if self.model.view.crop.flatten().is_some() => {
                self.ask_path(Purpose::SaveCrop)
            }
            Command::Save(format) => self.ask_path(Purpose::Save(format)),
            Command::SaveScene => self.ask_path(Purpose::SaveScene),
            Command::LoadReference => self.ask_path(Purpose::ReferenceFilm),
            Command::SavePlot => self.ask_path(Purpose::SavePlot),
            Command::SaveFlight => self.ask_path(Purpose::SaveFlight),
            Command::CopyPicture | Command::CopyCrop => self.pending_copy = true,
            Command::CopyCommand => self.copy_command(context),
            Command::CopyPlot => {
                context.copy_text(plot::csv(&self.main.status().history));
                self.toasts.good("Copied the plot's points");
            }
            Command::Quit => context.send_viewport_cmd(ViewportCommand::Close),
            Command::Undo => {
                self.keep_selection_after(|window| window.changes.undo(&mut window.model.document));
            }
            Command::Redo => {
                self.keep_selection_after(|window| window.changes.redo(&mut window.model.document));
            }
            Command::Home => self.model.document.camera = self.document().origin.recipe.camera,
            Command::ResetAll => self.keep_selection_after(|window| window.model.document.reset()),
            Command::AddBookmark => {
                let bookmarks = &mut self.model.remembered.bookmarks;
                let document = &self.model.document;
                let is_free = |name: &String| bookmarks.iter().all(|bookmark| bookmark.name != *name);
                // Of a stage, the section is enough.
                let place =
                    document.stage().map_or_else(|| document.title(), |stage| stage.section.to_owned());
                let mut names = (1..).map(|number| format!("{place} view {number}"));
                let name = names.find(is_free).unwrap_or_default();
                bookmarks.push(Bookmark::new(name, &document.camera));
                self.toasts.good("Bookmarked; see the Camera panel");
            }
            Command::ViewFrom(_) | Command::Bookmark(_) | Command::FlyBookmarks => {
                self.perform_flight(context, command);
            }
            Command::Flights | Command::Gizmo => self.switch(command),
            Command::ReferenceSize => {
                self.take_size(self.model.view.reference.as_ref().map(|film| [film.width, film.height]))
            }
            Command::AddSphere
            | Command::DuplicateSphere
            | Command::DeleteSphere
            | Command::NextSphere
            | Command::PreviousSphere
            | Command::Deselect
            | Command::FocusSphere
            | Command::LookAtSphere
            | Command::ResetSpheres => self.perform_on_spheres(command),
            Command::NextRay => self.paths.step(true),
            Command::PreviousRay => self.paths.step(false),
            Command::ClearPaths => self.paths.forget(),
            Command::Show(show) => self.model.view.choose(show),
            Command::Wipe => {
                let with = if self.document().stage().is_none() { With::Book } else { With::Stage };
                self.model.view.toggle(Mode::Wipe, with);
            }
            Command::WipeDifference => {
                let view = &mut self.model.view;
                // A comparison with the book's arithmetic that is shown changes only its form.
                let with = if view.with() == With::Book { With::Book } else { With::Stage };
                view.toggle(Mode::Difference, with);
            }
            Command::BookArithmetic => self.model.view.toggle(Mode::Wipe, With::Book),
            Command::Slot(command) => self.perform_on_slots(context, command),
            Command::Crop => {
                let crop = &mut self.model.view.crop;
                *crop = if crop.is_none() { Some(None) } else { None };
            }
            Command::SaveCrop => self.ask_path(Purpose::SaveCrop),
            Command::Brighter => self.model.view.tone.expose(Tone::STEP),
            Command::Darker => self.model.view.tone.expose(-Tone::STEP),
            Command::NoExposure => self.model.view.tone.exposure = 0.0,
            Command::Fit => self.viewport.placement.fit(),
            Command::ActualSize => self.viewport.placement.actual_size(),
            Command::ZoomIn => self.viewport.placement.zoom_by(1.25),
            Command::ZoomOut => self.viewport.placement.zoom_by(0.8),
            Command::Panels if self.model.presentation.is_some() => self.toggle_captions(),
            Command::Panels => {
                let has_panels = &mut self.model.remembered.has_panels;
                *has_panels = !*has_panels;
                if !*has_panels {
                    self.toasts.good("Tab brings the panels back");
                }
            }
            Command::Controls | Command::Info | Command::Plot | Command::Packet | Command::Code => {
                self.toggle_panel(command)
            }
            Command::NextPanel => self.panel = places::next(context, self.panel, &self.model),
            Command::ListPaths => {
                if let Some(pixel) = self.inspector.hovered() {
                    self.paths.list(&self.model.document, pixel, context);
                }
            }
            Command::FullScreen => {
                self.model.is_full_screen = !self.model.is_full_screen;
                context.send_viewport_cmd(ViewportCommand::Fullscreen(self.model.is_full_screen));
            }
            Command::Theme(theme) => {
                self.model.remembered.theme = theme;
                theme::choose(context, theme);
            }
            Command::Pause => self.toggle_pause(context),
            Command::GoOn => {
                if let Some(further) = self.facts().further() {
                    self.model.document.stop = further.stop;
                }
            }
            Command::Restart => {
                self.seconds_before = Some(0.0);
                if std::mem::take(&mut self.model.is_paused) {
                    self.second.resume();
                }
                self.main.restart();
                self.recovery.autosave.holds(None);
            }
            Command::SwitchDevice => {
                let device = &mut self.model.remembered.device;
                *device = if *device == Device::Gpu { Device::Cpu } else { Device::Gpu };
            }
            Command::Device(device) => self.model.remembered.device = device,
            Command::Size(sizing) => {
                self.model.remembered.sizing = sizing;
                self.model.document.has_own_size = false;
                self.sizer.ask();
            }
            Command::PreviousStage => {
                self.note_step(Step::Leaf);
                if let Some(stage) = neighbour(self.document(), false) {
                    self.show_origin(Origin::of_stage(stage));
                }
            }
            Command::NextStage => {
                self.note_step(Step::Leaf);
                if let Some(stage) = neighbour(self.document(), true) {
                    self.show_origin(Origin::of_stage(stage));
                }
            }
            Command::Stage(stage) => self.show_origin(Origin::of_stage(stage)),
            Command::Extreme(case) => self.show_origin(Origin::of_case(case)),
            Command::Book => {
                let url = self.document().stage().map_or_else(|| crate::stages::BOOK_URL.into(), |s| s.url());
                self.open_page(context, url);
            }
            Command::Companion => {
                self.open_companion(context, &std::path::absolute(COMPANION).unwrap_or_default());
            }
            Command::Stages => {
                self.model.remembered.has_panels = true;
                title_bar::open_stage_list(context);
            }
            Command::ShowMe => self.toggle_sight(),
            Command::Present => self.toggle_presentation(context),
            Command::Blank => self.toggle_blank(),
            Command::Palette => self.dialogs.open(Dialog::Palette(Palette::typed(context))),
            Command::Help => self.dialogs.open(Dialog::Help),
            Command::FirstSteps => self.toggle_first_steps(),
        }
    }

    /// Returns to the picture if the current view is no longer available, and says why.
    pub(super) fn leave_useless_show(&mut self) {
        let show = self.show();
        // The picture itself is always available, and it is the usual view.
        if show == Show::Picture {
            return;
        }
        if let Some(reason) = self.facts().useless_show(show) {
            self.toasts.good(format!("No {} here: {}", show.name(), lower_first(&reason)));
            self.model.view.leave_show();
        }
    }

    /// Opens the companion at the stage's figure, if the page has been written.
    fn open_companion(&mut self, context: &egui::Context, page: &Path) {
        if page.is_file() {
            self.open_page(context, companion::url(page, self.document().stage()));
        } else {
            let message = "write it with: weekender companion --out companion";
            self.toasts.bad(format!("There is no {COMPANION} here; {message}"));
        }
    }

    fn open_page(&mut self, context: &egui::Context, url: String) {
        self.toasts.good(format!("Opening {url}"));
        context.open_url(egui::OpenUrl::new_tab(url));
    }

    fn toggle_panel(&mut self, command: Command) {
        let remembered = &mut self.model.remembered;
        let panel = match command {
            Command::Controls => &mut remembered.has_controls,
            Command::Info => &mut remembered.has_info,
            Command::Packet => &mut remembered.has_packet,
            Command::Code => &mut remembered.has_code,
            _ => &mut remembered.has_plot,
        };
        // While all panels are hidden, show the requested one.
        *panel = !*panel || !remembered.has_panels;
        remembered.has_panels = true;
    }

    /// Turns a setting on or off, and says so if that is not seen.
    fn switch(&mut self, command: Command) {
        let remembered = &mut self.model.remembered;
        let is_seen = match command {
            Command::Gizmo => {
                remembered.has_gizmo = !remembered.has_gizmo;
                self.model.has_panels()
            }
            _ => {
                remembered.has_flights = !remembered.has_flights;
                false
            }
        };
        if !is_seen {
            let is_on = self.facts().is_on(command);
            self.toasts.switched(&command.name(), is_on);
        }
    }

    /// Shows the card with the first steps, or closes it for good.
    fn toggle_first_steps(&mut self) {
        let Model { has_first_steps, remembered, .. } = &mut self.model;
        *has_first_steps = !*has_first_steps;
        if *has_first_steps {
            remembered.first_steps.forget();
        } else {
            remembered.first_steps.is_over = true;
        }
    }

    /// Ticks a step off while the card is shown.
    pub(super) fn note_step(&mut self, step: Step) {
        if self.model.has_first_steps {
            self.model.remembered.first_steps.note(step);
        }
    }

    /// Opens a file of the list, or drops it from there if it is gone.
    fn open_recent(&mut self, context: &egui::Context, place: usize) {
        let recent = &mut self.model.remembered.recent;
        let Some(path) = recent.get(place).cloned() else { return };
        if path.exists() {
            self.files.open(context, path);
        } else {
            recent.remove(place);
            self.toasts.bad(format!("{} is no longer there; the list drops it", path.display()));
        }
    }

    fn toggle_pause(&mut self, context: &egui::Context) {
        if self.model.is_paused {
            self.model.is_paused = false;
            self.main.resume();
            self.second.resume();
        } else if self.facts().is_working() {
            self.model.is_paused = true;
            self.main.pause();
            self.second.pause();
            // Also shows what was traced since the last picture.
            context.request_repaint_after(PICTURES_APART);
        }
    }

    pub(super) fn ask_path(&mut self, purpose: Purpose) {
        let subject = self.subject();
        let mut name = subject.document().name();
        match purpose {
            Purpose::SaveScene => name = subject.document().scene_name(),
            Purpose::SaveCrop => name.push_str("-crop"),
            Purpose::SaveFlight => name.push_str("-path"),
            _ => {}
        }
        let directory = self.model.remembered.directory.as_deref();
        let mut path_box = PathBox::new(purpose, &name, directory);
        match (purpose, self.model.view.crop.flatten()) {
            (Purpose::Save(_), _) => path_box.say(self.size_words()),
            (Purpose::SaveCrop, Some(crop)) => path_box.say(format!("The crop: {}", crop.words())),
            _ => {}
        }
        self.dialogs.open(Dialog::Path(path_box));
    }

    /// What is saved now, in words.
    fn size_words(&self) -> String {
        let slots = &self.model.view.slots;
        if let (Some(number), Some(kept)) = (slots.looked(), slots.shown()) {
            let [width, height] = kept.size();
            return format!("{}: {width}x{height}", slots.title(number));
        }
        let size = self.document().size_words(self.model.remembered.sizing);
        match self.sizer.offer() {
            Some([width, height]) => format!("The picture: {size} when it began (now {width}x{height})"),
            None => format!("The picture: {size}"),
        }
    }

    /// Uses a file for the purpose for which it was chosen.
    pub(super) fn use_path(&mut self, context: &egui::Context, purpose: Purpose, path: PathBuf) {
        match purpose {
            Purpose::Open => self.files.open(context, path),
            Purpose::Save(format) => self.pending_save = Some((format, path)),
            Purpose::SaveCrop => {
                self.pending_crop = self.model.view.crop.flatten().map(|crop| (crop, path));
            }
            Purpose::SaveScene => {
                self.files.save_scene(context, path, self.subject().document());
            }
            Purpose::SaveFlight => self.save_flight(context, path),
            Purpose::SavePlot => {
                self.files.save_text(context, &path, &plot::csv(&self.main.status().history));
            }
            Purpose::ReferenceFilm => self.files.load_reference(context, path),
        }
    }
}

#[cfg(test)]
#[path = "perform/saving/tests.rs"]
mod saving_tests;
#[cfg(test)]
mod tests;
