//! Tests of drags of spheres and of places for new ones.

use super::*;
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
