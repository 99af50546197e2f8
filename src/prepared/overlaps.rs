//! Spheres with equal or nearly equal surfaces: the covered ones, and layers thin enough for rounding to show. They do not
//! depend on the camera.

use crate::job::render::RenderJob;
use crate::kernel::HALF_EPSILON;
use crate::scene::{Scene, Sphere};
use glam::DVec3;
use rayon::prelude::*;
use std::cmp::Ordering;

/// Two spheres form a layer if their surfaces are closer than this share of their radius everywhere.
const LAYER_SHARE: f64 = 1e-2;

/// A layer renders correctly if it is thicker than this many rounding units of its coordinates ...
const LAYER_UNITS: f64 = 16.0;

/// ... and than this many rounding units of its distance from the eye, below which surfaces have the same distance.
const DISTANCE_UNITS: f64 = 8.0;

/// Where a layer's surfaces touch or cross, it is too thin somewhere, however thick elsewhere. It is reported only if
/// its greatest thickness is at most this many times the required one: beyond that, hitting the wrong surface first
/// hardly changes a path's length.
const CLOSING_RATIO: f64 = 100.0;

/// The same limit where paths can be inside a sphere, because it is glass or surrounds the eye: a path that misses its
/// way out of glass, or escapes an opaque sphere, changes entirely.
const TRAPPING_CLOSING_RATIO: f64 = 1e4;

/// Cells with up to this many spheres compare all pairs; in fuller cells, each sphere is only compared with the next
/// two by place and size.
const CELL_LIMIT: usize = 128;

/// The overlaps of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Overlaps {
    /// For each sphere, whether an earlier one of equal place and size covers it.
    is_covered: Vec<bool>,
    layers: Vec<ThinLayer>,
}

/// Two spheres with nearly the same surface.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ThinLayer {
    spheres: [u32; 2],
    /// Greatest distance between the surfaces.
    thickness: f64,
    /// Smallest distance between the surfaces; 0 where they cross.
    opening: f64,
}

impl Overlaps {
    pub fn of(scene: &Scene) -> Self {
        let mut overlaps = Overlaps { is_covered: vec![false; scene.spheres.len()], layers: Vec::new() };
        overlaps.compare_neighbours(&scene.spheres);
        overlaps.layers.sort_by_key(|layer| layer.spheres);
        overlaps.layers.dedup();
        let Overlaps { is_covered, layers } = &mut overlaps;
        layers.retain(|layer| layer.spheres.iter().all(|index| !is_covered[*index as usize]));
        overlaps
    }

    /// Whether an equal sphere hides this one completely.
    pub fn covers(&self, index: u32) -> bool {
        self.is_covered.get(index as usize) == Some(&true)
    }

    /// A warning about what single precision cannot represent, for coordinates relative to `origin`.
    pub fn warning(&self, job: &RenderJob, origin: DVec3) -> Option<String> {
        let limits = self.layers.iter().map(|layer| (layer, needed_thickness(layer, job, origin)));
        let unresolved = || limits.clone().filter_map(|(layer, limit)| Some((layer, limit?)));
        let share = |(layer, limit): &(&ThinLayer, f64)| layer.thickness / limit;
        let (layer, limit) = unresolved().min_by(|a, b| share(a).total_cmp(&share(b)))?;
        let ([a, b], thickness) = (layer.spheres, layer.thickness);
        let others = match unresolved().count() {
            1 => String::new(),
            count => format!(" ({count} such pairs in all)"),
        };
        Some(format!(
            "the surfaces of spheres {a} and {b} are at most {thickness:.1e} apart and, at least in places, closer than \
             {limit:.1e}, where single precision cannot tell them apart{others}; move them apart, or render with --device \
             reference"
        ))
    }

    /// Compares spheres of similar size and place.
    fn compare_neighbours(&mut self, spheres: &[Sphere]) {
        let marked = |(index, sphere)| marks(sphere).into_iter().map(move |mark| (mark, index as u32));
        let mut cells: Vec<(u64, u32)> = spheres.par_iter().enumerate().flat_map_iter(marked).collect();
        cells.par_sort_unstable();
        for cell in cells.chunk_by(|a, b| a.0 == b.0).filter(|cell| cell.len() > 1) {
            let members = cell.iter().map(|(_, index)| *index).filter(|index| !self.covers(*index));
            let members = self.uncovered(spheres, members.collect());
            let next = if members.len() <= CELL_LIMIT { CELL_LIMIT } else { 2 };
            for (place, a) in members.iter().enumerate() {
                members[place + 1..].iter().take(next).for_each(|b| self.note_layer(spheres, *a, *b));
            }
        }
    }

    /// The members by place and size. Of equal spheres, only the first in the scene remains; the others are covered.
    fn uncovered(&mut self, spheres: &[Sphere], mut members: Vec<u32>) -> Vec<u32> {
        let numbers = |index: u32| {
            let Sphere { center: DVec3 { x, y, z }, radius, .. } = spheres[index as usize];
            // Adding 0 turns -0 into 0.
            [x, y, z, radius].map(|number| number + 0.0)
        };
        members.sort_by(|a, b| {
            let order = numbers(*a).into_iter().zip(numbers(*b)).map(|(a, b)| a.total_cmp(&b));
            order.fold(Ordering::Equal, Ordering::then).then(a.cmp(b))
        });
        let mut kept: Vec<u32> = Vec::with_capacity(members.len());
        for index in members {
            if kept.last().is_some_and(|last| numbers(*last) == numbers(index)) {
                self.is_covered[index as usize] = true;
            } else {
                kept.push(index);
            }
        }
        kept
    }

    fn note_layer(&mut self, spheres: &[Sphere], a: u32, b: u32) {
        let [first, second] = [a, b].map(|index| spheres[index as usize]);
        let spheres = [a.min(b), a.max(b)];
        let apart = first.center.distance(second.center);
        let thickness = apart + (first.radius - second.radius).abs();
        // Surfaces that cross differ by no more than this, too.
        if thickness < LAYER_SHARE * first.radius.min(second.radius) {
            let opening = ((first.radius - second.radius).abs() - apart).max(0.0);
            self.layers.push(ThinLayer { spheres, thickness, opening });
        }
    }
}

/// The thickness that a layer would need for rounding not to be visible; `None` if it renders correctly.
fn needed_thickness(layer: &ThinLayer, job: &RenderJob, origin: DVec3) -> Option<f64> {
    let spheres = layer.spheres.map(|index| job.scene().spheres[index as usize]);
    let limits = spheres.map(|Sphere { center, radius, .. }| {
        let coordinate = (center - origin).abs().max_element() + radius;
        let distance = center.distance(job.camera().look_from);
        HALF_EPSILON * (LAYER_UNITS * coordinate).max(DISTANCE_UNITS * distance)
    });
    let limit = limits[0].max(limits[1]);
    let is_transparent = |sphere: &Sphere| job.scene().material_of(sphere).is_transparent();
    // The margin is far larger than the distance by which rounding can move the eye.
    let reach = |sphere: &Sphere| sphere.radius * (1.0 + 1e-5) + job.camera().lens_radius();
    let has_inside = |sphere: &Sphere| {
        is_transparent(sphere) || sphere.center.distance(job.camera().look_from) <= reach(sphere)
    };
    let ratio = if spheres.iter().any(has_inside) { TRAPPING_CLOSING_RATIO } else { CLOSING_RATIO };
    let is_thin = layer.thickness < limit;
    let closes = layer.opening < limit && layer.thickness < ratio * limit;
    (is_thin || closes).then_some(limit)
}

/// How far outside a cell, in cells, a sphere may be and still form a layer with one inside.
const REACH: f64 = 2.0 * LAYER_SHARE;

/// Moves radii, which are often powers of two, away from the borders between sizes.
const SIZE_SHIFT: f64 = 0.37;

/// The marks of a sphere's cell and of the neighbouring cells that it is close to. A cell holds spheres of similar size
/// and place and is about as wide as their radius, so in an ordinary scene two spheres rarely share one.
fn marks(sphere: &Sphere) -> Vec<u64> {
    let mut marks = Vec::new();
    for size in cells_near(sphere.radius.log2() + SIZE_SHIFT) {
        let [x, y, z] = (sphere.center / size.exp2()).to_array().map(cells_near);
        for x in x {
            for y in y.clone() {
                marks.extend(z.clone().map(|z| mark([size, x, y, z])));
            }
        }
    }
    marks
}

fn mark(cell: [f64; 4]) -> u64 {
    cell.into_iter().fold(0x9E37_79B9_7F4A_7C15, |hash, number| {
        let mixed = (hash ^ (number + 0.0).to_bits()).wrapping_mul(0xFF51_AFD7_ED55_8CCD);
        mixed ^ (mixed >> 29)
    })
}

/// The number's cell, and the next one if the number is close to the border.
fn cells_near(number: f64) -> impl Iterator<Item = f64> + Clone {
    let cell = number.floor();
    let within = number - cell;
    let step = f64::from(within > 1.0 - REACH) - f64::from(within < REACH);
    // A number far larger than 1 gives the next cell the same number.
    let next = Some(cell + step).filter(|next| *next != cell);
    [Some(cell), next].into_iter().flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Material;

    fn scene(spheres: impl IntoIterator<Item = (DVec3, f64)>) -> Scene {
        let mut scene = Scene::default();
        let material = scene.add_material("m", Material::Lambertian { albedo: DVec3::ONE });
        spheres.into_iter().for_each(|(center, radius)| scene.add_sphere(center, radius, material));
        scene
    }

    fn covered(overlaps: &Overlaps) -> Vec<u32> {
        (0..overlaps.is_covered.len() as u32).filter(|index| overlaps.covers(*index)).collect()
    }

    /// Close spheres are found, whatever their place and size.
    #[test]
    fn layers_are_found_across_borders() {
        let random =
            |i: u32, k: u32| f64::from(crate::kernel::sampling::pcg4d([i, k, 0, 0])[0]) / f64::from(u32::MAX);
        for i in 0..5000 {
            let at = |k: u32| 10.0 * random(i, k) - 5.0;
            let radius = (6.0 * random(i, 3) - 3.0).exp2();
            let center = DVec3::new(at(0), at(1), at(2)).round() * f64::from(i % 2) + DVec3::X * at(4);
            let by = DVec3::new(random(i, 5), random(i, 6), random(i, 7)) - 0.5;
            let near = (center + by * 0.005 * radius, radius * (1.0 - 0.004 * random(i, 8)));
            let far = (center + DVec3::X * 0.02 * radius, radius);
            let overlaps = Overlaps::of(&scene([(center, radius), near, far, (center, radius)]));
            assert_eq!(covered(&overlaps), [3], "{center} {radius}");
            assert!(overlaps.layers.iter().any(|layer| layer.spheres == [0, 1]), "{center} {radius}");
            assert!(overlaps.layers.iter().all(|layer| layer.spheres != [0, 2]), "{center} {radius}");
        }
    }

    #[test]
    fn tiny_distant_sphere_is_not_a_layer() {
        for center in [DVec3::new(4.0, 1.0, 0.0), DVec3::splat(-1e3), DVec3::X] {
            for radius in [1e-18, 1e-16, 1e-14] {
                let overlaps = Overlaps::of(&scene([(center, radius), (DVec3::NEG_Y, 1.0)]));
                assert!(overlaps.layers.is_empty() && covered(&overlaps).is_empty(), "{center} {radius}");
            }
        }
    }

    #[test]
    fn first_of_copies_remains() {
        let copies = (0..10_000).map(|i| (DVec3::new(f64::from(i % 3), 0.0, -0.0), 1.0 + f64::from(i % 2)));
        let overlaps = Overlaps::of(&scene(copies));
        assert_eq!(covered(&overlaps), (6..10_000).collect::<Vec<_>>());
        assert!(overlaps.layers.is_empty());
    }

    #[test]
    fn layer_thickness_is_surface_distance() {
        let layer = |a: (f64, f64), b: (f64, f64)| {
            let overlaps = Overlaps::of(&scene([a, b].map(|(x, radius)| (DVec3::new(x, 0.5, 0.5), radius))));
            overlaps
                .layers
                .first()
                .map(|layer| [layer.thickness, layer.opening].map(|x| (x * 1024.0).round()))
        };
        let unit = 1.0 / 1024.0;
        assert_eq!(layer((0.5, 1.0), (0.5, 1.0 - 4.0 * unit)), Some([4.0, 4.0]));
        assert_eq!(layer((0.5, 1.0), (0.5 + unit, 1.0 - 4.0 * unit)), Some([5.0, 3.0]));
        assert_eq!(layer((0.5, 1.0), (0.5 + 4.0 * unit, 1.0 + unit)), Some([5.0, 0.0]));
        // A layer is thinner than a hundredth of the smaller radius.
        assert_eq!(layer((0.5, 1.0), (0.5 + 10.2 * unit, 1.0)), Some([10.0, 0.0]));
        assert_eq!(layer((0.5, 1.0), (0.5 + 10.3 * unit, 1.0)), None);
        assert_eq!(layer((0.5, 1.0), (0.5, 1.0 - 10.2 * unit)), None);
        assert_eq!(layer((0.5, 1.0), (0.5, 1.0 - 10.1 * unit)), Some([10.0, 10.0]));
    }

    /// Shells around one place, and coated balls that overlap, more of them than a cell compares in pairs.
    #[test]
    fn layers_in_a_crowd_are_found() {
        let random =
            |i: u32, k: u32| f64::from(crate::kernel::sampling::pcg4d([i, k, 2, 0])[0]) / f64::from(u32::MAX);
        for count in [2, 63, 65, 500] {
            let has = |overlaps: &Overlaps, pair: [u32; 2]| {
                overlaps.layers.iter().any(|layer| layer.spheres == pair)
            };
            let shells = (0..count).map(|i| (DVec3::splat(0.5), 1.0 + 1e-5 * f64::from(i)));
            let overlaps = Overlaps::of(&scene(shells));
            assert!(
                (1..count).all(|i| has(&overlaps, [i - 1, i])) && covered(&overlaps).is_empty(),
                "{count}"
            );
            let place = |i: u32| DVec3::new(random(i, 0), random(i, 1), random(i, 2));
            let balls = (0..2 * count).map(|i| (place(i % count), 1.4 - 1e-7 * f64::from(i / count)));
            let overlaps = Overlaps::of(&scene(balls));
            assert!((0..count).all(|i| has(&overlaps, [i, i + count])), "{count}");
        }
        // Here, others come between the two of a pair.
        let place = |i: u32| DVec3::new(random(i % 50, 3), random(i % 50, 4), random(i % 50, 5));
        let balls = (0..100).map(|i| (place(i) + DVec3::X * 0.008 * f64::from(i / 50), 1.4));
        let overlaps = Overlaps::of(&scene(balls));
        let missed = (0..50).filter(|i| overlaps.layers.iter().all(|layer| layer.spheres != [*i, *i + 50]));
        assert_eq!(missed.count(), 0);
    }
}
