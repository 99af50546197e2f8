//! The viewport: the picture, and mouse input on it.

mod badge;
mod dropped;
mod gizmo;
mod legend;
mod mark;
mod moving;
mod outline;
mod paint;
mod placement;
mod point;
mod selection;
mod still;
mod touch;

pub use paint::{Pictures, SecondPicture};
pub use placement::Placement;
use placement::whole_pixels;
pub use touch::Touch;

use super::command::Command;
use super::facts::Facts;
use super::menu;
use super::model::document::Document;
use super::model::edit::Edit;
use super::model::view::Mode;
use super::navigation;
use super::spheres::Selected;
use super::spheres::grip::new_body;
use crate::scene::Camera;
use dropped::paint_drop;
use eframe::egui::{
    self, CursorIcon, PointerButton, Pos2, Rect, Response, RichText, Sense, Ui, WidgetInfo, vec2,
};
use mark::Mark;
use moving::{Moving, Target};
use paint::{own_side, paint};
use point::place_at;
use selection::Selection;
use std::time::Instant;

/// How close the pointer must be to the wipe's divider to grab it, in points.
const GRIP: f32 = 8.0;

/// The state of the viewport.
#[derive(Default)]
pub struct Viewport {
    /// Position and scale of the picture.
    pub placement: Placement,
    mark: Option<Mark>,
    moving: Moving,
    is_dragging_divider: bool,
    /// Where the context menu was opened, if on the picture.
    menu_at: Option<Pos2>,
    /// The area of the viewport when it was last drawn.
    room: Option<Rect>,
    /// The room for the picture when it was last drawn, pixels of the screen.
    room_pixels: [u32; 2],
    /// The selected sphere in the picture.
    selection: Selection,
    /// The drag that marks a part of the picture.
    /// The place of the pointer in the picture, 0 to 1 from the upper left.
    pointer: Option<[f64; 2]>,
}

/// The state that the viewport may change.
pub struct Handle<'a> {
    /// The camera that mouse input moves.
    pub camera: &'a mut Camera,
    /// Position of the wipe's divider, `0..=1` of the picture's width.
    pub divider: &'a mut f32,
    /// The selected sphere.
    pub selected: Option<&'a Selected>,
}

impl Viewport {
    /// The area of the viewport when it was last drawn.
    pub fn room(&self) -> Option<Rect> {
        self.room
    }

    /// The room for the picture when it was last drawn, pixels of the screen.
    pub fn room_pixels(&self) -> [u32; 2] {
        self.room_pixels
    }

    /// Draws the picture and handles input on it.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        handle: Handle<'_>,
        pictures: Pictures<'_>,
        facts: &Facts,
        commands: &mut Vec<Command>,
    ) -> Touch {
        let Handle { camera, divider, selected } = handle;
        let is_kept = facts.model.view.kept.looked().is_some();
        let selected = selected.filter(|_| !is_kept);
        let sight = Target { document: facts.document(), has_rays: facts.no_rays().is_none() };
        let room = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(room, Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, "Picture"));
        self.room = Some(room);
        let pixels = facts.shown().size();
        let size = vec2(pixels[0] as f32, pixels[1] as f32);
        let margin = if facts.model.remembered.has_panels { 10.0 } else { 0.0 };
        let scale = ui.ctx().pixels_per_point();
        let rect = self.placement.place(room.shrink(margin), size, scale);
        self.room_pixels = whole_pixels(room.shrink(margin), scale);

        let mut touch = Touch { room: Some(room), ..Touch::default() };
        let is_wipe = facts.model.view.mode() == Some(Mode::Wipe);
        let before = *divider;
        let mut is_held = self.handle_divider(ui, &response, is_wipe, divider);
        touch.is_divider_moved = *divider != before;
        if is_kept && !is_held {
            still::handle(ui, &response, &mut self.placement);
            is_held = true;
        }
        if !is_held {
            (is_held, touch.edit) = self.selection.handle(ui, &response, rect, selected, facts.document());
        }
        if !is_held {
            self.moving.handle(ui, &response, &mut self.placement, (camera, sight), &mut touch);
            self.handle_click(ui, &response, sight, camera, &mut touch);
        } else {
            self.moving = Moving::default();
        }
        let document = match is_kept {
            true => facts.shown().clone(),
            false => Document { camera: *camera, ..facts.document().clone() },
        };
        let notices = pictures.notices.len();
        let taken = paint(ui, [room, rect], &self.placement, *divider, pictures, &document, facts);
        let is_left = facts.model.view.is_other_earlier(&document);
        let clip = if is_wipe { own_side(rect, *divider, is_left) } else { rect };
        let rows = if notices > 0 { notices + usize::from(is_wipe) } else { 0 };
        self.selection.paint(ui, (rect, clip.intersect(room)), selected, (rows, &taken));
        self.moving.paint(ui, clip.intersect(room), rect, &document);
        self.mark = self.mark.take().filter(|mark| mark.paint(ui, room, rect));
        self.pointer = response.hover_pos().filter(|at| rect.contains(*at)).map(|at| place_at(rect, at));
        touch.hovered = response.hover_pos().and_then(|at| self.placement.pixel_at(at, pixels));
        if response.secondary_clicked() {
            self.menu_at = response.interact_pointer_pos().filter(|at| rect.contains(*at));
        }
        response.context_menu(|ui| self.context_menu(ui, camera, sight, (facts, commands), &mut touch));
        if facts.model.has_panels() && facts.model.remembered.has_axes && sight.has_rays && !is_kept {
            gizmo::ui(ui, room, (camera, sight), commands, &mut touch);
        }
        paint_drop(ui, room);
        touch
    }

    /// Where a new sphere goes: the pointer's place in the picture; without one, the ground before the camera.
    pub fn aim(&self) -> [f64; 2] {
        const FOREGROUND: [f64; 2] = [0.5, 0.7];
        self.pointer.unwrap_or(FOREGROUND)
    }

    fn handle_divider(&mut self, ui: &Ui, response: &Response, is_wipe: bool, divider: &mut f32) -> bool {
        if !is_wipe {
            self.is_dragging_divider = false;
            return false;
        }
        let rect = self.placement.rect();
        let x = rect.left() + rect.width() * *divider;
        let pointer = response.interact_pointer_pos().or(response.hover_pos());
        let is_near = pointer.is_some_and(|at| (at.x - x).abs() < GRIP);
        if response.drag_started_by(PointerButton::Primary) {
            let origin = ui.input(|input| input.pointer.press_origin());
            self.is_dragging_divider = origin.is_some_and(|at| (at.x - x).abs() < GRIP);
        }
        if self.is_dragging_divider {
            if let Some(at) = response.interact_pointer_pos() {
                *divider = ((at.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
            }
            if !response.dragged() {
                self.is_dragging_divider = false;
            }
        }
        let is_on_it = self.is_dragging_divider || (is_near && !response.dragged());
        if is_on_it {
            ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
        }
        is_on_it
    }

    fn handle_click(
        &mut self,
        ui: &Ui,
        response: &Response,
        sight: Target<'_>,
        camera: &mut Camera,
        touch: &mut Touch,
    ) {
        let rect = self.placement.rect();
        let Some(at) = response.interact_pointer_pos().filter(|at| rect.contains(*at)) else { return };
        if !sight.has_rays {
            touch.is_refused |= response.clicked();
        } else if response.double_clicked() {
            self.use_at(Spot::Centre, at, sight, camera, touch);
        } else if response.clicked() {
            let is_held = |is_it: fn(&egui::Modifiers) -> bool| {
                ui.input(|input| is_it(&input.modifiers)) || is_release(ui, is_it)
            };
            let spot = if is_held(|modifiers| modifiers.alt) {
                Spot::Paths
            } else if is_held(|modifiers| modifiers.command) {
                Spot::Focus
            } else {
                Spot::Select
            };
            self.use_at(spot, at, sight, camera, touch);
        }
    }

    fn use_at(&mut self, spot: Spot, at: Pos2, sight: Target<'_>, camera: &mut Camera, touch: &mut Touch) {
        let document = sight.document;
        let place = place_at(self.placement.rect(), at);
        match spot {
            Spot::Select => {
                let sphere = document.pick(camera, place).map(|pick| pick.sphere);
                touch.select = Some(sphere);
                if sphere.is_none() {
                    self.mark = Some(Mark { place, text: "sky".to_owned(), since: Instant::now() });
                }
            }
            Spot::Add => {
                let hit = document.pick(camera, place);
                touch.edit = Some(Edit::Add(new_body(hit, camera, document.aspect(), place)));
            }
            Spot::Focus => self.focus(sight, camera, place),
            Spot::Centre => self.recentre(sight, camera, place),
            Spot::Paths => {
                let settings = document.settings;
                touch.listed = self.placement.pixel_at(at, [settings.width, settings.height]);
            }
        }
    }

    fn focus(&mut self, sight: Target<'_>, camera: &mut Camera, place: [f64; 2]) {
        let text = match sight.document.pick(camera, place) {
            Some(pick) => {
                *camera = navigation::focus(camera, pick.point);
                let distance = camera.depth_of(pick.point);
                let is_pinhole = camera.defocus_angle_degrees == 0.0;
                let note = if is_pinhole { " (a pinhole is sharp everywhere)" } else { "" };
                format!("focus {distance:.3}{note}")
            }
            None => "sky".to_owned(),
        };
        self.mark = Some(Mark { place, text, since: Instant::now() });
    }

    fn recentre(&mut self, sight: Target<'_>, camera: &mut Camera, place: [f64; 2]) {
        if let Some(pick) = sight.document.pick(camera, place) {
            *camera = navigation::recentre(camera, pick.point);
            let text = "centre".to_owned();
            self.mark = Some(Mark { place: [0.5, 0.5], text, since: Instant::now() });
        }
    }

    fn context_menu(
        &mut self,
        ui: &mut Ui,
        camera: &mut Camera,
        sight: Target<'_>,
        (facts, commands): (&Facts, &mut Vec<Command>),
        touch: &mut Touch,
    ) {
        ui.set_width(menu::MENU_WIDTH);
        if still::menu(ui, facts, commands) {
            return;
        }
        if let Some(at) = self.menu_at {
            for spot in Spot::ALL {
                let [name, mouse] = spot.names();
                let mouse = RichText::new(mouse).color(ui.visuals().weak_text_color());
                let button =
                    egui::Button::new(name).shortcut_text(mouse).min_size(vec2(ui.available_width(), 0.0));
                let reason = facts.no_rays();
                let response = ui.add_enabled(reason.is_none(), button);
                if response.on_disabled_hover_text(reason.unwrap_or_default()).clicked() {
                    self.use_at(spot, at, sight, camera, touch);
                    ui.close();
                }
            }
            ui.separator();
        }
        if facts.model.selected.is_some() {
            for command in [Command::DuplicateSphere, Command::DeleteSphere] {
                menu::item(ui, facts, commands, command);
            }
            ui.separator();
        }
        for command in [Command::Home, Command::AddBookmark, Command::Keep, Command::CopyCommand] {
            menu::item(ui, facts, commands, command);
        }
    }
}

/// An action for a point of the picture.
#[derive(Clone, Copy)]
enum Spot {
    Select,
    Focus,
    Centre,
    Paths,
    Add,
}

impl Spot {
    /// All actions, in the order of the menu.
    const ALL: [Spot; 5] = [Spot::Select, Spot::Focus, Spot::Centre, Spot::Paths, Spot::Add];

    /// Its name in the menu, and its mouse shortcut.
    fn names(self) -> [&'static str; 2] {
        match self {
            Spot::Select => ["Select this", "Click"],
            Spot::Focus => ["Focus on this", "Ctrl and click"],
            Spot::Centre => ["Look at this", "Double click"],
            Spot::Paths => ["List the paths of this pixel", "T"],
            Spot::Add => ["Add a sphere here", ""],
        }
    }
}

/// Whether a key was held when a button was released. In a long frame, it may have been released since.
fn is_release(ui: &Ui, is_held: impl Fn(&egui::Modifiers) -> bool) -> bool {
    let is_it = |event: &egui::Event| matches!(event, egui::Event::PointerButton { pressed: false, modifiers, .. } if is_held(modifiers));
    ui.input(|input| input.events.iter().any(is_it))
}

#[cfg(test)]
mod tests;
