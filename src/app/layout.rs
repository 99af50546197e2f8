//! Where everything is drawn in a frame: panels, the viewport, what lies over it, and dialogs.

use super::facts::Facts;
use super::model::Model;
use super::model::first_steps::Step;
use super::model::view::{Mode, ViewState};
use super::places::Place;
use super::present::{self, Lens, Seen};
use super::viewport::{Handle, Pictures};
use super::window::Window;
use super::{info, menu, panels, plot, status_bar, theme, widgets};
use eframe::egui::{self, Rect};

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
            slot_actions,
            is_new,
            presenter,
            thumbnails,
            ..
        } = self;
        let selected = spheres.selected(model);
        let selected = selected.as_ref();
        let mut edits = Vec::new();
        let Model { document, view, remembered, .. } = model;
        let is_narrow = ui.available_width() < NARROW;
        let layer = view.show().layer();
        let has = &facts.model.remembered;
        let mut info = |ui: &mut egui::Ui, view: &mut ViewState, commands: &mut Vec<_>| {
            info::ui(ui, &mut view.is_with_next, &facts, commands);
            tone.ui(ui, view, &facts);
            let value =
                inspector.pixel().and_then(|pixel| layers.value_at(pixel.at)).filter(|_| layer.is_some());
            let other = view.subtracted(second.film()).zip(inspector.pixel());
            let other = other.and_then(|(film, pixel)| film.mean(pixel.at));
            inspector.ui(ui, facts.shown(), value, other);
            paths.ui(ui, facts.document());
        };
        if facts.model.presentation.is_some() {
            presenter.ui(ui, &facts);
        }
        if facts.model.has_panels() {
            Place::Menu.begin(ui);
            menu::ui(ui, is_narrow, thumbnails, &facts, commands);
            status_bar::ui(ui, &facts);
            if view.slots.is_used() {
                Place::Slots.begin(ui);
                slot_actions.strip.ui(ui, &mut view.slots, &facts, commands);
            }
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
                        info(ui, view, commands);
                    }
                });
            }
            if has.has_info && !is_narrow {
                let panel = egui::Panel::right("info").default_size(256.0).size_range(190.0..=420.0);
                Place::Info.begin(ui);
                scrolling(ui, panel, |ui| info(ui, view, commands));
            }
        }
        let before = document.camera;
        let same = identity.is_same().then(|| "identical to the bit".to_owned());
        // Where the panel with the caption is not shown.
        let has_caption = facts.model.presentation.is_some() || (facts.model.has_panels() && has.has_info);
        let sight = document.stage().filter(|_| facts.has_sight && !has_caption);
        let caption = sight.map(|stage| stage.sight.caption.to_owned());
        let divider = view.divider;
        let touch = egui::CentralPanel::default().frame(egui::Frame::new()).show(ui, |ui| {
            if facts.model.presentation.is_some() {
                let context = ui.ctx().clone();
                present::enlarge(&context, ui.style_mut());
            }
            let kept = view.slots.shown();
            let shown = match kept {
                Some(kept) => slot_actions.picture.shown_mut(kept),
                None => main.shown_mut(),
            };
            let has_film = shown.is_some();
            let inside = surfaces.inside(document).filter(|_| kept.is_none());
            let compared = view.compared_slot().map(|number| view.slots.title(number));
            let pictures = Pictures {
                main: match layer.and_then(|layer| layers.shown_mut(layer)) {
                    Some(layer) => Some((&mut layer.texture, layer.divisor)),
                    None => shown.map(|shown| (&mut shown.texture, shown.divisor)),
                },
                has_film,
                second: second.shown_mut().map(|shown| {
                    let title = compared.unwrap_or_else(|| shown.document.title());
                    (&mut shown.texture, shown.divisor, title)
                }),
                paths: kept.is_none().then_some(&*paths),
                values,
                notices: slot_notice(&facts).into_iter().chain(caption).chain(inside).chain(same).collect(),
            };
            let (camera, divider) = (&mut document.camera, &mut view.divider);
            let handle = Handle { camera, divider, selected, surfaces, crop: &mut view.crop };
            viewport.ui(ui, handle, pictures, &facts, commands)
        });
        let touch = touch.inner;
        if view.divider != divider {
            view.is_divider_unplaced = false;
        }
        if facts.model.presentation.is_some() {
            self.lens(ui, touch.hovered, touch.room);
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
            if facts.model.presentation.is_none() {
                if facts.model.has_recovered {
                    self.offer_recovered(ui, room);
                } else {
                    self.first_steps.ui(ui, room, &facts, &mut self.commands);
                }
                self.sizer.ui(ui, room, &mut self.commands);
            }
            self.toasts.ui(ui, room);
        }
        if let Some(text) = widgets::take_told(ui.ctx()) {
            self.toasts.good(text);
        }
        self.check.ui(ui.ctx());
        self.slot_actions.verdict.ui(ui.ctx());
        if let Some((purpose, path)) = self.dialogs.ui(ui, &facts, &mut self.commands) {
            let context = ui.ctx().clone();
            self.use_path(&context, purpose, path);
        }
        if facts.model.presentation.is_some_and(|presentation| presentation.is_blank) {
            present::blank(ui.ctx());
        }
    }

    /// Shows the pixel under the pointer large: that of the picture which is on top there.
    fn lens(&mut self, ui: &egui::Ui, hovered: Option<[u32; 2]>, room: Option<Rect>) {
        let (Some(at), Some(room)) = (hovered, room) else { return };
        let Some(pointer) = ui.ctx().input(|input| input.pointer.hover_pos()) else { return };
        let (view, document) = (&self.model.view, self.document());
        let picture = self.viewport.placement.rect();
        let share = (pointer.x - picture.left()) / picture.width();
        let is_other =
            view.mode() == Some(Mode::Wipe) && (share < view.divider) == view.is_other_earlier(document);
        let mean = self.inspector.pixel().filter(|pixel| pixel.at == at && !is_other).map(|pixel| pixel.mean);
        let layer = view.show().layer();
        let (texture, divisor) = match layer.and_then(|layer| self.layers.shown_mut(layer)) {
            Some(layer) => (&layer.texture, layer.divisor),
            None => {
                let mine = match view.slots.shown() {
                    Some(kept) => self.slot_actions.picture.shown_mut(kept).map(|shown| &*shown),
                    None => self.main.shown(),
                };
                let other = self.second.shown().filter(|_| is_other);
                let Some(shown) = other.or(mine) else { return };
                (&shown.texture, shown.divisor)
            }
        };
        let seen = Seen::around(at.map(|along| along / divisor), mean, |at| texture.colour(at));
        let seen = Seen { at, ..seen };
        Lens { room, picture, pointer, seen: &seen }.paint(ui);
    }
}

/// Which slot is shown or subtracted. The titles of a wipe say it themselves.
fn slot_notice(facts: &Facts) -> Option<String> {
    let view = &facts.model.view;
    match (view.mode(), view.compared_slot()) {
        (Some(Mode::Difference), Some(number)) => {
            Some(format!("A: {}    B: {}", facts.title(), view.slots.title(number)))
        }
        (None, _) => view.slots.looked().map(|_| format!("{} (Escape returns)", facts.title())),
        _ => None,
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
