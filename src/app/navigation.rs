//! Camera movement. Each function takes a camera and returns a new one. A move that would give an invalid camera is
//! not made.

use crate::scene::Camera;
use glam::{DQuat, DVec3};

/// The view direction stays at least this far from the poles, so that left stays left.
const POLE_DEGREES: f64 = 1.0;

/// Orbits around `look_at`: `right` and `up` in radians, in the direction in which the scene appears to turn.
pub fn orbit(camera: &Camera, right: f64, up: f64) -> Camera {
    let away = turned(camera, camera.look_from - camera.look_at, -right, up);
    kept(camera, Camera { look_from: camera.look_at + away, ..*camera })
}

/// Turns the camera in place: `right` and `up` in radians.
pub fn look(camera: &Camera, right: f64, up: f64) -> Camera {
    let ahead = turned(camera, camera.look_at - camera.look_from, -right, up);
    kept(camera, Camera { look_at: camera.look_from + ahead, ..*camera })
}

/// Moves towards `look_at` (`factor` below 1) or away from it.
pub fn dolly(camera: &Camera, factor: f64) -> Camera {
    let look_from = camera.look_at + (camera.look_from - camera.look_at) * factor;
    kept(camera, Camera { look_from, ..*camera })
}

/// Moves the camera and `look_at`: `by` is right, up and forward, in scene units.
pub fn fly(camera: &Camera, by: DVec3) -> Camera {
    let basis = camera.basis();
    let offset = by.x * basis.u + by.y * basis.v - by.z * basis.w;
    kept(camera, Camera { look_from: camera.look_from + offset, look_at: camera.look_at + offset, ..*camera })
}

/// Looks at `point` from the current position.
pub fn recentre(camera: &Camera, point: DVec3) -> Camera {
    kept(camera, Camera { look_at: point, ..*camera })
}

/// Focuses on the plane through `point`.
pub fn focus(camera: &Camera, point: DVec3) -> Camera {
    kept(camera, Camera { focus_distance: Some(camera.depth_of(point)), ..*camera })
}

/// Rotates `v` around `vup`, then towards it.
fn turned(camera: &Camera, v: DVec3, about_up: f64, towards_up: f64) -> DVec3 {
    let Some(up) = camera.vup.try_normalize() else { return v };
    let v = DQuat::from_axis_angle(up, about_up) * v;
    let Some(side) = v.cross(up).try_normalize() else { return v };
    let angle_to_up = v.angle_between(up);
    let pole = POLE_DEGREES.to_radians();
    let wanted = (angle_to_up - towards_up).clamp(pole, std::f64::consts::PI - pole);
    DQuat::from_axis_angle(side, angle_to_up - wanted) * v
}

fn kept(old: &Camera, new: Camera) -> Camera {
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
        close(orbit(&CAMERA, quarter, 0.0).look_from, DVec3::new(-4.0, 0.0, 0.0));
        close(look(&CAMERA, quarter, 0.0).look_at, DVec3::new(4.0, 0.0, 4.0));
        assert!(orbit(&CAMERA, 0.0, 0.3).look_from.y > 0.0);
        assert!(look(&CAMERA, 0.0, 0.3).look_at.y > 0.0);
        close(dolly(&CAMERA, 0.5).look_from, DVec3::new(0.0, 0.0, 2.0));
        close(fly(&CAMERA, DVec3::new(1.0, 2.0, 3.0)).look_from, DVec3::new(1.0, 2.0, 1.0));
        assert_eq!(focus(&CAMERA, DVec3::new(9.0, 9.0, 1.0)).focus_distance, Some(3.0));
        assert_eq!(recentre(&CAMERA, CAMERA.look_from), CAMERA, "no direction: not made");
        assert_eq!(focus(&CAMERA, DVec3::new(0.0, 0.0, 5.0)), CAMERA, "behind the eye: not made");
    }

    proptest! {
        #[test]
        fn turning_keeps_distances_and_never_turns_over(right in -9.0..9.0f64, up in -9.0..9.0f64) {
            for camera in [orbit(&CAMERA, right, up), look(&CAMERA, right, up)] {
                prop_assert!((camera.effective_focus_distance() - 4.0).abs() < 1e-9);
                prop_assert!(camera.basis().v.y > 0.0);
            }
        }
    }
}
