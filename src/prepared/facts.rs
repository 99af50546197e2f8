//! Properties of a scene that do not depend on the camera: spheres that others cover, and layers so thin that rounding
//! may be visible.

mod nearest;

use crate::kernel::HALF_EPSILON;
use crate::render::RenderJob;
use crate::scene::{Scene, Sphere};
use glam::DVec3;
use nearest::{Nearest, thickness};
use rayon::prelude::*;

/// Two spheres form a layer if their surfaces are everywhere closer than this share of their radius.
const LAYER_SHARE: f64 = 1e-2;

/// A layer renders correctly if it is thicker than this many rounding units of its coordinates ...
const LAYER_UNITS: f64 = 16.0;

/// ... and than this many rounding units of its distance from the eye: surfaces closer than that have the same
/// distance.
const DISTANCE_UNITS: f64 = 8.0;

/// Where the surfaces of a layer touch or cross, it is too thin somewhere, however thick it is elsewhere. Such a layer
/// is reported only if its greatest thickness is at most this many times the required one: a path that hits the wrong
/// surface first is then hardly longer.
const CLOSING_RATIO: f64 = 100.0;

/// The same limit where paths can be inside one of the spheres, which is glass or around the eye: a path that misses its
/// way out of glass, or gets out of an opaque sphere, becomes a different path.
const TRAPPING_CLOSING_RATIO: f64 = 1e4;

/// In cells of up to this many spheres, all pairs are compared; in fuller cells, each sphere only with those that are
/// nearest to it in place and size.
const CELL_LIMIT: usize = 64;

/// Covered spheres and thin layers of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Facts {
    /// Indices, ascending, of spheres that are covered by an earlier sphere of the same place and size.
    covered: Vec<u32>,
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

/// A layer in which rounding is visible.
#[derive(Clone, Copy, Debug)]
struct Unresolved {
    layer: ThinLayer,
    /// The thickness that the layer would need.
    limit: f64,
}

impl Facts {
    pub fn of(scene: &Scene) -> Self {
        let mut facts = Facts::default();
        facts.compare_neighbours(&scene.spheres);
        facts.covered.sort_unstable();
        facts.covered.dedup();
        facts.layers.sort_by_key(|layer| layer.spheres);
        facts.layers.dedup();
        let covered = std::mem::take(&mut facts.covered);
        let is_seen = |index: &u32| covered.binary_search(index).is_err();
        facts.layers.retain(|layer| layer.spheres.iter().all(is_seen));
        facts.covered = covered;
        facts
    }

    /// Whether the sphere is never hit because an equal sphere is in its place.
    pub fn covers(&self, index: u32) -> bool {
        self.covered.binary_search(&index).is_ok()
    }

    /// What single precision cannot represent in a job whose coordinates are relative to `origin`.
    pub fn warnings(&self, job: &RenderJob, origin: DVec3) -> Vec<String> {
        let unresolved: Vec<Unresolved> =
            self.layers.iter().filter_map(|layer| unresolved(*layer, job, origin)).collect();
        let (thin, closing): (Vec<_>, Vec<_>) =
            unresolved.into_iter().partition(|found| found.layer.thickness < found.limit);
        let others =
            |count: usize| if count > 1 { format!(" ({count} such layers in all)") } else { String::new() };
        let thin_ones = worst(&thin).map(|Unresolved { layer, limit }| {
            let ([a, b], others) = (layer.spheres, others(thin.len()));
            format!(
                "the surfaces of spheres {a} and {b} are at most {:.1e} apart, and single precision cannot tell them apart \
                 where that is less than {limit:.1e}{others}; make the layer thicker, or render with --device reference",
                layer.thickness,
            )
        });
        let closing_ones = worst(&closing).map(|Unresolved { layer, limit }| {
            let ([a, b], others) = (layer.spheres, others(closing.len()));
            format!(
                "the surfaces of spheres {a} and {b} touch or cross and are nowhere more than {:.1e} apart; up to {:.1e} \
                 of them is closer than {limit:.1e}, where single precision cannot tell them apart{others}; move the \
                 spheres apart, or render with --device reference",
                layer.thickness,
                limit / layer.thickness,
            )
        });
        thin_ones.into_iter().chain(closing_ones).collect()
    }

    /// Compares spheres of similar size and place: those in the same cell, and those in the neighbouring cell if one is
    /// close to the border.
    fn compare_neighbours(&mut self, spheres: &[Sphere]) {
        let mut cells: Vec<(u64, u32)> =
            spheres.par_iter().enumerate().map(|(index, sphere)| (own_mark(sphere), index as u32)).collect();
        cells.par_sort_unstable();
        let mut full: Vec<(u64, Nearest<'_>)> = Vec::new();
        for cell in cells.chunk_by(|a, b| a.0 == b.0).filter(|cell| cell.len() > 1) {
            let mut members: Vec<u32> = cell.iter().map(|(_, index)| *index).collect();
            self.drop_covered(spheres, &mut members);
            if members.len() <= CELL_LIMIT {
                for (place, a) in members.iter().enumerate() {
                    for b in &members[place + 1..] {
                        self.note_layer(spheres, *a, *b);
                    }
                }
            }
            if cell.len() > CELL_LIMIT {
                full.push((cell[0].0, Nearest::new(spheres, members)));
            }
        }
        // What is nearest to a sphere in one of the full cells.
        let nearest_to = |index: u32, cell: &Nearest<'_>| {
            cell.to(index, LAYER_SHARE * spheres[index as usize].radius).into_iter().map(move |b| [index, b])
        };
        for (_, cell) in full.iter().filter(|(_, cell)| cell.members().len() > CELL_LIMIT) {
            let pairs: Vec<[u32; 2]> =
                cell.members().par_iter().flat_map_iter(|index| nearest_to(*index, cell)).collect();
            for [a, b] in pairs {
                self.note_layer(spheres, a, b);
            }
        }
        let occupied = Occupied::by(&cells);
        let beyond_borders: Vec<[u32; 2]> = spheres
            .par_iter()
            .enumerate()
            .flat_map_iter(|(index, sphere)| {
                let index = index as u32;
                let mut pairs: Vec<[u32; 2]> = Vec::new();
                for mark in marks_beyond_borders(sphere).into_iter().filter(|mark| occupied.may_hold(*mark)) {
                    match full.binary_search_by_key(&mark, |cell| cell.0) {
                        Ok(place) => pairs.extend(nearest_to(index, &full[place].1)),
                        Err(_) => pairs.extend(members_of(&cells, mark).map(|other| [index, other])),
                    }
                }
                // Where coordinates are huge for the radius, the next cell has the same number.
                pairs.retain(|[a, b]| a != b);
                pairs
            })
            .collect();
        for [a, b] in beyond_borders {
            self.note_layer(spheres, a, b);
        }
    }

    /// Of equal spheres, keeps the first in the scene.
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
        let spheres = [a.min(b), a.max(b)];
        let apart = first.center.distance(second.center);
        let thickness = thickness(&first, &second);
        // Where surfaces cross, they differ by no more than this either.
        if thickness < LAYER_SHARE * first.radius.min(second.radius) {
            let opening = ((first.radius - second.radius).abs() - apart).max(0.0);
            self.layers.push(ThinLayer { spheres, thickness, opening });
        }
    }
}

/// Returns `None` if the layer renders correctly.
fn unresolved(layer: ThinLayer, job: &RenderJob, origin: DVec3) -> Option<Unresolved> {
    let spheres = layer.spheres.map(|index| job.scene().spheres[index as usize]);
    let limits = spheres.map(|Sphere { center, radius, .. }| {
        let coordinate = (center - origin).abs().max_element() + radius;
        let distance = center.distance(job.camera().look_from);
        HALF_EPSILON * (LAYER_UNITS * coordinate).max(DISTANCE_UNITS * distance)
    });
    let limit = limits[0].max(limits[1]);
    let is_transparent = |sphere: &Sphere| job.scene().material_of(sphere).is_transparent();
    // The margin is far above what rounding can move the eye by.
    let reach = |sphere: &Sphere| sphere.radius * (1.0 + 1e-5) + job.camera().lens_radius();
    let has_inside = |sphere: &Sphere| {
        is_transparent(sphere) || sphere.center.distance(job.camera().look_from) <= reach(sphere)
    };
    let ratio = if spheres.iter().any(has_inside) { TRAPPING_CLOSING_RATIO } else { CLOSING_RATIO };
    let is_thin = layer.thickness < limit;
    let closes = layer.opening < limit && layer.thickness < ratio * limit;
    (is_thin || closes).then_some(Unresolved { layer, limit })
}

/// The layer that falls furthest short of the thickness it needs.
fn worst(all: &[Unresolved]) -> Option<Unresolved> {
    let share = |found: &Unresolved| found.layer.thickness / found.limit;
    all.iter().copied().min_by(|a, b| share(a).total_cmp(&share(b)))
}

/// The spheres of the cell with this mark, which is not a full one.
fn members_of(cells: &[(u64, u32)], mark: u64) -> impl Iterator<Item = u32> {
    let first = cells.partition_point(|cell| cell.0 < mark);
    cells[first..].iter().take_while(move |cell| cell.0 == mark).map(|(_, index)| *index)
}

/// Rules out most empty cells without a search: one bit for all marks with the same low bits.
struct Occupied {
    bits: Vec<u64>,
}

impl Occupied {
    fn by(cells: &[(u64, u32)]) -> Self {
        // Sixteen bits per sphere: the filter lets one in sixteen empty cells through to a search.
        let mut occupied = Occupied { bits: vec![0; (cells.len() / 4).next_power_of_two()] };
        for (mark, _) in cells {
            let (word, bit) = occupied.place(*mark);
            occupied.bits[word] |= bit;
        }
        occupied
    }

    fn place(&self, mark: u64) -> (usize, u64) {
        ((mark >> 6) as usize & (self.bits.len() - 1), 1 << (mark & 63))
    }

    fn may_hold(&self, mark: u64) -> bool {
        let (word, bit) = self.place(mark);
        self.bits[word] & bit != 0
    }
}

/// How far outside a cell, in cells, a sphere may lie and still form a layer with one inside.
const REACH: f64 = 2.0 * LAYER_SHARE;

/// Radii are often powers of two; this shift moves them far from the borders between sizes.
const SIZE_SHIFT: f64 = 0.37;

/// The mark of the cell that contains a sphere. A cell holds spheres of similar size and place and is about as wide as
/// their radius, so in an ordinary scene two spheres rarely share a cell.
fn own_mark(sphere: &Sphere) -> u64 {
    let size = (sphere.radius.log2() + SIZE_SHIFT).floor();
    let [x, y, z] = (sphere.center / size.exp2()).floor().to_array();
    mark([size, x, y, z])
}

fn mark(cell: [f64; 4]) -> u64 {
    cell.into_iter().fold(0x9E37_79B9_7F4A_7C15, |hash, number| {
        let mixed = (hash ^ (number + 0.0).to_bits()).wrapping_mul(0xFF51_AFD7_ED55_8CCD);
        mixed ^ (mixed >> 29)
    })
}

/// The marks of the neighbouring cells that a sphere is close to.
fn marks_beyond_borders(sphere: &Sphere) -> Vec<u64> {
    let mut marks = Vec::new();
    let sizes = cells_near(sphere.radius.log2() + SIZE_SHIFT);
    for (which, size) in sizes.into_iter().flatten().enumerate() {
        let [x, y, z] = (sphere.center / size.exp2()).to_array().map(cells_near);
        if which == 0 && [x, y, z].iter().all(|cells| cells[1].is_none()) {
            continue;
        }
        let all = x.into_iter().flatten().flat_map(|x| {
            y.into_iter().flatten().flat_map(move |y| z.into_iter().flatten().map(move |z| [x, y, z]))
        });
        // The first mark is that of the sphere's own cell.
        marks.extend(all.skip(usize::from(which == 0)).map(|[x, y, z]| mark([size, x, y, z])));
    }
    marks
}

/// The cell that contains a number, and the neighbouring cell if the number is close to the border.
fn cells_near(number: f64) -> [Option<f64>; 2] {
    let cell = number.floor();
    let within = number - cell;
    let next = if within < REACH {
        Some(cell - 1.0)
    } else if within > 1.0 - REACH {
        Some(cell + 1.0)
    } else {
        None
    };
    [Some(cell), next]
}

#[cfg(test)]
mod tests;
