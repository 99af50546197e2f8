//! Rules of the tracer that stages switch. [`Rules::default`] is the finished renderer.

use crate::scene::Scene;
use serde::{Deserialize, Serialize};

/// Which of the book's rules are in effect.
///
/// They are switches within one kernel, not separate tracers. A job with the finished rules carries no code for the
/// others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Rules {
    pub shading: Shading,
    pub diffuse: Diffuse,
    pub dielectric: DielectricLaws,
    pub surface: SurfaceRule,
    /// Whether every material's reflectance is that of its picture strip: five vertical strips of 10 %
    /// to 90 % in steps of 20 %. (Section 9.5.)
    pub reflectance_strips: bool,
    /// Whether samples are spread over the pixel; otherwise all pass through its centre. (Section 8.)
    pub antialiasing: bool,
    pub transfer: Transfer,
}

impl Default for Rules {
    fn default() -> Self {
        Rules::FINISHED
    }
}

impl Rules {
    pub const FINISHED: Rules = Rules {
        shading: Shading::Path,
        diffuse: Diffuse::Lambertian,
        dielectric: DielectricLaws::Schlick,
        surface: SurfaceRule::Exact,
        reflectance_strips: false,
        antialiasing: true,
        transfer: Transfer::Gamma2,
    };

    /// Whether the tracer needs only the finished renderer's code. (To the kernel, antialiasing is just a number, and
    /// the transfer comes after it.)
    pub fn are_finished(&self) -> bool {
        Rules { antialiasing: true, transfer: Transfer::Gamma2, ..*self } == Rules::FINISHED
    }

    /// Without rays, neither the scene nor the camera shows.
    pub fn has_rays(&self) -> bool {
        self.shading != Shading::ImageGradient
    }

    /// Whether paths continue after their first hit.
    pub fn has_bounces(&self) -> bool {
        self.shading == Shading::Path
    }

    /// The largest radiance of any sample, linear; 0 if the scene has no light.
    pub fn brightest(&self, scene: &Scene) -> f64 {
        let sky = scene.sky.bottom.max(scene.sky.top).max_element();
        // Stages without light show colours up to 1.
        if self.has_bounces() { sky } else { sky.max(1.0) }
    }
}

/// The contribution of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shading {
    /// Traces no rays: red increases with x and green downwards with y, from 0 to 1 across the picture. (Section 2.)
    ImageGradient,
    /// Hits are red, misses show the sky. (Section 5.2.)
    FirstHitRed,
    /// Hits show `(n + 1) / 2`, misses show the sky. (Section 6.1.)
    Normals,
    /// Light along a path. (From section 9 on.)
    Path,
}

/// Direction of a bounce off a Lambertian surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Diffuse {
    /// Uniform over the hemisphere. (Section 9.1.)
    Hemisphere,
    /// The normal plus a unit vector, with a density proportional to the cosine. (Section 9.4.)
    Lambertian,
}

/// The laws that glass obeys.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DielectricLaws {
    /// Always refracts. Where Snell's law has no solution, keeps the wrong direction of the book's formula. (Section
    /// 11.2.)
    RefractOnly,
    /// Reflects where Snell's law has no solution. (Section 11.3.)
    TotalReflection,
    /// Also reflects with Schlick's reflectance. (Section 11.4.)
    Schlick,
}

/// How rays leave the surface that they start on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SurfaceRule {
    /// The ray knows its surface: no threshold, and no acne at any scale.
    Exact,
    /// The book's quadratic with a minimum distance of 0, so rounding finds the same surface again. (Section 9.3.)
    Acne,
    /// The book's final arithmetic: the quadratic with a minimum distance of [`BOOK_T_MIN`]. (Section 9.3.)
    Book,
}

/// The book ignores hits closer than this, scene units. (Section 9.3.)
pub const BOOK_T_MIN: f64 = 0.001;

impl SurfaceRule {
    /// Hits closer than this are ignored, scene units; `None` for [`SurfaceRule::Exact`], which needs no threshold.
    pub fn smallest_distance(self) -> Option<f64> {
        match self {
            SurfaceRule::Exact => None,
            SurfaceRule::Acne => Some(0.0),
            SurfaceRule::Book => Some(BOOK_T_MIN),
        }
    }
}

/// How linear values become bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Transfer {
    /// Linear. (Sections 2 to 9.4.)
    Linear,
    /// Square root. (Section 9.5.)
    Gamma2,
    /// Linear in the upper half, square root in the lower, for comparison. (Section 9.5.)
    LinearAboveGamma2,
}

impl Transfer {
    /// Whether `row` of a picture of this height takes the square root.
    pub fn is_gamma(self, row: usize, height: usize) -> bool {
        match self {
            Transfer::Linear => false,
            Transfer::Gamma2 => true,
            Transfer::LinearAboveGamma2 => row >= height / 2,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Sky;
    use glam::DVec3;

    #[test]
    fn brightest_sample_is_sky_or_stage_colour() {
        let sky = Sky { bottom: DVec3::new(0.0, 2e-8, 0.0), top: DVec3::new(1e-8, 0.0, 0.0) };
        let scene = Scene { sky, ..Scene::default() };
        assert_eq!(Rules::FINISHED.brightest(&scene), 2e-8);
        for shading in [Shading::ImageGradient, Shading::FirstHitRed, Shading::Normals] {
            assert_eq!(Rules { shading, ..Rules::FINISHED }.brightest(&scene), 1.0);
        }
    }
}
