//! Where everything is drawn in a frame: panels, the picture, what lies over it, and dialogs.

use super::Window;
use crate::app::commands::{Command, PanelContext};
use crate::app::model::{Mode, Model, Partner, Remembered, Tab};
use crate::app::panels::{bar, compare, controls, present, right, stage_panel, status, tone};
use crate::app::toolkit::{theme, widgets};
use crate::app::tools::inspector::Inspector;
use crate::app::tools::{Tools, dock};
use crate::app::tracing::Tracing;
use crate::app::tracing::second::Other;
use crate::app::viewport::display::Display;
use crate::app::viewport::{Pictures, Touch};
use eframe::egui::{self, ScrollArea, Ui};

/// Windows narrower than this many points have no room for two panels beside the picture.
pub(super) const NARROW: f32 = 1000.0;

/// In windows lower than this many points, what is compared scrolls with the text.
const LOW: f32 = 500.0;

/// The share of the right panel's height that view and comparison have; more of them scrolls.
const FOOT: f32 = 0.4;

impl Window {
    /// Draws everything. Each panel gets the state that it may change, the facts, and the list of commands to add to.
    pub(super) fn layout(&mut self, ui: &mut Ui) {
        let cx = PanelContext::new(self.snapshot());
        bar::name_window(ui.ctx(), cx.document());
        if cx.model.presentation.is_some() {
            let Window { display, tracing, tools, .. } = self;
            let is_read = display.viewport.has_pointer(ui.ctx());
            let numbers = |ui: &mut Ui| numbers(ui, &cx, display, tracing, &tools.inspector);
            present::ui(ui, &cx, is_read.then_some(numbers));
        }
        if cx.model.has_panels() {
            self.panels(ui, &cx);
        }
        let touch =
            egui::CentralPanel::default().frame(egui::Frame::new()).show(ui, |ui| self.middle(ui, &cx));
        self.take_touch(ui, touch.inner);
        let outcome = self.shell.dialogs.ui(ui, &cx);
        self.end_dialog(&ui.ctx().clone(), outcome);
        if cx.model.presentation.is_some_and(|presentation| presentation.is_blank) {
            present::blank(ui.ctx());
        }
        self.commands.extend(cx.requests.into_inner());
    }

    /// The panels around the picture.
    fn panels(&mut self, ui: &mut Ui, cx: &PanelContext) {
        let Window { model, tracing, display, tools, .. } = self;
        let Model { document, view, remembered, .. } = model;
        let has = &cx.model.remembered;
        let (room, is_narrow) = (ui.available_width(), ui.available_width() < NARROW);
        let is_low = ui.available_height() < LOW;
        bar::ui(ui, cx);
        status::ui(ui, cx, tracing.sizer.offer);
        let mut tabs = Vec::new();
        if !has.hides_info {
            tabs.extend([Tab::Stage, Tab::Code]);
            tabs.extend(tools.check.is_open().then_some(Tab::Check));
        }
        if !has.hides_controls && is_narrow {
            tabs.push(Tab::Controls);
        }
        let wanted = tabs.iter().find(|tab| **tab == remembered.tab).or(tabs.first()).copied();
        let mut controls = |ui: &mut Ui, remembered: &mut Remembered| {
            controls::ui(ui, document, remembered, cx);
        };
        if !has.hides_controls && !is_narrow {
            let panel = egui::Panel::left("controls").exact_size(232.0);
            let panel = panel.frame(theme::panel(egui::Margin::ZERO));
            panel.show(ui, |ui| right::scrolling(ui, |ui| controls(ui, remembered)));
        }
        if let Some(tab) = wanted {
            right::panel(tab, room).show(ui, |ui| {
                let names: Vec<_> = tabs.iter().map(|tab| (*tab, tab.name())).collect();
                let chosen = widgets::tabs(ui, &names, tab, |_| {});
                if chosen != tab {
                    remembered.tab = chosen;
                    if chosen == Tab::Check && view.kept.mine.is_some() {
                        cx.send(Command::CompareWith(Partner::Mine));
                    }
                }
                match tab {
                    Tab::Stage => {
                        let height = FOOT * ui.available_height();
                        right::foot(ui, |ui| {
                            let area = ScrollArea::vertical().max_height(height).auto_shrink([false, true]);
                            area.show(ui, |ui| {
                                tone::ui(ui, view, cx);
                                if !is_low {
                                    compare::ui(ui, cx);
                                }
                            });
                            numbers(ui, cx, display, tracing, &tools.inspector);
                        });
                        right::scrolling(ui, |ui| {
                            stage_panel::ui(ui, cx);
                            if is_low {
                                compare::ui(ui, cx);
                            }
                        });
                    }
                    Tab::Code => tools.code.ui(ui, cx),
                    Tab::Check => {
                        let Tools { check, inspector, .. } = tools;
                        check.ui(ui, cx, |ui| numbers(ui, cx, display, tracing, inspector));
                    }
                    Tab::Controls => right::scrolling(ui, |ui| controls(ui, remembered)),
                }
            });
        }
    }

    /// The picture, with the dock below.
    fn middle(&mut self, ui: &mut Ui, cx: &PanelContext) -> Touch {
        if cx.model.has_panels() {
            let Window { model, tools, .. } = self;
            dock::ui(ui, model, tools, cx);
        }
        if cx.model.presentation.is_some() {
            let context = ui.ctx().clone();
            present::enlarge(&context, ui.style_mut());
        }
        self.picture(ui, cx)
    }

    fn picture(&mut self, ui: &mut Ui, cx: &PanelContext) -> Touch {
        let Window { model, tracing, display, tools, .. } = self;
        let Model { document, view, selected, .. } = model;
        let layer = view.show().layer();
        let shown = tracing.main.shown();
        let other = tracing.other(&cx.model);
        let is_scaled = matches!(other, Some(Other::Kept(kept)) if kept.size() != cx.document().size());
        let ([theirs, mine], is_short) = (cx.model.side_names(), view.mode() == Some(Mode::Difference));
        let pictures = Pictures {
            main: match layer.and_then(|layer| display.layers.shown(layer)) {
                Some(layer) => Some((&layer.texture, layer.divisor > 1)),
                None => shown.map(|shown| (&shown.texture, shown.divisor > 1)),
            },
            titles: [&theirs[usize::from(is_short)], &mine[usize::from(is_short)]],
            second: other
                .and_then(|other| tracing.second.texture(&other))
                .map(|(texture, is_preview)| (texture, is_preview || is_scaled)),
            paths: &tools.paths,
            has_difference: tracing.second.means(&cx.model, cx.document().size()).is_some()
                && shown.is_some_and(|shown| shown.divisor == 1 && shown.run == tracing.main.status().run),
            places: match cx.model.view.compared(cx.document()) {
                Some(Partner::Mine) => tools.check.places(),
                _ => &[],
            },
        };
        let handles = (&mut document.camera, &mut view.divider, selected);
        display.viewport.ui(ui, handles, pictures, cx)
    }

    /// Does what the pointer did in the picture.
    fn take_touch(&mut self, ui: &Ui, touch: Touch) {
        let room = self.display.viewport.room;
        self.tools.inspector.hover(touch.hovered);
        if let Some(said) = touch.said {
            self.shell.toasts.good(said);
        }
        if touch.is_move {
            self.changes.note_move();
        }
        if let Some(room) = room {
            self.shell.toasts.ui(ui, room, &mut self.commands);
        }
    }
}

/// The numbers of the pixel under the pointer.
fn numbers(ui: &mut Ui, cx: &PanelContext, display: &Display, tracing: &Tracing, inspector: &Inspector) {
    let view = &cx.model.view;
    let at = inspector.readout(&cx.model).map(|readout| readout.pixel.at);
    let value = at.filter(|_| view.show().layer().is_some()).and_then(|at| display.layers.value_at(at));
    let other = tracing.other(&cx.model).map_or(Some(cx.document()), |other| other.document());
    inspector.ui(ui, cx, other, value);
}
