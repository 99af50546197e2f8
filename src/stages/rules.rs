//! The rules of the tracer that a stage can switch. The finished renderer is [`Rules::default`].

use serde::{Deserialize, Serialize};

/// Which of the book's rules are in force.
///
/// None of these is a second tracer: they are switches within the one kernel, and a job whose rules are the
/// finished ones carries no code for the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Rules {
    /// What a ray brings back.
    pub shading: Shading,
    /// Direction of a Lambertian bounce.
    pub diffuse: Diffuse,
    /// Which laws glass obeys.
    pub dielectric: DielectricLaws,
    /// How a ray leaves the surface that it starts on.
    pub surface: Surface,
    /// Whether the reflectance of every material is replaced by that of the picture's strip: five vertical
    /// strips of 10, 30, 50, 70 and 90 %. (Section 9.5.)
    pub reflectance_strips: bool,
    /// Whether samples are spread over the pixel; else all go through its centre. (Section 8.)
    pub antialiasing: bool,
    /// How linear values become the picture's bytes.
    pub transfer: Transfer,
}

impl Default for Rules {
    /// [`Rules::FINISHED`].
    fn default() -> Self {
        Rules::FINISHED
    }
}

impl Rules {
    /// Those of the finished renderer.
    pub const FINISHED: Rules = Rules {
        shading: Shading::Path,
        diffuse: Diffuse::Lambertian,
        dielectric: DielectricLaws::Schlick,
        surface: Surface::Exact,
        reflectance_strips: false,
        antialiasing: true,
        transfer: Transfer::Gamma2,
    };

    /// Whether the tracer needs no code beyond that of the finished renderer.
    /// (Antialiasing is a number to the kernel, and the transfer comes after it.)
    pub fn are_finished(&self) -> bool {
        Rules { antialiasing: true, transfer: Transfer::Gamma2, ..*self } == Rules::FINISHED
    }
}

/// What a ray brings back.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shading {
    /// No rays: red grows with x, green with y downwards, from 0 to 1 over the picture. (Section 2.)
    ImageGradient,
    /// A hit is red, a miss is the sky. (Section 5.2.)
    FirstHitRed,
    /// A hit is `(n + 1) / 2`, a miss is the sky. (Section 6.1.)
    Normals,
    /// Light along a path. (Section 9 on.)
    Path,
}

/// Direction of a Lambertian bounce.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Diffuse {
    /// Uniform over the hemisphere. (Section 9.1.)
    Hemisphere,
    /// The normal plus a unit vector: in proportion to the cosine. (Section 9.4.)
    Lambertian,
}

/// Which laws glass obeys.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DielectricLaws {
    /// Always refracts. Where Snell's law has no solution the book's formula is followed to its wrong
    /// direction. (Section 11.2.)
    RefractOnly,
    /// Reflects where Snell's law has no solution. (Section 11.3.)
    TotalReflection,
    /// Reflects by Schlick's share besides. (Section 11.4.)
    Schlick,
}

/// How a ray leaves the surface that it starts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Surface {
    /// It knows the surface: no threshold, and no acne at any scale.
    Exact,
    /// The book's quadratic with 0 as the smallest distance, which finds the surface again by rounding.
    /// (Section 9.3.)
    Acne,
    /// The book's arithmetic as it ends: the quadratic with [`BOOK_T_MIN`] as the smallest distance. (Section 9.3.)
    Book,
}

/// The distance within which the book finds no surface, scene units. (Section 9.3.)
pub const BOOK_T_MIN: f64 = 0.001;

impl Surface {
    /// The distance within which the book's arithmetic finds no surface, scene units; `None` where ours is in force,
    /// which needs none.
    pub fn smallest_distance(self) -> Option<f64> {
        match self {
            Surface::Exact => None,
            Surface::Acne => Some(0.0),
            Surface::Book => Some(BOOK_T_MIN),
        }
    }
}

/// How linear values become the picture's bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Transfer {
    /// As they are. (Sections 2 to 9.4.)
    Linear,
    /// Square root. (Section 9.5.)
    Gamma2,
    /// The upper half linear, the lower half with the square root: to compare. (Section 9.5.)
    LinearAboveGamma2,
}

impl Transfer {
    /// Whether `row` of `height` takes the square root.
    pub fn is_gamma(self, row: usize, height: usize) -> bool {
        match self {
            Transfer::Linear => false,
            Transfer::Gamma2 => true,
            Transfer::LinearAboveGamma2 => row >= height / 2,
        }
    }
}
