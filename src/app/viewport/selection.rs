//! The selected sphere in the picture: its outline, its handle, and drags of either.

use super::badge::badge_below;
use super::outline::paint_outline;
use super::point::{place_at, point_at};
use crate::app::model::document::Document;
use crate::app::model::edit::{Body, Edit};
use crate::app::spheres::grip::{Grip, Held};
use crate::app::spheres::silhouette::Outline;
use crate::app::spheres::{LARGE, Selected};
use crate::app::theme;
use crate::app::widgets::compact;
use crate::scene::{Camera, Scene};
use eframe::egui::{
    Align2, Color32, CursorIcon, PointerButton, Pos2, Rect, Response, Stroke, TextStyle, Ui, pos2, vec2,
};

/// How close the pointer must be to the handle to grab it, in points.
const GRIP: f32 = 9.0;

/// The handle of a sphere that looks smaller than this is beside its outline, in points.
const SMALL: f32 = 16.0;

/// A sphere that looks larger than this many pictures is not dragged: drags on the ground turn the camera.
const LARGEST: f64 = 1.5;

/// Height of a row of notices, in points.
pub(super) const ROW: f32 = 28.0;

/// What is known about the selected sphere in the picture.
#[derive(Default)]
pub(super) struct Selection {
    /// The sphere that the user drags.
    held: Option<Held>,
    /// The outline of the selected sphere.
    drawn: Option<Drawn>,
}

/// The outline of the selected sphere, and what it was made for.
struct Drawn {
    /// The scene's address: an edited scene has another one.
    scene: *const Scene,
    camera: Camera,
    aspect: f64,
    body: Body,
    outline: Outline,
}

impl Selection {
    /// Handles drags of the selected sphere in the picture at `rect`. Returns whether the user holds it, and the change
    /// that the drag makes.
    pub(super) fn handle(
        &mut self,
        ui: &Ui,
        response: &Response,
        rect: Rect,
        selected: Option<&Selected>,
        document: &Document,
    ) -> (bool, Option<Edit>) {
        let Some(selected) = selected else {
            *self = Selection::default();
            return (false, None);
        };
        self.draw(selected, document);
        let (modifiers, origin) = ui.input(|input| (input.modifiers, input.pointer.press_origin()));
        if response.drag_started_by(PointerButton::Primary)
            && !modifiers.shift
            && let Some(at) = origin
        {
            self.held = self.grasped(rect, selected, document, at, modifiers.command);
        }
        match &self.held {
            Some(held) if response.dragged_by(PointerButton::Primary) && held.sphere == selected.sphere => {
                let edit = response.interact_pointer_pos().and_then(|at| {
                    let body = held.dragged(&document.camera, document.aspect(), place_at(rect, at));
                    (body != selected.body).then_some(Edit::Change(selected.sphere, body))
                });
                ui.ctx().set_cursor_icon(cursor(held.grip, true));
                (true, edit)
            }
            _ => {
                self.held = None;
                let hovered = response.hover_pos().filter(|_| !response.dragged() && !modifiers.shift);
                if let Some(held) =
                    hovered.and_then(|at| self.grasped(rect, selected, document, at, modifiers.command))
                {
                    ui.ctx().set_cursor_icon(cursor(held.grip, false));
                }
                (false, None)
            }
        }
    }

    /// What a drag that begins at this point of the screen would hold.
    fn grasped(
        &self,
        rect: Rect,
        selected: &Selected,
        document: &Document,
        at: Pos2,
        is_level: bool,
    ) -> Option<Held> {
        self.extent()?;
        let start = place_at(rect, at);
        let held = Held {
            grip: if is_level { Grip::Level } else { Grip::Centre },
            sphere: selected.sphere,
            before: selected.body,
            start,
            offset: [0.0; 2],
        };
        if let Some((handle, place)) = self.handle_at(rect)
            && handle.distance(at) < GRIP
        {
            let offset = [0, 1].map(|axis| place[axis] - start[axis]);
            return Some(Held { grip: Grip::Radius, offset, ..held });
        }
        is_on(selected, document, start).then_some(held)
    }

    /// The lower and upper corner of the outline in the picture, if the sphere is small enough to be dragged.
    fn extent(&self) -> Option<[[f64; 2]; 2]> {
        let [low, high] = self.drawn.as_ref()?.outline.bounds()?;
        (0..2).all(|axis| high[axis] - low[axis] < LARGEST).then_some([low, high])
    }

    /// The handle of the radius: its point on the screen, and the point of the outline that it moves.
    fn handle_at(&self, rect: Rect) -> Option<(Pos2, [f64; 2])> {
        let [low, high] = self.extent()?;
        let outline = &self.drawn.as_ref()?.outline;
        let is_in_sight = |place: &[f64; 2]| place.iter().all(|along| (0.01..0.99).contains(along));
        let place = outline.quarters().find(is_in_sight)?;
        let middle = point_at(rect, [0, 1].map(|axis| 0.5 * (low[axis] + high[axis])));
        let at = point_at(rect, place);
        let outwards = (at - middle).normalized();
        let beside = (SMALL - (at - middle).length()).max(0.0);
        Some((at + outwards * beside, place))
    }

    /// Makes the outline, unless the last one still holds.
    fn draw(&mut self, selected: &Selected, document: &Document) {
        let (scene, camera, aspect, body) =
            (document.scene(), document.camera, document.aspect(), selected.body);
        let is_it = |drawn: &Drawn| {
            (drawn.scene, drawn.camera, drawn.aspect, drawn.body)
                == (std::ptr::from_ref(scene), camera, aspect, body)
        };
        if !self.drawn.as_ref().is_some_and(is_it) {
            let hiding = Some(scene).filter(|scene| scene.spheres.len() <= LARGE);
            let outline = Outline::new(&camera, aspect, body.center, body.radius, hiding);
            self.drawn = Some(Drawn { scene, camera, aspect, body, outline });
        }
    }

    /// Draws the outline, the handle and the name of the selected sphere. The name is below so many `rows` of notices, and
    /// covers none of the words at the `taken` places.
    pub(super) fn paint(
        &self,
        ui: &Ui,
        (rect, clip): (Rect, Rect),
        selected: Option<&Selected>,
        (rows, taken): (usize, &[Rect]),
    ) {
        let (Some(selected), Some(drawn)) = (selected, &self.drawn) else { return };
        let painter = &ui.painter().with_clip_rect(clip);
        paint_outline(&drawn.outline.points, painter, rect);
        let mut top = rect.intersect(clip).center_top() + vec2(0.0, 40.0);
        let in_sight = drawn.outline.points.iter().filter_map(|point| point.place);
        let in_sight =
            in_sight.map(|place| point_at(rect, place)).filter(|at| painter.clip_rect().contains(*at));
        let around = Rect::from_points(&in_sight.collect::<Vec<_>>());
        if around.is_finite() {
            top = around.center_top();
        }
        if let Some((at, _)) = self.handle_at(rect) {
            let pointer = ui.input(|input| input.pointer.hover_pos());
            let is_held = self.held.is_some_and(|held| held.grip == Grip::Radius);
            let is_hot = is_held || (self.held.is_none() && pointer.is_some_and(|to| to.distance(at) < GRIP));
            let fill = if is_hot { theme::accent(ui) } else { Color32::WHITE };
            painter.circle(at, 5.0, fill, Stroke::new(1.5, Color32::from_black_alpha(190)));
        }
        let Body { center, radius, .. } = selected.body;
        let text = match self.held.map(|held| held.grip) {
            Some(Grip::Radius) => format!("radius {}", compact(radius)),
            Some(_) => format!("centre {}", center.to_array().map(compact).join(", ")),
            None => selected.name(),
        };
        let font = TextStyle::Body.resolve(ui.style());
        // Above the outline if there is room.
        let highest = painter.clip_rect().top() + 34.0 + ROW * rows as f32;
        let at = pos2(top.x, (top.y - 8.0).max(highest));
        badge_below(ui, painter, (at, Align2::CENTER_BOTTOM), &text, &font, taken);
    }
}

/// Whether the selected sphere is what is seen at a point of the picture. Among very many spheres, whether it is behind
/// that point.
fn is_on(selected: &Selected, document: &Document, place: [f64; 2]) -> bool {
    let camera = &document.camera;
    if document.scene().spheres.len() <= LARGE {
        let pick =
            document.scene().pick(camera.look_from, camera.direction_through(place, document.aspect()));
        return pick.is_some_and(|pick| pick.sphere == selected.sphere);
    }
    let mut alone = Scene::default();
    alone.add_sphere(selected.body.center, selected.body.radius, 0);
    alone.pick(camera.look_from, camera.direction_through(place, document.aspect())).is_some()
}

fn cursor(grip: Grip, is_held: bool) -> CursorIcon {
    match grip {
        Grip::Radius => CursorIcon::ResizeHorizontal,
        Grip::Level => CursorIcon::Move,
        Grip::Centre if is_held => CursorIcon::Grabbing,
        Grip::Centre => CursorIcon::Grab,
    }
}

#[cfg(test)]
mod tests;
