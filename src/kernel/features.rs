//! Features: properties of a job that need code in a kernel. Each is declared once: how it follows from the job, the part
//! of a kernel that implements it, and its pipeline override on the GPU.

use super::record::last;
use super::{AnchoredSphere, Roots, Tag, UNIFORM_ANCHORED, UNIFORM_SPHERES};
use crate::job::render::{RenderJob, SamplerKind};
use crate::scene::Material;
use crate::stages::{DielectricLaws, Diffuse, Shading, SurfaceRule};

/// Parts of a kernel, as reports name them. On the CPU they are compiled in or left out: bits of a const parameter. Every
/// combination must be compiled, so there are fewer parts than features.
pub mod parts {
    /// Spheres with both roots, and refraction.
    pub const GLASS: u32 = 1;
    /// A lens of nonzero radius.
    pub const LENS: u32 = 2;
    /// For few scenes: anchored spheres, specks and steep glass.
    pub const EXTREMES: u32 = 4;
    /// Traversal of the hierarchy.
    pub const HIERARCHY: u32 = 8;
    /// The rules of the stages.
    pub const RULES: u32 = 16;
    pub const ALL: u32 = 31;
    /// For features whose code every kernel contains, or that the CPU checks at run time.
    pub const NONE: u32 = 0;

    const LABELS: [(u32, &str); 5] = [
        (GLASS, "glass"),
        (LENS, "lens"),
        (EXTREMES, "extremes"),
        (HIERARCHY, "hierarchy"),
        (RULES, "stage rules"),
    ];

    /// Whether a kernel with the parts `present` has all those `needed`.
    pub const fn include(present: u32, needed: u32) -> bool {
        needed & !present == 0
    }

    /// Describes a kernel with these parts.
    pub fn describe(parts: u32) -> String {
        let present = labels_of(parts);
        if present.is_empty() { "opaque spheres, pinhole".to_owned() } else { present.join(", ") }
    }

    /// Names the parts that a kernel with these parts leaves out.
    pub fn left_out(parts: u32) -> Vec<&'static str> {
        labels_of(!parts)
    }

    fn labels_of(parts: u32) -> Vec<&'static str> {
        LABELS.iter().filter(|(part, _)| parts & part != 0).map(|(_, label)| *label).collect()
    }
}

/// How a job's spheres are sorted.
#[derive(Clone, Copy, Debug)]
pub struct SortedSpheres<'a, R> {
    /// Number of spheres whose nearer root alone counts.
    pub opaque_count: usize,
    /// Number of spheres whose roots both count.
    pub two_root_count: usize,
    /// Spheres described relative to a point on their surface.
    pub anchored: &'a [AnchoredSphere<R>],
    /// Whether a hierarchy holds the spheres of one and two roots.
    pub has_hierarchy: bool,
    /// Whether a sphere is so small for its distance that a hit's depth hardly determines where on it the hit is.
    pub has_specks: bool,
}

/// Between these indices, the refracted direction computed from the cosine of incidence is accurate to rounding. Beyond
/// them, rounding of the cosine loses the critical angle.
const GENTLE_INDICES: [f64; 2] = [0.25, 4.0];

/// For paths of up to this many rays inside glass, each ray may change the angle of incidence by a rounding error, and
/// the critical angle is still accurate to 1e-6.
const GENTLE_DEPTH: u32 = 64;

/// A feature's type, as a pipeline override.
trait Override: Copy {
    const TYPE: &'static str = "u32";
    /// The value on the device; booleans become 0 or 1.
    fn number(self) -> u32;
}

impl Override for bool {
    const TYPE: &'static str = "bool";
    fn number(self) -> u32 {
        u32::from(self)
    }
}

impl Override for u32 {
    fn number(self) -> u32 {
        self
    }
}

impl<T: Tag> Override for T {
    fn number(self) -> u32 {
        self.tag()
    }
}

/// The declaration of the override for the feature `name`.
fn declared<T: Override>(name: &str, default: T) -> String {
    let number = default.number();
    let literal = if T::TYPE == "bool" { (number != 0).to_string() } else { format!("{number}u") };
    format!("override {}: {} = {literal};\n", name.to_uppercase(), T::TYPE)
}

/// Declares [`Features`]. Each feature has a type and, in brackets: the value that needs no kernel code (`off`); the
/// value in a kernel that leaves nothing out, if it does not affect the samples (`general`); and the part of a kernel
/// that implements it (`part`). An expression then computes the value from the job and its spheres. A feature's override
/// in WGSL is its name in capitals.
macro_rules! features {
    (
        |$job:ident, $spheres:ident|
        $(
            $(#[doc = $doc:literal])*
            $name:ident: $type:ty [
                off $off:expr
                $(, general $general:expr)?
                $(, part $part:ident)?
            ] = $answer:expr;
        )*
    ) => {
        /// The features that a job needs from a kernel, which leaves out the code for everything else.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub struct Features {
            $($(#[doc = $doc])* pub $name: $type,)*
        }

        impl<const PARTS: u32> KernelFeatures<'_, PARTS> {
            $(
                $(#[doc = $doc])*
                #[inline(always)]
                pub fn $name(self) -> $type {
                    let part = last!(parts::NONE $(, parts::$part)?);
                    if parts::include(PARTS, part) { self.0.$name } else { $off }
                }
            )*
        }

        impl Default for Features {
            /// A kernel with everything that a job without stage rules and hierarchy may need.
            fn default() -> Self {
                Features { $($name: last!($off $(, $general)?),)* }
            }
        }

        impl Features {
            /// The features that a job needs, given how its spheres are sorted.
            pub fn of<R>($job: &RenderJob, $spheres: &SortedSpheres<R>) -> Self {
                Features { $($name: $answer,)* }
            }

            /// Enables every feature that does not affect the samples, to measure the gain of specialising.
            pub fn generalised(self) -> Self {
                Features { $($name: last!(self.$name $(, $general)?),)* }
            }

            /// The parts of a kernel that implement these features: bits of [`parts`].
            pub fn parts(&self) -> u32 {
                0 $(| if self.$name == $off { 0 } else { last!(parts::NONE $(, parts::$part)?) })*
            }

            /// The pipeline overrides: their WGSL names and values.
            pub fn overrides(&self) -> Vec<(String, f64)> {
                vec![$((stringify!($name).to_uppercase(), f64::from(self.$name.number()))),*]
            }

            /// The declarations of the overrides, with these values as defaults.
            pub(super) fn wgsl(&self) -> String {
                [$(declared(stringify!($name), self.$name)),*].concat()
            }
        }
    };
}

/// A job's features as a kernel with these parts sees them. Without the part that implements it, a feature is off, and
/// the compiler removes its code.
#[derive(Clone, Copy)]
pub struct KernelFeatures<'f, const PARTS: u32>(&'f Features);

impl Features {
    /// The features in a kernel with the parts `PARTS`.
    #[inline(always)]
    pub fn in_kernel<const PARTS: u32>(&self) -> KernelFeatures<'_, PARTS> {
        KernelFeatures(self)
    }
}

features! {
    |job, spheres|
    /// The scene has Lambertian surfaces.
    lambertian: bool [off false, general true] =
        occurs(job, |material| matches!(material, Material::Lambertian { .. }));
    /// The scene has metals.
    metal: bool [off false, general true] =
        occurs(job, |material| matches!(material, Material::Metal { .. }));
    /// The scene has metals with fuzz.
    fuzz: bool [off false, general true] = occurs(job, |material| material.effective_fuzz() > 0.0);
    /// The scene has glass.
    glass: bool [off false, general true, part GLASS] =
        occurs(job, |material| matches!(material, Material::Dielectric { .. }));
    /// The camera has a lens of nonzero radius.
    lens: bool [off false, general true, part LENS] = job.camera().defocus_angle_degrees > 0.0;
    /// There are spheres that a ray can be inside of, or a hierarchy.
    two_root: bool [off false, general true, part GLASS] = spheres.two_root_count > 0;
    /// There are spheres described relative to a point on their surface.
    anchored: bool [off false, general true, part EXTREMES] = !spheres.anchored.is_empty();
    /// The eye is on the surface of an anchored sphere, so that camera rays start there.
    eye_on_surface: bool [off false, general true, part EXTREMES] =
        spheres.anchored.iter().any(AnchoredSphere::is_under_eye);
    /// An anchored opaque sphere encloses every ray.
    cavity: bool [off false, general true, part EXTREMES] =
        spheres.anchored.iter().any(|sphere| sphere.roots() == Roots::Farther);
    /// There are spheres that are small relative to their distance: hit points are found from the offset across the
    /// ray.
    specks: bool [off false, part EXTREMES] = spheres.has_specks;
    /// There is glass whose critical angle needs more precision than a rounded cosine has, or has to hold for many
    /// rays.
    steep_glass: bool [off false, part EXTREMES] = has_steep_glass(job);
    /// The scene has a hierarchy.
    hierarchy: bool [off false, part HIERARCHY] = spheres.has_hierarchy;
    /// The spheres fit the uniform buffer, and the next two counts are those of the scene.
    few_spheres: bool [off false, general false] = are_few(spheres);
    /// Number of spheres with one root, if there are few spheres.
    opaque_count: u32 [off 0, general 0] = if are_few(spheres) { spheres.opaque_count as u32 } else { 0 };
    /// Number of spheres with two roots, if there are few spheres.
    two_root_count: u32 [off 0, general 0] = if are_few(spheres) { spheres.two_root_count as u32 } else { 0 };
    /// The anchored spheres fit the uniform buffer, and the next count is that of the scene.
    few_anchored: bool [off false, general false] = spheres.anchored.len() <= UNIFORM_ANCHORED;
    /// Number of anchored spheres, if there are few.
    anchored_count: u32 [off 0, general 0] =
        if spheres.anchored.len() <= UNIFORM_ANCHORED { spheres.anchored.len() as u32 } else { 0 };
    /// The sampler, which generates the numbers of a sample.
    sampler: SamplerKind [off SamplerKind::Sobol] = job.settings().sampler;
    /// Samples are spread over the pixel.
    antialiasing: bool [off true, part RULES] = job.rules().antialiasing;
    /// Any rays are traced.
    rays: bool [off true] = job.rules().shading != Shading::ImageGradient;
    /// How rays leave the surface that they start on.
    surface: SurfaceRule [off SurfaceRule::Exact, part RULES] = job.rules().surface;
    /// Lambertian surfaces scatter uniformly over the hemisphere.
    hemisphere: bool [off false, part RULES] = job.rules().diffuse == Diffuse::Hemisphere;
    /// The reflectance depends on the picture strip.
    reflectance_strips: bool [off false, part RULES] = job.rules().reflectance_strips;
    /// Paths may be too long for one dispatch: its threads suspend them, and those of a workgroup share its blocks of
    /// samples. Only the renderer on the GPU knows the length of a dispatch, and clears this where all paths fit.
    suspends: bool [off true, general true] = true;
    /// The contribution of a ray.
    shading: Shading [off Shading::Path, part RULES] = job.rules().shading;
    /// The laws that glass obeys.
    dielectric_laws: DielectricLaws [off DielectricLaws::Schlick, part RULES] = job.rules().dielectric;
}

fn occurs(job: &RenderJob, is_such: impl Fn(&Material) -> bool) -> bool {
    let scene = job.scene();
    scene.spheres.iter().any(|sphere| is_such(scene.material_of(sphere)))
}

fn are_few<R>(spheres: &SortedSpheres<R>) -> bool {
    !spheres.has_hierarchy && spheres.opaque_count + spheres.two_root_count <= UNIFORM_SPHERES
}

/// Whether glass needs more precise angles than a rounded cosine gives.
fn has_steep_glass(job: &RenderJob) -> bool {
    let many_rays = job.settings().max_depth > GENTLE_DEPTH;
    let [least, most] = GENTLE_INDICES;
    job.rules().surface == SurfaceRule::Exact
        && job.scene().materials.iter().any(|named| match named.material {
            Material::Dielectric { refraction_index } => {
                many_rays || !(least..=most).contains(&refraction_index)
            }
            _ => false,
        })
}
