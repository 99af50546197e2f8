//! The spheres of the scene: selecting and dragging them.

use crate::harness::{drag, drag_from, has_samples, open, send, until};
use crate::questions::Ask as _;
use eframe::egui::{self, Modifiers, PointerButton, Pos2};
use egui_kittest::Harness;
use glam::DVec3;
use weekender::app::{Command, Window};
use weekender::scene::{Material, Sphere};

/// A ground, a sphere of glass with a bubble in it, one of fuzzy metal, and a matte one in the middle.
const SCENE: &str = "--stage glass-schlick --size 64x36";

pub fn opened() -> Harness<'static, Window> {
    let mut harness = open(SCENE);
    until(&mut harness, "a picture", has_samples(1));
    harness
}

pub fn spheres(harness: &Harness<'_, Window>) -> Vec<Sphere> {
    harness.state().shown_document().scene().spheres.clone()
}

pub fn material(harness: &Harness<'_, Window>, sphere: usize) -> Material {
    let scene = harness.state().shown_document().scene();
    *scene.material_of(&scene.spheres[sphere])
}

/// The sphere with its centre nearest to `center`.
fn sphere_at(harness: &Harness<'_, Window>, center: DVec3) -> usize {
    let spheres = spheres(harness);
    let nearest = |a: &usize, b: &usize| {
        spheres[*a].center.distance(center).total_cmp(&spheres[*b].center.distance(center))
    };
    (0..spheres.len()).min_by(nearest).unwrap()
}

pub fn middle_sphere(harness: &Harness<'_, Window>) -> usize {
    sphere_at(harness, DVec3::new(0.0, 0.0, -1.2))
}

pub fn metal_sphere(harness: &Harness<'_, Window>) -> usize {
    sphere_at(harness, DVec3::new(1.0, 0.0, -1.0))
}

/// Where a point of the scene is on the screen.
pub fn on_screen(harness: &Harness<'_, Window>, point: DVec3) -> Pos2 {
    let document = harness.state().shown_document();
    let [x, y] = document.camera.place_of(point, document.aspect()).unwrap();
    harness.state().picture_rect().lerp_inside(egui::vec2(x as f32, y as f32))
}

pub fn click(harness: &mut Harness<'_, Window>, pos: Pos2, modifiers: Modifiers) {
    harness.event(egui::Event::PointerMoved(pos));
    harness.step();
    for pressed in [true, false] {
        let button = PointerButton::Primary;
        harness.event_modifiers(egui::Event::PointerButton { pos, button, pressed, modifiers }, modifiers);
        harness.step();
    }
    // A second click at once would be a double click.
    harness.run_steps(40);
}

pub fn select(harness: &mut Harness<'_, Window>, sphere: usize) {
    let at = on_screen(harness, spheres(harness)[sphere].center);
    click(harness, at, Modifiers::NONE);
    assert_eq!(harness.state().selected(), Some(sphere));
}

#[test]
fn a_click_selects_and_a_click_on_the_sky_deselects() {
    let mut harness = opened();
    let before = harness.state().shown_document().clone();
    let (middle, metal) = (middle_sphere(&harness), metal_sphere(&harness));
    select(&mut harness, metal);
    select(&mut harness, middle);
    let sky = harness.state().picture_rect().lerp_inside(egui::vec2(0.5, 0.03));
    click(&mut harness, sky, Modifiers::NONE);
    assert_eq!(harness.state().selected(), None);
    assert!(*harness.state().shown_document() == before, "selecting changes nothing");
}

#[test]
fn a_drag_moves_the_selected_sphere_and_nothing_else() {
    let mut harness = opened();
    let metal = metal_sphere(&harness);
    let (before, camera) = (spheres(&harness), harness.state().shown_document().camera);
    let at = on_screen(&harness, before[metal].center);
    // A sphere that is not selected is not grasped: the drag turns the camera.
    drag_from(&mut harness, at, egui::vec2(20.0, 0.0));
    assert_eq!(spheres(&harness), before);
    assert_ne!(harness.state().shown_document().camera, camera);
    send(&mut harness, Command::Home);

    select(&mut harness, metal);
    let by = egui::vec2(-60.0, -40.0);
    drag_from(&mut harness, at, by);
    let (after, document) = (spheres(&harness), harness.state().shown_document().clone());
    assert_eq!(document.camera, camera, "the camera stays");
    assert!(on_screen(&harness, after[metal].center).distance(at + by) < 1.5, "it follows the pointer");
    let moved = after[metal].center - before[metal].center;
    assert!(moved.dot(camera.basis().w).abs() < 1e-9, "parallel to the picture");
    let rest = |spheres: &[Sphere]| {
        let mut rest = spheres.to_vec();
        rest[metal].center = DVec3::ZERO;
        rest
    };
    assert_eq!(rest(&after), rest(&before));
    assert_eq!(document.job(1).unwrap().scene().spheres, after, "the job has the new centre");
    until(&mut harness, "the picture of the changed scene", has_samples(1));

    // The whole drag is one step.
    send(&mut harness, Command::Undo);
    assert_eq!(spheres(&harness), before);
    assert!(!harness.state().shown_document().has_changed_scene());
    send(&mut harness, Command::Redo);
    assert_eq!(spheres(&harness), after);
    assert_eq!(harness.state().selected(), Some(metal));
}

/// It stays on what it stands on; with Ctrl it goes anywhere.
#[test]
fn a_dragged_ball_stays_on_its_level() {
    let mut harness = open("--stage metal --size 64x36 --device cpu");
    send(&mut harness, Command::NewScene);
    until(&mut harness, "a picture", has_samples(1));
    select(&mut harness, 1);
    let before = spheres(&harness)[1].center;
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE);
    let after = spheres(&harness)[1].center;
    assert!((after.y - before.y).abs() < 1e-9 && after.distance(before) > 0.1, "{before} {after}");
    drag(&mut harness, PointerButton::Primary, Modifiers::COMMAND);
    assert!((spheres(&harness)[1].center.y - after.y).abs() > 0.1);
}

#[test]
fn the_handle_changes_the_radius() {
    let mut harness = opened();
    let middle = middle_sphere(&harness);
    let before = spheres(&harness)[middle];
    select(&mut harness, middle);
    // The camera looks straight at this sphere, so its outline is a circle, and the handle is to the right.
    let centre = on_screen(&harness, before.center);
    let distance = before.center.length();
    let outline = |radius: f64| {
        let angle = (radius / distance).asin();
        let camera = harness.state().shown_document().camera;
        let half = (camera.vfov_degrees.to_radians() / 2.0).tan();
        (angle.tan() / half) as f32 * harness.state().picture_rect().height() / 2.0
    };
    let handle = centre + egui::vec2(outline(before.radius), 0.0);
    let to = outline(0.7 * before.radius) - outline(before.radius);
    drag_from(&mut harness, handle, egui::vec2(to, 0.0));
    let after = spheres(&harness)[middle];
    assert_eq!(after.center, before.center);
    assert!((after.radius / before.radius - 0.7).abs() < 0.01, "{} {}", before.radius, after.radius);
    send(&mut harness, Command::Undo);
    assert_eq!(spheres(&harness)[middle], before);
    // Grabbed beside its middle, it moves as far as the pointer and does not jump.
    let beside = handle + egui::vec2(6.0, 0.0);
    drag_from(&mut harness, beside, egui::vec2(to, 0.0));
    let beside = spheres(&harness)[middle];
    assert!((beside.radius / after.radius - 1.0).abs() < 0.005, "{} {}", after.radius, beside.radius);
}
