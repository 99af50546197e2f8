//! The viewport: the picture, and mouse input on it.

pub mod display;
mod moving;
pub mod paint;
mod placement;
mod selection;
pub mod sight;

pub use paint::Pictures;
pub use placement::{Placement, Touch};

use crate::app::commands::{Command, PanelContext, Snapshot};
use crate::app::model::{Document, Mode, Partner, navigation};
use crate::app::toolkit::menu;
use crate::app::toolkit::number::compact;
use crate::scene::Camera;
use eframe::egui::{self, CursorIcon, PointerButton, Pos2, Rect, Response, Sense, Ui, WidgetInfo, vec2};
use moving::Moving;
use placement::{place_at, whole_pixels};
use selection::Selection;

/// How far right the divider can be dragged, so that its handle stays in sight.
const LAST_PLACE: f32 = 0.9999;

/// How close the pointer must be to the wipe's divider to grab it, in points.
const GRIP: f32 = 12.0;

/// Space around the picture, in points.
const MARGIN: f32 = 8.0;

/// The state of the viewport.
#[derive(Default)]
pub struct Viewport {
    /// Position and scale of the picture.
    pub placement: Placement,
    /// Those of before the presentation.
    pub parked: Placement,
    moving: Moving,
    is_dragging_divider: bool,
    pub room: Option<Rect>,
    pub room_pixels: [u32; 2],
    selection: Selection,
    /// The place of the pointer in the picture, 0 to 1 from the upper left.
    pointer: Option<[f64; 2]>,
}

/// The picture in words, for those who cannot see it.
fn description(document: &Document) -> String {
    match document.stage().filter(|_| !document.is_changed()) {
        Some(stage) => format!("{}. {}", document.heading(), stage.alt),
        None => document.heading(),
    }
}

impl Viewport {
    /// Where a new sphere goes: the pointer's place in the picture; without one, the ground before the camera.
    pub fn aim(&self) -> [f64; 2] {
        const FOREGROUND: [f64; 2] = [0.5, 0.7];
        self.pointer.unwrap_or(FOREGROUND)
    }

    /// Whether the pointer was over the picture when that was last drawn.
    pub fn has_pointer(&self, context: &egui::Context) -> bool {
        let at = context.input(|input| input.pointer.hover_pos());
        at.is_some_and(|at| {
            self.placement.rect.contains(at) && self.room.is_some_and(|room| room.contains(at))
        })
    }

    /// Draws the picture and handles input on it, which moves the camera and the wipe's divider, `0..=1` of the picture's
    /// width, and selects a sphere.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        (camera, divider, selected): (&mut Camera, &mut f32, &mut Option<usize>),
        pictures: Pictures<'_>,
        cx: &PanelContext,
    ) -> Touch {
        let (view, live) = (&cx.model.view, cx.document());
        let room = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(room, Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, "Picture"));
        ui.ctx().accesskit_node_builder(response.id, |node| node.set_description(description(live)));
        if response.drag_started() {
            // As a click does.
            ui.memory_mut(|memory| memory.focused().into_iter().for_each(|id| memory.surrender_focus(id)));
        }
        let rect = self.place(ui, room, cx);
        let mut touch = Touch::default();
        let is_wipe = view.mode() == Some(Mode::Wipe);
        let mut is_held = self.handle_divider(ui, &response, is_wipe, divider);
        // Nothing acts on a picture that another one hides; a traced one is seen by the same camera.
        let at = ui.input(|input| input.pointer.press_origin()).or(response.interact_pointer_pos());
        let at = at.or(response.hover_pos());
        let is_over_other = at.is_some_and(|at| view.is_other(place_at(rect, at)[0]));
        let is_same_scene = matches!(view.compared(live), Some(Partner::Device(_) | Partner::Book));
        let is_covered = view.is_hidden() || is_over_other && !is_same_scene;
        let is_hidden = view.is_hidden() || is_over_other && view.kept_partner().is_some();
        if !is_covered && !is_held {
            (is_held, touch.is_move) = self.selection.handle(ui, &response, rect, cx);
        }
        if is_held {
            self.moving = Moving::default();
        } else {
            let handles = (&mut *camera, live);
            self.moving.handle(ui, &response, &mut self.placement, handles, is_hidden, &mut touch);
        }
        if !is_covered && !is_held {
            self.handle_click(ui, &response, cx, (camera, selected), &mut touch);
        }
        let document = Document { camera: *camera, ..live.clone() };
        paint::paint(ui, [room, rect], (&self.placement, *divider), pictures, &document, cx);
        // A wipe shows the traced picture right of the divider.
        let left = match view.mode() {
            Some(Mode::Wipe) => *divider,
            Some(Mode::Flip) => 1.0,
            _ => 0.0,
        };
        let own = rect.with_min_x(rect.lerp_inside(vec2(left, 0.0)).x);
        self.selection.paint(ui, (rect, own.intersect(room)), &document, cx);
        self.pointer = response.hover_pos().filter(|at| rect.contains(*at)).map(|at| place_at(rect, at));
        let pixel = |at| self.placement.pixel_at(at, document.size());
        touch.hovered = response.hover_pos().and_then(pixel);
        if response.secondary_clicked()
            && let Some(at) = response.interact_pointer_pos().filter(|at| rect.contains(*at))
            && live.no_rays().is_none()
            && !is_covered
        {
            *selected = live.pick(camera, place_at(rect, at)).map(|pick| pick.sphere);
        }
        let has_menu = response.context_menu(|ui| context_menu(ui, cx)).is_some();
        if has_menu && !response.secondary_clicked() {
            // The entries mean the pixel where the menu was opened.
            touch.hovered = None;
        }
        paint::paint_drop(ui, room);
        touch
    }

    /// Places the picture. One that is presented fits the screen.
    fn place(&mut self, ui: &Ui, room: Rect, snapshot: &Snapshot) -> Rect {
        let model = &snapshot.model;
        let is_presenting = model.presentation.is_some();
        if !snapshot.has_sight && is_presenting {
            self.placement.fit();
        }
        let margin = if is_presenting || !model.has_panels() { 0.0 } else { MARGIN };
        let (inner, scale) = (room.shrink(margin), ui.ctx().pixels_per_point());
        (self.room, self.room_pixels) = (Some(room), whole_pixels(inner, scale));
        let [width, height] = snapshot.document().size().map(|along| along as f32);
        self.placement.place(inner, vec2(width, height), scale)
    }

    fn handle_divider(&mut self, ui: &Ui, response: &Response, is_wipe: bool, divider: &mut f32) -> bool {
        if !is_wipe {
            self.is_dragging_divider = false;
            return false;
        }
        let rect = self.placement.rect;
        // A part that is enlarged has a divider, too.
        let seen = self.room.map_or(rect, |room| rect.intersect(room)).shrink(1.0);
        let [least, most] = [seen.left(), seen.right()].map(|x| (x - rect.left()) / rect.width());
        if least > 0.01 || most < 0.99 {
            *divider = divider.clamp(least, most.max(least));
        }
        let is_near = |at: Pos2| (at.x - rect.lerp_inside(vec2(*divider, 0.0)).x).abs() < GRIP;
        if response.drag_started_by(PointerButton::Primary) {
            self.is_dragging_divider = ui.input(|input| input.pointer.press_origin()).is_some_and(is_near);
        }
        let pointer = response.interact_pointer_pos().or(response.hover_pos());
        let is_on_it = self.is_dragging_divider || (!response.dragged() && pointer.is_some_and(is_near));
        if self.is_dragging_divider
            && let Some(at) = response.interact_pointer_pos()
        {
            *divider = ((at.x - rect.left()) / rect.width()).clamp(0.0, LAST_PLACE);
        }
        self.is_dragging_divider &= response.dragged();
        if is_on_it {
            ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
        }
        is_on_it
    }

    fn handle_click(
        &mut self,
        ui: &Ui,
        response: &Response,
        cx: &PanelContext,
        (camera, selected): (&mut Camera, &mut Option<usize>),
        touch: &mut Touch,
    ) {
        let (rect, live) = (self.placement.rect, cx.document());
        let at = response.interact_pointer_pos().filter(|at| rect.contains(*at));
        let Some(at) = at.filter(|_| response.clicked()) else { return };
        if let Some(reason) = live.no_rays() {
            touch.said = Some(reason.to_owned());
            return;
        }
        let place = place_at(rect, at);
        let pick = live.pick(camera, place);
        if response.double_clicked() {
            if let Some(pick) = pick {
                *camera = navigation::recentre(camera, pick.point);
            }
        } else if is_held(ui, |modifiers| modifiers.alt) {
            cx.send(Command::ListPaths);
        } else if is_held(ui, |modifiers| modifiers.command) {
            let said = pick.map(|pick| {
                *camera = navigation::focus(camera, pick.point);
                let is_pinhole = camera.defocus_angle_degrees == 0.0;
                let note = if is_pinhole { "; a pinhole is sharp everywhere" } else { "" };
                format!("Focus distance {}{note}", compact(camera.depth_of(pick.point)))
            });
            touch.said = Some(said.unwrap_or_else(|| "The sky has no distance".to_owned()));
        } else {
            *selected = pick.map(|pick| pick.sphere);
        }
    }
}

/// Whether a key was held when a button was released. In a long frame, it may have been released since.
fn is_held(ui: &Ui, is_it: fn(&egui::Modifiers) -> bool) -> bool {
    let is_release = |event: &egui::Event| matches!(event, egui::Event::PointerButton { pressed: false, modifiers, .. } if is_it(modifiers));
    ui.input(|input| is_it(&input.modifiers) || input.events.iter().any(is_release))
}

/// The menu of a right click.
fn context_menu(ui: &mut Ui, cx: &PanelContext) {
    use Command as C;
    ui.set_width(menu::MENU_WIDTH);
    let of_sphere = [C::FocusSphere, C::DuplicateSphere, C::DeleteSphere];
    let of_sphere = of_sphere.into_iter().filter(|_| cx.model.selected.is_some());
    of_sphere.chain([C::Copy, C::ListPaths, C::Keep]).for_each(|command| _ = menu::item(ui, cx, command));
}
