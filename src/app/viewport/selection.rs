//! The selected sphere in the picture: its outline, its handle, and drags of either.

use super::badge::badge;
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

    /// Draws the outline, the handle and the name of the selected sphere.
    pub(super) fn paint(&self, ui: &Ui, rect: Rect, clip: Rect, selected: Option<&Selected>) {
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
        let at = pos2(top.x, (top.y - 8.0).max(painter.clip_rect().top() + 34.0));
        badge(ui, painter, at, Align2::CENTER_BOTTOM, &text, &font);
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
mod tests {
    use super::*;
    use crate::app::model::origin::Origin;
    use crate::app::tests::{Drawings, dressed, leave};
    use crate::scene::Material;
    use crate::stages::Stage;
    use eframe::egui::{Event, Modifiers, Sense};
    use egui_kittest::Harness;
    use glam::DVec3;

    const RECT: Rect = Rect { min: pos2(20.0, 10.0), max: pos2(340.0, 190.0) };

    struct Picture {
        document: Document,
        selected: Option<Selected>,
        selection: Selection,
        is_held: bool,
        edits: Vec<Edit>,
        cursor: CursorIcon,
    }

    /// A picture of a stage in which a sphere is selected.
    fn picture(stage: &str, sphere: usize) -> Harness<'static, Picture> {
        let document = Document::new(Origin::of_stage(Stage::find(stage).unwrap()));
        let selected = selected(&document, sphere);
        let draw = |ui: &mut Ui, picture: &mut Picture| {
            let Picture { document, selected, selection, is_held, edits, cursor } = picture;
            let response = ui.allocate_rect(RECT, Sense::click_and_drag());
            let (held, edit) = selection.handle(ui, &response, RECT, selected.as_ref(), document);
            *is_held = held;
            edits.extend(edit);
            selection.paint(ui, RECT, RECT, selected.as_ref());
            *cursor = ui.ctx().output(|output| output.cursor_icon);
        };
        let picture = Picture {
            document,
            selected: Some(selected),
            selection: Selection::default(),
            is_held: false,
            edits: Vec::new(),
            cursor: CursorIcon::Default,
        };
        dressed([360.0, 200.0]).build_ui_state(draw, picture)
    }

    fn selected(document: &Document, sphere: usize) -> Selected {
        let body = Body::of(document.scene(), sphere).unwrap();
        let count = document.scene().spheres.len();
        Selected { sphere, body, material: "a material".to_owned(), count }
    }

    fn at(harness: &mut Harness<'_, Picture>, pos: Pos2) {
        harness.event(Event::PointerMoved(pos));
        harness.run_steps(1);
    }

    fn button(harness: &mut Harness<'_, Picture>, pos: Pos2, pressed: bool, modifiers: Modifiers) {
        let button = PointerButton::Primary;
        harness.event(Event::PointerMoved(pos));
        harness.event_modifiers(Event::PointerButton { pos, button, pressed, modifiers }, modifiers);
        harness.run_steps(1);
    }

    /// Where the handle of the selected sphere is on the screen.
    fn handle(harness: &Harness<'_, Picture>) -> Pos2 {
        harness.state().selection.handle_at(RECT).unwrap().0
    }

    #[test]
    fn spheres_are_outlined_and_named() {
        let mut drawings = Drawings::default();
        for stage in ["metal", "hollow-glass", "view-close"] {
            let count = picture(stage, 0).state().selected.as_ref().map_or(0, |selected| selected.count);
            for sphere in 0..count {
                drawings.add(&format!("{stage} {sphere}"), &picture(stage, sphere));
            }
        }
        let mut harness = picture("metal", 1);
        for (name, center, radius) in [
            ("behind another", DVec3::new(0.0, 0.0, -4.0), 1.5),
            ("behind the eye", DVec3::new(0.0, 0.0, 3.0), 0.5),
            ("tiny", DVec3::new(0.5, 0.5, -1.0), 0.01),
            ("all around the eye", DVec3::ZERO, 2.0),
            ("far to the left", DVec3::new(-3.5, 0.0, -1.0), 0.5),
            ("above", DVec3::new(0.0, 1.2, -1.0), 0.4),
        ] {
            let picture = harness.state_mut();
            let material = Material::Lambertian { albedo: DVec3::splat(0.5) };
            picture.selected.as_mut().unwrap().body = Body { center, radius, material };
            harness.run_steps(2);
            drawings.add(name, &harness);
        }
        harness.state_mut().selected = None;
        harness.run_steps(2);
        drawings.add("none", &harness);
        assert!(harness.state().selection.drawn.is_none());
        drawings.keep("selections");
    }

    #[test]
    fn the_pointer_shows_what_a_drag_would_do() {
        let mut harness = picture("metal", 1);
        let mut drawings = Drawings::default();
        drawings.add("the pointer is elsewhere", &harness);
        let (middle, handle) = (RECT.center(), handle(&harness));
        at(&mut harness, middle);
        assert_eq!(harness.state().cursor, CursorIcon::Grab);
        at(&mut harness, handle + vec2(GRIP - 0.5, 0.0));
        assert_eq!(harness.state().cursor, CursorIcon::ResizeHorizontal);
        drawings.add("at the handle", &harness);
        at(&mut harness, RECT.left_top() + vec2(5.0, 5.0));
        assert_eq!(harness.state().cursor, CursorIcon::Default, "the sky");
        assert!(!harness.state().is_held && harness.state().edits.is_empty());
        drawings.keep("selection_pointer");
    }

    #[test]
    fn drags_move_and_resize_the_sphere() {
        let mut drawings = Drawings::default();
        for (name, from_handle, modifiers, cursor) in [
            ("its centre", false, Modifiers::NONE, CursorIcon::Grabbing),
            ("level", false, Modifiers::COMMAND, CursorIcon::Move),
            ("its radius", true, Modifiers::NONE, CursorIcon::ResizeHorizontal),
        ] {
            let mut harness = picture("metal", 1);
            let before = harness.state().selected.clone().unwrap().body;
            // From above, where a level drag leads somewhere.
            harness.state_mut().document.camera.look_from.y = 0.5;
            harness.run_steps(1);
            let from = if from_handle { handle(&harness) } else { RECT.center() };
            let to = from + vec2(16.0, 0.0);
            button(&mut harness, from, true, modifiers);
            harness.event_modifiers(Event::PointerMoved(to), modifiers);
            harness.run_steps(1);
            assert!(harness.state().is_held && harness.state().cursor == cursor, "{name}");
            drawings.add(name, &harness);
            let Some(Edit::Change(1, body)) = harness.state().edits.last().copied() else { panic!("{name}") };
            assert_eq!(body.radius > before.radius, from_handle, "{name}: {body:?}");
            // The picture is 400 pixels wide for 320 points, and a unit at the sphere's distance takes 90 points.
            assert_eq!(body.center.x > before.center.x + 0.05, !from_handle, "{name}: {body:?}");
            button(&mut harness, to, false, modifiers);
            leave(&mut harness);
            assert!(!harness.state().is_held && harness.state().selection.held.is_none());
        }
        drawings.keep("selection_drags");
    }

    #[test]
    fn drags_beside_the_sphere_or_with_shift_hold_nothing() {
        for (at, modifiers) in
            [(RECT.left_top() + vec2(5.0, 5.0), Modifiers::NONE), (RECT.center(), Modifiers::SHIFT)]
        {
            let mut harness = picture("metal", 1);
            button(&mut harness, at, true, modifiers);
            harness.event_modifiers(Event::PointerMoved(at + vec2(16.0, 0.0)), modifiers);
            harness.run_steps(1);
            assert!(!harness.state().is_held && harness.state().edits.is_empty(), "{modifiers:?}");
        }
    }

    #[test]
    fn a_sphere_that_looks_larger_than_pictures_is_not_dragged() {
        let mut harness = picture("metal", 0);
        assert!(harness.state().selection.extent().is_none(), "the ground");
        button(&mut harness, RECT.center_bottom() - vec2(0.0, 5.0), true, Modifiers::NONE);
        let to = RECT.center_bottom() - vec2(20.0, 5.0);
        harness.event(Event::PointerMoved(to));
        harness.run_steps(1);
        assert!(!harness.state().is_held);
    }
}
