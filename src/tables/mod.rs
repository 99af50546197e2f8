//! What a kernel reads: the job, rounded once to the kernel's precision and laid out flat.

pub mod cwbvh;
pub mod hierarchy;
mod real;

pub use real::{Real, Row};

use crate::film::FIXED_POINT_SCALE;
use crate::render::{RenderJob, RenderSettings};
use crate::scene::{Camera, Material, Scene, Sphere};
use crate::stages::{Rules, Surface};
use glam::DVec3;
use hierarchy::Hierarchy;
use std::time::{Duration, Instant};

/// Spheres from which on there is a hierarchy. On generated fields at 8 lanes the list was faster with 4 spheres
/// and the hierarchy with 48, by a tenth; between 12 and 32 they were alike.
const HIERARCHY_MIN_SPHERES: usize = 24;

/// In place of a sphere's number: no sphere.
pub const NONE: u32 = u32::MAX;

/// Below this squared length, the normal plus a unit vector is a rounding error, and the normal stands in.
pub const NEAR_ZERO: f64 = 1e-14;

/// A sphere is anchored when rounding at its radius, `f32::EPSILON / 2` of it, exceeds this share of the
/// scene's smallest length. At that point the perpendicular form's distances are off by some `1e-4` of that
/// length.
const ANCHOR_SHARE: f64 = 5e-5;

/// A job's spheres, materials, camera and sky for a kernel of precision `R`.
///
/// Spheres are numbered by their row, in the order `opaque`, `two_root`, `anchored`.
#[derive(Clone, Debug)]
pub struct Tables<R> {
    /// Centre and squared radius of spheres that no ray is ever inside of: only the nearer root counts.
    pub opaque: Vec<[R; 4]>,
    /// Centre and squared radius of the others, or of all when there is a hierarchy (in the order of its leaves).
    pub two_root: Vec<[R; 4]>,
    /// Huge spheres, seen from a point on their surface.
    pub anchored: Vec<AnchoredSphere<R>>,
    /// Over `two_root`.
    pub hierarchy: Option<Hierarchy<R>>,
    /// Wall time that building it took.
    pub hierarchy_time: Duration,
    /// By row, what shading needs: centre or anchor, 1/radius | albedo, weight of the unit vector (with a minus
    /// sign where the direction is a reflection) | radius, refraction index (0: not glass), its inverse,
    /// Schlick's share at normal incidence | the anchor's inward unit normal, 1 if anchored.
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
    groups: Groups,
}

/// Which spheres are intersected how: indices in the scene, rising.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Groups {
    opaque: Vec<u32>,
    two_root: Vec<u32>,
    anchored: Vec<u32>,
}

impl Groups {
    fn of(job: &RenderJob) -> Self {
        let (scene, camera) = (job.scene(), job.camera());
        let exact = job.rules().surface == Surface::Exact;
        let scale = smallest_length(scene, camera);
        let is_anchored =
            |s: &Sphere| exact && f64::from(f32::EPSILON) / 2.0 * s.radius > ANCHOR_SHARE * scale;
        let lens_radius =
            camera.effective_focus_distance() * (camera.defocus_angle_degrees.to_radians() / 2.0).tan();
        let needs_both_roots = |s: &Sphere| {
            matches!(scene.material_of(s), Material::Dielectric { .. })
                || holds_the_eye(s, camera, lens_radius)
        };
        let mut groups = Groups::default();
        for (index, sphere) in scene.spheres.iter().enumerate() {
            let group = if is_anchored(sphere) {
                &mut groups.anchored
            } else if needs_both_roots(sphere) {
                &mut groups.two_root
            } else {
                &mut groups.opaque
            };
            group.push(index as u32);
        }
        groups
    }
}

/// A sphere far larger than the scene: `anchor` is a point on it near the scene, `inward` the unit vector from
/// there to the centre, `curvature` the inverse of the radius.
#[derive(Clone, Copy, Debug)]
pub struct AnchoredSphere<R> {
    /// A point of the surface.
    pub anchor: [R; 3],
    /// Unit vector from the anchor to the centre.
    pub inward: [R; 3],
    /// 1 / radius.
    pub curvature: R,
}

/// The camera in the form that gives a ray with a few multiplications and no difference of far points.
///
/// A pixel position `p` (with the point in the pixel) lies at `s = p scale + offset` on the plane at distance 1.
/// With a point `xi` of the unit disk on the lens, the direction is
/// `(s.x - tau xi.x) u + (s.y - tau xi.y) v - w`, the origin `eye + focus_tau (xi.x u + xi.y v)`.
#[derive(Clone, Copy, Debug)]
pub struct CameraTable<R> {
    /// The eye.
    pub eye: [R; 3],
    /// Right.
    pub u: [R; 3],
    /// Up.
    pub v: [R; 3],
    /// Against the view.
    pub w: [R; 3],
    /// Of x and y.
    pub scale: [R; 2],
    /// Of x and y.
    pub offset: [R; 2],
    /// Tangent of half the defocus angle; 0 without a lens.
    pub tau: R,
    /// Radius of the lens.
    pub focus_tau: R,
}

impl<R: Real> CameraTable<R> {
    /// For a picture of `width` by `height` pixels.
    pub fn new(camera: &Camera, width: u32, height: u32) -> Self {
        let basis = camera.basis();
        let half_height = (camera.vfov_degrees.to_radians() / 2.0).tan();
        let half_width = half_height * f64::from(width) / f64::from(height);
        let tau = (camera.defocus_angle_degrees.to_radians() / 2.0).tan();
        CameraTable {
            eye: rounded(camera.look_from),
            u: rounded(basis.u),
            v: rounded(basis.v),
            w: rounded(basis.w),
            scale: [
                R::from_f64(2.0 * half_width / f64::from(width)),
                R::from_f64(-2.0 * half_height / f64::from(height)),
            ],
            offset: [R::from_f64(-half_width), R::from_f64(half_height)],
            tau: R::from_f64(tau),
            focus_tau: R::from_f64(camera.effective_focus_distance() * tau),
        }
    }
}

impl<R: Copy> CameraTable<R> {
    /// The same in another form of number.
    pub fn map<T>(&self, f: impl Fn(R) -> T) -> CameraTable<T> {
        CameraTable {
            eye: self.eye.map(&f),
            u: self.u.map(&f),
            v: self.v.map(&f),
            w: self.w.map(&f),
            scale: self.scale.map(&f),
            offset: self.offset.map(&f),
            tau: f(self.tau),
            focus_tau: f(self.focus_tau),
        }
    }
}

impl<R: Real> Tables<R> {
    /// Sorts, anchors and rounds the scene, and builds the hierarchy if one is worth it.
    pub fn new(job: &RenderJob) -> Self {
        let groups = Groups::of(job);
        let has_hierarchy = job.rules().surface == Surface::Exact
            && groups.opaque.len() + groups.two_root.len() >= HIERARCHY_MIN_SPHERES;
        if !has_hierarchy {
            return Tables::from_groups(job, &groups.opaque, &groups.two_root, &groups.anchored);
        }
        let begin = Instant::now();
        let all: Vec<u32> = groups.opaque.iter().chain(&groups.two_root).copied().collect();
        let (hierarchy, mut two_root) =
            Hierarchy::build(all.iter().map(|i| &job.scene().spheres[*i as usize]));
        two_root.iter_mut().for_each(|i| *i = all[*i as usize]);
        drop(all);
        let hierarchy_time = begin.elapsed();
        let tables = Tables::from_groups(job, &[], &two_root, &groups.anchored);
        Tables { hierarchy: Some(hierarchy), hierarchy_time, groups, ..tables }
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
        let is_same = self.hierarchy.is_some() && job.shares_scene_with(before);
        if !is_same || Groups::of(job) != self.groups {
            return false;
        }
        let settings = *job.settings();
        self.camera = CameraTable::new(job.camera(), settings.width, settings.height);
        self.settings = settings;
        self.hierarchy_time = Duration::ZERO;
        true
    }

    /// Memory that grows with the number of spheres.
    pub fn bytes(&self) -> usize {
        let Groups { opaque, two_root, anchored } = &self.groups;
        let indices = [opaque, two_root, anchored, &self.scene_index];
        let packed = [&self.opaque, &self.two_root];
        let nodes = self.hierarchy.as_ref().map_or(0, |hierarchy| size_of_val(hierarchy.nodes.as_slice()));
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

    fn from_groups(job: &RenderJob, opaque: &[u32], two_root: &[u32], anchored: &[u32]) -> Self {
        let (scene, settings) = (job.scene(), *job.settings());
        let sphere = |index: &u32| &scene.spheres[*index as usize];
        let packed = |index: &u32| {
            let s = sphere(index);
            [s.center.x, s.center.y, s.center.z, s.radius * s.radius].map(R::from_f64)
        };
        let focus = focus_of_interest(scene, anchored, job.camera());
        let anchored_spheres: Vec<_> =
            anchored.iter().map(|i| AnchoredSphere::new(sphere(i), focus)).collect();
        let mut rows = Vec::with_capacity(scene.spheres.len().max(1));
        rows.extend(opaque.iter().chain(two_root).map(|i| shading_row(scene, sphere(i), None)));
        rows.extend(
            anchored.iter().zip(&anchored_spheres).map(|(i, a)| shading_row(scene, sphere(i), Some(a))),
        );
        if rows.is_empty() {
            // A ray that hits nothing looks up row 0 and ignores it.
            rows.push(Row::default());
        }
        let (bottom, top) = (scene.sky.bottom * FIXED_POINT_SCALE, scene.sky.top * FIXED_POINT_SCALE);
        Tables {
            opaque: opaque.iter().map(packed).collect(),
            two_root: two_root.iter().map(packed).collect(),
            anchored: anchored_spheres,
            hierarchy: None,
            hierarchy_time: Duration::ZERO,
            rows,
            scene_index: opaque.iter().chain(two_root).chain(anchored).copied().collect(),
            camera: CameraTable::new(job.camera(), settings.width, settings.height),
            sky_middle: rounded((bottom + top) / 2.0),
            sky_slope: rounded((top - bottom) / 2.0),
            block_limit: block_limit(scene.sky.bottom.max(scene.sky.top).max_element()),
            settings,
            rules: *job.rules(),
            groups: Groups::default(),
        }
    }
}

impl<R: Real> AnchoredSphere<R> {
    fn new(sphere: &Sphere, focus: DVec3) -> Self {
        let towards = (focus - sphere.center).try_normalize().unwrap_or(DVec3::Y);
        let anchor: [R; 3] = rounded(sphere.center + towards * sphere.radius);
        let [x, y, z] = anchor.map(R::to_f64);
        let inward = (sphere.center - DVec3::new(x, y, z)).normalize();
        AnchoredSphere { anchor, inward: rounded(inward), curvature: R::from_f64(1.0 / sphere.radius) }
    }
}

fn shading_row<R: Real>(scene: &Scene, sphere: &Sphere, anchored: Option<&AnchoredSphere<R>>) -> Row<R> {
    let (albedo, weight, index) = match *scene.material_of(sphere) {
        Material::Lambertian { albedo } => (albedo, 1.0, 0.0),
        Material::Metal { albedo, fuzz } => (albedo, -fuzz.clamp(0.0, 1.0), 0.0),
        Material::Dielectric { refraction_index } => (DVec3::ONE, -0.0, refraction_index),
    };
    let normal_share = ((1.0 - index) / (1.0 + index)).powi(2);
    let inverse_index = if index > 0.0 { 1.0 / index } else { 0.0 };
    let r = R::from_f64;
    let [x, y, z] = anchored.map_or_else(|| rounded(sphere.center), |a| a.anchor);
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
        r(index),
        r(inverse_index),
        r(normal_share),
        mx,
        my,
        mz,
        r(if anchored.is_some() { 1.0 } else { 0.0 }),
    ])
}

fn rounded<R: Real>(v: DVec3) -> [R; 3] {
    v.to_array().map(R::from_f64)
}

/// The smallest length that the picture can show a fault of: a radius, a distance from the eye to a surface, or
/// the distance that the camera looks at.
fn smallest_length(scene: &Scene, camera: &Camera) -> f64 {
    let view = camera.effective_focus_distance().min(camera.look_from.distance(camera.look_at));
    scene.spheres.iter().fold(view, |length, s| {
        let height = (camera.look_from.distance(s.center) - s.radius).abs();
        let length = length.min(s.radius);
        if height > 0.0 { length.min(height) } else { length }
    })
}

/// Whether a ray from the camera can start inside the sphere.
fn holds_the_eye(sphere: &Sphere, camera: &Camera, lens_radius: f64) -> bool {
    // The margin is far above what rounding can move the eye by.
    let reach = sphere.radius * (1.0 + 1e-5) + lens_radius * (1.0 + 1e-5);
    camera.look_from.distance(sphere.center) <= reach + 1e-6 * camera.look_from.abs().max_element()
}

/// Where the picture's detail is: the mean centre of the spheres that are not anchored, or else where the
/// camera looks.
fn focus_of_interest(scene: &Scene, anchored: &[u32], camera: &Camera) -> DVec3 {
    let is_anchored = |index: usize| anchored.binary_search(&(index as u32)).is_ok();
    let (mut sum, mut count) = (DVec3::ZERO, 0.0);
    for (_, sphere) in scene.spheres.iter().enumerate().filter(|(i, _)| !is_anchored(*i)) {
        sum += sphere.center;
        count += 1.0;
    }
    if count > 0.0 { sum / count } else { camera.look_at }
}

/// Most samples, as a power of two, whose sum is sure to fit 32 bits.
fn block_limit(largest_radiance: f64) -> u32 {
    let largest = (largest_radiance * FIXED_POINT_SCALE).ceil().max(1.0);
    let fitting = (f64::from(u32::MAX) / largest).clamp(1.0, 128.0) as u32;
    1 << fitting.ilog2()
}
