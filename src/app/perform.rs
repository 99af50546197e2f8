//! What each command does.

use super::command::Command;
use super::compare::Mode;
use super::device::Device;
use super::dialogs::{Dialog, Palette, PathBox, Purpose};
use super::document::{Document, Origin, Source};
use super::remembered::Bookmark;
use super::theme;
use super::viewport::{Show, Zoom};
use super::window::Window;
use crate::stages::Shading;
use eframe::egui::{self, ViewportCommand};
use std::time::Duration;

/// More than the time between two pictures.
const PICTURES_APART: Duration = Duration::from_millis(300);

impl Window {
    /// Why a command can do nothing now, in words; `None` if it can.
    pub fn useless(&self, command: Command) -> Option<String> {
        let no = |reason: &str| Some(reason.to_owned());
        match command {
            Command::Undo if !self.undo.has_undo(&self.document) => no("Nothing has been changed yet"),
            Command::Redo if !self.undo.has_redo(&self.document) => no("Nothing was taken back"),
            Command::Home if self.document.camera == self.document.origin.recipe.camera => {
                no("This is the stage's camera")
            }
            Command::Device(device) => device.unavailable(),
            Command::SwitchDevice => Device::Gpu.unavailable(),
            Command::Show(show) => self.useless_show(show),
            Command::CopyPlot | Command::SavePlot if self.main.status().history.is_empty() => {
                no("No error has been estimated yet")
            }
            Command::Wipe | Command::WipeDifference
                if self.document.stage().is_none() && !self.document.origin.is_other_by_the_book() =>
            {
                no("Nothing is there to compare this picture with; choose a stage of the book")
            }
            Command::BookArithmetic if !self.document.origin.is_other_by_the_book() => {
                no("This picture has the book's arithmetic already, or sends no rays; choose another")
            }
            Command::PreviousStage if self.neighbour(false).is_none() => no("This is the first stage"),
            Command::NextStage if self.neighbour(true).is_none() => no("This is the last stage"),
            _ => None,
        }
    }

    fn useless_show(&self, show: Show) -> Option<String> {
        let no = |reason: &str| Some(reason.to_owned());
        let (settings, shading) = (self.document.settings, self.document.rules().shading);
        match show {
            Show::Error if !settings.estimate_error => no("The film has one half; switch on Estimate error"),
            Show::Difference => match &self.compare.reference {
                None => no("Load a reference film first (File > Load reference film)"),
                Some(film) if (film.width, film.height) != (settings.width, settings.height) => {
                    let [width, height] = [film.width, film.height];
                    Some(format!("The reference film is {width}x{height}; set the picture's size to that"))
                }
                Some(_) => None,
            },
            Show::Normals | Show::Albedo | Show::Bounces | Show::Occupancy
                if shading == Shading::ImageGradient =>
            {
                no("This stage sends no rays: its picture is computed from the pixel's place alone")
            }
            Show::Bounces if shading != Shading::Path => {
                no("In this stage a ray sees no further than its first hit: each path is one ray")
            }
            Show::Occupancy if self.remembered.device == Device::Gpu => {
                no("The graphics adapter traces without packets; switch to the CPU")
            }
            Show::Occupancy if self.remembered.device == Device::Reference => {
                no("The reference traces one ray at a time, without packets; switch to the CPU")
            }
            _ => None,
        }
    }

    /// Goes back to the picture if what is shown cannot be shown any more, and says why.
    pub(super) fn leave_useless_show(&mut self) {
        let show = self.viewport.show;
        if let Some(reason) = self.useless_show(show) {
            self.toasts.good(format!("No {} here: {}", show.name(), lower_first(&reason)));
            self.choose_show(Show::Picture);
        }
    }

    fn choose_show(&mut self, show: Show) {
        self.viewport.show = show;
        self.compare.show(&self.main, show);
    }

    /// One thing at a time is shown in the picture's place.
    fn toggle_compare(&mut self, mode: Mode, is_by_book: bool) {
        self.choose_show(Show::Picture);
        self.compare.toggle(mode, is_by_book);
    }

    pub(super) fn neighbour(&self, is_next: bool) -> Option<&'static crate::stages::Stage> {
        match self.document.stage() {
            Some(stage) if is_next => stage.next(),
            Some(stage) => stage.previous(),
            None => crate::stages::Stage::ALL.first().filter(|_| is_next),
        }
    }

    /// Carries a command out; one that can do nothing says why.
    pub fn perform(&mut self, context: &egui::Context, command: Command) {
        self.performed = Some(command);
        if let Some(log) = &mut self.frame_log {
            log.command(&command.name());
        }
        self.end_move();
        if let Some(reason) = self.useless(command) {
            self.toasts.good(format!("{}: {}", command.name().trim_end_matches('…'), lower_first(&reason)));
            return;
        }
        match command {
            Command::Open => self.ask_path(Purpose::Open),
            Command::Save(format) => self.ask_path(Purpose::Save(format)),
            Command::SaveScene => self.ask_path(Purpose::SaveScene),
            Command::LoadReference => self.ask_path(Purpose::Reference),
            Command::SavePlot => self.ask_path(Purpose::SavePlot),
            Command::CopyCommand => self.copy_command(context),
            Command::CopyPlot => {
                context.copy_text(super::plot::csv(&self.main.status().history));
                self.toasts.good("Copied the plot's points");
            }
            Command::Quit => context.send_viewport_cmd(ViewportCommand::Close),
            Command::Undo => {
                if let Some(document) = self.undo.undo(&self.document) {
                    self.document = document.clone();
                    self.is_undoing = true;
                }
            }
            Command::Redo => {
                if let Some(document) = self.undo.redo(&self.document) {
                    self.document = document.clone();
                    self.is_undoing = true;
                }
            }
            Command::Home => self.document.camera = self.document.origin.recipe.camera,
            Command::ResetAll => {
                let origin = std::sync::Arc::clone(&self.document.origin);
                let stop = origin.usual_stop();
                let recipe = &origin.recipe;
                self.document = Document { camera: recipe.camera, settings: recipe.settings, stop, origin };
            }
            Command::AddBookmark => {
                let number = self.remembered.bookmarks.len() + 1;
                let name = format!("{} {number}", self.document.origin.recipe.name);
                self.remembered.bookmarks.push(Bookmark::new(name, &self.document.camera));
                self.toasts.good("Bookmarked; it is in the Camera panel");
            }
            Command::Show(show) => {
                self.compare.mode = None;
                self.choose_show(show);
            }
            Command::Wipe => self.toggle_compare(Mode::Wipe, self.document.stage().is_none()),
            Command::WipeDifference => self.toggle_compare(Mode::Difference, self.compare.is_by_book),
            Command::BookArithmetic => self.toggle_compare(Mode::Wipe, true),
            Command::Fit => self.viewport.zoom = Zoom::Fit,
            Command::ActualSize => self.viewport.actual_size(),
            Command::ZoomIn => self.viewport.zoom_by(1.25),
            Command::ZoomOut => self.viewport.zoom_by(0.8),
            Command::Panels => {
                self.remembered.has_panels = !self.remembered.has_panels;
                if !self.remembered.has_panels {
                    self.toasts.good("Tab brings the panels back");
                }
            }
            Command::Controls => toggle(&mut self.remembered.has_controls, &mut self.remembered.has_panels),
            Command::Info => toggle(&mut self.remembered.has_info, &mut self.remembered.has_panels),
            Command::Plot => toggle(&mut self.remembered.has_plot, &mut self.remembered.has_panels),
            Command::FullScreen => {
                self.is_full_screen = !self.is_full_screen;
                context.send_viewport_cmd(ViewportCommand::Fullscreen(self.is_full_screen));
            }
            Command::Theme(theme) => {
                self.remembered.theme = theme;
                theme::choose(context, theme);
            }
            Command::Pause => {
                if self.is_paused {
                    self.is_paused = false;
                    self.main.resume();
                    self.compare.resume();
                } else if self.is_working() {
                    self.is_paused = true;
                    self.main.pause();
                    self.compare.pause();
                    // What was traced since the last picture is shown, too.
                    context.request_repaint_after(PICTURES_APART);
                }
            }
            Command::Restart => {
                self.seconds_before = Some(0.0);
                self.is_paused = false;
                self.main.restart();
            }
            Command::SwitchDevice => {
                let next = if self.remembered.device == Device::Gpu { Device::Cpu } else { Device::Gpu };
                self.remembered.device = next;
            }
            Command::Device(device) => self.remembered.device = device,
            Command::PreviousStage => {
                if let Some(stage) = self.neighbour(false) {
                    self.show_origin(Origin::of_stage(stage));
                }
            }
            Command::NextStage => {
                if let Some(stage) = self.neighbour(true) {
                    self.show_origin(Origin::of_stage(stage));
                }
            }
            Command::Stage(stage) => self.show_origin(Origin::of_stage(stage)),
            Command::Extreme(case) => self.show_origin(Origin::of_case(case)),
            Command::Book => {
                let url = self.document.stage().map_or_else(|| crate::stages::BOOK_URL.into(), |s| s.url());
                self.toasts.good(format!("Opening {url}"));
                context.open_url(egui::OpenUrl::new_tab(url));
            }
            Command::Palette => self.dialog = Some(Dialog::Palette(Palette::typed(context))),
            Command::Help => self.dialog = Some(Dialog::Help),
        }
    }

    fn ask_path(&mut self, purpose: Purpose) {
        let name = &self.document.origin.recipe.name;
        self.dialog = Some(Dialog::Path(PathBox::new(purpose, name, self.remembered.directory.as_deref())));
    }

    fn copy_command(&mut self, context: &egui::Context) {
        // As many as a picture that is saved now has.
        let samples = match self.main.status().samples_per_pixel {
            samples @ 1.. if self.main.is_full(&self.document) => samples,
            _ => self.document.stop.samples.unwrap_or(self.document.origin.recipe.samples_per_pixel),
        };
        let device = self.remembered.device;
        // Software adapters are used only when they are named.
        let is_gpu = matches!(device, Device::Gpu | Device::Both);
        let adapter = super::device::adapter().ok().filter(|adapter| is_gpu && adapter.is_software);
        let adapter = adapter.map(|adapter| adapter.name.as_str());
        let line = self.document.command_line(samples.max(1), device.name(), adapter);
        context.copy_text(line);
        self.toasts.good(match &self.document.origin.source {
            Source::Embedded | Source::Extreme(_) => {
                "Copied; the scene is in no file yet: save the scene file beside it"
            }
            _ => "Copied: the command line that renders this picture",
        });
    }
}

/// Shows or hides a panel; while all are hidden, the one that is asked for comes back.
fn toggle(panel: &mut bool, all: &mut bool) {
    *panel = !*panel || !*all;
    *all = true;
}

fn lower_first(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}
