//! What a drag does to a sphere, and where a new sphere goes.

use crate::app::model::edit::Body;
use crate::scene::{Camera, Material, Pick, Scene, Sphere};
use glam::DVec3;

/// A sphere never becomes larger than this share of the distance from the eye to its centre, so that the eye stays
/// outside.
const RADIUS_SHARE_LIMIT: f64 = 0.95;

/// A sphere never becomes smaller than this share of that distance.
const RADIUS_SHARE_LEAST: f64 = 1e-4;

/// A drag moves a sphere at most to so many times its distance from the eye.
const FAR: f64 = 8.0;

/// The radius of a new sphere as a share of the picture's height at its distance.
const NEW_SHARE: f64 = 0.09;

/// How far from its original a copy of a sphere is, in radii.
const COPY_RADII: f64 = 2.2;

/// Spheres that overlap by no more than this share of the radius merely touch.
const OVERLAP: f64 = 0.05;

/// What a drag changes.
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
    /// What the drag changes.
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
    let radius_at = |distance: f64| two_digits(NEW_SHARE * height * distance);
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

/// From a sphere to a place for its copy: beside it, where the copy is in no other sphere, nothing hides it, and the whole
/// of it is in the picture, or else its centre; above it if there is no such place.
pub fn to_copy(scene: &Scene, camera: &Camera, aspect: f64, sphere: usize) -> DVec3 {
    let Some(original) = scene.spheres.get(sphere) else { return DVec3::ZERO };
    let radius = original.radius;
    let overlaps = |center: DVec3, other: &Sphere| {
        center.distance(other.center) < other.radius + radius * (1.0 - OVERLAP)
    };
    let basis = camera.basis();
    let is_in_picture = |point: DVec3| {
        let place = camera.place_of(point, aspect);
        place.is_some_and(|place| place.iter().all(|along| (0.0..1.0).contains(along)))
    };
    let edges = [basis.u, -basis.u, basis.v, -basis.v].map(|direction| radius * direction);
    let is_whole = |by: &DVec3| edges.iter().all(|edge| is_in_picture(original.center + *by + *edge));
    let is_free = |by: &DVec3| {
        let center = original.center + *by;
        let is_in_sight = is_in_picture(center) && camera.look_from.distance(center) > 2.0 * radius;
        // What the original overlaps too, such as the ground or a glass around it, is no obstacle.
        let is_obstacle = |other: &&Sphere| overlaps(center, other) && !overlaps(original.center, other);
        is_in_sight && scene.spheres.iter().find(is_obstacle).is_none()
    };
    let is_seen = |by: &DVec3| {
        let center = original.center + *by;
        let hides = |(index, other): (usize, &Sphere)| {
            (index == sphere || !overlaps(original.center, other))
                && !is_glass(scene, other)
                && is_before(other, camera.look_from, center, radius)
        };
        !scene.spheres.iter().enumerate().any(hides)
    };
    let (right, up, back) = (basis.u, basis.v, basis.w);
    let beside = [right, -right, up];
    let aslant = [up + right, up - right, up - back, right - back, -right - back];
    let directions = beside.into_iter().chain(aslant.map(DVec3::normalize)).chain([back]);
    let places = directions.map(|direction| COPY_RADII * radius * direction);
    let free: Vec<DVec3> = places.filter(is_free).filter(is_seen).collect();
    let best = free.iter().find(|by| is_whole(by)).or(free.first());
    best.copied().unwrap_or(COPY_RADII * radius * basis.v)
}

fn is_glass(scene: &Scene, sphere: &Sphere) -> bool {
    let material = scene.materials.get(sphere.material).map(|named| named.material);
    matches!(material, Some(Material::Dielectric { .. }))
}

/// Whether a sphere is in front of the middle of another one, of this `center` and `radius`, as seen from `eye`.
fn is_before(sphere: &Sphere, eye: DVec3, center: DVec3, radius: f64) -> bool {
    let distance = eye.distance(center);
    let to_sphere = sphere.center - eye;
    let along = to_sphere.dot(center - eye) / distance;
    let across = to_sphere.length_squared() - along * along;
    let half_chord = sphere.radius * sphere.radius - across;
    half_chord > 0.0 && {
        let nearest = along - half_chord.sqrt();
        0.0 < nearest && nearest < distance - radius
    }
}

/// Rounds a positive number to two digits.
fn two_digits(value: f64) -> f64 {
    let unit = 10.0_f64.powf(value.log10().floor() - 1.0);
    (value / unit).round() * unit
}

#[cfg(test)]
mod tests;
