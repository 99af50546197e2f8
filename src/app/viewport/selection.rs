//! The selected sphere in the picture: its outline, its handle, and drags of either.

use super::paint::label;
use super::{place_at, point_at};
use crate::app::model::document::Document;
use crate::app::model::edit::{Body, Edit};
use crate::app::spheres::Selected;
use crate::app::spheres::grip::{Grip, Held};
use crate::app::spheres::silhouette::{Outline, OutlinePoint};
use crate::app::theme;
use crate::app::widgets::{compact, point_words};
use crate::scene::{Camera, Scene};
use eframe::egui::{
    Align2, Color32, CursorIcon, Painter, PointerButton, Pos2, Rect, Response, Shape, Stroke, Ui, vec2,
};

/// How close the pointer must be to the handle to grab it, in points.
const GRIP: f32 = 9.0;

/// The handle of a sphere that looks smaller than this is beside its outline, in points.
const SMALL: f32 = 16.0;

/// A sphere that looks larger than this many pictures is not dragged: drags on the ground turn the camera.
const LARGEST: f64 = 1.5;

/// What is known about the selected sphere in the picture.
#[derive(Default)]
pub(super) struct Selection {
    /// The sphere that the user drags.
    held: Option<Held>,
    /// Its outline.
    drawn: Option<Drawn>,
}

/// The outline of the selected sphere, and what it was made for.
struct Drawn {
    /// The scene's address: an edited scene has another one.
    of: (*const Scene, Camera, f64, Body),
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
        let grasped = |selection: &Self, at: Option<Pos2>| {
            selection.grasped(rect, selected, document, at.filter(|_| !modifiers.shift)?, modifiers.command)
        };
        if response.drag_started_by(PointerButton::Primary) {
            self.held = grasped(self, origin);
        }
        let is_held =
            |held: &&Held| response.dragged_by(PointerButton::Primary) && held.sphere == selected.sphere;
        if let Some(held) = self.held.as_ref().filter(is_held) {
            ui.ctx().set_cursor_icon(cursor(held.grip, true));
            let edit = response.interact_pointer_pos().and_then(|at| {
                let body = held.dragged(&document.camera, document.aspect(), place_at(rect, at));
                (body != selected.body).then_some(Edit::Change(selected.sphere, body))
            });
            return (true, edit);
        }
        if let Some(held) = grasped(self, response.hover_pos().filter(|_| !response.dragged())) {
            ui.ctx().set_cursor_icon(cursor(held.grip, false));
        }
        self.held = None;
        (false, None)
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
        let grip = if is_level { Grip::Level } else { Grip::Centre };
        let held = Held { grip, sphere: selected.sphere, before: selected.body, start, offset: [0.0; 2] };
        if let Some((handle, place)) = self.handle_at(rect)
            && handle.distance(at) < GRIP
        {
            let offset = [0, 1].map(|axis| place[axis] - start[axis]);
            return Some(Held { grip: Grip::Radius, offset, ..held });
        }
        let pick = document.pick(&document.camera, start);
        pick.is_some_and(|pick| pick.sphere == selected.sphere).then_some(held)
    }

    /// The lower and upper corner of the outline in the picture, if the sphere is small enough to be dragged.
    fn extent(&self) -> Option<[[f64; 2]; 2]> {
        let [low, high] = self.drawn.as_ref()?.outline.bounds()?;
        (0..2).all(|axis| high[axis] - low[axis] < LARGEST).then_some([low, high])
    }

    /// The handle of the radius: its point on the screen, and the point of the outline that it moves.
    fn handle_at(&self, rect: Rect) -> Option<(Pos2, [f64; 2])> {
        let [low, high] = self.extent()?;
        let is_in_sight = |place: &[f64; 2]| place.iter().all(|along| (0.01..0.99).contains(along));
        let place = self.drawn.as_ref()?.outline.quarters().find(is_in_sight)?;
        let middle = point_at(rect, [0, 1].map(|axis| 0.5 * (low[axis] + high[axis])));
        let at = point_at(rect, place);
        let beside = (SMALL - at.distance(middle)).max(0.0);
        Some((at + (at - middle).normalized() * beside, place))
    }

    /// Makes the outline, unless the last one still holds.
    fn draw(&mut self, selected: &Selected, document: &Document) {
        let (scene, camera, aspect, body) =
            (document.scene(), document.camera, document.aspect(), selected.body);
        let of = (std::ptr::from_ref(scene), camera, aspect, body);
        if self.drawn.as_ref().is_none_or(|drawn| drawn.of != of) {
            let outline = Outline::new(&camera, aspect, body.center, body.radius, scene);
            self.drawn = Some(Drawn { of, outline });
        }
    }

    /// Draws the outline, the handle and the name of the selected sphere.
    pub(super) fn paint(&self, ui: &Ui, (rect, clip): (Rect, Rect), selected: Option<&Selected>) {
        let (Some(selected), Some(drawn)) = (selected, &self.drawn) else { return };
        let painter = &ui.painter().with_clip_rect(clip);
        paint_outline(&drawn.outline.points, painter, rect);
        let handle = self.handle_at(rect);
        if let Some((at, _)) = handle {
            let pointer = ui.input(|input| input.pointer.hover_pos());
            let is_near = || pointer.is_some_and(|to| to.distance(at) < GRIP);
            let is_hot = self.held.map_or_else(is_near, |held| held.grip == Grip::Radius);
            let fill = if is_hot { theme::accent(ui) } else { Color32::WHITE };
            painter.circle(at, 5.0, fill, Stroke::new(1.5, Color32::from_black_alpha(190)));
        }
        let Body { center, radius, .. } = selected.body;
        let text = match self.held.map(|held| held.grip) {
            Some(Grip::Radius) => format!("Radius {}", compact(radius)),
            Some(_) => format!("Centre {}", point_words(center)),
            None => selected.material.clone(),
        };
        let in_sight = drawn.outline.points.iter().filter_map(|point| point.place);
        let in_sight = in_sight.map(|place| point_at(rect, place)).filter(|at| clip.contains(*at));
        let around = Rect::from_points(&in_sight.collect::<Vec<_>>());
        let top = if around.is_finite() { around.center_top() } else { clip.center_top() };
        label(ui, painter, top - vec2(0.0, 8.0), Align2::CENTER_BOTTOM, &text);
    }
}

fn cursor(grip: Grip, is_held: bool) -> CursorIcon {
    match grip {
        Grip::Radius => CursorIcon::ResizeHorizontal,
        Grip::Level => CursorIcon::Move,
        Grip::Centre if is_held => CursorIcon::Grabbing,
        Grip::Centre => CursorIcon::Grab,
    }
}

/// Draws what is visible as a line, and what is hidden as dashes.
fn paint_outline(points: &[OutlinePoint], painter: &Painter, rect: Rect) {
    // Points far outside are left out: their lines would not be seen, and their coordinates have no precision.
    let near = |place: &[f64; 2]| place.iter().all(|along| along.abs() < 30.0);
    let place = |point: &OutlinePoint| point.place.filter(near).map(|place| point_at(rect, place));
    // From a point where visibility changes on, so that no run is cut where the list begins.
    let begin = points.iter().position(|point| point.is_visible != points[0].is_visible).unwrap_or(0);
    let around: Vec<_> = points.iter().cycle().skip(begin).take(points.len() + 1).collect();
    for run in around.chunk_by(|a, b| a.is_visible == b.is_visible) {
        let is_visible = run[0].is_visible;
        for line in run.split(|point| place(point).is_none()) {
            let line: Vec<_> = line.iter().filter_map(|point| place(point)).collect();
            for (wide, colour) in [(1.0, Color32::from_black_alpha(150)), (0.0, Color32::WHITE)] {
                if is_visible {
                    painter.add(Shape::line(line.clone(), Stroke::new(2.0 + 2.0 * wide, colour)));
                } else {
                    let stroke = Stroke::new(1.25 + 1.25 * wide, colour.gamma_multiply(0.7));
                    painter.extend(Shape::dashed_line(&line, stroke, 4.0, 5.0));
                }
            }
        }
    }
}
