//! Drags of spheres, and the place of a new sphere.

use crate::app::model::Body;
use crate::numbers::rounded;
use crate::scene::{Camera, Material, Pick};
use glam::DVec3;

/// A sphere never becomes larger than this share of the distance from the eye to its centre, so that the eye stays
/// outside.
const RADIUS_SHARE_LIMIT: f64 = 0.95;

/// A sphere never becomes smaller than this share of that distance.
const RADIUS_SHARE_LEAST: f64 = 1e-4;

/// A drag moves a sphere to at most this many times its distance from the eye.
const FAR: f64 = 8.0;

/// The radius of a new sphere as a share of the picture's height at its distance.
const NEW_SHARE: f64 = 0.09;

/// The quantity that a drag changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grip {
    /// Its place, on the plane through the centre that is parallel to the picture.
    Centre,
    /// Its place, on the level plane through the centre.
    Level,
    /// Its radius.
    Radius,
}

/// A sphere that the user holds.
#[derive(Clone, Copy, Debug)]
pub struct Held {
    /// The quantity that the drag changes.
    pub grip: Grip,
    /// The sphere.
    pub sphere: usize,
    /// Its values when the drag began.
    pub before: Body,
    /// Where the drag began, in the picture.
    pub start: [f64; 2],
    /// The offset from the pointer to the point that follows it, because a handle may be beside the outline.
    pub offset: [f64; 2],
}

impl Held {
    /// The sphere after a drag to the point `to` of the picture. Where no place or radius follows, it is as before.
    pub fn dragged(&self, camera: &Camera, aspect: f64, to: [f64; 2]) -> Body {
        let ray = |place| camera.direction_through(place, aspect);
        let to = [0, 1].map(|axis| to[axis] + self.offset[axis]);
        let Body { center, radius, .. } = self.before;
        let eye = camera.look_from;
        match self.grip {
            Grip::Radius => {
                let distance = eye.distance(center);
                let angle = ray(to).angle_between(center - eye).min(std::f64::consts::FRAC_PI_2);
                let limits = [RADIUS_SHARE_LEAST * distance, RADIUS_SHARE_LIMIT * distance];
                let radius = (distance * angle.sin()).clamp(limits[0], limits[1]);
                Body { radius, ..self.before }
            }
            Grip::Centre | Grip::Level => {
                let normal = match self.grip {
                    Grip::Level => camera.vup.try_normalize().unwrap_or(DVec3::Y),
                    _ => camera.basis().w,
                };
                let on_plane = |place| {
                    let direction = ray(place);
                    let along = (center - eye).dot(normal) / direction.dot(normal);
                    let limit = FAR * (eye.distance(center) + radius);
                    (along > 0.0 && along < limit).then(|| eye + along * direction)
                };
                match (on_plane(self.start), on_plane(to)) {
                    (Some(from), Some(to)) => Body { center: center + (to - from), ..self.before },
                    _ => self.before,
                }
            }
        }
    }
}

/// A new sphere at a point of the picture: it lies on what is there, which is `hit`, or is as far away as the point looked
/// at.
pub fn new_body(hit: Option<Pick>, camera: &Camera, aspect: f64, place: [f64; 2]) -> Body {
    let direction = camera.direction_through(place, aspect);
    let height = 2.0 * (camera.vfov_degrees.to_radians() / 2.0).tan();
    let radius_at = |distance: f64| {
        let radius = NEW_SHARE * height * distance;
        rounded(radius, radius, 2)
    };
    let material = Material::Lambertian { albedo: DVec3::new(0.7, 0.3, 0.3) };
    match hit {
        Some(pick) => {
            let radius = radius_at(pick.distance);
            Body { center: pick.point + radius * pick.normal, radius, material }
        }
        None => {
            let distance = camera.look_from.distance(camera.look_at);
            let center = camera.look_from + distance * direction;
            Body { center, radius: radius_at(distance), material }
        }
    }
}

#[cfg(test)]
mod tests {
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
        #[test]
        fn a_dragged_sphere_follows_the_pointer(x in 0.05..0.95f64, y in 0.05..0.95f64) {
            let camera = Camera::BOOK;
            let start = camera.place_of(BODY.center, 1.5).unwrap();
            let moved = held(Grip::Centre, start).dragged(&camera, 1.5, [x, y]);
            let place = camera.place_of(moved.center, 1.5).unwrap();
            prop_assert!((place[0] - x).abs() < 1e-9 && (place[1] - y).abs() < 1e-9);
            prop_assert!((moved.center.z - BODY.center.z).abs() < 1e-9 && moved.radius == BODY.radius);
            let sized = held(Grip::Radius, start).dragged(&camera, 1.5, [x, y]);
            prop_assert!(sized.center == BODY.center && sized.radius < camera.look_from.distance(BODY.center));
        }
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
        assert!((to(28.2).center.y + 0.2).abs() < 1e-9);
    }
}
