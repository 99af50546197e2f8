//! A frame: it takes answers, carries out commands, has the window drawn, and starts renders.

use super::frame_log::FrameTimes;
use super::input::{self, Keyboard};
use super::kept::Subject;
use super::model::Model;
use super::model::show::Show;
use super::sizer::Present;
use super::theme;
use super::tracer::{Shown, Want};
use super::window::Window;
use super::wording::in_window_words;
use crate::scene::Camera;
use eframe::egui;
use glam::DVec3;
use std::time::{Duration, Instant};

/// Seconds between press and release of a click. A frame can take long while the device prepares a large scene.
const LONGEST_CLICK: f64 = 5.0;

/// With this many samples per pixel, pictures differ by more than their noise.
const CLEAR_SAMPLES: u64 = 16;

impl Window {
    /// Draws a frame.
    pub fn ui_in(&mut self, ui: &mut egui::Ui) {
        let context = ui.ctx().clone();
        self.dress(&context);
        self.fit_on_screen(&context);
        self.poll(&context);
        self.receive(&context);
        self.follow_scene_file(&context);
        self.receive_recovered();
        self.receive_slot_files();
        self.go_on_flying(&context);
        self.take_input(&context);
        self.perform_all(&context);
        self.layout(ui);
        self.perform_all(&context);
        self.follow(&context);
        self.write_recovery(&context);
        theme::paint_focus(&context);
        self.had_focus = context.memory(|memory| memory.focused().is_some())
            || egui::Popup::is_any_open(&context)
            || self.dialogs.is_open();
    }

    /// Chooses the colours, once.
    pub(super) fn dress(&mut self, context: &egui::Context) {
        if self.is_dressed {
            return;
        }
        self.is_dressed = true;
        theme::install(context);
        theme::choose(context, self.model.remembered.theme);
        context.options_mut(|options| options.input_options.max_click_duration = LONGEST_CLICK);
        self.main.wake(context);
        self.recovery.begin(context);
        self.read_slots(context);
        if let Some((path, job)) = self.pending_resume.take() {
            self.files.resume(context, path, job, &self.model.document);
        }
    }

    /// Shrinks a new window that is larger than its screen, frame included, so that the status bar stays visible.
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

    fn poll(&mut self, context: &egui::Context) {
        self.second.receive();
        let begin = Instant::now();
        let pictured = self.main.poll(context);
        self.frame_times.picture = begin.elapsed();
        self.speed.follow(self.main.status());
        if self.crashes_at.is_some_and(|samples| self.main.status().samples_per_pixel >= samples) {
            panic!("injected fault");
        }
        if let Some(log) = &mut self.frame_log {
            if let Some(begun) = pictured {
                log.pictured(begun);
            }
            let status = self.main.status();
            if let Some(backend) = status.backend.as_ref().filter(|_| status.samples_per_pixel > 0) {
                log.tracing(status.run, backend.name);
            }
        }
    }

    fn take_input(&mut self, context: &egui::Context) {
        for path in input::dropped(context) {
            self.files.open(context, path);
        }
        let Model { view, selected, remembered, is_full_screen, has_first_steps, .. } = &self.model;
        let (has_recovered, presentation) = (self.model.has_recovered, &self.model.presentation);
        let keyboard = Keyboard {
            had_focus: self.had_focus,
            has_code: remembered.has_code && self.model.has_panels(),
            is_other_view: view.mode().is_some() || view.show() != Show::Picture,
            is_cropping: view.crop.is_some(),
            has_paths: self.paths.len() > 0,
            is_at_slot: view.slots.looked().is_some(),
            has_selection: selected.is_some(),
            is_full_screen: *is_full_screen,
            has_first_steps: *has_first_steps && !has_recovered,
            has_sight: self.sight.is_some(),
            is_presenting: presentation.is_some(),
        };
        // Escape closes a finding first, or else the card with what other windows left.
        let has_finding = self.slot_actions.verdict.is_open() || self.check.is_open();
        let has_card = has_recovered && presentation.is_none() && !keyboard.has_code;
        if (has_finding || has_card)
            && !self.had_focus
            && context.input_mut(|input| input.consume_key(egui::Modifiers::NONE, egui::Key::Escape))
        {
            if self.slot_actions.verdict.is_open() {
                self.slot_actions.verdict.close();
            } else if has_finding {
                self.check.close();
            } else {
                self.close_recovered();
            }
        }
        let is_at_slot = keyboard.is_at_slot;
        let is_free = !self.dialogs.is_open() && input::take_keys(context, &keyboard, &mut self.commands);
        let before = self.model.document.camera;
        if is_free && !is_at_slot && input::fly(context, &mut self.model.document.camera) {
            if let Some(reason) = self.document().no_rays() {
                self.model.document.camera = before;
                self.toasts.good(reason);
            } else {
                self.stop_at_surfaces(&before, None);
                self.changes.note_move();
            }
        }
    }

    /// Puts the divider of a new wipe where the two pictures differ most, once both are good enough to tell.
    fn place_divider(&mut self) {
        let view = &mut self.model.view;
        if !view.is_divider_unplaced {
            return;
        }
        let is_clear = |shown: &&Shown| shown.divisor == 1 && shown.samples >= CLEAR_SAMPLES;
        let mine = match view.slots.shown() {
            Some(kept) => self.slot_actions.picture.shown(kept),
            None => self.main.shown().filter(|shown| is_clear(shown) || self.main.status().phase.is_over()),
        };
        let theirs = self.second.shown().filter(|shown| is_clear(shown) || self.second.is_over());
        if let (Some(mine), Some(theirs)) = (mine, theirs) {
            view.divider = mine.texture.most_different_column(&theirs.texture).unwrap_or(view.divider);
            view.is_divider_unplaced = false;
        }
    }

    /// Ends a move of the camera from `before` in front of the first surface. `pivot` is the point that the move keeps where
    /// it is in the picture, if there is one.
    pub(super) fn stop_at_surfaces(&mut self, before: &Camera, pivot: Option<DVec3>) {
        let document = &self.model.document;
        let stopped = self.surfaces.stop(document, before, &document.camera, pivot);
        self.model.document.camera = without_dust(stopped, before);
    }

    fn perform_all(&mut self, context: &egui::Context) {
        for command in std::mem::take(&mut self.commands) {
            self.perform(context, command);
        }
    }

    /// Makes the picture as large as the viewport, unless that would throw away too much.
    fn follow_size(&mut self, context: &egui::Context) {
        // A film that is about to go on has its size.
        if self.pending_film.is_some() || self.recovery.resuming.is_some() {
            return;
        }
        let (main, view) = (&self.main, &self.model.view);
        let present = Present {
            is_documents: main.is_of(&self.model.document),
            seconds: self.seconds_before.unwrap_or(f64::INFINITY) + main.status().trace.as_secs_f64(),
            // A reference film has the size that it has.
            is_needed: self.pending_save.is_some()
                || self.pending_crop.is_some()
                || self.pending_copy
                || view.show() == Show::Difference,
        };
        // Pictures of another size could not be compared with those in the slots.
        let room = view.slots.room().unwrap_or(self.viewport.room_pixels());
        let wish = (self.model.remembered.sizing, room);
        self.sizer.follow(context, &mut self.model.document, wish, &present);
    }

    /// Notes what has changed and starts the render that this requires.
    fn follow(&mut self, context: &egui::Context) {
        if let Err(reason) = self.spheres.follow(context, &mut self.model) {
            self.toasts.bad(reason);
        }
        self.follow_size(context);
        if self.changes.follow(context, &self.model.document, false) {
            self.seconds_before = Some(0.0);
            // A change is seen in the live picture.
            self.model.view.look(None);
            self.recovery.shown_slots = None;
            if let Some(log) = &mut self.frame_log {
                log.changed();
            }
        }
        let is_moving = self.changes.is_moving();
        if is_moving {
            context.request_repaint_after(Duration::from_millis(40));
        }
        self.leave_useless_show();
        self.leave_useless_comparison();
        self.follow_sight();
        let Model { document, view, is_paused, .. } = &self.model;
        let want = Want {
            document,
            backend: &self.model.backend(),
            stop: document.stop,
            view: view.of_film(self.second.film()),
            is_moving,
            is_paused: *is_paused,
        };
        let outcome = match self.pending_film.take() {
            Some(film) => self.main.go_on_with(film, &want),
            None => self.main.want(&want),
        };
        self.invalid = outcome.err().map(|reason| in_window_words(&reason));
        let has_second = self.second.follow(context, view, &want);
        let live = (document, &self.main);
        let subject = Subject::new(view, live, self.seconds_before, &self.slot_actions.thread);
        // The picture that a key would flip to is made before it is asked for.
        let next = || view.slots.other().and_then(|number| view.slots.get(number)).map(|slot| &slot.kept);
        if let Some(kept) = view.slots.shown().or_else(next) {
            self.slot_actions.picture.follow(context, kept, &view.of_film(self.second.film()));
        }
        let is_live_moving = is_moving && !subject.is_kept();
        let layer = view.show().layer();
        if let Some(reason) = self.layers.follow(context, layer, subject.document(), is_live_moving) {
            self.toasts.bad(format!("This view cannot be traced: {reason}"));
        }
        if subject.has_samples() {
            if let Some(named) = self.pending_save.take() {
                self.files.save(context, &subject, named);
            }
            if let Some((crop, path)) = self.pending_crop.take() {
                self.files.save_crop(context, &subject, crop, path);
            }
            if std::mem::take(&mut self.pending_copy) {
                self.files.copy(context, &subject, view.crop.flatten());
            }
        }
        if let Some(words) = self.spheres.told(document, &self.main) {
            self.toasts.good(words);
        }
        self.inspector.follow(&subject, context);
        self.tone.follow(&subject, view.tone.white(), context);
        let is_picture = view.mode().is_none() && view.show() == Show::Picture;
        let area = self.viewport.room().filter(|_| is_picture);
        self.values.follow(&subject, self.viewport.placement.rect(), area, context);
        self.surfaces.follow(document, self.main.has_samples(document), context);
        self.identity.follow(view.subtracted(self.second.film()), &subject, context);
        self.paths.follow(document, context);
        let has_packet = self.model.has_panels() && self.model.remembered.has_packet;
        let lanes = has_packet.then(|| self.model.remembered.lanes_in_use());
        self.packet.follow(context, document, lanes, is_moving);
        self.thumbnails.follow(context, self.model.document.stage(), self.main.status().phase.is_over());
        self.place_divider();
        if !has_second {
            self.model.view.end_comparison();
        }
        self.keep_wanted(context);
    }
}

/// The camera after a move from `before`. Where rounding has left next to nothing of a coordinate that it looks at, that is
/// 0: it is shown, saved and copied with all its digits.
fn without_dust(camera: Camera, before: &Camera) -> Camera {
    /// How much larger than the rounding of the coordinates it may be, after several steps.
    const STEPS: f64 = 8.0;
    /// A smaller share of the distance turns the camera by nothing.
    const SHARE: f64 = 1e-12;
    let Camera { look_from, look_at, .. } = camera;
    let largest = look_from.abs().max_element().max(look_at.abs().max_element());
    let limit = (STEPS * f64::EPSILON * largest).min(SHARE * look_from.distance(look_at));
    let without = |axis: usize| {
        let is_dust = look_at[axis].abs() < limit && look_at[axis] != before.look_at[axis];
        if is_dust { 0.0 } else { look_at[axis] }
    };
    Camera { look_at: DVec3::from_array([0, 1, 2].map(without)), ..camera }
}

/// The inner size for a window that is too large for its screen, to replace `inner`.
fn fitting(inner: egui::Vec2, outer: egui::Vec2, screen: egui::Vec2) -> Option<egui::Vec2> {
    let excess = (outer - screen).max(egui::Vec2::ZERO);
    (excess != egui::Vec2::ZERO && screen.min_elem() > 0.0).then(|| inner - excess)
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

    fn raw_input_hook(&mut self, context: &egui::Context, raw: &mut egui::RawInput) {
        input::part_at_tab(&mut self.late_events, &mut raw.events);
        if !self.late_events.is_empty() {
            context.request_repaint();
        }
    }

    /// Also called while the window is hidden.
    fn logic(&mut self, context: &egui::Context, _: &mut eframe::Frame) {
        self.write_recovery(context);
    }

    fn on_exit(&mut self, _: Option<&eframe::glow::Context>) {
        self.end_in_order();
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }
}

#[cfg(test)]
mod tests;
