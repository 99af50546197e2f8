//! The prepared scene: a job rounded once to the kernel's precision and laid out flat.

mod bounded;
mod camera;
mod effort;
mod groups;
pub mod hierarchy;
mod overlaps;
mod parted;
mod regions;
pub mod wide_bvh;

use crate::film::FIXED_POINT_SCALE;
use crate::job::render::{RenderJob, RenderSettings};
use crate::kernel::{
    AnchoredSphere, CameraTable, Features, Real, RecordColumns, Roots, ShadingRecord, SortedSpheres,
    UNDER_EYE,
};
use crate::scene::{Material, Scene};
use crate::stages::SurfaceRule;
use glam::DVec3;
use groups::{Anchored, Groups};
use hierarchy::{Effort, Hierarchy};
use overlaps::Overlaps;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// From this many spheres on, a hierarchy is built. On generated fields with 8 lanes, the list was a tenth faster with
/// 4 spheres and the hierarchy a tenth faster with 48; between 12 and 32 they were equally fast.
const HIERARCHY_MIN_SPHERES: usize = 24;

/// Where a prepared scene got its hierarchy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HierarchySource {
    /// It has no hierarchy.
    None,
    /// Built for it, in this wall time.
    Built(Duration),
    /// Kept from an earlier job.
    Kept,
}

impl HierarchySource {
    /// Wall time of building the hierarchy; zero if none was built.
    pub fn time(self) -> Duration {
        match self {
            HierarchySource::Built(time) => time,
            HierarchySource::None | HierarchySource::Kept => Duration::ZERO,
        }
    }
}

/// The hierarchy that a scene of many spheres gets.
#[derive(Clone, Copy)]
enum Tree {
    /// For the CPU, built quickly.
    Quick,
    /// For the CPU, the best.
    Thorough,
    /// For the GPU.
    Wide,
}

/// A job's spheres, materials, camera and sky for a kernel of precision `R`.
///
/// A sphere's number is its row, in the order `opaque`, `two_root`, `anchored`.
#[derive(Clone, Debug)]
pub struct PreparedScene<R> {
    /// Centre and squared radius of spheres that no ray is ever inside of: only the nearer root counts.
    pub opaque: Vec<[R; 4]>,
    /// Centre and squared radius of the other spheres. With a hierarchy, these are all spheres in leaf order, and the
    /// squared radius is negative where only the nearer root counts.
    pub two_root: Vec<[R; 4]>,
    /// Huge spheres and those that the eye is in or on, described relative to a point on their surface.
    pub anchored: Vec<AnchoredSphere<R>>,
    /// The hierarchy over `two_root`, if there are enough spheres.
    pub hierarchy: Option<Hierarchy<R>>,
    pub hierarchy_source: HierarchySource,
    /// One per row.
    pub records: Vec<RecordColumns<R>>,
    /// The scene index of each row's sphere.
    pub scene_index: Vec<u32>,
    pub camera: CameraTable<R>,
    /// Sky radiance at the horizon times `2^24`, linear RGB.
    pub sky_middle: [R; 3],
    /// Growth of the sky radiance with the direction's y, times `2^24`.
    pub sky_slope: [R; 3],
    /// Maximum number of samples whose sum in units of `2^-24` fits 32 bits: a power of two.
    pub block_limit: u32,
    pub settings: RenderSettings,
    /// The features that the job needs from a kernel.
    pub features: Features,
    /// The origin of the prepared coordinates, in scene coordinates.
    pub origin: DVec3,
    groups: Groups,
    overlaps: Arc<Overlaps>,
    pub warning: Option<String>,
}

impl<R: Real> PreparedScene<R> {
    /// Sorts, anchors and rounds the scene, and builds a hierarchy if there are enough spheres.
    pub fn new(job: &RenderJob) -> Self {
        Self::made(job, Some(Tree::Quick))
    }

    /// Like [`PreparedScene::new`], with the best possible hierarchy, which may take many times as long. Both render
    /// the same bits.
    pub fn thorough(job: &RenderJob) -> Self {
        Self::made(job, Some(Tree::Thorough))
    }

    /// Like [`PreparedScene::new`], but never builds a hierarchy, for comparisons.
    pub fn as_list(job: &RenderJob) -> Self {
        Self::made(job, None)
    }

    /// Like [`PreparedScene::new`], with a hierarchy for the GPU.
    pub fn wide(job: &RenderJob) -> Self {
        Self::made(job, Some(Tree::Wide))
    }

    /// As [`PreparedScene::wide`]. Returns `None` soon after `cancel` is set. Before it
    /// builds a hierarchy, it announces the features that the job needs from a kernel.
    pub fn for_gpu(cancel: &AtomicBool, job: &RenderJob, announce: impl FnOnce(&Features)) -> Option<Self> {
        Self::with_tree(job, Some(Tree::Wide), cancel, announce)
    }

    fn made(job: &RenderJob, tree: Option<Tree>) -> Self {
        #[expect(clippy::expect_used, reason = "nothing cancels it")]
        Self::with_tree(job, tree, &AtomicBool::new(false), |_| ()).expect("it is not cancelled")
    }

    fn with_tree(
        job: &RenderJob,
        tree: Option<Tree>,
        cancel: &AtomicBool,
        announce: impl FnOnce(&Features),
    ) -> Option<Self> {
        let overlaps = Arc::new(Overlaps::of(job.scene()));
        let groups = Groups::of(job, &overlaps);
        let (mut listed, mut hierarchy, mut hierarchy_source) =
            (groups.in_list_order(), None, HierarchySource::None);
        let is_wanted = job.rules().surface == SurfaceRule::Exact && listed.len() >= HIERARCHY_MIN_SPHERES;
        if let Some(tree) = tree.filter(|_| is_wanted) {
            let anchored: Vec<AnchoredSphere<R>> =
                groups.anchored.iter().map(|a| anchored_sphere(job.scene(), a, groups.origin)).collect();
            announce(&Features::of(
                job,
                &SortedSpheres {
                    opaque_count: 0,
                    two_root_count: listed.len(),
                    anchored: &anchored,
                    has_hierarchy: true,
                    has_specks: groups.has_specks,
                },
            ));
            let begin = Instant::now();
            let spheres = listed.iter().map(|index| &job.scene().spheres[*index as usize]);
            let built = match tree {
                Tree::Quick => Hierarchy::build_unless(cancel, spheres, groups.origin, Effort::Quick),
                Tree::Thorough => Hierarchy::build_unless(cancel, spheres, groups.origin, Effort::Thorough),
                Tree::Wide => Hierarchy::build_wide(cancel, spheres, groups.origin),
            }?;
            listed = built.ranks.par_iter().map(|rank| listed[*rank as usize]).collect();
            hierarchy = Some(built);
            hierarchy_source = HierarchySource::Built(begin.elapsed());
        }
        let (scene, settings) = (job.scene(), *job.settings());
        let one_root = groups.opaque.len();
        let packed = |(place, index): (usize, &u32)| {
            let sphere = &scene.spheres[*index as usize];
            let center = sphere.center - groups.origin;
            // In the hierarchy, the sign marks spheres with one root.
            let is_signed = hierarchy.as_ref().is_some_and(|h| (h.ranks[place] as usize) < one_root);
            let radius2 = sphere.radius * sphere.radius * if is_signed { -1.0 } else { 1.0 };
            [center.x, center.y, center.z, radius2].map(R::from_f64)
        };
        let mut opaque: Vec<[R; 4]> = listed.par_iter().enumerate().map(packed).collect();
        let two_root = match hierarchy {
            Some(_) => std::mem::take(&mut opaque),
            None => opaque.split_off(one_root),
        };
        let mut records = Vec::with_capacity(listed.len() + groups.anchored.len() + 1);
        records.par_extend(listed.par_iter().map(|i| shading_record(scene, *i, groups.origin, None)));
        let (bottom, top) = (scene.sky.bottom * FIXED_POINT_SCALE, scene.sky.top * FIXED_POINT_SCALE);
        let mut prepared = PreparedScene {
            opaque,
            two_root,
            anchored: Vec::new(),
            hierarchy,
            hierarchy_source,
            records,
            scene_index: listed,
            camera: camera_of(job, groups.origin),
            sky_middle: rounded((bottom + top) / 2.0),
            sky_slope: rounded((top - bottom) / 2.0),
            block_limit: block_limit(scene.sky.bottom.max(scene.sky.top).max_element()),
            settings,
            features: Features::default(),
            origin: groups.origin,
            groups: Groups::default(),
            overlaps,
            warning: None,
        };
        prepared.set_view(job, groups);
        Some(prepared)
    }

    /// Prepares `job`, reusing the hierarchy of `old` if the jobs differ only in camera and settings. Returns `None` soon
    /// after `cancel` is set.
    pub fn renewed(cancel: &AtomicBool, old: Option<(Self, RenderJob)>, job: &RenderJob) -> Option<Self> {
        if cancel.load(Ordering::Relaxed) {
            return None;
        }
        let reused = old.and_then(|(mut old, before)| old.try_reuse(&before, job).then_some(old));
        let prepared = reused.or_else(|| Self::with_tree(job, Some(Tree::Quick), cancel, |_| ()));
        prepared.filter(|_| !cancel.load(Ordering::Relaxed))
    }

    /// Turns the prepared scene of `before` into that of `job` if only camera and settings differ and the hierarchy can
    /// be reused; otherwise changes nothing and returns false.
    pub fn try_reuse(&mut self, before: &RenderJob, job: &RenderJob) -> bool {
        if self.hierarchy.is_none() || !job.shares_scene_with(before) {
            return false;
        }
        let groups = Groups::of(job, &self.overlaps);
        if !groups.share_hierarchy(&self.groups) {
            return false;
        }
        let settings = *job.settings();
        self.camera = camera_of(job, groups.origin);
        self.settings = settings;
        self.hierarchy_source = HierarchySource::Kept;
        self.set_view(job, groups);
        true
    }

    /// Sets everything that depends on the eye's position.
    fn set_view(&mut self, job: &RenderJob, groups: Groups) {
        let scene = job.scene();
        let listed = self.opaque.len() + self.two_root.len();
        self.records.truncate(listed);
        self.scene_index.truncate(listed);
        self.anchored = groups.anchored.iter().map(|a| anchored_sphere(scene, a, groups.origin)).collect();
        for (anchored, sphere) in groups.anchored.iter().zip(&self.anchored) {
            self.records.push(shading_record(scene, anchored.index, groups.origin, Some(sphere)));
            self.scene_index.push(anchored.index);
        }
        if self.records.is_empty() {
            // A ray without a hit reads row 0 and ignores it.
            self.records.push(RecordColumns::default());
        }
        let is_exact = job.rules().surface == SurfaceRule::Exact;
        self.warning = self.overlaps.warning(job, groups.origin).filter(|_| is_exact);
        self.groups = groups;
        self.features = Features::of(job, &self.sorted());
        #[cfg(test)]
        self.validate(job);
    }

    fn sorted(&self) -> SortedSpheres<'_, R> {
        SortedSpheres {
            opaque_count: self.opaque.len(),
            two_root_count: self.two_root.len(),
            anchored: &self.anchored,
            has_hierarchy: self.hierarchy.is_some(),
            has_specks: self.groups.has_specks,
        }
    }
}

/// Describes a sphere relative to its anchor.
fn camera_of<R: Real>(job: &RenderJob, origin: DVec3) -> CameraTable<R> {
    let size = [job.settings().width, job.settings().height];
    CameraTable::new(job.camera(), job.viewport(), size, origin)
}

fn anchored_sphere<R: Real>(scene: &Scene, anchored: &Anchored, origin: DVec3) -> AnchoredSphere<R> {
    let sphere = &scene.spheres[anchored.index as usize];
    let towards = (anchored.near - sphere.center).try_normalize().unwrap_or(DVec3::Y);
    let center = sphere.center - origin;
    let foot = if anchored.under_eye { anchored.near - origin } else { center + towards * sphere.radius };
    let anchor: [R; 3] = rounded(foot);
    let [x, y, z] = anchor.map(R::to_f64);
    let inward = (center - DVec3::new(x, y, z)).normalize();
    AnchoredSphere {
        anchor,
        curvature: R::from_f64(1.0 / sphere.radius),
        inward: rounded(inward),
        flags: anchored.roots as u32 | if anchored.under_eye { UNDER_EYE } else { 0 },
    }
}

fn shading_record<R: Real>(
    scene: &Scene,
    index: u32,
    origin: DVec3,
    anchored: Option<&AnchoredSphere<R>>,
) -> RecordColumns<R> {
    let sphere = &scene.spheres[index as usize];
    let (albedo, weight, refraction_index) = match *scene.material_of(sphere) {
        Material::Lambertian { albedo } => (albedo, 1.0, 0.0),
        Material::Metal { albedo, fuzz } => (albedo, -fuzz.clamp(0.0, 1.0), 0.0),
        Material::Dielectric { refraction_index } => (DVec3::ONE, -0.0, refraction_index),
    };
    let f0 = ((1.0 - refraction_index) / (1.0 + refraction_index)).powi(2);
    let inverse_index = if refraction_index > 0.0 { 1.0 / refraction_index } else { 0.0 };
    let anchoring = |sphere: &AnchoredSphere<R>| if sphere.roots() == Roots::Farther { 2.0 } else { 1.0 };
    let r = R::from_f64;
    ShadingRecord {
        reference: anchored.map_or_else(|| rounded(sphere.center - origin), |a| a.anchor),
        curvature: r(1.0 / sphere.radius),
        albedo: rounded(albedo),
        weight: r(weight),
        radius: r(sphere.radius),
        refraction_index: r(refraction_index),
        inverse_index: r(inverse_index),
        f0: r(f0),
        inward: anchored.map_or([R::default(); 3], |a| a.inward),
        anchoring: r(anchored.map_or(0.0, anchoring)),
    }
    .into()
}

fn rounded<R: Real>(v: DVec3) -> [R; 3] {
    v.to_array().map(R::from_f64)
}

/// Largest number of samples, a power of two, whose sum always fits 32 bits.
fn block_limit(largest_radiance: f64) -> u32 {
    let largest = (largest_radiance * FIXED_POINT_SCALE).ceil().max(1.0);
    let fitting = (f64::from(u32::MAX) / largest).clamp(1.0, 128.0) as u32;
    1 << fitting.ilog2()
}

#[cfg(test)]
mod tests;
