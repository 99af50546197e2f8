//! A frame: it takes answers, carries out commands, draws the window, and starts renders.

use super::frame_log::FrameTimes;
use super::input::{self, Keyboard};
use super::model::Model;
use super::model::show::Show;
use super::tracer::Want;
use super::viewport::{Handle, Pictures};
use super::window::Window;
use super::{info, menu, panels, plot, status_bar, theme};
use eframe::egui;
use std::time::{Duration, Instant};

/// Windows narrower than this many points have no room for two panels beside the picture.
const NARROW: f32 = 900.0;

impl Window {
    /// Draws a frame.
    pub fn ui_in(&mut self, ui: &mut egui::Ui) {
        let context = ui.ctx().clone();
        self.dress(&context);
        self.fit_on_screen(&context);
        self.poll(&context);
        self.receive(&context);
        self.take_input(&context);
        self.perform_all(&context);
        self.layout(ui);
        self.perform_all(&context);
        self.follow(&context);
        self.had_focus = context.memory(|memory| memory.focused().is_some())
            || egui::Popup::is_any_open(&context)
            || self.dialogs.is_open();
    }

    fn dress(&mut self, context: &egui::Context) {
        if self.is_dressed {
            return;
        }
        self.is_dressed = true;
        theme::install(context);
        theme::choose(context, self.model.remembered.theme);
        self.main.wake(context);
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
        let keyboard = Keyboard {
            had_focus: self.had_focus,
            has_selection: self.model.selected.is_some(),
            is_full_screen: self.model.is_full_screen,
        };
        let is_free = !self.dialogs.is_open() && input::take_keys(context, &keyboard, &mut self.commands);
        if is_free && input::fly(context, &mut self.model.document.camera) {
            self.changes.note_move();
        }
    }

    fn perform_all(&mut self, context: &egui::Context) {
        for command in std::mem::take(&mut self.commands) {
            self.perform(context, command);
        }
    }

    /// Draws everything. Each panel gets the state that it may change, the facts, and the list of commands to add to.
    fn layout(&mut self, ui: &mut egui::Ui) {
        let facts = self.facts();
        let Window {
            model,
            main,
            second,
            layers,
            tone,
            values,
            viewport,
            inspector,
            paths,
            packet,
            code,
            commands,
            spheres,
            ..
        } = self;
        let selected = spheres.selected(model);
        let selected = selected.as_ref();
        let mut edits = Vec::new();
        let Model { document, view, remembered, .. } = model;
        let is_narrow = ui.available_width() < NARROW;
        let layer = view.show().layer();
        let has = &facts.model.remembered;
        let mut info = |ui: &mut egui::Ui, commands: &mut Vec<_>| {
            info::ui(ui, &mut view.is_with_next, &facts, commands);
            tone.ui(ui, view, &facts);
            let value =
                inspector.pixel().and_then(|pixel| layers.value_at(pixel.at)).filter(|_| layer.is_some());
            inspector.ui(ui, facts.document(), value);
            paths.ui(ui, facts.document());
        };
        if has.has_panels {
            menu::ui(ui, is_narrow, &facts, commands);
            status_bar::ui(ui, &facts);
            if has.has_plot {
                plot::ui(ui, &mut document.stop.noise, &facts, commands);
            }
            if has.has_code {
                code.ui(ui, &facts, commands);
            }
            if has.has_packet {
                packet.ui(ui, commands);
            }
            if has.has_controls {
                let panel = egui::Panel::left("controls").default_size(244.0).size_range(190.0..=380.0);
                scrolling(ui, panel, |ui| {
                    panels::ui(ui, (document, selected), remembered, &facts, (&mut edits, commands));
                    if is_narrow && has.has_info {
                        info(ui, commands);
                    }
                });
            }
            if has.has_info && !is_narrow {
                let panel = egui::Panel::right("info").default_size(256.0).size_range(190.0..=420.0);
                scrolling(ui, panel, |ui| info(ui, commands));
            }
        }
        let touch = egui::CentralPanel::default().frame(egui::Frame::new()).show(ui, |ui| {
            let has_film = main.shown().is_some();
            let pictures = Pictures {
                main: match layer.and_then(|layer| layers.shown_mut(layer)) {
                    Some(layer) => Some((&mut layer.texture, layer.divisor)),
                    None => main.shown_mut().map(|shown| (&mut shown.texture, shown.divisor)),
                },
                has_film,
                second: second.shown_mut().map(|shown| {
                    let title = shown.document.title();
                    (&mut shown.texture, shown.divisor, title)
                }),
                paths,
                values,
            };
            let (camera, divider) = (&mut document.camera, &mut view.divider);
            let handle = Handle { camera, divider, selected };
            viewport.ui(ui, handle, pictures, &facts, commands)
        });
        let touch = touch.inner;
        self.inspector.hover(touch.hovered);
        if let Some(pixel) = touch.listed {
            self.paths.list(&self.model.document, pixel, ui.ctx());
        }
        if touch.is_move || touch.edit.is_some() {
            self.changes.note_move();
        }
        if let Some(sphere) = touch.select {
            self.model.selected = sphere;
        }
        edits.into_iter().chain(touch.edit).for_each(|edit| self.edit(edit));
        if let Some(room) = touch.room {
            self.toasts.ui(ui, room);
        }
        self.check.ui(ui.ctx());
        if let Some((purpose, path)) = self.dialogs.ui(ui, &facts, &mut self.commands) {
            let context = ui.ctx().clone();
            self.use_path(&context, purpose, path);
        }
    }

    /// Notes what has changed and starts the render that this requires.
    fn follow(&mut self, context: &egui::Context) {
        if let Err(reason) = self.spheres.follow(context, &mut self.model) {
            self.toasts.bad(reason);
        }
        if self.changes.follow(context, &self.model.document) {
            self.seconds_before = Some(0.0);
            if let Some(log) = &mut self.frame_log {
                log.changed();
            }
        }
        let is_moving = self.changes.is_moving();
        if is_moving {
            context.request_repaint_after(Duration::from_millis(40));
        }
        self.leave_useless_show();
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
        self.invalid = outcome.err();
        let has_second = self.second.follow(context, view, &want);
        self.layers.follow(context, view.show().layer(), document, is_moving);
        if self.main.has_samples(document)
            && let Some(named) = self.pending_save.take()
        {
            self.files.save(context, (document, &self.main), self.seconds_before, named);
        }
        if let Some(words) = self.spheres.told(document, &self.main) {
            self.toasts.good(words);
        }
        self.inspector.follow(document, &self.main, context);
        self.tone.follow(document, view.tone.white(), &self.main, context);
        let is_picture = view.mode().is_none() && view.show() == Show::Picture;
        let area = self.viewport.room().filter(|_| is_picture);
        self.values.follow(document, self.viewport.placement.rect(), area, &self.main, context);
        self.paths.follow(document, context);
        let has_packet = self.model.remembered.has_panels && self.model.remembered.has_packet;
        let lanes = has_packet.then(|| self.model.remembered.lanes_in_use());
        self.packet.follow(context, document, lanes, is_moving);
        if !has_second {
            self.model.view.end_comparison();
        }
    }
}

/// A panel that can scroll.
fn scrolling(ui: &mut egui::Ui, panel: egui::Panel, content: impl FnOnce(&mut egui::Ui)) {
    panel.frame(theme::panel(egui::Margin::ZERO)).show(ui, |ui| {
        egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            egui::Frame::new().inner_margin(egui::Margin::symmetric(12, 8)).show(ui, content);
        });
    });
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

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        self.remember(storage);
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
