//! Tests of drags of spheres and of places for new ones.

use super::*;
use crate::app::model::document::Document;
use crate::app::model::origin::Origin;
use crate::stages::Stage;
use proptest::prelude::*;

const BODY: Body = Body {
    center: DVec3::new(0.4, -0.2, -3.0),
    radius: 0.5,
    material: Material::Lambertian { albedo: DVec3::ONE },
};

fn held(grip: Grip, start: [f64; 2]) -> Held {
    Held { grip, sphere: 0, before: BODY, start, offset: [0.0; 2] }
}

proptest! {
    /// The point of the sphere's plane that was grasped stays under the pointer.
    #[test]
    fn a_sphere_follows_the_pointer(x in 0.2..0.8f64, y in 0.55..0.9f64, yaw in -0.4..0.4f64) {
        let camera = Camera { look_at: DVec3::new(yaw, -0.3, -1.0), ..Camera::BOOK };
        let start = camera.place_of(BODY.center, 1.5).unwrap();
        for (grip, normal) in [(Grip::Centre, camera.basis().w), (Grip::Level, DVec3::Y)] {
            let moved = held(grip, start).dragged(&camera, 1.5, [x, y]);
            let off = moved.center - BODY.center;
            if off == DVec3::ZERO {
                prop_assert_eq!(grip, Grip::Level, "only a level drag can lead nowhere");
                continue;
            }
            prop_assert!(off.dot(normal).abs() < 1e-9);
            prop_assert_eq!(moved.radius, BODY.radius);
            let place = camera.place_of(moved.center, 1.5).unwrap();
            prop_assert!((place[0] - x).abs() < 1e-9 && (place[1] - y).abs() < 1e-9, "{:?}", place);
        }
    }

    /// After a drag of the handle, the outline goes through the pointer.
    #[test]
    fn an_outline_follows_the_pointer(x in 0.0..1.0f64, y in 0.0..1.0f64) {
        let dragged = held(Grip::Radius, [0.5, 0.5]).dragged(&Camera::BOOK, 1.5, [x, y]);
        let mut scene = Scene::default();
        scene.add_sphere(dragged.center, dragged.radius, 0);
        prop_assert_eq!(dragged.center, BODY.center);
        let distance = BODY.center.length();
        let towards = Camera::BOOK.direction_through([x, y], 1.5);
        let sine = BODY.center.cross(towards).length() / distance;
        prop_assert!((dragged.radius / distance - sine.clamp(RADIUS_SHARE_LEAST, RADIUS_SHARE_LIMIT)).abs() < 1e-9);
    }
}

#[test]
fn a_copy_is_where_it_can_be_seen() {
    let mut scene = Scene::default();
    scene.add_sphere(DVec3::new(0.0, -100.5, -3.0), 100.0, 0);
    scene.add_sphere(DVec3::new(0.0, 0.0, -3.0), 0.5, 0);
    let to_copy = |scene: &Scene| to_copy(scene, &Camera::BOOK, 1.5, 1) / (0.5 * COPY_RADII);
    for (direction, obstacle) in [(DVec3::X, DVec3::X), (DVec3::NEG_X, DVec3::NEG_X), (DVec3::Y, DVec3::Y)] {
        assert!(to_copy(&scene).distance(direction) < 1e-12, "{direction}");
        scene.add_sphere(scene.spheres[1].center + obstacle, 0.5, 0);
    }
    assert!(to_copy(&scene).distance(DVec3::Z) < 1e-12, "towards the eye");
    let mut crowded = scene.clone();
    crowded.add_sphere(scene.spheres[1].center + DVec3::Z, 0.5, 0);
    assert!(to_copy(&crowded).distance(DVec3::Y) < 1e-12, "above it, not behind it");
    // Nothing else is in sight of a narrow lens.
    let narrow = Camera { vfov_degrees: 1.0, ..Camera::BOOK };
    assert_eq!(super::to_copy(&scene, &narrow, 1.5, 1).normalize(), DVec3::Z);
    assert_eq!(super::to_copy(&scene, &narrow, 1.5, 99), DVec3::ZERO);
    // The shell around a bubble of glass is no obstacle for a second bubble.
    let mut scene = Scene::default();
    scene.add_sphere(DVec3::new(0.0, 0.0, -3.0), 0.9, 0);
    scene.add_sphere(DVec3::new(0.0, 0.0, -3.0), 0.5, 0);
    assert!(super::to_copy(&scene, &Camera::BOOK, 1.5, 1).normalize().distance(DVec3::X) < 1e-12);
}

#[test]
fn a_copy_is_not_hidden() {
    let document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
    let (scene, camera) = (document.scene(), &document.camera);
    // All but the ground.
    for (index, sphere) in scene.spheres.iter().enumerate().filter(|(_, sphere)| sphere.radius < 10.0) {
        let center = sphere.center + to_copy(scene, camera, document.aspect(), index);
        let mut more = scene.clone();
        more.add_sphere(center, sphere.radius, sphere.material);
        let towards = (center - camera.look_from).normalize();
        let hit = more.pick(camera.look_from, towards).unwrap();
        assert_eq!(hit.sphere, scene.spheres.len(), "the copy of sphere {index}");
        assert!(camera.place_of(center, document.aspect()).is_some(), "the copy of sphere {index}");
    }
    // A wall between the eye and the free place at the right.
    let mut scene = Scene::default();
    scene.add_sphere(DVec3::new(0.0, 0.0, -3.0), 0.5, 0);
    scene.add_sphere(DVec3::new(0.55, 0.0, -1.5), 0.2, 0);
    let by = to_copy(&scene, &Camera::BOOK, 1.5, 0);
    assert!(by.normalize().distance(DVec3::NEG_X) < 1e-12, "{by}");
}

#[test]
fn a_copy_is_wholly_in_the_picture_if_it_can_be() {
    let mut scene = Scene::default();
    // The copy at its right would be cut off at the edge: half a picture is 4.5 wide at its distance.
    scene.add_sphere(DVec3::new(3.2, 0.0, -3.0), 0.5, 0);
    let by = to_copy(&scene, &Camera::BOOK, 1.5, 0);
    assert!(by.normalize().distance(DVec3::NEG_X) < 1e-12, "{by}");
    scene.add_sphere(scene.spheres[0].center + DVec3::NEG_X, 0.5, 0);
    let by = to_copy(&scene, &Camera::BOOK, 1.5, 0);
    assert!(by.normalize().distance(DVec3::Y) < 1e-12, "{by}");
    let mut ball = Scene::default();
    ball.add_sphere(DVec3::new(0.0, 0.0, -3.0), 2.9, 0);
    assert_ne!(to_copy(&ball, &Camera::BOOK, 1.5, 0), DVec3::ZERO, "none fits");
}

#[test]
fn a_level_drag_ends_at_the_horizon() {
    let above = held(Grip::Level, [0.5, 0.6]).dragged(&Camera::BOOK, 1.0, [0.5, 0.1]);
    assert_eq!(above, BODY);
}

#[test]
fn a_level_drag_ends_far_away() {
    // The plane is 0.2 under the eye, and the limit is eight times (3.03 + 0.5).
    let start = Camera::BOOK.place_of(BODY.center, 1.0).unwrap();
    let to = |along: f64| {
        let below = 0.2 / (along * along - 0.04).sqrt();
        held(Grip::Level, start).dragged(&Camera::BOOK, 1.0, [0.5, 0.5 + 0.5 * below])
    };
    for (along, is_moved) in [(28.2, true), (28.4, false)] {
        assert_eq!(to(along) != BODY, is_moved, "{along}");
    }
    let moved = to(28.2).center;
    assert!((moved.length() - 28.2).abs() < 1e-6 && (moved.y + 0.2).abs() < 1e-9, "{moved}");
}

#[test]
fn a_radius_stays_the_largest_where_the_pointer_is_beside_the_eye() {
    // From a sphere at the right edge to far to the left: more than a right angle.
    let center = DVec3::new(4.2, 0.0, -3.0);
    let held = Held { before: Body { center, ..BODY }, ..held(Grip::Radius, [0.5, 0.5]) };
    for to in [[0.0, 0.5], [-50.0, 0.5]] {
        let radius = held.dragged(&Camera::BOOK, 1.5, to).radius;
        assert!((radius / center.length() - RADIUS_SHARE_LIMIT).abs() < 1e-9, "{to:?}: {radius}");
    }
}

#[test]
fn a_copy_may_touch_others_and_glass_hides_nothing() {
    let mut scene = Scene::default();
    let matte = scene.add_material("matte", Material::Lambertian { albedo: DVec3::ONE });
    let glass = scene.add_material("glass", Material::Dielectric { refraction_index: 1.5 });
    let center = DVec3::new(0.0, 0.0, -3.0);
    scene.add_sphere(center, 0.5, matte);
    let copied = |other: DVec3, radius: f64, material: usize| {
        let mut scene = scene.clone();
        scene.add_sphere(other, radius, material);
        (to_copy(&scene, &Camera::BOOK, 1.5, 0) / (0.5 * COPY_RADII)).round()
    };
    // The copy would be 1.1 to the right. It may overlap by a twentieth of its radius.
    for (distance, direction) in [(0.98, DVec3::X), (0.97, DVec3::NEG_X)] {
        let other = center + DVec3::X * (1.1 + distance);
        assert_eq!(copied(other, 0.5, matte), direction, "{distance}");
    }
    // A ball between the eye and the copy.
    let between = DVec3::new(0.55, 0.0, -1.5);
    assert_eq!(copied(between, 0.2, matte), DVec3::NEG_X);
    assert_eq!(copied(between, 0.2, glass), DVec3::X);
}

#[test]
fn a_copy_is_not_too_near_to_the_eye() {
    // There is room only towards the eye, at 1.1 before the sphere.
    for (depth, direction) in [(2.15, DVec3::Z), (2.05, DVec3::Y)] {
        let mut scene = Scene::default();
        let center = DVec3::NEG_Z * depth;
        scene.add_sphere(center, 0.5, 0);
        for obstacle in [DVec3::X, DVec3::NEG_X, DVec3::Y] {
            scene.add_sphere(center + obstacle, 0.5, 0);
        }
        let by = to_copy(&scene, &Camera::BOOK, 1.5, 0);
        assert!(by.normalize().distance(direction) < 1e-12, "{depth}: {by}");
    }
}

#[test]
fn only_what_is_between_the_eye_and_a_sphere_is_before_it() {
    let is_before = |center: [f64; 3], radius: f64| {
        let sphere = Sphere { center: DVec3::from(center), radius, material: 0 };
        super::is_before(&sphere, DVec3::ZERO, DVec3::new(0.0, 0.0, -4.0), 0.5)
    };
    for (center, radius, expected) in [
        ([0.0, 0.0, -2.0], 0.2, true),
        ([0.19, 0.0, -2.0], 0.2, true),
        ([0.21, 0.0, -2.0], 0.2, false),
        ([0.0, 0.0, -3.6], 0.2, true),
        // It begins within the other one, or behind it.
        ([0.0, 0.0, -3.8], 0.2, false),
        ([0.0, 0.0, -6.0], 0.2, false),
        // It is behind the eye, or around it.
        ([0.0, 0.0, 2.0], 0.2, false),
        ([0.0, 0.0, -0.1], 0.5, false),
    ] {
        assert_eq!(is_before(center, radius), expected, "{center:?}");
    }
}

#[test]
fn a_new_sphere_is_as_large_in_the_picture_with_every_lens() {
    for vfov_degrees in [10.0, 40.0, 90.0, 130.0] {
        let camera = Camera { vfov_degrees, ..Camera::BOOK };
        let body = new_body(None, &camera, 1.5, [0.5, 0.5]);
        let top = body.center + body.radius * camera.basis().v;
        let share = 0.5 - camera.place_of(top, 1.5).unwrap()[1];
        // The radius has two digits.
        assert!((share / NEW_SHARE - 1.0).abs() < 0.06, "{vfov_degrees} degrees: {share}");
    }
}

#[test]
fn a_new_sphere_lies_on_what_is_there() {
    let mut scene = Scene::default();
    scene.add_sphere(DVec3::new(0.0, -100.5, -1.0), 100.0, 0);
    let at = |place| {
        let hit = scene.pick(Camera::BOOK.look_from, Camera::BOOK.direction_through(place, 1.5));
        new_body(hit, &Camera::BOOK, 1.5, place)
    };
    let lying = at([0.5, 0.8]);
    let gap = lying.center.distance(scene.spheres[0].center) - 100.0 - lying.radius;
    assert!(gap.abs() < 1e-9 && lying.radius > 0.01, "{lying:?}");
    // The picture is as high as twice the distance, and 0.09 of that is 0.18.
    let towards = Camera::BOOK.direction_through([0.5, 0.8], 1.5);
    let hit = scene.pick(Camera::BOOK.look_from, towards).unwrap();
    assert!((lying.radius / (0.18 * hit.distance) - 1.0).abs() < 0.06, "{lying:?} at {}", hit.distance);
    let floating = at([0.5, 0.1]);
    let there = Camera::BOOK.direction_through([0.5, 0.1], 1.5);
    assert!(floating.center.distance(there) < 1e-12 && (floating.radius - 0.18).abs() < 1e-12);
    assert_eq!((two_digits(0.012345), two_digits(6789.0)), (0.012, 6800.0));
}
