//! The selected sphere in the picture: its outline, its handle, and drags of either.

use super::placement::{place_at, point_at};
use crate::app::commands::{Command, PanelContext, Snapshot};
use crate::app::model::spheres::grip::{Grip, Held};
use crate::app::model::spheres::silhouette::Outline;
use crate::app::model::spheres::{MANY, Selected};
use crate::app::model::{Body, Document, Edit};
use crate::app::toolkit::number::{compact, point_words};
use crate::app::toolkit::overlay::plate;
use crate::app::toolkit::theme;
use eframe::egui::{
    Align2, Color32, CursorIcon, PointerButton, Pos2, Rect, Response, Shape, Stroke, Ui, vec2,
};
use glam::DVec3;

/// How close the pointer must be to the handle to grab it, in points.
const GRIP: f32 = 9.0;

/// The handle of a sphere that looks smaller than this is beside its outline, in points.
const SMALL: f32 = 16.0;

/// A sphere that looks larger than this many pictures is not dragged: drags on the ground turn the camera.
const LARGEST: f64 = 1.5;

/// The sphere that the user drags.
#[derive(Default)]
pub(super) struct Selection(Option<Held>);

impl Selection {
    /// Handles drags of the selected sphere in the picture at `rect`. Returns whether the user holds it, and whether it
    /// changes.
    pub fn handle(&mut self, ui: &Ui, response: &Response, rect: Rect, cx: &PanelContext) -> (bool, bool) {
        let before = self.0.take();
        let Some(selected) = Selected::of(&cx.model) else { return (false, false) };
        let document = cx.document();
        let (modifiers, origin) = ui.input(|input| (input.modifiers, input.pointer.press_origin()));
        let grasped = |at: Option<Pos2>| {
            grasped(rect, &selected, document, at.filter(|_| !modifiers.shift)?, modifiers.command)
        };
        let is_begin = response.drag_started_by(PointerButton::Primary);
        let held = if is_begin { grasped(origin) } else { before };
        let is_dragged = response.dragged_by(PointerButton::Primary);
        self.0 = held.filter(|held| is_dragged && held.sphere == selected.sphere);
        if let Some(held) = &self.0 {
            ui.ctx().set_cursor_icon(cursor(held.grip, true));
            let Some(at) = response.interact_pointer_pos() else { return (true, false) };
            let body = held.dragged(&document.camera, document.aspect(), place_at(rect, at));
            let is_changed = body != selected.body;
            if is_changed {
                cx.send(Command::Edit(Edit::Change(selected.sphere, body)));
            }
            return (true, is_changed);
        }
        let is_small = document.scene().spheres.len() <= MANY;
        if let Some(held) = grasped(response.hover_pos().filter(|_| is_small && !response.dragged())) {
            ui.ctx().set_cursor_icon(cursor(held.grip, false));
        }
        (false, false)
    }

    /// Draws the outline, the handle and the name of the selected sphere.
    pub fn paint(&self, ui: &Ui, (rect, clip): (Rect, Rect), document: &Document, snapshot: &Snapshot) {
        let Some(selected) = Selected::of(&snapshot.model) else { return };
        let painter = &ui.painter().with_clip_rect(clip);
        let outline = outline(&selected, document);
        // Points far outside are left out: their lines would not be seen, and their coordinates have no precision.
        let near = |place: &[f64; 2]| place.iter().all(|along| along.abs() < 30.0);
        let points = outline.0.iter().chain(outline.0.first());
        let points: Vec<_> =
            points.map(|place| place.filter(near).map(|place| point_at(rect, place))).collect();
        for line in points.split(Option::is_none) {
            let line: Vec<_> = line.iter().copied().flatten().collect();
            painter.add(Shape::line(line.clone(), Stroke::new(4.0, Color32::from_black_alpha(150))));
            painter.add(Shape::line(line, Stroke::new(2.0, Color32::WHITE)));
        }
        if let Some((at, _)) = handle_at(rect, &outline) {
            let pointer = ui.input(|input| input.pointer.hover_pos());
            let is_near = || pointer.is_some_and(|to| to.distance(at) < GRIP);
            let is_hot = self.0.map_or_else(is_near, |held| held.grip == Grip::Radius);
            let fill = if is_hot { theme::colours(ui).accent } else { Color32::WHITE };
            painter.circle(at, 5.0, fill, Stroke::new(1.5, Color32::from_black_alpha(190)));
        }
        let Body { center, radius, .. } = selected.body;
        let text = match self.0.map(|held| held.grip) {
            Some(Grip::Radius) => format!("Radius {}", compact(radius)),
            Some(_) => format!("Centre {}", point_words(center)),
            None => selected.material.clone(),
        };
        let in_sight = points.into_iter().flatten().filter(|at| clip.contains(*at));
        let around = Rect::from_points(&in_sight.collect::<Vec<_>>());
        let top = if around.is_finite() { around.center_top() } else { clip.center_top() };
        plate(ui, painter, top - vec2(0.0, 8.0), Align2::CENTER_BOTTOM, &text, f32::INFINITY);
    }
}

fn outline(selected: &Selected, document: &Document) -> Outline {
    let Body { center, radius, .. } = selected.body;
    Outline::new(&document.camera, document.aspect(), center, radius)
}

/// The part that a drag from this point of the screen would hold.
fn grasped(rect: Rect, selected: &Selected, document: &Document, at: Pos2, is_free: bool) -> Option<Held> {
    /// At its own height, the eye sees a level plane from its edge.
    const EDGE: f64 = 0.05;
    let outline = outline(selected, document);
    extent(&outline)?;
    let start = place_at(rect, at);
    let towards = (selected.body.center - document.camera.look_from).normalize_or_zero();
    let is_level = !is_free && towards.dot(document.camera.vup.normalize_or(DVec3::Y)).abs() > EDGE;
    let grip = if is_level { Grip::Level } else { Grip::Centre };
    let held = Held { grip, sphere: selected.sphere, before: selected.body, start, offset: [0.0; 2] };
    if let Some((handle, place)) = handle_at(rect, &outline)
        && handle.distance(at) < GRIP
    {
        let offset = [0, 1].map(|axis| place[axis] - start[axis]);
        return Some(Held { grip: Grip::Radius, offset, ..held });
    }
    let pick = document.pick(&document.camera, start);
    pick.is_some_and(|pick| pick.sphere == selected.sphere).then_some(held)
}

/// The lower and upper corner of the outline in the picture, if the sphere is small enough to be dragged.
fn extent(outline: &Outline) -> Option<[[f64; 2]; 2]> {
    let [low, high] = outline.bounds()?;
    (0..2).all(|axis| high[axis] - low[axis] < LARGEST).then_some([low, high])
}

/// The handle of the radius: its point on the screen, and the point of the outline that it moves.
fn handle_at(rect: Rect, outline: &Outline) -> Option<(Pos2, [f64; 2])> {
    let [low, high] = extent(outline)?;
    let is_in_sight = |place: &[f64; 2]| place.iter().all(|along| (0.01..0.99).contains(along));
    let place = outline.quarters().find(is_in_sight)?;
    let middle = point_at(rect, [0, 1].map(|axis| 0.5 * (low[axis] + high[axis])));
    let at = point_at(rect, place);
    let beside = (SMALL - at.distance(middle)).max(0.0);
    Some((at + (at - middle).normalized() * beside, place))
}

fn cursor(grip: Grip, is_held: bool) -> CursorIcon {
    match grip {
        Grip::Radius => CursorIcon::ResizeHorizontal,
        Grip::Level => CursorIcon::Move,
        Grip::Centre if is_held => CursorIcon::Grabbing,
        Grip::Centre => CursorIcon::Grab,
    }
}
