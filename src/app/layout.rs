//! Where everything is drawn in a frame: panels, the picture, what lies over it, and dialogs.

use super::command::Command;
use super::facts::Facts;
use super::inspector::OtherPixel;
use super::model::Model;
use super::model::document::Document;
use super::model::first_steps::Step;
use super::model::fitted::Fitted;
use super::model::remembered::{Dock, Tab};
use super::model::view::{Mode, ViewState};
use super::places::Place;
use super::present::{self, Lens, Seen};
use super::second::Second;
use super::viewport::{Handle, Pictures, SecondPicture, Touch};
use super::window::Window;
use super::{bar, controls, first_steps, info, plot, status, theme};
use eframe::egui::{self, Rect, Ui};

/// Windows narrower than this many points have no room for two panels beside the picture.
const NARROW: f32 = 900.0;

impl Window {
    /// Draws everything. Each panel gets the state that it may change, the facts, and the list of commands to add to.
    pub(super) fn layout(&mut self, ui: &mut Ui) {
        let facts = self.facts();
        bar::name_window(ui.ctx(), facts.document());
        self.shell.dialogs.begin(ui.ctx());
        if facts.model.presentation.is_some() {
            self.shell.presenter.ui(ui, &facts);
        }
        if facts.model.has_panels() {
            self.panels(ui, &facts);
        }
        let touch =
            egui::CentralPanel::default().frame(egui::Frame::new()).show(ui, |ui| self.middle(ui, &facts));
        self.take_touch(ui, touch.inner, &facts);
        self.display.kept.verdict.ui(ui.ctx());
        let mut edits = Vec::new();
        let chosen = self.shell.dialogs.ui(ui, &facts, (&mut edits, &mut self.commands));
        edits.into_iter().for_each(|edit| self.edit(edit));
        if let Some((purpose, path)) = chosen {
            let context = ui.ctx().clone();
            self.use_path(&context, purpose, path);
        }
        if facts.model.presentation.is_some_and(|presentation| presentation.is_blank) {
            present::blank(ui.ctx());
        }
    }

    /// The panels around the picture.
    fn panels(&mut self, ui: &mut Ui, facts: &Facts) {
        let Window { model, spheres, tracing, display, tools, commands, .. } = self;
        let selected = spheres.selected(model);
        let Model { document, view, remembered, .. } = model;
        let has = &facts.model.remembered;
        let is_narrow = ui.available_width() < NARROW;
        Place::Bar.begin(ui);
        bar::ui(ui, facts, commands);
        status::ui(ui, facts, tracing.sizer.offer(), commands);
        let mut edits = Vec::new();
        let mut right = |ui: &mut Ui, commands: &mut Vec<Command>| {
            match has.tab {
                Tab::Stage => info::ui(ui, facts, commands),
                Tab::Code => tools.code.ui(ui, facts, commands),
                Tab::Check => tools.check.ui(ui),
            }
            display.tone.ui(ui, view, facts);
            let pixel = tools.inspector.pixel();
            let layer = view.show().layer();
            let value = pixel.and_then(|pixel| display.layers.value_at(pixel.at)).filter(|_| layer.is_some());
            let other =
                pixel.and_then(|pixel| other_pixel(view, &tracing.second, facts.document(), pixel.at));
            tools.inspector.ui(ui, facts.shown(), value, other);
        };
        if has.has_info && !is_narrow {
            let panel = egui::Panel::right("info").default_size(272.0).size_range(240.0..=640.0);
            Place::Info.begin(ui);
            scrolling(ui, panel, |ui| right(ui, commands));
        }
        if has.has_controls {
            let panel = egui::Panel::left("controls").exact_size(232.0);
            Place::Controls.begin(ui);
            scrolling(ui, panel, |ui| {
                controls::ui(ui, (document, selected.as_ref()), remembered, facts, (&mut edits, commands));
                if has.has_info && is_narrow {
                    Place::Info.begin(ui);
                    right(ui, commands);
                }
            });
        }
        edits.into_iter().for_each(|edit| self.edit(edit));
    }

    /// The picture, with the dock and the card of first steps below.
    fn middle(&mut self, ui: &mut Ui, facts: &Facts) -> Touch {
        if facts.model.has_panels()
            && let Some(dock) = facts.model.remembered.dock
        {
            let Window { model, tools, commands, .. } = self;
            match dock {
                Dock::Error => plot::ui(ui, &mut model.document.stop.noise, facts, commands),
                Dock::Lanes => tools.packet.ui(ui, commands),
                Dock::Path => {}
                Dock::Kept => {}
            }
        }
        if facts.model.has_panels() {
            first_steps::ui(ui, facts, &mut self.commands);
        }
        if facts.model.presentation.is_some() {
            let context = ui.ctx().clone();
            present::enlarge(&context, ui.style_mut());
        }
        self.picture(ui, facts)
    }

    fn picture(&mut self, ui: &mut Ui, facts: &Facts) -> Touch {
        let Window { model, spheres, tracing, display, tools, commands, .. } = self;
        let selected = spheres.selected(model);
        let Model { document, view, .. } = model;
        let layer = view.show().layer();
        let kept = view.kept.shown();
        let shown = match kept {
            Some(kept) => display.kept.picture.shown_mut(kept),
            None => tracing.main.shown_mut(),
        };
        let has_film = shown.is_some();
        let (fitted, size) = (view.wiped(document).map(|(_, fitted)| fitted), facts.shown().size());
        let compared = view.compared_kept().map(|place| view.kept.title(place));
        let pictures = Pictures {
            main: match layer.and_then(|layer| display.layers.shown_mut(layer)) {
                Some(layer) => Some((&mut layer.texture, layer.divisor)),
                None => shown.map(|shown| (&mut shown.texture, shown.divisor)),
            },
            has_film,
            second: tracing.second.shown_mut().map(|shown| SecondPicture {
                title: compared.unwrap_or_else(|| shown.document.title()),
                texture: &mut shown.texture,
                divisor: shown.divisor,
                fitted: fitted.unwrap_or(Fitted::new(size, size)),
            }),
            paths: kept.is_none().then_some(&tools.paths),
            values: &display.values,
            notices: notices(facts, display.identity.is_same()),
        };
        let handle =
            Handle { camera: &mut document.camera, divider: &mut view.divider, selected: selected.as_ref() };
        display.viewport.ui(ui, handle, pictures, facts, commands)
    }

    /// Does what the pointer did in the picture.
    fn take_touch(&mut self, ui: &Ui, touch: Touch, facts: &Facts) {
        if touch.is_divider_moved {
            self.model.view.is_divider_unplaced = false;
        }
        if facts.model.presentation.is_some() {
            self.lens(ui, touch.hovered, touch.room);
        }
        self.tools.inspector.hover(touch.hovered);
        if let Some(pixel) = touch.listed {
            self.tools.paths.list(&self.model.document, pixel, ui.ctx());
            self.model.remembered.dock = Some(Dock::Path);
        }
        if touch.is_orbit {
            self.note_step(Step::Orbit);
        }
        if let Some(reason) = facts.no_rays().filter(|_| touch.is_refused) {
            self.shell.toasts.good(reason);
        }
        if touch.is_move || touch.edit.is_some() {
            self.changes.note_move();
        }
        if let Some(sphere) = touch.select {
            self.model.selected = sphere;
        }
        touch.edit.into_iter().for_each(|edit| self.edit(edit));
        if let Some(room) = touch.room {
            self.shell.toasts.ui(ui, room, &mut self.commands);
        }
    }

    /// The magnifier of a presentation.
    fn lens(&mut self, ui: &Ui, hovered: Option<[u32; 2]>, room: Option<Rect>) {
        let (Some(at), Some(room)) = (hovered, room) else { return };
        let Some(pointer) = ui.ctx().input(|input| input.pointer.hover_pos()) else { return };
        let Window { model, tracing, display, tools, .. } = self;
        let (view, document) = (&model.view, &model.document);
        let picture = display.viewport.placement.rect();
        let share = (pointer.x - picture.left()) / picture.width();
        let is_other =
            view.mode() == Some(Mode::Wipe) && (share < view.divider) == view.is_other_earlier(document);
        let wiped = view.wiped(document).filter(|_| is_other).map(|(_, fitted)| fitted);
        let mean =
            tools.inspector.pixel().filter(|pixel| pixel.at == at && !is_other).map(|pixel| pixel.mean);
        let layer = view.show().layer();
        let (texture, divisor) = match layer.and_then(|layer| display.layers.shown_mut(layer)) {
            Some(layer) => (&layer.texture, layer.divisor),
            None => {
                let mine = match view.kept.shown() {
                    Some(kept) => display.kept.picture.shown(kept),
                    None => tracing.main.shown(),
                };
                let other = tracing.second.shown().filter(|_| is_other);
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

/// The pixel of the other picture of a comparison.
fn other_pixel(view: &ViewState, second: &Second, live: &Document, at: [u32; 2]) -> Option<OtherPixel> {
    if let Some((kept, fitted)) = view.wiped(live) {
        let place = fitted.pixel(at)?;
        let scaled = (!fitted.is_exact()).then_some(place);
        return Some(OtherPixel { mean: kept.mean(place)?, scaled });
    }
    let mean = view.subtracted(second.film())?.mean(at)?;
    Some(OtherPixel { mean, scaled: None })
}

/// What is said at the top of the picture.
fn notices(facts: &Facts, is_same: bool) -> Vec<String> {
    let view = &facts.model.view;
    let mut notices = Vec::new();
    if let (Some(Mode::Difference), Some(place)) = (view.mode(), view.compared_kept()) {
        notices.push(format!("A: {}    B: {}", facts.title(), view.kept.title(place)));
    }
    if is_same {
        notices.push("identical to the bit".to_owned());
    }
    notices
}

/// A panel whose content scrolls.
fn scrolling(ui: &mut Ui, panel: egui::Panel, content: impl FnOnce(&mut Ui)) {
    panel.frame(theme::panel(egui::Margin::ZERO)).show(ui, |ui| {
        egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            egui::Frame::new().inner_margin(egui::Margin::same(16)).show(ui, content);
        });
    });
}
