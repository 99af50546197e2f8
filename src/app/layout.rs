//! Where everything is drawn in a frame: panels, the viewport, what lies over it, and dialogs.

use super::model::Model;
use super::model::first_steps::Step;
use super::places::Place;
use super::viewport::{Handle, Pictures};
use super::window::Window;
use super::{info, menu, panels, plot, status_bar, theme, widgets};
use eframe::egui;

/// Windows narrower than this many points have no room for two panels beside the picture.
const NARROW: f32 = 900.0;

impl Window {
    /// Draws everything. Each panel gets the state that it may change, the facts, and the list of commands to add to.
    pub(super) fn layout(&mut self, ui: &mut egui::Ui) {
        let facts = self.facts();
        let Window {
            model,
            main,
            second,
            layers,
            tone,
            values,
            surfaces,
            identity,
            viewport,
            inspector,
            paths,
            packet,
            code,
            commands,
            spheres,
            is_new,
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
            let other = view.subtracted(second.film()).zip(inspector.pixel());
            let other = other.and_then(|(film, pixel)| film.mean(pixel.at));
            inspector.ui(ui, facts.document(), value, other);
            paths.ui(ui, facts.document());
        };
        if has.has_panels {
            Place::Menu.begin(ui);
            menu::ui(ui, is_narrow, &facts, commands);
            status_bar::ui(ui, &facts);
            if has.has_plot {
                Place::Plot.begin(ui);
                plot::ui(ui, &mut document.stop.noise, &facts, commands);
            }
            if has.has_code {
                Place::Code.begin(ui);
                code.ui(ui, &facts, commands);
            }
            if has.has_packet {
                Place::Packet.begin(ui);
                packet.ui(ui, commands);
            }
            if has.has_controls {
                let panel = egui::Panel::left("controls").default_size(244.0).size_range(190.0..=380.0);
                Place::Controls.begin(ui);
                scrolling(ui, panel, |ui| {
                    let has_info_below = is_narrow && has.has_info;
                    let help = "The window has no room for it at the right; it follows the controls";
                    let is_asked =
                        has_info_below && ui.button("Stage and pixel: below").on_hover_text(help).clicked();
                    panels::ui(
                        ui,
                        (document, selected),
                        remembered,
                        (&facts, *is_new),
                        (&mut edits, commands),
                    );
                    if is_asked {
                        ui.scroll_to_cursor(Some(egui::Align::Min));
                    }
                    if has_info_below {
                        Place::Info.begin(ui);
                        info(ui, commands);
                    }
                });
            }
            if has.has_info && !is_narrow {
                let panel = egui::Panel::right("info").default_size(256.0).size_range(190.0..=420.0);
                Place::Info.begin(ui);
                scrolling(ui, panel, |ui| info(ui, commands));
            }
        }
        let before = document.camera;
        let same = identity.is_same().then(|| "identical to the bit".to_owned());
        let divider = view.divider;
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
                notices: surfaces.inside(document).into_iter().chain(same).collect(),
            };
            let (camera, divider) = (&mut document.camera, &mut view.divider);
            let handle = Handle { camera, divider, selected, surfaces };
            viewport.ui(ui, handle, pictures, &facts, commands)
        });
        let touch = touch.inner;
        if view.divider != divider {
            view.is_divider_unplaced = false;
        }
        self.inspector.hover(touch.hovered);
        if let Some(pixel) = touch.listed {
            self.paths.list(&self.model.document, pixel, ui.ctx());
        }
        if touch.is_move {
            self.stop_at_surfaces(&before, touch.pivot);
        }
        if touch.is_orbit && facts.no_rays().is_none() {
            self.note_step(Step::Orbit);
        }
        if touch.is_move || touch.edit.is_some() {
            self.changes.note_move();
        }
        if let Some(sphere) = touch.select {
            self.model.selected = sphere;
        }
        edits.into_iter().chain(touch.edit).for_each(|edit| self.edit(edit));
        if let Some(room) = touch.room {
            self.first_steps.ui(ui, room, &facts, &mut self.commands);
            self.toasts.ui(ui, room);
        }
        if let Some(text) = widgets::take_told(ui.ctx()) {
            self.toasts.good(text);
        }
        self.check.ui(ui.ctx());
        if let Some((purpose, path)) = self.dialogs.ui(ui, &facts, &mut self.commands) {
            let context = ui.ctx().clone();
            self.use_path(&context, purpose, path);
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
