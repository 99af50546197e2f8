//! What a kernel reads: the job, rounded once to the kernel's precision and laid out flat.

mod camera;
pub mod cwbvh;
mod facts;
mod groups;
pub mod hierarchy;
mod parted;
mod real;

pub use camera::CameraTable;
pub use groups::Roots;
pub use real::{Real, Row};

use crate::film::FIXED_POINT_SCALE;
use crate::render::{RenderJob, RenderSettings};
use crate::scene::{Material, Scene, Sphere};
use crate::stages::{Rules, Surface};
use facts::Facts;
use glam::DVec3;
use groups::{Anchored, Groups};
use hierarchy::Hierarchy;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Spheres from which on there is a hierarchy. On generated fields at 8 lanes the list was faster with 4 spheres
/// and the hierarchy with 48, by a tenth; between 12 and 32 they were alike.
const HIERARCHY_MIN_SPHERES: usize = 24;

/// In place of a sphere's number: no sphere.
pub const NONE: u32 = u32::MAX;

/// Below this squared length, the normal plus a unit vector is a rounding error, and the normal stands in.
pub const NEAR_ZERO: f64 = 1e-14;

/// Where a ray starts in place of a sphere that it leaves: at an eye on the surface of one.
pub const EYE: u32 = u32::MAX - 1;

/// Between these refraction indices a refracted direction is good to rounding when it is worked out from the cosine of
/// incidence; beyond them the critical angle is lost in its rounding.
const GENTLE_INDICES: [f64; 2] = [0.25, 4.0];

/// In glass that a path does not leave, each of so many rays may move the angle of incidence by a rounding error and
/// still the critical angle is held to 1e-6.
const GENTLE_DEPTH: u32 = 64;

/// A job's spheres, materials, camera and sky for a kernel of precision `R`.
///
/// Spheres are numbered by their row, in the order `opaque`, `two_root`, `anchored`.
#[derive(Clone, Debug)]
pub struct Tables<R> {
    /// Centre and squared radius of spheres that no ray is ever inside of: only the nearer root counts.
    pub opaque: Vec<[R; 4]>,
    /// Centre and squared radius of the others. Where there is a hierarchy, all spheres, in the order of its leaves,
    /// the squared radius with a minus sign where only the nearer root counts.
    pub two_root: Vec<[R; 4]>,
    /// Spheres that are seen from a point on their surface: huge ones, and those that the eye is in or on.
    pub anchored: Vec<AnchoredSphere<R>>,
    /// Over `two_root`.
    pub hierarchy: Option<Hierarchy<R>>,
    /// Wall time that building it took.
    pub hierarchy_time: Duration,
    /// By row, what shading needs: centre or anchor, 1/radius | albedo, weight of the unit vector (with a minus
    /// sign where the direction is a reflection) | radius, refraction index (0: not glass), its inverse,
    /// Schlick's share at normal incidence | the anchor's inward unit normal, 1 if anchored, 2 if every ray is inside.
    pub rows: Vec<Row<R>>,
    /// By row, the sphere's index in the scene.
    pub scene_index: Vec<u32>,
    /// The camera.
    pub camera: CameraTable<R>,
    /// Sky radiance at the horizon times `2^24`, linear RGB.
    pub sky_middle: [R; 3],
    /// Growth of the sky radiance with the direction's y, times `2^24`.
    pub sky_slope: [R; 3],
    /// Most samples whose sum in units of `2^-24` fits 32 bits: a power of two.
    pub block_limit: u32,
    /// Size, depth, sampler, seed, halves.
    pub settings: RenderSettings,
    /// The rules in force.
    pub rules: Rules,
    /// A sphere is small beside its distance: where a ray meets it is told by the way across the ray, not along it.
    pub has_specks: bool,
    /// Glass whose critical angle must be known better than from a rounded cosine, or for many rays.
    pub has_steep_glass: bool,
    /// What coordinates are measured from, in the scene's.
    pub origin: DVec3,
    groups: Groups,
    facts: Arc<Facts>,
    warnings: Vec<String>,
}

/// A sphere as seen from a point of its surface: `anchor` is that point, near what is looked at, `inward` the unit
/// vector from there to the centre, `curvature` the inverse of the radius.
#[derive(Clone, Copy, Debug)]
pub struct AnchoredSphere<R> {
    /// A point of the surface.
    pub anchor: [R; 3],
    /// Unit vector from the anchor to the centre.
    pub inward: [R; 3],
    /// 1 / radius.
    pub curvature: R,
    /// Which of the distances to it count.
    pub roots: Roots,
    /// Whether the eye is a point of the surface, and on its outer side: rays that start at [`EYE`] and go outwards
    /// leave it, the others meet it where they start.
    pub under_eye: bool,
}

impl<R: Real> Tables<R> {
    /// Sorts, anchors and rounds the scene, and builds the hierarchy if one is worth it.
    pub fn new(job: &RenderJob) -> Self {
        Tables::with_hierarchy_from(job, HIERARCHY_MIN_SPHERES)
    }

    /// The same without a hierarchy, however many spheres there are: to compare with.
    pub fn as_list(job: &RenderJob) -> Self {
        Tables::with_hierarchy_from(job, usize::MAX)
    }

    fn with_hierarchy_from(job: &RenderJob, least_spheres: usize) -> Self {
        let facts = Arc::new(Facts::of(job.scene()));
        let groups = Groups::of(job, &facts);
        let has_hierarchy = job.rules().surface == Surface::Exact
            && groups.opaque.len() + groups.two_root.len() >= least_spheres;
        let begin = Instant::now();
        let (mut listed, mut hierarchy) = (groups.in_list_order(), None);
        if has_hierarchy {
            let spheres = listed.iter().map(|index| &job.scene().spheres[*index as usize]);
            let built = Hierarchy::build(spheres, groups.origin);
            listed = built.ranks.iter().map(|rank| listed[*rank as usize]).collect();
            hierarchy = Some(built);
        }
        let hierarchy_time = if has_hierarchy { begin.elapsed() } else { Duration::ZERO };
        let (scene, settings) = (job.scene(), *job.settings());
        let one_root = groups.opaque.len();
        let packed = |(place, index): (usize, &u32)| {
            let sphere = &scene.spheres[*index as usize];
            let center = sphere.center - groups.origin;
            // In the hierarchy the sign tells spheres of one root.
            let is_signed = hierarchy.as_ref().is_some_and(|h| (h.ranks[place] as usize) < one_root);
            let radius2 = sphere.radius * sphere.radius * if is_signed { -1.0 } else { 1.0 };
            [center.x, center.y, center.z, radius2].map(R::from_f64)
        };
        let mut opaque: Vec<[R; 4]> = listed.iter().enumerate().map(packed).collect();
        let two_root = opaque.split_off(if has_hierarchy { 0 } else { one_root });
        let mut rows = Vec::with_capacity(listed.len() + groups.anchored.len() + 1);
        rows.extend(listed.iter().map(|i| shading_row(scene, *i, groups.origin, None)));
        let (bottom, top) = (scene.sky.bottom * FIXED_POINT_SCALE, scene.sky.top * FIXED_POINT_SCALE);
        let mut tables = Tables {
            opaque,
            two_root,
            anchored: Vec::new(),
            hierarchy,
            hierarchy_time,
            rows,
            scene_index: listed,
            camera: CameraTable::new(job.camera(), settings.width, settings.height, groups.origin),
            sky_middle: rounded((bottom + top) / 2.0),
            sky_slope: rounded((top - bottom) / 2.0),
            block_limit: block_limit(scene.sky.bottom.max(scene.sky.top).max_element()),
            settings,
            rules: *job.rules(),
            has_specks: false,
            has_steep_glass: has_steep_glass(job),
            origin: groups.origin,
            groups: Groups::default(),
            facts,
            warnings: Vec::new(),
        };
        tables.see(job, groups);
        tables
    }

    /// The tables of `job`; where there are those of a job that differs in camera and settings alone, the
    /// hierarchy is not built again.
    pub fn renewed(old: Option<(Self, RenderJob)>, job: &RenderJob) -> Self {
        if let Some((mut tables, before)) = old
            && tables.follow(&before, job)
        {
            return tables;
        }
        Tables::new(job)
    }

    /// Makes the tables of `before` those of `job`, if they have a hierarchy and it would be the same, so that camera
    /// and settings alone differ; else does nothing and returns false.
    pub fn follow(&mut self, before: &RenderJob, job: &RenderJob) -> bool {
        if self.hierarchy.is_none() || !job.shares_scene_with(before) {
            return false;
        }
        let groups = Groups::of(job, &self.facts);
        if !groups.share_hierarchy(&self.groups) {
            return false;
        }
        let settings = *job.settings();
        self.camera = CameraTable::new(job.camera(), settings.width, settings.height, groups.origin);
        self.settings = settings;
        self.has_steep_glass = has_steep_glass(job);
        self.hierarchy_time = Duration::ZERO;
        self.see(job, groups);
        true
    }

    /// Sets what depends on where the eye is.
    fn see(&mut self, job: &RenderJob, groups: Groups) {
        let scene = job.scene();
        let listed = self.opaque.len() + self.two_root.len();
        self.rows.truncate(listed);
        self.scene_index.truncate(listed);
        self.anchored =
            groups.anchored.iter().map(|a| AnchoredSphere::new(scene, a, groups.origin)).collect();
        for (anchored, sphere) in groups.anchored.iter().zip(&self.anchored) {
            self.rows.push(shading_row(scene, anchored.index, groups.origin, Some(sphere)));
            self.scene_index.push(anchored.index);
        }
        if self.rows.is_empty() {
            // A ray that hits nothing looks up row 0 and ignores it.
            self.rows.push(Row::default());
        }
        self.has_specks = groups.has_specks;
        self.warnings = if job.rules().surface == Surface::Exact {
            self.facts.warnings(job, &groups)
        } else {
            Vec::new()
        };
        self.groups = groups;
    }

    /// What single precision does not hold of the scene, with the numbers and what to do.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Whether a kernel needs code that few scenes do: anchored spheres, specks, steep glass.
    pub fn is_extreme(&self) -> bool {
        !self.anchored.is_empty() || self.has_specks || self.has_steep_glass
    }

    /// Whether rays from the camera start on a surface.
    pub fn is_eye_on_surface(&self) -> bool {
        self.anchored.iter().any(|sphere| sphere.under_eye)
    }

    /// Whether all rays are inside a sphere that no light passes.
    pub fn is_eye_in_cavity(&self) -> bool {
        self.anchored.iter().any(|sphere| sphere.roots == Roots::Farther)
    }

    /// Memory that grows with the number of spheres.
    pub fn bytes(&self) -> usize {
        let Groups { opaque, two_root, .. } = &self.groups;
        let indices = [opaque, two_root, &self.scene_index];
        let packed = [&self.opaque, &self.two_root];
        let nodes = self.hierarchy.as_ref().map_or(0, |hierarchy| {
            size_of_val(hierarchy.nodes.as_slice()) + size_of_val(hierarchy.ranks.as_slice())
        });
        indices.iter().map(|list| size_of_val(list.as_slice())).sum::<usize>()
            + packed.iter().map(|list| size_of_val(list.as_slice())).sum::<usize>()
            + size_of_val(self.anchored.as_slice())
            + size_of_val(self.rows.as_slice())
            + nodes
    }

    /// The spheres of `two_root` as the scene has them. The tables must be the job's.
    pub fn spheres_of_hierarchy<'a>(&'a self, job: &'a RenderJob) -> impl Iterator<Item = &'a Sphere> {
        let indices = self.scene_index.iter().skip(self.opaque.len()).take(self.two_root.len());
        indices.map(|index| &job.scene().spheres[*index as usize])
    }
}

impl<R: Real> AnchoredSphere<R> {
    fn new(scene: &Scene, anchored: &Anchored, origin: DVec3) -> Self {
        let sphere = &scene.spheres[anchored.index as usize];
        let towards = (anchored.near - sphere.center).try_normalize().unwrap_or(DVec3::Y);
        let center = sphere.center - origin;
        let foot = if anchored.under_eye { anchored.near - origin } else { center + towards * sphere.radius };
        let anchor: [R; 3] = rounded(foot);
        let [x, y, z] = anchor.map(R::to_f64);
        let inward = (center - DVec3::new(x, y, z)).normalize();
        AnchoredSphere {
            anchor,
            inward: rounded(inward),
            curvature: R::from_f64(1.0 / sphere.radius),
            roots: anchored.roots,
            under_eye: anchored.under_eye,
        }
    }
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

fn shading_row<R: Real>(
    scene: &Scene,
    index: u32,
    origin: DVec3,
    anchored: Option<&AnchoredSphere<R>>,
) -> Row<R> {
    let sphere = &scene.spheres[index as usize];
    let (albedo, weight, refraction_index) = match *scene.material_of(sphere) {
        Material::Lambertian { albedo } => (albedo, 1.0, 0.0),
        Material::Metal { albedo, fuzz } => (albedo, -fuzz.clamp(0.0, 1.0), 0.0),
        Material::Dielectric { refraction_index } => (DVec3::ONE, -0.0, refraction_index),
    };
    let normal_share = ((1.0 - refraction_index) / (1.0 + refraction_index)).powi(2);
    let inverse_index = if refraction_index > 0.0 { 1.0 / refraction_index } else { 0.0 };
    let r = R::from_f64;
    let [x, y, z] = anchored.map_or_else(|| rounded(sphere.center - origin), |a| a.anchor);
    let [mx, my, mz] = anchored.map_or([R::default(); 3], |a| a.inward);
    Row([
        x,
        y,
        z,
        r(1.0 / sphere.radius),
        r(albedo.x),
        r(albedo.y),
        r(albedo.z),
        r(weight),
        r(sphere.radius),
        r(refraction_index),
        r(inverse_index),
        r(normal_share),
        mx,
        my,
        mz,
        r(anchored.map_or(0.0, |a| if a.roots == Roots::Farther { 2.0 } else { 1.0 })),
    ])
}

fn rounded<R: Real>(v: DVec3) -> [R; 3] {
    v.to_array().map(R::from_f64)
}

/// Most samples, as a power of two, whose sum is sure to fit 32 bits.
fn block_limit(largest_radiance: f64) -> u32 {
    let largest = (largest_radiance * FIXED_POINT_SCALE).ceil().max(1.0);
    let fitting = (f64::from(u32::MAX) / largest).clamp(1.0, 128.0) as u32;
    1 << fitting.ilog2()
}
