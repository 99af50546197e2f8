//! The camera: where it stands, where it looks, and its lens. (Book 1, sections 12 and 13.)

use super::SceneError;
use super::error::{finite, finite_vector};
use glam::DVec3;

/// Vertical field of view, degrees.
pub const VFOV_LIMITS_DEGREES: [f64; 2] = [0.01, 179.0];

/// Defocus angles are from 0 to below this, degrees.
pub const DEFOCUS_LIMIT_DEGREES: f64 = 179.0;

/// A thin-lens camera as the user sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The eye, scene units.
    pub look_from: DVec3,
    /// A point in the middle of the picture, scene units.
    pub look_at: DVec3,
    /// What is up in the picture. Its length does not matter. Parallel to the view, the axis least aligned
    /// with the view takes its place.
    pub vup: DVec3,
    /// Angle from the picture's lower to its upper edge, degrees, in [`VFOV_LIMITS_DEGREES`].
    pub vfov_degrees: f64,
    /// Apex angle of the cone from the focus point to the lens, degrees, `0..179`; 0 is a pinhole.
    pub defocus_angle_degrees: f64,
    /// Distance from the eye to the plane that is sharp, scene units, more than 0.
    /// `None`: the distance from `look_from` to `look_at`.
    pub focus_distance: Option<f64>,
}

impl Default for Camera {
    /// The book's first camera: at the origin, looking along -z, 90 degrees high.
    fn default() -> Self {
        Camera {
            look_from: DVec3::ZERO,
            look_at: DVec3::NEG_Z,
            vup: DVec3::Y,
            vfov_degrees: 90.0,
            defocus_angle_degrees: 0.0,
            focus_distance: None,
        }
    }
}

/// An orthonormal frame: `u` right, `v` up, `w` backwards (against the view).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraBasis {
    /// Right in the picture.
    pub u: DVec3,
    /// Up in the picture.
    pub v: DVec3,
    /// Against the view.
    pub w: DVec3,
}

impl Camera {
    /// Checks every number against its limits.
    ///
    /// # Errors
    /// The first value that no picture can be made with, with its limit and what to do about it.
    pub fn validate(&self) -> Result<(), SceneError> {
        finite_vector("look_from", self.look_from)?;
        finite_vector("look_at", self.look_at)?;
        finite_vector("vup", self.vup)?;
        if self.look_from == self.look_at {
            return Err(SceneError::NoDirection { at: self.look_from });
        }
        finite("vfov_degrees", self.vfov_degrees)?;
        if !(VFOV_LIMITS_DEGREES[0]..=VFOV_LIMITS_DEGREES[1]).contains(&self.vfov_degrees) {
            return Err(SceneError::range(
                "vfov_degrees".into(),
                self.vfov_degrees,
                "within 0.01 and 179 degrees",
                "90 is wide, 20 is a portrait lens",
            ));
        }
        finite("defocus_angle_degrees", self.defocus_angle_degrees)?;
        if !(0.0..DEFOCUS_LIMIT_DEGREES).contains(&self.defocus_angle_degrees) {
            return Err(SceneError::range(
                "defocus_angle_degrees".into(),
                self.defocus_angle_degrees,
                "at least 0 and below 179 degrees",
                "use 0 for a pinhole",
            ));
        }
        if let Some(distance) = self.focus_distance {
            finite("focus_distance", distance)?;
            if !(distance > 0.0 && (1e-18..=1e18).contains(&distance)) {
                return Err(SceneError::range(
                    "focus_distance".into(),
                    distance,
                    "within 1e-18 and 1e18 scene units",
                    "leave it out to focus on look_at",
                ));
            }
        }
        Ok(())
    }

    /// The focus distance that acts, scene units.
    pub fn effective_focus_distance(&self) -> f64 {
        self.focus_distance.unwrap_or_else(|| self.look_from.distance(self.look_at))
    }

    /// The camera's frame, orthonormal to the precision of `f64` for every valid camera.
    pub fn basis(&self) -> CameraBasis {
        let w = unit(self.look_from - self.look_at);
        let right = |up: DVec3| up.cross(w);
        // Below this sine of the angle to the view, rounding would choose the roll.
        const PARALLEL_SINE: f64 = 1e-9;
        let vup = if self.vup == DVec3::ZERO { DVec3::ZERO } else { unit(self.vup) };
        let mut u = right(vup);
        if u.length() < PARALLEL_SINE {
            let least_aligned = [DVec3::X, DVec3::Y, DVec3::Z]
                .into_iter()
                .min_by(|a, b| a.dot(w).abs().total_cmp(&b.dot(w).abs()))
                .unwrap_or(DVec3::X);
            u = right(least_aligned);
        }
        let u = unit(u);
        CameraBasis { u, v: w.cross(u), w }
    }
}

/// `v` scaled to length 1. The largest component is divided out first, so that squares neither overflow nor
/// vanish.
fn unit(v: DVec3) -> DVec3 {
    (v / v.abs().max_element()).normalize()
}
