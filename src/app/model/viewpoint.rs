//! The six points that the scene can be viewed from, along the axes.

use crate::scene::Camera;
use glam::DVec3;

/// A side of the scene. With y up, as in the book, x points right and z to the front.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Viewpoint {
    /// +x.
    Right,
    /// +y.
    Top,
    /// +z.
    Front,
    /// -x.
    Left,
    /// -y.
    Bottom,
    /// -z.
    Back,
}

impl Viewpoint {
    /// All sides; those of the positive axes come first.
    pub const ALL: [Viewpoint; 6] = [
        Viewpoint::Right,
        Viewpoint::Top,
        Viewpoint::Front,
        Viewpoint::Left,
        Viewpoint::Bottom,
        Viewpoint::Back,
    ];

    /// The name of its view.
    pub fn name(self) -> &'static str {
        [
            "Look from the right",
            "Look from above",
            "Look from the front",
            "Look from the left",
            "Look from below",
            "Look from the back",
        ][self as usize]
    }

    /// The number of its axis, 0 to 2.
    pub fn axis(self) -> usize {
        self as usize % 3
    }

    /// Whether it is the end of a positive axis.
    pub fn is_positive(self) -> bool {
        (self as usize) < 3
    }

    /// The unit vector that points to this side.
    pub fn direction(self) -> DVec3 {
        let axis = DVec3::AXES[self.axis()];
        if self.is_positive() { axis } else { -axis }
    }

    /// The camera on this side, looking at the same point from the same distance. What is `up` in the scene is up in the
    /// picture, unless it points to the camera or away from it.
    pub fn camera(self, camera: &Camera, up: DVec3) -> Camera {
        /// Above this cosine of the angle to the axis, `up` counts as parallel to it.
        const PARALLEL: f64 = 0.999;
        let (away, up) = (self.direction(), up.normalize_or_zero());
        let is_upright = up != DVec3::ZERO && up.dot(away).abs() < PARALLEL;
        // The x axis points right, as from the front; from the sides, y points up.
        let right = if self.axis() == 0 { away.cross(DVec3::Y) } else { DVec3::X };
        let vup = if is_upright { up } else { away.cross(right) };
        let look_from = camera.look_at + camera.look_from.distance(camera.look_at) * away;
        Camera { look_from, vup, ..*camera }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAMERA: Camera =
        Camera { look_from: DVec3::new(3.0, 2.0, 6.0), look_at: DVec3::new(0.0, 0.0, -1.0), ..Camera::BOOK };

    #[test]
    fn every_view_is_valid_and_shows_the_same_point() {
        for up in [DVec3::Y, DVec3::X, DVec3::NEG_Z, DVec3::new(0.2, 1.0, 0.1), DVec3::Y * 1e200] {
            for side in Viewpoint::ALL {
                let camera = side.camera(&CAMERA, up);
                camera.validate().unwrap();
                assert!(camera.basis().w.distance(side.direction()) < 1e-12, "{side:?}");
                assert_eq!(camera.look_at, CAMERA.look_at);
                let [old, new] = [CAMERA, camera].map(|camera| camera.effective_focus_distance());
                assert!((old - new).abs() < 1e-12, "{side:?}");
            }
        }
    }

    #[test]
    fn views_are_the_right_way_round() {
        let basis = |side: Viewpoint| side.camera(&CAMERA, DVec3::Y).basis();
        for (side, right, up) in [
            (Viewpoint::Front, DVec3::X, DVec3::Y),
            (Viewpoint::Back, DVec3::NEG_X, DVec3::Y),
            (Viewpoint::Right, DVec3::NEG_Z, DVec3::Y),
            (Viewpoint::Left, DVec3::Z, DVec3::Y),
            (Viewpoint::Top, DVec3::X, DVec3::NEG_Z),
            (Viewpoint::Bottom, DVec3::X, DVec3::Z),
        ] {
            assert!(basis(side).u.distance(right) < 1e-12 && basis(side).v.distance(up) < 1e-12, "{side:?}");
        }
    }
}
