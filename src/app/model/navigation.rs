//! Camera movement. Each function takes a camera and returns a new one. A move that would give an invalid camera is
//! not made.

use super::spheres::{clearance, ground};
use crate::numbers::rounded;
use crate::scene::{Camera, Scene};
use glam::{DQuat, DVec3};
use std::f64::consts::PI;

/// The view direction stays at least this far from the poles, so that left stays left.
const POLE_DEGREES: f64 = 1.0;

/// Turns camera and `look_at` about `pivot`, which stays where it is in the picture: `right` and `up` in radians, in the
/// direction in which the scene appears to turn.
pub fn orbit(camera: &Camera, pivot: DVec3, right: f64, up: f64) -> Camera {
    let turn = rotation(camera, -right, up);
    let [look_from, look_at] = [camera.look_from, camera.look_at].map(|at| pivot + turn * (at - pivot));
    kept(camera, Camera { look_from, look_at, ..*camera })
}

/// Turns the camera in place: `right` and `up` in radians.
pub fn look(camera: &Camera, right: f64, up: f64) -> Camera {
    orbit(camera, camera.look_from, right, -up)
}

/// A point in the same direction as `point`, not much farther away than what the camera looks at: a turn about the horizon
/// would throw the eye out of the scene.
pub fn within_reach(camera: &Camera, point: DVec3) -> DVec3 {
    /// How far the pivot of an orbit is at most, in distances to `look_at`.
    const REACH: f64 = 2.0;
    let (away, reach) = (point - camera.look_from, REACH * camera.look_from.distance(camera.look_at));
    camera.look_from + away * (reach / away.length()).min(1.0)
}

/// [`orbit`], but `up` only as far as the eye stays above the opaque ground that it is above of.
pub fn orbit_above_ground(camera: &Camera, pivot: DVec3, right: f64, up: f64, scene: &Scene) -> Camera {
    /// The least height of the eye, in distances to `look_at`; an eye that is lower keeps its height.
    const FLOOR: f64 = 0.02;
    let floor = FLOOR * camera.look_from.distance(camera.look_at);
    let heights: Vec<_> =
        ground(scene, camera).map(|sphere| (sphere, clearance(sphere, camera.look_from))).collect();
    let is_above = |moved: &Camera| {
        let low = |height: f64| height.min(floor) - 1e-6 * floor;
        heights.iter().all(|(sphere, height)| clearance(sphere, moved.look_from) >= low(*height))
    };
    // As far up as possible, or where the ground curves up, a little higher.
    let ups = [1.0, 0.5, 0.25, 0.125, 0.0].map(|share| share * up).into_iter().chain([0.005, 0.02, 0.05]);
    ups.map(|up| orbit(camera, pivot, right, up)).find(is_above).unwrap_or(*camera)
}

/// Moves along the line through `point`, which stays where it is in the picture: to `factor` times its distance. The
/// distance in focus changes by the same factor. So does that of `look_at`, which a camera that comes closer also brings
/// nearer to the depth of `point`: flying and turning then suit what it has come to.
pub fn dolly(camera: &Camera, point: DVec3, factor: f64) -> Camera {
    /// The least distance to `point`, as a share of its coordinates. Closer, rounding would turn the camera.
    const LEAST: f64 = 1e-9;
    let look_from = point + (camera.look_from - point) * factor;
    if factor < 1.0 && look_from.distance(point) < LEAST * point.abs().max_element() {
        return *camera;
    }
    let ahead = camera.look_at - camera.look_from;
    let (distance, depth) = (ahead.length(), camera.depth_of(point));
    let share = if depth > 0.0 { (distance / depth).powf(factor.min(1.0) - 1.0) } else { 1.0 };
    let look_at = look_from + ahead * (factor * share);
    let focus_distance = camera.focus_distance.map(|distance| distance * factor);
    kept(camera, Camera { look_from, look_at, focus_distance, ..*camera })
}

/// The point under `place` of the picture at the depth of `look_at`: what the wheel moves to where there is only sky.
pub fn at_depth(camera: &Camera, place: [f64; 2], aspect: f64) -> DVec3 {
    let direction = camera.direction_through(place, aspect);
    let ahead = camera.look_at - camera.look_from;
    camera.look_from + direction * (ahead.length_squared() / ahead.dot(direction))
}

/// Moves the camera and `look_at`: `by` is right, up and forward, in scene units.
pub fn fly(camera: &Camera, by: DVec3) -> Camera {
    let basis = camera.basis();
    let offset = by.x * basis.u + by.y * basis.v - by.z * basis.w;
    // What is in focus stays so.
    let is_lens = camera.defocus_angle_degrees > 0.0;
    let focused =
        Some(camera.effective_focus_distance() - by.z).filter(|distance| is_lens && *distance > 0.0);
    let (look_from, look_at) = (camera.look_from + offset, camera.look_at + offset);
    kept(camera, Camera { look_from, look_at, focus_distance: focused.or(camera.focus_distance), ..*camera })
}

/// Looks at `point` from the current position.
pub fn recentre(camera: &Camera, point: DVec3) -> Camera {
    kept(camera, Camera { look_at: point, ..*camera })
}

/// Focuses on the plane through `point`.
pub fn focus(camera: &Camera, point: DVec3) -> Camera {
    kept(camera, Camera { focus_distance: Some(camera.depth_of(point)), ..*camera })
}

/// The turn that rotates the view about `vup`, then brings the eye `up` towards it, as far as the poles allow.
fn rotation(camera: &Camera, about_up: f64, up: f64) -> DQuat {
    let Some(axis) = camera.vup.try_normalize() else { return DQuat::IDENTITY };
    let level = DQuat::from_axis_angle(axis, about_up);
    let back = level * camera.basis().w;
    let Some(side) = back.cross(axis).try_normalize() else { return level };
    let angle_to_up = back.angle_between(axis);
    let pole = POLE_DEGREES.to_radians();
    let wanted = (angle_to_up - up).clamp(pole, PI - pole);
    DQuat::from_axis_angle(side, angle_to_up - wanted) * level
}

fn kept(old: &Camera, new: Camera) -> Camera {
    let scale = new.look_from.abs().max_element().max(new.look_at.abs().max_element());
    // To thirteen digits, without what rounding adds and the sign of a zero.
    let tidy = |point: DVec3| point.map(|n| rounded(n, scale, 13) + 0.0);
    let new = Camera {
        look_from: if new.look_from == old.look_from { old.look_from } else { tidy(new.look_from) },
        look_at: if new.look_at == old.look_at { old.look_at } else { tidy(new.look_at) },
        ..new
    };
    if new.validate().is_ok() { new } else { *old }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const CAMERA: Camera =
        Camera { look_from: DVec3::new(0.0, 0.0, 4.0), look_at: DVec3::ZERO, ..Camera::BOOK };

    #[test]
    fn moves_go_where_they_say() {
        let close = |a: DVec3, b: DVec3| assert!(a.distance(b) < 1e-9, "{a} {b}");
        let quarter = std::f64::consts::FRAC_PI_2;
        close(orbit(&CAMERA, DVec3::ZERO, quarter, 0.0).look_from, DVec3::new(-4.0, 0.0, 0.0));
        close(look(&CAMERA, quarter, 0.0).look_at, DVec3::new(4.0, 0.0, 4.0));
        let (sine, cosine) = 0.3_f64.sin_cos();
        close(orbit(&CAMERA, DVec3::ZERO, 0.0, 0.3).look_from, 4.0 * DVec3::new(0.0, sine, cosine));
        close(look(&CAMERA, 0.0, 0.3).look_at, 4.0 * DVec3::new(0.0, sine, 1.0 - cosine));
        close(dolly(&CAMERA, DVec3::ZERO, 0.5).look_from, DVec3::new(0.0, 0.0, 2.0));
        let flown = fly(&CAMERA, DVec3::new(1.0, 2.0, 3.0));
        close(flown.look_from, DVec3::new(1.0, 2.0, 1.0));
        close(flown.look_at, DVec3::new(1.0, 2.0, -3.0));
        let lens = Camera { defocus_angle_degrees: 1.0, ..CAMERA };
        let distances = [1.0, -2.0, 9.0].map(|forward| fly(&lens, DVec3::Z * forward).focus_distance);
        assert_eq!(distances, [Some(3.0), Some(6.0), None], "what is in focus stays so, unless it is passed");
        assert_eq!(focus(&CAMERA, DVec3::new(9.0, 9.0, 1.0)).focus_distance, Some(3.0));
        assert_eq!(recentre(&CAMERA, CAMERA.look_from), CAMERA, "no direction: not made");
        assert_eq!(focus(&CAMERA, DVec3::new(0.0, 0.0, 5.0)), CAMERA, "behind the eye: not made");
    }

    /// Having come close, the camera looks at a point about as far away as what it has come to.
    #[test]
    fn a_dolly_leads_look_at_to_the_depth_of_its_point() {
        for depth in [0.5, 80.0] {
            let point = CAMERA.look_from - DVec3::Z * depth;
            let mut camera = CAMERA;
            let step = |camera: &mut Camera, factor| {
                let before = camera.effective_focus_distance();
                *camera = dolly(camera, point, factor);
                camera.effective_focus_distance() / before
            };
            for _ in 0..30 {
                let share = step(&mut camera, 0.9);
                assert!((0.7..=1.3).contains(&share), "{depth}: a jump by {share}");
            }
            let ratio = camera.effective_focus_distance() / camera.depth_of(point);
            assert!((0.8..1.25).contains(&ratio), "{depth}: {ratio}");
            for _ in 0..30 {
                assert!(
                    (step(&mut camera, 1.1) - 1.1).abs() < 1e-9,
                    "{depth}: away, both distances grow alike"
                );
            }
        }
        assert_eq!(dolly(&CAMERA, CAMERA.look_from, 0.5).look_from, CAMERA.look_from);
    }

    #[test]
    fn an_orbit_leaves_no_dust() {
        let turned = orbit(&CAMERA, DVec3::ZERO, 0.5, 0.0);
        assert_eq!((turned.look_from.y, turned.look_at), (0.0, DVec3::ZERO));
        let back = orbit(&orbit(&CAMERA, DVec3::ZERO, 0.7, 0.2), DVec3::ZERO, -0.7, -0.2);
        assert_eq!(back.look_from, CAMERA.look_from);
    }

    /// The camera of the last picture of the book is 2 above the ground and looks far over it.
    #[test]
    fn no_orbit_leads_into_the_ground_or_out_of_the_scene() {
        let stage = crate::stages::Stage::find("book").unwrap();
        let (scene, home) = ((stage.setup.scene)(), stage.setup.camera);
        let ground = scene.spheres.iter().max_by(|a, b| a.radius.total_cmp(&b.radius)).unwrap();
        let mut camera = home;
        for _ in 0..40 {
            camera = orbit_above_ground(&camera, home.look_at, 0.02, -0.1, &scene);
            assert!(clearance(ground, camera.look_from) > 0.2, "{:?}", camera.look_from);
        }
        let horizon = home.look_from + 1e6 * home.direction_through([0.5, 0.5], 1.5);
        let pivot = within_reach(&home, horizon);
        let turned = orbit_above_ground(&home, pivot, 0.3, 0.2, &scene);
        assert!(turned.look_from.distance(home.look_from) < 2.0 * home.look_from.length(), "{turned:?}");
        assert_eq!(within_reach(&home, DVec3::ONE), home.look_from + (DVec3::ONE - home.look_from));
    }

    #[test]
    fn a_turn_ends_a_degree_before_the_poles() {
        for (up, degrees) in [(9.0, 1.0), (-9.0, 179.0)] {
            let eye = orbit(&CAMERA, DVec3::ZERO, 0.0, up).look_from;
            assert!((eye.angle_between(DVec3::Y).to_degrees() - degrees).abs() < 1e-6, "{up}: {eye}");
        }
    }

    #[test]
    fn the_sky_is_at_the_depth_of_look_at() {
        let point = at_depth(&CAMERA, [0.5, 0.5], 1.5);
        assert!(point.distance(CAMERA.look_at) < 1e-12);
        let point = at_depth(&CAMERA, [0.9, 0.2], 1.5);
        assert!((CAMERA.depth_of(point) - 4.0).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn turning_keeps_distances_and_never_turns_over(right in -9.0..9.0f64, up in -9.0..9.0f64) {
            for camera in [orbit(&CAMERA, CAMERA.look_at, right, up), look(&CAMERA, right, up)] {
                prop_assert!((camera.effective_focus_distance() - 4.0).abs() < 1e-9);
                prop_assert!(camera.basis().v.y > 0.0);
            }
        }

        #[test]
        fn the_pivot_of_an_orbit_stays_where_it_is(
            x in 0.0..1.0f64, y in 0.0..1.0f64, far in 0.1..50.0f64, right in -3.0..3.0f64, up in -3.0..3.0f64,
        ) {
            let pivot = CAMERA.look_from + far * CAMERA.direction_through([x, y], 1.5);
            let orbited = orbit(&CAMERA, pivot, right, up);
            prop_assert_eq!(orbited.vup, CAMERA.vup);
            prop_assert!((orbited.look_from.distance(pivot) / far - 1.0).abs() < 1e-9);
            prop_assert!((orbited.effective_focus_distance() - 4.0).abs() < 1e-9);
            prop_assert!(orbited.basis().v.y > 0.0);
            let place = orbited.place_of(pivot, 1.5).unwrap();
            prop_assert!((place[0] - x).abs() < 1e-7 && (place[1] - y).abs() < 1e-7, "{:?}", place);
        }

        #[test]
        fn what_a_dolly_goes_to_stays_where_it_is(
            x in 0.0..1.0f64, y in 0.0..1.0f64, far in 0.1..50.0f64, factor in 0.02..3.0f64,
        ) {
            let point = CAMERA.look_from + far * CAMERA.direction_through([x, y], 1.5);
            let camera = Camera { focus_distance: Some(3.0), ..CAMERA };
            let moved = dolly(&camera, point, factor);
            prop_assert!((moved.look_from.distance(point) / (far * factor) - 1.0).abs() < 1e-9);
            let place = moved.place_of(point, 1.5).unwrap();
            prop_assert!((place[0] - x).abs() < 1e-7 && (place[1] - y).abs() < 1e-7, "{:?}", place);
            prop_assert!((moved.effective_focus_distance() - 3.0 * factor).abs() < 1e-12);
        }
    }
}
