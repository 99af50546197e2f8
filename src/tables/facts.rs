//! What follows from a scene alone, whoever looks at it: spheres that others cover, and layers so thin that rounding
//! may show.

use super::groups::{Groups, UNIT};
use crate::scene::{Scene, Sphere};
use glam::DVec3;
use rayon::prelude::*;

/// Two spheres whose surfaces are everywhere closer than this share of their radius are a layer.
const LAYER_SHARE: f64 = 1e-2;

/// A layer is right while it is thicker than this many units of rounding of the coordinates that it lies at.
const LAYER_UNITS: f64 = 16.0;

/// Grids on which spheres are looked for that lie close together. Two that are close by one fifth of a cell in each of
/// four numbers (size and place) share a cell in one of five grids, each moved by a fifth: a border parts them in one
/// grid a number.
const GRIDS: u32 = 5;

/// So many spheres are compared with each other in a cell; in a fuller one each with the next larger.
const CELL_LIMIT: usize = 64;

/// See the module.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Facts {
    /// Spheres that an earlier one of the same place and size covers: indices in the scene, rising.
    covered: Vec<u32>,
    layers: Vec<Layer>,
}

/// Two spheres with almost the same surface.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Layer {
    spheres: [u32; 2],
    /// Most distance between the surfaces.
    thickness: f64,
}

impl Facts {
    pub fn of(scene: &Scene) -> Self {
        let mut facts = Facts::default();
        for grid in 0..GRIDS {
            facts.look_on(grid, &scene.spheres);
        }
        facts.covered.sort_unstable();
        facts.covered.dedup();
        facts.layers.sort_by(|a, b| a.spheres.cmp(&b.spheres));
        facts.layers.dedup();
        let covered = std::mem::take(&mut facts.covered);
        let is_seen = |index: &u32| covered.binary_search(index).is_err();
        facts.layers.retain(|layer| layer.spheres.iter().all(is_seen));
        facts.covered = covered;
        facts
    }

    /// Whether the sphere is never met since another is in its place.
    pub fn covers(&self, index: u32) -> bool {
        self.covered.binary_search(&index).is_ok()
    }

    /// What single precision does not hold of a scene that is seen as `groups` say.
    pub fn warnings(&self, scene: &Scene, groups: &Groups) -> Vec<String> {
        let resolved = |layer: &Layer| {
            let sizes = layer.spheres.map(|index| {
                let Sphere { center, radius, .. } = scene.spheres[index as usize];
                (center - groups.origin).abs().max_element() + radius
            });
            LAYER_UNITS * UNIT * sizes[0].max(sizes[1])
        };
        let too_thin = self.layers.iter().filter(|layer| layer.thickness < resolved(layer));
        let count = too_thin.clone().count();
        let worst =
            too_thin.min_by(|a, b| (a.thickness / resolved(a)).total_cmp(&(b.thickness / resolved(b))));
        let Some(worst) = worst else { return Vec::new() };
        let [a, b] = worst.spheres;
        let others = if count > 1 { format!(" ({} such layers in all)", count) } else { String::new() };
        vec![format!(
            "the surfaces of spheres {a} and {b} are at most {:.1e} apart, but single precision is right there only \
             from {:.1e} on{others}; make the layer thicker, or render with --device reference",
            worst.thickness,
            resolved(worst),
        )]
    }

    /// Compares spheres that lie in one cell.
    fn look_on(&mut self, grid: u32, spheres: &[Sphere]) {
        let mut cells: Vec<(u64, u32)> = spheres
            .par_iter()
            .enumerate()
            .map(|(index, sphere)| (cell_of(sphere, grid), index as u32))
            .collect();
        cells.par_sort_unstable();
        for cell in cells.chunk_by(|a, b| a.0 == b.0).filter(|cell| cell.len() > 1) {
            let mut members: Vec<u32> = cell.iter().map(|(_, index)| *index).collect();
            self.drop_covered(spheres, &mut members);
            let reach = if members.len() <= CELL_LIMIT { members.len() } else { 1 };
            for (place, a) in members.iter().enumerate() {
                for b in members.iter().skip(place + 1).take(reach) {
                    self.note_layer(spheres, *a.min(b), *a.max(b));
                }
            }
        }
    }

    /// Keeps of spheres that are alike the first of the scene.
    fn drop_covered(&mut self, spheres: &[Sphere], members: &mut Vec<u32>) {
        let numbers = |index: u32| {
            let Sphere { center: DVec3 { x, y, z }, radius, .. } = spheres[index as usize];
            // Adding 0 makes -0 the same as 0.
            [radius, x, y, z].map(|number| number + 0.0)
        };
        members.sort_by(|a, b| {
            let order = numbers(*a).into_iter().zip(numbers(*b)).map(|(a, b)| a.total_cmp(&b));
            order.fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then).then(a.cmp(b))
        });
        let mut kept: Vec<u32> = Vec::with_capacity(members.len());
        for index in members.drain(..) {
            if kept.last().is_some_and(|last| numbers(*last) == numbers(index)) {
                self.covered.push(index);
            } else {
                kept.push(index);
            }
        }
        *members = kept;
    }

    fn note_layer(&mut self, spheres: &[Sphere], a: u32, b: u32) {
        let [first, second] = [a, b].map(|index| spheres[index as usize]);
        let apart = first.center.distance(second.center);
        let thickness = apart + (first.radius - second.radius).abs();
        // Surfaces that cross differ by no more where they do.
        if thickness < LAYER_SHARE * first.radius.min(second.radius) {
            self.layers.push(Layer { spheres: [a, b], thickness });
        }
    }
}

/// A mark that spheres of about one place and size share: cells are as wide as five layers, and by the radius.
fn cell_of(sphere: &Sphere, grid: u32) -> u64 {
    let shift = f64::from(grid) / f64::from(GRIDS);
    // A power of two near the radius, by which neighbouring sizes are told apart on all grids but one.
    let size = (sphere.radius.log2() + shift).floor();
    let width = size.exp2() * LAYER_SHARE * f64::from(GRIDS) * 2.0;
    let numbers = [size, sphere.center.x / width, sphere.center.y / width, sphere.center.z / width];
    numbers.into_iter().fold(0x9E37_79B9_7F4A_7C15, |hash: u64, number| {
        let cell = (number + shift).floor() + 0.0;
        let mixed = (hash ^ cell.to_bits()).wrapping_mul(0xFF51_AFD7_ED55_8CCD);
        mixed ^ (mixed >> 29)
    })
}
