//! Where everything is drawn in a frame: panels, the viewport, what lies over it, and dialogs.

use super::facts::Facts;
use super::inspector::OtherPixel;
use super::model::Model;
use super::model::document::Document;
use super::model::first_steps::Step;
use super::model::fitted::Fitted;
use super::model::view::{Mode, ViewState};
use super::places::Place;
use super::present::{self, Lens, Seen};
use super::second::Second;
use super::viewport::{Handle, Pictures, SecondPicture};
use super::window::Window;
use super::{controls, info, plot, status_bar, theme, tips, title_bar};
use eframe::egui::{self, Rect};

/// Windows narrower than this many points have no room for two panels beside the picture.
const NARROW: f32 = 900.0;

/// Height of the titles of a wipe, which take two rows if they are long, points.
const TITLES: f32 = 64.0;

/// About the height of a card in a corner of the picture, points.
const CARD: f32 = 240.0;

impl Window {
    /// Draws everything. Each panel gets the state that it may change, the facts, and the list of commands to add to.
    pub(super) fn layout(&mut self, ui: &mut egui::Ui) {
        let facts = self.facts();
        self.dialogs.begin(ui.ctx());
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
            let other =
                inspector.pixel().and_then(|pixel| other_pixel(view, second, facts.document(), pixel.at));
            inspector.ui(ui, facts.shown(), value, other);
            paths.ui(ui, facts.document());
        };
        if facts.model.presentation.is_some() {
            presenter.ui(ui, &facts);
        }
        if facts.model.has_panels() {
            Place::Menu.begin(ui);
            title_bar::ui(ui, thumbnails, &facts, commands);
            status_bar::ui(ui, &facts);
            if view.slots.is_listed() {
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
                let panel = egui::Panel::left("controls").exact_size(232.0);
                Place::Controls.begin(ui);
                scrolling(ui, panel, None, |ui| {
                    let has_info_below = is_narrow && has.has_info;
                    let help = "The window has no room for it at the right; it follows the controls";
                    let is_asked = has_info_below && {
                        let response = ui.button("Stage and pixel: below");
                        tips::beside(ui, response, help).clicked()
                    };
                    controls::ui(ui, (document, selected), remembered, &facts, (&mut edits, commands));
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
                let name = facts.document().origin.recipe.name.as_str();
                scrolling(ui, panel, Some(name), |ui| info(ui, view, commands));
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
            let (fitted, size) = (view.wiped(document).map(|(_, fitted)| fitted), facts.shown().size());
            let compared = view.compared_slot().map(|number| view.slots.title(number));
            let pictures = Pictures {
                main: match layer.and_then(|layer| layers.shown_mut(layer)) {
                    Some(layer) => Some((&mut layer.texture, layer.divisor)),
                    None => shown.map(|shown| (&mut shown.texture, shown.divisor)),
                },
                has_film,
                second: second.shown_mut().map(|shown| SecondPicture {
                    title: compared.unwrap_or_else(|| shown.document.title()),
                    texture: &mut shown.texture,
                    divisor: shown.divisor,
                    fitted: fitted.unwrap_or(Fitted::new(size, size)),
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
        if touch.is_orbit {
            self.note_step(Step::Orbit);
        }
        if let Some(reason) = facts.no_rays().filter(|_| touch.is_refused) {
            self.toasts.good(reason);
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
                let below = self.below_titles(room, &facts);
                if facts.model.has_recovered {
                    self.offer_recovered(ui, below);
                } else {
                    self.first_steps.ui(ui, below, &facts, &mut self.commands);
                }
                self.sizer.ui(ui, room, &mut self.commands);
            }
            self.toasts.ui(ui, room, &mut self.commands);
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

    /// The part of the viewport in which a card covers no title of a wipe or slot, nor that the camera is in a sphere.
    fn below_titles(&self, room: Rect, facts: &Facts) -> Rect {
        let is_wipe = self.model.view.mode() == Some(Mode::Wipe) && self.second.shown().is_some();
        let is_inside = || self.surfaces.inside(self.document()).is_some();
        let is_titled = is_wipe || slot_notice(facts).is_some() || is_inside();
        let titles = self.viewport.placement.rect().top().max(room.top());
        let top = titles + TITLES;
        // A card above the titles stays there. Where hardly anything would be left for it, it is worth more than they are.
        let is_near = titles < room.top() + CARD && room.bottom() - top > 2.0 * TITLES;
        if is_titled && is_near { Rect { min: egui::pos2(room.left(), top), ..room } } else { room }
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
        // The other picture may be scaled.
        let wiped = view.wiped(document).filter(|_| is_other).map(|(_, fitted)| fitted);
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
        let Some(at) = wiped.map_or(Some(at), |fitted| fitted.pixel(at)) else { return };
        let seen = Seen::around(at.map(|along| along / divisor), mean, |at| texture.colour(at));
        let seen = Seen { at, ..seen };
        Lens { room, picture, pointer, seen: &seen }.paint(ui);
    }
}

/// What the picture that the shown one is compared with has at the place of a pixel.
fn other_pixel(view: &ViewState, second: &Second, live: &Document, at: [u32; 2]) -> Option<OtherPixel> {
    if let Some((kept, fitted)) = view.wiped(live) {
        let place = fitted.pixel(at)?;
        let scaled = (!fitted.is_exact()).then_some(place);
        return Some(OtherPixel { mean: kept.mean(place)?, scaled });
    }
    let mean = view.subtracted(second.film())?.mean(at)?;
    Some(OtherPixel { mean, scaled: None })
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

/// A panel that can scroll. What it says `about` another picture begins at the top.
fn scrolling(
    ui: &mut egui::Ui,
    panel: egui::Panel,
    about: Option<&str>,
    content: impl FnOnce(&mut egui::Ui),
) {
    let known = egui::Id::unique("the picture that a panel is about");
    let is_another = about.is_some_and(|name| {
        // Not kept for the next start of the program, in which the panel begins at the top, too.
        let before =
            ui.data_mut(|data| std::mem::replace(data.get_temp_mut_or_default(known), name.to_owned()));
        before != name
    });
    panel.frame(theme::panel(egui::Margin::ZERO)).show(ui, |ui| {
        let mut area = egui::ScrollArea::vertical().auto_shrink(false);
        if is_another {
            area = area.vertical_scroll_offset(0.0);
        }
        area.show(ui, |ui| {
            egui::Frame::new().inner_margin(egui::Margin::symmetric(12, 8)).show(ui, content);
        });
    });
}
