//! The camera: its position, direction and lens. (Book 1, sections 12 and 13.)

use super::SceneError;
use super::error::{allowed, finite_vector, position};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// Limits on the vertical field of view, degrees.
pub const VFOV_LIMITS_DEGREES: [f64; 2] = [0.01, 179.0];

/// Exclusive upper limit on the defocus angle, degrees; the lower limit is 0.
pub const DEFOCUS_LIMIT_DEGREES: f64 = 179.0;

/// Limits on the focus distance, scene units. The upper one covers the distance between any two valid positions.
pub const FOCUS_LIMITS: RangeInclusive<f64> = 1e-18..=1e19;

/// A thin-lens camera in the user's parameters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Scene units.
    pub look_from: DVec3,
    /// The point in the middle of the picture, scene units.
    pub look_at: DVec3,
    /// Any vector longer than 0 and not parallel to the view.
    pub vup: DVec3,
    /// Angle from the lower to the upper edge of the picture, within [`VFOV_LIMITS_DEGREES`].
    pub vfov_degrees: f64,
    /// Apex angle of the cone from the focus point to the lens, `0..179`; 0 means a pinhole.
    pub defocus_angle_degrees: f64,
    /// Distance to the plane in focus, scene units, greater than 0. `None` means the distance from `look_from` to
    /// `look_at`.
    pub focus_distance: Option<f64>,
}

impl Default for Camera {
    fn default() -> Self {
        Camera::BOOK
    }
}

/// An orthonormal frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraBasis {
    /// Right in the picture.
    pub u: DVec3,
    /// Up in the picture.
    pub v: DVec3,
    /// Backwards, against the view.
    pub w: DVec3,
}

impl Camera {
    /// The book's first camera: at the origin, looking along -z, with a vertical field of view of 90 degrees.
    pub const BOOK: Camera = Camera {
        look_from: DVec3::ZERO,
        look_at: DVec3::NEG_Z,
        vup: DVec3::Y,
        vfov_degrees: 90.0,
        defocus_angle_degrees: 0.0,
        focus_distance: None,
    };

    /// Checks every number against its limits. The error describes the first invalid value, with its limit and a
    /// remedy.
    pub fn validate(&self) -> Result<(), SceneError> {
        position(|| "look_from".to_owned(), self.look_from)?;
        position(|| "look_at".to_owned(), self.look_at)?;
        finite_vector(|| "vup".to_owned(), self.vup)?;
        if self.look_from == self.look_at {
            let at = self.look_from.to_array();
            return Err(SceneError(format!(
                "look_from and look_at are both {at:?}, so there is no direction to look in; move one of them"
            )));
        }
        let w = unit(self.look_from - self.look_at);
        if right(self.vup, w).is_none() {
            let reason = match self.vup {
                DVec3::ZERO => "has no direction",
                _ => "is parallel to the view, so the picture has no up direction",
            };
            let [vup, other] = [self.vup, least_aligned(w)].map(|vector| vector.to_array());
            return Err(SceneError(format!(
                "vup is {vup:?}, which {reason}; use another, such as {other:?}"
            )));
        }
        let named = |name: &'static str| move || name.to_owned();
        let [narrowest, widest] = VFOV_LIMITS_DEGREES;
        allowed(
            named("vfov_degrees"),
            self.vfov_degrees,
            (narrowest..=widest).contains(&self.vfov_degrees),
            &format!("between {narrowest} and {widest} degrees"),
            "90 is wide, 20 is a portrait lens",
        )?;
        allowed(
            named("defocus_angle_degrees"),
            self.defocus_angle_degrees,
            (0.0..DEFOCUS_LIMIT_DEGREES).contains(&self.defocus_angle_degrees),
            "at least 0 and below 179 degrees",
            "use 0 for a pinhole",
        )?;
        let (name, remedy) = match self.focus_distance {
            None => {
                ("focus_distance (that from look_from to look_at)", "move look_at or give a focus_distance")
            }
            Some(_) => ("focus_distance", "leave it out to focus on look_at"),
        };
        let distance = self.effective_focus_distance();
        let is_allowed = FOCUS_LIMITS.contains(&distance);
        allowed(named(name), distance, is_allowed, "between 1e-18 and 1e19 scene units", remedy)
    }

    /// The focus distance in effect, scene units.
    pub fn effective_focus_distance(&self) -> f64 {
        self.focus_distance.unwrap_or_else(|| self.look_from.distance(self.look_at))
    }

    /// Tangent of half the defocus angle: the radius of the lens at a focus distance of 1.
    pub fn defocus_tangent(&self) -> f64 {
        (self.defocus_angle_degrees.to_radians() / 2.0).tan()
    }

    /// Rays start within this distance of `look_from`, scene units.
    pub fn lens_radius(&self) -> f64 {
        self.effective_focus_distance() * self.defocus_tangent()
    }

    /// The camera's frame, orthonormal to `f64` precision for every valid camera. An invalid up vector is replaced by
    /// the axis least aligned with the view.
    pub fn basis(&self) -> CameraBasis {
        let w = unit(self.look_from - self.look_at);
        let u = right(self.vup, w).unwrap_or_else(|| unit(least_aligned(w).cross(w)));
        CameraBasis { u, v: w.cross(u), w }
    }
}

/// The unit vector perpendicular to `vup` and to the unit vector `w`; `None` if they are parallel.
fn right(vup: DVec3, w: DVec3) -> Option<DVec3> {
    /// Below this sine of the angle between up and view, rounding would determine the roll.
    const PARALLEL_SINE: f64 = 1e-9;
    let right = (vup != DVec3::ZERO).then(|| unit(vup).cross(w))?;
    (right.length() >= PARALLEL_SINE).then(|| unit(right))
}

/// The axis least aligned with `w`; ties go to y, then z.
fn least_aligned(w: DVec3) -> DVec3 {
    let aligned = |axis: &DVec3| axis.dot(w).abs();
    [DVec3::Y, DVec3::Z, DVec3::X]
        .into_iter()
        .min_by(|a, b| aligned(a).total_cmp(&aligned(b)))
        .unwrap_or(DVec3::Y)
}

/// Normalises `v`. Dividing by the largest component first keeps the squares from overflowing and underflowing.
pub(super) fn unit(v: DVec3) -> DVec3 {
    (v / v.abs().max_element()).normalize()
}
