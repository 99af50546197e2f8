//! What a job needs of a kernel, each feature declared once: the question to the job that it answers, the part of the
//! CPU's kernels that has its code, the pipeline override of the GPU's, and its words in summaries.

use super::{AnchoredSphere, Roots, Tag, UNIFORM_ANCHORED, UNIFORM_SPHERES};
use crate::render::{RenderJob, SamplerKind};
use crate::scene::Material;
use crate::stages::{DielectricLaws, Diffuse, Shading, Surface};

/// Code that comes or goes as one in the CPU's kernels, as bits of their constant parameter. Every combination would
/// have to be compiled, so there are fewer of these than features.
pub mod parts {
    /// Spheres with both roots, and refraction.
    pub const GLASS: u32 = 1;
    /// A lens of some size.
    pub const LENS: u32 = 2;
    /// What few scenes need: anchored spheres, specks, steep glass.
    pub const EXTREMES: u32 = 4;
    /// The hierarchy.
    pub const HIERARCHY: u32 = 8;
    /// Stage rules.
    pub const RULES: u32 = 16;
    /// Everything.
    pub const ALL: u32 = 31;
    /// No part: the code is in every kernel, or the CPU's tracer looks at the job instead.
    pub const NONE: u32 = 0;

    /// What a kernel of these parts has code for, in words.
    pub fn describe(parts: u32) -> String {
        let words = [
            (GLASS, "glass"),
            (LENS, "lens"),
            (EXTREMES, "extremes"),
            (HIERARCHY, "hierarchy"),
            (RULES, "stage rules"),
        ];
        let present: Vec<&str> =
            words.iter().filter(|(part, _)| parts & part != 0).map(|(_, word)| *word).collect();
        if present.is_empty() { "opaque spheres, pinhole".to_owned() } else { present.join(", ") }
    }
}

/// How a job's spheres are sorted: what features ask besides the job.
#[derive(Clone, Copy, Debug)]
pub struct SortedSpheres<'a, R> {
    /// Spheres of one root.
    pub opaque_count: usize,
    /// Spheres of two.
    pub two_root_count: usize,
    /// Spheres that are seen from a point of their surface.
    pub anchored: &'a [AnchoredSphere<R>],
    /// Whether there is a hierarchy over those of one root and of two.
    pub has_hierarchy: bool,
    /// Whether one is so small beside its distance that a hit's depth says little of where on it the hit lies.
    pub has_specks: bool,
}

/// Between these refraction indices a refracted direction is good to rounding when it is worked out from the cosine of
/// incidence; beyond them the critical angle is lost in its rounding.
const GENTLE_INDICES: [f64; 2] = [0.25, 4.0];

/// In glass that a path does not leave, each of so many rays may move the angle of incidence by a rounding error and
/// still the critical angle is held to 1e-6.
const GENTLE_DEPTH: u32 = 64;

/// The type of a feature, as a pipeline override.
pub trait Override: Copy + Eq {
    /// Its type in WGSL.
    const TYPE: &'static str;
    /// As the device takes it; a truth value as 0 or 1.
    fn number(self) -> u32;
    /// As WGSL writes it.
    fn literal(self) -> String;
}

impl Override for bool {
    const TYPE: &'static str = "bool";
    fn number(self) -> u32 {
        u32::from(self)
    }
    fn literal(self) -> String {
        self.to_string()
    }
}

impl Override for u32 {
    const TYPE: &'static str = "u32";
    fn number(self) -> u32 {
        self
    }
    fn literal(self) -> String {
        format!("{self}u")
    }
}

impl<T: Tag> Override for T {
    const TYPE: &'static str = "u32";
    fn number(self) -> u32 {
        self.tag()
    }
    fn literal(self) -> String {
        format!("{}u", self.tag())
    }
}

/// The last of one or two values.
macro_rules! last {
    ($value:expr) => {
        $value
    };
    ($value:expr, $other:expr) => {
        $other
    };
}

/// Declares [`Features`]. Each has its type; then, in brackets, the value for which a kernel needs no code (`off`), the
/// value in a kernel that leaves nothing out where the samples stay the same whatever the value is (`general`), the part of
/// the CPU's kernels that has its code (`cpu`), and the words for its values from 1 on (`says`); then the question that
/// the job and its spheres answer. A feature's override in WGSL is its name in capitals.
macro_rules! features {
    (
        |$job:ident, $spheres:ident|
        $(
            $(#[doc = $doc:literal])*
            $name:ident: $type:ty [
                off $off:expr
                $(, general $general:expr)?
                $(, cpu $part:ident)?
                $(, says $($words:literal)+)?
            ] = $answer:expr;
        )*
    ) => {
        /// What a job needs of a kernel; code for what it does not need is left out.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub struct Features {
            $($(#[doc = $doc])* pub $name: $type,)*
        }

        impl Default for Features {
            /// A kernel that leaves nothing out that a job without stage rules and hierarchy may need.
            fn default() -> Self {
                Features { $($name: last!($off $(, $general)?),)* }
            }
        }

        impl Features {
            /// What a job needs whose spheres are sorted so.
            pub fn of<R>($job: &RenderJob, $spheres: &SortedSpheres<R>) -> Self {
                Features { $($name: $answer,)* }
            }

            /// A kernel that leaves out nothing that leaves the samples as they are: to measure what specialising gains.
            pub fn generalised(self) -> Self {
                Features { $($name: last!(self.$name $(, $general)?),)* }
            }

            /// The parts of the CPU's kernels that have code for it: bits of [`parts`].
            pub fn parts(&self) -> u32 {
                0 $(| if self.$name == $off { 0 } else { last!(parts::NONE $(, parts::$part)?) })*
            }

            /// The pipeline overrides: their names in WGSL and their values.
            pub fn overrides(&self) -> Vec<(String, f64)> {
                vec![$((stringify!($name).to_uppercase(), f64::from(self.$name.number()))),*]
            }

            /// The declarations of the overrides, with these values as their defaults.
            pub(super) fn wgsl(&self) -> String {
                [$(format!(
                    "override {}: {} = {};\n",
                    stringify!($name).to_uppercase(), <$type as Override>::TYPE, self.$name.literal(),
                )),*].concat()
            }

            /// By feature, the words for its value.
            fn words(&self) -> Vec<(&'static str, &'static str)> {
                vec![$((stringify!($name), word(self.$name, &[$($($words),+)?]))),*]
            }
        }
    };
}

fn word(value: impl Override, words: &[&'static str]) -> &'static str {
    let index = (value.number() as usize).checked_sub(1);
    index.and_then(|index| words.get(index)).copied().unwrap_or("")
}

features! {
    |job, spheres|
    /// Lambertian surfaces.
    lambertian: bool [off false, general true, says "lambertian"] =
        occurs(job, |material| matches!(material, Material::Lambertian { .. }));
    /// Metals.
    metal: bool [off false, general true, says "metal"] =
        occurs(job, |material| matches!(material, Material::Metal { .. }));
    /// Metals with fuzz.
    fuzz: bool [off false, general true, says "fuzz"] = occurs(job, |material| material.effective_fuzz() > 0.0);
    /// Glass.
    glass: bool [off false, general true, cpu GLASS, says "glass"] =
        occurs(job, |material| matches!(material, Material::Dielectric { .. }));
    /// A lens of some size.
    lens: bool [off false, general true, cpu LENS, says "lens"] = job.camera().defocus_angle_degrees > 0.0;
    /// Spheres that a ray can be inside of, or a hierarchy.
    two_root: bool [off false, general true, cpu GLASS, says "two roots"] = spheres.two_root_count > 0;
    /// Spheres that are seen from a point of their surface.
    anchored: bool [off false, general true, cpu EXTREMES, says "anchored"] = !spheres.anchored.is_empty();
    /// The eye is on the surface of one of them, so that rays from the camera start there.
    eye_on_surface: bool [off false, general true, cpu EXTREMES, says "eye on a surface"] =
        spheres.anchored.iter().any(AnchoredSphere::is_under_eye);
    /// One of them, which no light passes, holds every ray.
    cavity: bool [off false, general true, cpu EXTREMES, says "cavity"] =
        spheres.anchored.iter().any(|sphere| sphere.roots() == Roots::Farther);
    /// Spheres that are small beside their distance: where a ray meets them is told by the way across the ray.
    specks: bool [off false, cpu EXTREMES, says "specks"] = spheres.has_specks;
    /// Glass whose critical angle must be known better than from a rounded cosine, or for many rays.
    steep_glass: bool [off false, cpu EXTREMES, says "steep glass"] = has_steep_glass(job);
    /// A hierarchy.
    hierarchy: bool [off false, cpu HIERARCHY, says "hierarchy"] = spheres.has_hierarchy;
    /// It is the compressed one: for the GPU to choose.
    cwbvh: bool [off false, general false, says "compressed hierarchy"] = false;
    /// The spheres fit the uniform buffer, and the next two counts are those of the scene.
    few_spheres: bool [off false, general false] = are_few(spheres);
    /// Spheres of one root, if they are few.
    opaque_count: u32 [off 0, general 0] = if are_few(spheres) { spheres.opaque_count as u32 } else { 0 };
    /// Spheres of two roots, if they are few.
    two_root_count: u32 [off 0, general 0] = if are_few(spheres) { spheres.two_root_count as u32 } else { 0 };
    /// The anchored spheres fit the uniform buffer, and the next count is that of the scene.
    few_anchored: bool [off false, general false] = spheres.anchored.len() <= UNIFORM_ANCHORED;
    /// Anchored spheres, if they are few.
    anchored_count: u32 [off 0, general 0] =
        if spheres.anchored.len() <= UNIFORM_ANCHORED { spheres.anchored.len() as u32 } else { 0 };
    /// Where the numbers of a sample come from.
    sampler: SamplerKind [off SamplerKind::Sobol] = job.settings().sampler;
    /// Samples are spread over the pixel.
    antialiasing: bool [off true] = job.rules().antialiasing;
    /// Rays are traced at all.
    rays: bool [off true] = job.rules().shading != Shading::ImageGradient;
    /// How rays leave the surface that they start on.
    surface: Surface [off Surface::Exact, cpu RULES, says "acne" "the book's arithmetic"] = job.rules().surface;
    /// Lambertian surfaces send light evenly over the hemisphere.
    hemisphere: bool [off false, cpu RULES, says "hemisphere"] = job.rules().diffuse == Diffuse::Hemisphere;
    /// The reflectance is that of the picture's strip.
    reflectance_strips: bool [off false, cpu RULES, says "strips"] = job.rules().reflectance_strips;
    /// Paths can be too long for one dispatch of the GPU: for the GPU to decide.
    aside: bool [off true, general true] = true;
    /// What a ray brings back.
    shading: Shading [off Shading::Path, cpu RULES] = job.rules().shading;
    /// The laws of glass.
    dielectric_laws: DielectricLaws [off DielectricLaws::Schlick, cpu RULES] = job.rules().dielectric;
}

impl Features {
    /// Whether the job needs code that few do: anchored spheres, specks, steep glass.
    pub fn are_extreme(&self) -> bool {
        self.parts() & parts::EXTREMES != 0
    }

    /// What a kernel for just this contains, for reports: `lambertian, metal, glass, 5 spheres in constants`.
    pub fn describe(&self) -> String {
        let is_told =
            |(name, words): &(&str, &str)| !(words.is_empty() || self.cwbvh && *name == "hierarchy");
        let words = self.words().into_iter().filter(is_told).map(|(_, words)| words.to_owned());
        let count = self.opaque_count + self.two_root_count;
        let few = self.few_spheres.then(|| format!("{count} spheres in constants"));
        words.chain(few).collect::<Vec<_>>().join(", ")
    }
}

fn occurs(job: &RenderJob, is_such: impl Fn(&Material) -> bool) -> bool {
    let scene = job.scene();
    scene.spheres.iter().any(|sphere| is_such(scene.material_of(sphere)))
}

fn are_few<R>(spheres: &SortedSpheres<R>) -> bool {
    !spheres.has_hierarchy && spheres.opaque_count + spheres.two_root_count <= UNIFORM_SPHERES
}

/// Whether the angles of glass matter more than a rounded cosine tells.
fn has_steep_glass(job: &RenderJob) -> bool {
    let many_rays = job.settings().max_depth > GENTLE_DEPTH;
    let [least, most] = GENTLE_INDICES;
    job.rules().surface == Surface::Exact
        && job.scene().materials.iter().any(|named| match named.material {
            Material::Dielectric { refraction_index } => {
                many_rays || !(least..=most).contains(&refraction_index)
            }
            _ => false,
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_follow_from_features() {
        let none = Features {
            lambertian: false,
            metal: false,
            fuzz: false,
            glass: false,
            lens: false,
            two_root: false,
            anchored: false,
            eye_on_surface: false,
            cavity: false,
            ..Features::default()
        };
        assert_eq!(none.parts(), parts::NONE);
        assert_eq!(Features { metal: true, antialiasing: false, ..none }.parts(), parts::NONE);
        assert_eq!(Features { two_root: true, ..none }.parts(), parts::GLASS);
        assert_eq!(Features { specks: true, lens: true, ..none }.parts(), parts::EXTREMES | parts::LENS);
        assert_eq!(Features { surface: Surface::Book, ..none }.parts(), parts::RULES);
        assert_eq!(Features { shading: Shading::Normals, hierarchy: true, ..none }.parts(), 8 | 16);
    }

    #[test]
    fn a_summary_has_the_words_of_what_is_on() {
        let features =
            Features { few_spheres: true, opaque_count: 3, two_root_count: 2, ..Features::default() };
        assert_eq!(
            features.describe(),
            "lambertian, metal, fuzz, glass, lens, two roots, anchored, eye on a surface, cavity, 5 spheres in constants"
        );
        let boxed = Features { hierarchy: true, surface: Surface::Acne, ..Features::default() };
        assert!(boxed.describe().ends_with("cavity, hierarchy, acne"), "{}", boxed.describe());
        let compressed = Features { cwbvh: true, ..boxed };
        assert!(compressed.describe().ends_with("cavity, compressed hierarchy, acne"));
    }
}
