//! Carries out commands. Those that touch several parts of the window have their own methods.

use super::Window;
use super::layout::NARROW;
use crate::app::commands::{Command, MENUS, Snapshot};
use crate::app::dialogs::{Dialog, Purpose, What, stage_list};
use crate::app::model::animation::{FRAMES_PER_SECOND, Play};
use crate::app::model::spheres::grip::new_body;
use crate::app::model::spheres::{self, Selected};
use crate::app::model::{
    Body, Device, Dock, Document, Edit, Mode, Model, Origin, Presentation, Remembered, Show, Source, Tab,
    Tone, navigation,
};
use crate::app::toolkit::Finder;
use crate::app::toolkit::widgets::focus;
use crate::job::output::OutputFormat;
use crate::job::saved::SavedFilm;
use crate::stages::{BOOK_URL, Stage};
use eframe::egui::{Context, ViewportCommand};
use glam::DVec3;
use std::sync::Arc;

impl Window {
    /// Carries out a command. A disabled command shows why it is disabled.
    pub fn perform(&mut self, context: &Context, command: Command) {
        if let Command::Edit(edit) = command {
            return self.edit(edit);
        }
        self.shell.performed = Some(command);
        // Who goes on working stays.
        self.shell.leaves_when_saved &= matches!(command, Command::StopSaving | Command::Quit);
        let snapshot = self.snapshot();
        if self.stop_play() && command == Command::Play {
            return;
        }
        self.changes.end_move();
        if command != Command::Blank
            && let Some(presentation) = &mut self.model.presentation
        {
            presentation.is_blank = false;
        }
        match snapshot.disabled_reason(command) {
            Some(reason) => self.refuse(&snapshot.name(command), &reason),
            None => self.run(context, command, &snapshot),
        }
    }

    fn run(&mut self, context: &Context, command: Command, snapshot: &Snapshot) {
        use Command as C;
        let Window { model, tracing, display, tools, files, shell, .. } = self;
        let Model { document, view, remembered, .. } = model;
        match command {
            C::NewScene => self.show_origin(Origin::new_scene()),
            C::Open => self.ask_path(context, Purpose::Open),
            C::CheckPicture => self.ask_path(context, Purpose::Check),
            C::Save => self.ask_save(match self.document().origin.source {
                Source::New | Source::File(_) => What::Scene,
                _ => What::Picture(OutputFormat::Png),
            }),
            C::SaveAnimation => self.ask_save(What::Animation),
            C::Recent(place) => self.open_recent(context, place),
            C::Copy => files.copy.make(document, ()),
            C::Quit => context.send_viewport_cmd(ViewportCommand::Close),
            C::StopSaving => files.stop_saving(),
            C::DeleteFilms => self.store.delete(None),

            C::Undo => self.undo(),
            C::Redo => self.redo(),
            C::ResetAll => self.change(|window| window.model.document.reset()),
            C::AddSphere => self.add_sphere(),
            C::DuplicateSphere => self.duplicate_sphere(),
            C::DeleteSphere => {
                model.selected.into_iter().for_each(|sphere| self.edit(Edit::Delete(sphere)));
            }
            C::Edit(edit) => self.edit(edit),
            C::NextSphere => model.selected = spheres::neighbour(document.scene(), model.selected, true),
            C::PreviousSphere => model.selected = spheres::neighbour(document.scene(), model.selected, false),
            C::FocusSphere => self.focus_sphere(),
            C::Home => document.camera = document.origin.recipe.camera,
            C::AddBookmark => {
                document.add_bookmark();
                shell.toasts.good("Bookmarked; View > Bookmarks jumps back to it");
            }
            C::DeleteBookmark => {
                document.bookmark().into_iter().for_each(|place| _ = document.keyframes.remove(place));
            }
            C::Bookmark(at) => document.keyframes.get(at).iter().for_each(|to| document.camera = to.camera),
            C::Play => self.begin_play(context),

            C::Fit => {
                display.viewport.placement.fit();
                tools.check.place = None;
            }
            C::ActualSize => display.viewport.placement.actual_size(),
            C::ZoomIn => display.viewport.placement.zoom_by(1.25),
            C::ZoomOut => display.viewport.placement.zoom_by(0.8),
            C::Show(show) => view.choose(show),
            C::Brighter => view.tone.expose(Tone::STEP),
            C::Darker => view.tone.expose(-Tone::STEP),
            C::NoExposure => view.tone.exposure = 0.0,
            C::Denoise => view.is_denoised ^= true,
            C::Theme(theme) => {
                remembered.theme = theme;
                context.set_theme(theme);
            }
            C::Controls => self.toggle(|remembered| &mut remembered.hides_controls),
            C::Info => self.toggle(|remembered| &mut remembered.hides_info),
            C::Code => {
                let tab = if model.shows(Tab::Code) { Tab::Stage } else { Tab::Code };
                (model.hides_panels, model.remembered.hides_info) = (false, false);
                model.remembered.tab = tab;
            }
            C::Field(name) => {
                (model.hides_panels, remembered.hides_controls) = (false, false);
                if context.content_rect().width() < NARROW {
                    remembered.tab = Tab::Controls;
                }
                focus(context, name);
            }
            C::FocusControls => self.focus_next_panel(context),
            C::ErrorDock => self.toggle_dock(Dock::Error),
            C::Panels => self.toggle_panels(),
            C::Present => self.toggle_presentation(context),
            C::Blank => model.presentation.iter_mut().for_each(|shown| shown.is_blank ^= true),
            C::FullScreen => self.fill_screen(context, !self.model.is_full_screen),

            C::Pause => self.pause_or_go_on(context),
            C::Restart => {
                if std::mem::take(&mut model.is_paused) {
                    tracing.resume();
                }
                tracing.tracers_mut().for_each(|tracer| tracer.started = None);
                self.store.delete(Some(document.clone()));
            }
            C::RenderAtSize => {
                document.has_own_size = false;
                tracing.sizer.ask();
            }
            C::Device(device) => model.choose_device(device),
            C::SwitchDevice | C::Reference => {
                let other = if command == C::Reference { Device::Reference } else { Device::Gpu };
                let is_on = remembered.device == other;
                model.choose_device(if is_on { Device::Cpu } else { other });
            }

            C::Keep => display.kept.wanted.make(document, ()),
            C::AreSame => {
                if view.mode().is_none() {
                    view.toggle(Mode::Wipe);
                }
                display.kept.asked.make(document, view.partner);
            }
            C::GoOnFromKept => {
                let kept =
                    view.kept_partner().and_then(|kept| Some((kept.document.clone()?, kept.film.try_copy())));
                if let Some((document, Ok(film))) = kept {
                    self.show_document(Document { has_own_size: true, ..document });
                    self.adopt(SavedFilm { film, seconds: None });
                    self.model.view.end_comparison();
                }
            }
            C::DeleteKept => {
                view.kept_partner().into_iter().for_each(|kept| self.store.unpin(Arc::clone(kept)));
                view.delete_kept();
            }

            C::Stages => shell.dialogs.open(Dialog::Stages(stage_list::list(snapshot))),
            C::Stage(stage) => self.show_origin(Origin::of_stage(stage)),
            C::Extreme(case) => self.show_origin(Origin::of_case(case)),
            C::PreviousStage | C::NextStage => {
                let stage = model.neighbour(command == C::NextStage);
                stage.into_iter().for_each(|stage| self.show_origin(Origin::of_stage(stage)));
            }
            C::ShowMe => self.toggle_sight(),
            C::Wipe => view.toggle(Mode::Wipe),
            C::Flip => view.toggle(Mode::Flip),
            C::Difference => view.toggle(Mode::Difference),
            C::CompareWith(partner) => self.compare_with(partner),
            C::CompareDevices => self.compare_devices(),
            C::CompareFile => self.ask_path(context, Purpose::Compare),
            C::NextPlace => {
                let part = tools.check.next_place();
                part.into_iter().for_each(|part| display.viewport.placement.show_part(part));
            }
            C::RenderAtPartnerSize => {
                view.kept_partner().into_iter().for_each(|kept| document.give_size(kept.size()));
            }
            C::ListPaths => self.list_paths(context),
            C::NextRay | C::PreviousRay => tools.paths.step(command == C::NextRay),
            C::ClearPaths => {
                tools.paths.forget();
                remembered.dock.take_if(|dock| *dock == Dock::Path);
            }
            C::Book => {
                let url = document.stage().map_or_else(|| BOOK_URL.into(), Stage::url);
                self.open_url(context, url);
            }
            C::Companion => self.show_companion(context),

            C::Help => shell.dialogs.open(Dialog::Help),
            C::Palette => shell.dialogs.open(Dialog::Palette(Finder::typed(context))),
            C::About => shell.dialogs.open(Dialog::About),
        }
    }

    pub(super) fn refuse(&mut self, name: &str, reason: &str) {
        self.shell.toasts.good(format!("{}: {reason}", name.trim_end_matches('…')));
    }

    /// Leaves the innermost thing that can be left.
    pub(super) fn escape(&mut self) {
        if self.stop_play() {
            return;
        }
        let Window { model, tools, display, commands, shell, .. } = self;
        if shell.toasts.close_newest() {
        } else if model.presentation.is_some() {
            commands.push(Command::Present);
        } else if model.view.is_hidden() {
            model.view.end_look();
        } else if tools.paths.len() > 0 {
            commands.push(Command::ClearPaths);
        } else if display.sight.is_some() {
            commands.push(Command::ShowMe);
        } else if model.view.mode().is_some() || model.view.show() != Show::Picture {
            model.view.choose(Show::Picture);
        } else if model.selected.is_some() {
            model.selected = None;
        } else if model.remembered.dock.is_some() {
            model.remembered.dock = None;
        } else if model.is_full_screen {
            commands.push(Command::FullScreen);
        }
    }

    // Undo

    pub(super) fn undo(&mut self) {
        let [undone, _] = self.changes.labels(self.document());
        self.change(|window| window.changes.undo(&mut window.model.document));
        self.shell.toasts.withdraw(Command::Redo);
        self.shell.toasts.good_with(format!("Undone: {}", undone.unwrap_or_default()), &[Command::Redo]);
    }

    pub(super) fn redo(&mut self) {
        self.shell.toasts.withdraw(Command::Redo);
        self.change(|window| window.changes.redo(&mut window.model.document));
    }

    /// Changes the document. With other spheres, the selection would be another one.
    pub(super) fn change(&mut self, change: impl FnOnce(&mut Self)) {
        let before = self.document().clone();
        change(self);
        let is_other = !Arc::ptr_eq(&before.origin, &self.document().origin);
        if is_other {
            self.leave_picture();
        }
        if is_other || before.scene().spheres.len() != self.document().scene().spheres.len() {
            self.model.selected = None;
        }
    }

    // Camera and spheres

    fn begin_play(&mut self, context: &Context) {
        let (document, since) = (&self.model.document, context.input(|input| input.time));
        let path = document.path(document.frame_count());
        let (before, shown) = (document.camera, document.camera);
        self.model.playing = Some(Play { path, since, before, frame: 0, shown });
    }

    /// Shows the camera of the frame of now, until the last one or until the user moves the camera.
    pub(super) fn play(&mut self, context: &Context) {
        let Model { playing: Some(play), document, .. } = &mut self.model else { return };
        context.request_repaint();
        let seconds = context.input(|input| input.time) - play.since;
        play.frame = (seconds * FRAMES_PER_SECOND) as u32;
        if document.camera != play.shown {
            self.model.playing = None;
        } else if play.frame >= document.frame_count() {
            self.stop_play();
        } else {
            let camera = play.path.camera(play.frame);
            document.camera = if camera.validate().is_ok() { camera } else { document.camera };
            play.shown = document.camera;
            self.changes.note_move();
        }
    }

    /// Returns to the camera from before an animation. Returns whether one was played.
    pub(super) fn stop_play(&mut self) -> bool {
        let Some(play) = self.model.playing.take() else { return false };
        // No step of the history.
        (self.model.document.camera, self.changes.last.camera) = (play.before, play.before);
        true
    }

    pub(super) fn edit(&mut self, edit: Edit) {
        if let Err(reason) = spheres::edit(&mut self.model, edit) {
            self.shell.toasts.good(reason);
        }
    }

    pub(super) fn add_sphere(&mut self) {
        let (document, place) = (self.document(), self.display.viewport.aim());
        let body =
            new_body(document.pick(&document.camera, place), &document.camera, document.aspect(), place);
        self.edit(Edit::Add(body));
    }

    /// Adds a copy of the selected sphere, to the right of the camera.
    fn duplicate_sphere(&mut self) {
        let Some(Selected { body, .. }) = Selected::of(&self.model) else { return };
        let step = 2.2 * body.radius.abs() * self.document().camera.basis().u;
        let spheres = &self.document().scene().spheres;
        let is_taken = |center: &DVec3| spheres.iter().any(|other| other.center == *center);
        let center =
            (1..).map(|steps| body.center + f64::from(steps) * step).find(|center| !is_taken(center));
        self.edit(Edit::Add(Body { center: center.unwrap_or(body.center), ..body }));
    }

    pub(super) fn focus_sphere(&mut self) {
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

    // Panels

    /// Shows or hides a panel. If all are hidden, shows them with this one.
    pub(super) fn toggle(&mut self, panel: impl FnOnce(&mut Remembered) -> &mut bool) {
        let had_panels = !std::mem::take(&mut self.model.hides_panels);
        let is_hidden = panel(&mut self.model.remembered);
        *is_hidden = !*is_hidden && had_panels;
    }

    /// Gives the focus to a control of the next panel, or to a message.
    fn focus_next_panel(&mut self, context: &Context) {
        let Remembered { tab, hides_controls, hides_info, dock, .. } = self.model.remembered;
        let is_narrow = context.content_rect().width() < NARROW;
        let of_left = if self.document().no_rays().is_some() { "Render" } else { "Camera" };
        let of_right = if tab == Tab::Stage { "Compare with" } else { tab.name() };
        let panels = [
            (MENUS[0], true),
            (of_left, !hides_controls && (!is_narrow || tab == Tab::Controls)),
            (of_right, !hides_info && tab != Tab::Controls),
            (dock.map_or("", Dock::name), dock.is_some()),
            ("Close this message", self.shell.toasts.texts().next().is_some()),
        ];
        let mut shown = (0..panels.len()).map(|step| (self.shell.panel + step) % panels.len());
        if self.model.has_panels()
            && let Some(next) = shown.find(|next| panels[*next].1)
        {
            self.shell.panel = next + 1;
            focus(context, panels[next].0);
        }
    }

    pub(super) fn toggle_dock(&mut self, dock: Dock) {
        let had_panels = !std::mem::take(&mut self.model.hides_panels);
        let is_open = had_panels && self.model.remembered.dock == Some(dock);
        self.model.remembered.dock = (!is_open).then_some(dock);
    }

    pub(super) fn toggle_panels(&mut self) {
        if let Some(presentation) = &mut self.model.presentation {
            presentation.has_captions = !presentation.has_captions;
            return;
        }
        self.model.hides_panels ^= true;
        if self.model.hides_panels {
            self.shell.toasts.good("Tab brings the panels back");
        }
    }

    pub(super) fn fill_screen(&mut self, context: &Context, is_full: bool) {
        if self.model.is_full_screen != is_full {
            self.model.is_full_screen = is_full;
            context.send_viewport_cmd(ViewportCommand::Fullscreen(is_full));
        }
    }

    pub(super) fn toggle_presentation(&mut self, context: &Context) {
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

    pub(super) fn pause_or_go_on(&mut self, context: &Context) {
        let further = self.document().further(self.tracing.main.status());
        if let Some(stop) = further.filter(|_| !self.model.is_paused) {
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

    /// Goes on with a film of the document.
    pub(super) fn adopt(&mut self, film: SavedFilm) {
        (self.tracing.film, self.store.sought) = (Some(film), Some(self.document().clone()));
    }
}
