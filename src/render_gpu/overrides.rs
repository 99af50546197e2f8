//! What a kernel is specialised by: override constants, from what a job needs.

use super::layout::{UNIFORM_ANCHORED, UNIFORM_SPHERES};
use super::shader_source::{laws_tag, shading_tag};
use crate::render::{RenderJob, SamplerKind};
use crate::stages::{DielectricLaws, Diffuse, Shading, Surface};
use crate::tables::Tables;

/// What a kernel is specialised by. Code that a flag switches off is not in the kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Overrides {
    /// Lambertian surfaces.
    pub lambertian: bool,
    /// Metals.
    pub metal: bool,
    /// Metals with fuzz.
    pub fuzz: bool,
    /// Glass.
    pub glass: bool,
    /// A lens.
    pub lens: bool,
    /// Spheres that a ray can be inside of.
    pub two_root: bool,
    /// Spheres that are seen from a point on their surface.
    pub anchored: bool,
    /// The eye is on the surface of one of them.
    pub eye_on_surface: bool,
    /// One of them holds every ray.
    pub cavity: bool,
    /// Spheres that are small beside their distance.
    pub specks: bool,
    /// Glass whose angles must be known better than from a cosine.
    pub steep_glass: bool,
    /// A hierarchy.
    pub hierarchy: bool,
    /// It is the compressed one.
    pub cwbvh: bool,
    /// The spheres fit the uniform buffer, and the next two counts are those of the scene.
    pub few_spheres: bool,
    /// Spheres of one root.
    pub opaque_count: u32,
    /// Spheres of two.
    pub two_root_count: u32,
    /// The anchored spheres fit the uniform buffer, and the next count is that of the scene.
    pub few_anchored: bool,
    /// Anchored spheres.
    pub anchored_count: u32,
    /// The Sobol sampler, else independent numbers.
    pub sobol: bool,
    /// Samples are spread over the pixel.
    pub antialiasing: bool,
    /// Rays are traced at all.
    pub rays: bool,
    /// How rays leave the surface that they start on.
    pub surface: Surface,
    /// Lambertian surfaces send light evenly over the hemisphere.
    pub hemisphere: bool,
    /// The reflectance is that of the picture's strip.
    pub reflectance_strips: bool,
    /// Paths can be too long for one dispatch: see [`super::TURN_LIMIT`].
    pub aside: bool,
    /// What a ray brings back.
    pub shading: Shading,
    /// The laws of glass.
    pub dielectric_laws: DielectricLaws,
}

/// The value of an override constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Constant {
    /// A `bool`.
    Flag(bool),
    /// A `u32`.
    Number(u32),
    /// An `f32`.
    Real(f64),
}

impl Constant {
    /// As the device takes it.
    pub fn value(self) -> f64 {
        match self {
            Constant::Flag(flag) => f64::from(u8::from(flag)),
            Constant::Number(number) => f64::from(number),
            Constant::Real(real) => real,
        }
    }
}

impl Default for Overrides {
    /// The kernel that leaves nothing out but the hierarchy and the stages' rules.
    fn default() -> Self {
        Overrides {
            lambertian: true,
            metal: true,
            fuzz: true,
            glass: true,
            lens: true,
            two_root: true,
            anchored: true,
            eye_on_surface: true,
            cavity: true,
            specks: false,
            steep_glass: false,
            hierarchy: false,
            cwbvh: false,
            few_spheres: false,
            opaque_count: 0,
            two_root_count: 0,
            few_anchored: false,
            anchored_count: 0,
            sobol: true,
            antialiasing: true,
            rays: true,
            surface: Surface::Exact,
            hemisphere: false,
            reflectance_strips: false,
            aside: true,
            shading: Shading::Path,
            dielectric_laws: DielectricLaws::Schlick,
        }
    }
}

impl Overrides {
    /// The kernel that carries no more than a job needs.
    pub fn specialised(job: &RenderJob, tables: &Tables<f32>) -> Self {
        let features = job.features();
        let rules = job.rules();
        let listed = tables.opaque.len() + tables.two_root.len();
        let few_spheres = tables.hierarchy.is_none() && listed <= UNIFORM_SPHERES;
        let few_anchored = tables.anchored.len() <= UNIFORM_ANCHORED;
        Overrides {
            lambertian: features.lambertian,
            metal: features.metal,
            fuzz: features.fuzz,
            glass: features.dielectric,
            lens: features.lens,
            two_root: !tables.two_root.is_empty(),
            anchored: !tables.anchored.is_empty(),
            eye_on_surface: tables.is_eye_on_surface(),
            cavity: tables.is_eye_in_cavity(),
            specks: tables.has_specks,
            steep_glass: tables.has_steep_glass,
            few_spheres,
            opaque_count: if few_spheres { tables.opaque.len() as u32 } else { 0 },
            two_root_count: if few_spheres { tables.two_root.len() as u32 } else { 0 },
            few_anchored,
            anchored_count: if few_anchored { tables.anchored.len() as u32 } else { 0 },
            hierarchy: tables.hierarchy.is_some(),
            cwbvh: false,
            rays: features.rays,
            sobol: job.settings().sampler == SamplerKind::Sobol,
            antialiasing: rules.antialiasing,
            surface: rules.surface,
            hemisphere: rules.diffuse == Diffuse::Hemisphere,
            reflectance_strips: rules.reflectance_strips,
            aside: true,
            shading: rules.shading,
            dielectric_laws: rules.dielectric,
        }
    }

    /// The kernel that leaves out nothing that leaves the job's samples as they are: to measure what
    /// specialising gains.
    pub fn general(job: &RenderJob, tables: &Tables<f32>) -> Self {
        let needed = Overrides::specialised(job, tables);
        Overrides {
            specks: needed.specks,
            steep_glass: needed.steep_glass,
            hierarchy: needed.hierarchy,
            rays: needed.rays,
            sobol: needed.sobol,
            antialiasing: needed.antialiasing,
            surface: needed.surface,
            hemisphere: needed.hemisphere,
            reflectance_strips: needed.reflectance_strips,
            shading: needed.shading,
            dielectric_laws: needed.dielectric_laws,
            ..Overrides::default()
        }
    }

    /// Names in the shader and values.
    pub fn constants(&self) -> Vec<(&'static str, Constant)> {
        use Constant::{Flag, Number, Real};
        vec![
            ("LAMBERTIAN", Flag(self.lambertian)),
            ("METAL", Flag(self.metal)),
            ("FUZZ", Flag(self.fuzz)),
            ("GLASS", Flag(self.glass)),
            ("LENS", Flag(self.lens)),
            ("TWO_ROOT", Flag(self.two_root)),
            ("ANCHORED", Flag(self.anchored)),
            ("EYE_ON_SURFACE", Flag(self.eye_on_surface)),
            ("CAVITY", Flag(self.cavity)),
            ("SPECKS", Flag(self.specks)),
            ("STEEP_GLASS", Flag(self.steep_glass)),
            ("HIERARCHY", Flag(self.hierarchy)),
            ("CWBVH", Flag(self.cwbvh)),
            ("FEW_SPHERES", Flag(self.few_spheres)),
            ("OPAQUE_COUNT", Number(self.opaque_count)),
            ("TWO_ROOT_COUNT", Number(self.two_root_count)),
            ("FEW_ANCHORED", Flag(self.few_anchored)),
            ("ANCHORED_COUNT", Number(self.anchored_count)),
            ("SOBOL", Flag(self.sobol)),
            ("ANTIALIASING", Flag(self.antialiasing)),
            ("RAYS", Flag(self.rays)),
            ("BOOK_ARITHMETIC", Flag(self.surface != Surface::Exact)),
            ("BOOK_T_MIN", Real(self.surface.smallest_distance().unwrap_or(0.0))),
            ("HEMISPHERE", Flag(self.hemisphere)),
            ("REFLECTANCE_STRIPS", Flag(self.reflectance_strips)),
            ("ASIDE", Flag(self.aside)),
            ("SHADING", Number(shading_tag(self.shading))),
            ("DIELECTRIC_LAWS", Number(laws_tag(self.dielectric_laws))),
        ]
    }

    /// What the kernel contains, for reports: `lambertian, metal, glass, 5 spheres in constants`.
    pub fn summary(&self) -> String {
        let mut words: Vec<String> = [
            (self.lambertian, "lambertian"),
            (self.metal, "metal"),
            (self.fuzz, "fuzz"),
            (self.glass, "glass"),
            (self.lens, "lens"),
            (self.two_root, "two roots"),
            (self.anchored, "anchored"),
            (self.eye_on_surface, "eye on a surface"),
            (self.cavity, "cavity"),
            (self.specks, "specks"),
            (self.steep_glass, "steep glass"),
            (self.hierarchy && !self.cwbvh, "hierarchy"),
            (self.hierarchy && self.cwbvh, "compressed hierarchy"),
            (self.surface == Surface::Acne, "acne"),
            (self.surface == Surface::Book, "the book's arithmetic"),
            (self.hemisphere, "hemisphere"),
            (self.reflectance_strips, "strips"),
        ]
        .into_iter()
        .filter(|(on, _)| *on)
        .map(|(_, word)| word.to_owned())
        .collect();
        if self.few_spheres {
            words.push(format!("{} spheres in constants", self.opaque_count + self.two_root_count));
        }
        words.join(", ")
    }
}
