//! Trees over many spheres, built for several regions of space at the same time and joined at the top.
//!
//! The regions follow from the spheres alone, not from the number of threads, so the result is always the same tree.

use super::bounded::Bounded;
use super::effort::{Effort, Leaves, params};
use super::parted;
use glam::DVec3;
use obvhs::Boundable;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ploc::morton::morton_encode_u64;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// From this many spheres on, a quick build divides them.
const MANY: usize = 40_000;

/// Bounds on the maximum number of spheres in a region, unless they share a place: enough regions to keep all threads
/// busy until the end, each small enough for a core's cache.
const REGION_LIMITS: [usize; 2] = [4096, 1 << 16];

/// Approximate number of regions in a scene, if the limits allow.
const WANTED_REGIONS: usize = 64;

/// How a tree is built. Each way gives at most as many levels as the one before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    /// By clustering, unless that would take long for these spheres.
    Clustered,
    /// From the top, with the best split of each node.
    Split,
    /// From the top, with the middle as the split of each node: about as many levels as the number has bits.
    Halved,
}

impl Method {
    pub const ALL: [Method; 3] = [Method::Clustered, Method::Split, Method::Halved];
}

/// The trees of all regions, and the one above them.
pub(super) struct Forest<T> {
    pub trees: Vec<T>,
    /// Its leaves are the regions, one each.
    pub top: Bvh2,
}

impl<T: Send> Forest<T> {
    /// Builds the trees over at least one sphere. `lay_out` gets a region's tree, the boxes of its spheres, and their
    /// places in the list; the tree's indices are positions in both. Returns `None` soon after `cancel` is set.
    pub fn build(
        spheres: &[Bounded<'_>],
        leaves: Leaves,
        effort: Effort,
        method: Method,
        cancel: &AtomicBool,
        lay_out: impl Fn(Bvh2, &[Aabb], &[u32]) -> T + Sync,
    ) -> Option<Forest<T>> {
        let (order, regions) = divided(spheres, effort, method);
        let tree_of = |region: Range<usize>| {
            if cancel.load(Ordering::Relaxed) {
                return None;
            }
            let places = &order[region];
            let own: Vec<&Bounded> = places.iter().map(|place| &spheres[*place as usize]).collect();
            // In a region, reading boxes is faster than computing them again.
            let boxes: Vec<Aabb> = own.iter().map(|sphere| sphere.aabb()).collect();
            let is_clustered = method == Method::Clustered && !parted::is_crowded(&own, &boxes);
            let tree = if is_clustered {
                build_bvh2(&boxes, params(spheres.len(), leaves, effort), &mut Duration::default())
            } else {
                parted::build(&boxes, leaves.most as usize, method == Method::Halved, cancel)
            };
            let around = tree.nodes.first().map_or_else(Aabb::empty, |root| *root.aabb());
            Some((around, lay_out(tree, &boxes, places)))
        };
        let built: Option<Vec<(Aabb, T)>> = match regions.len() {
            // On the caller's thread, which may have a low priority.
            1 => regions.into_iter().map(tree_of).collect(),
            _ => regions.into_par_iter().map(tree_of).collect(),
        };
        let (around, trees): (Vec<Aabb>, Vec<T>) = built?.into_iter().unzip();
        let top = parted::build(&around, 1, method == Method::Halved, cancel);
        (!cancel.load(Ordering::Relaxed)).then_some(Forest { trees, top })
    }
}

/// The places of the spheres along a curve, and the ranges of it that are regions.
#[expect(clippy::single_range_in_vec_init, reason = "a list of one range is meant")]
fn divided(spheres: &[Bounded<'_>], effort: Effort, method: Method) -> (Vec<u32>, Vec<Range<usize>>) {
    let count = spheres.len();
    if count < parted::FEW_SPHERES {
        return ((0..count as u32).collect(), vec![0..count]);
    }
    let codes = along_a_curve(spheres);
    let [least, most] = REGION_LIMITS;
    let is_divided = effort == Effort::Quick && method == Method::Clustered && count >= MANY;
    let most = if is_divided { (count / WANTED_REGIONS).clamp(least, most) } else { count };
    let mut regions = Vec::new();
    let mut open = vec![0..count];
    while let Some(range) = open.pop() {
        let [first, last] = [range.start, range.end - 1].map(|place| codes[place].0);
        if range.len() <= most || first == last {
            regions.push(range);
            continue;
        }
        // Both halves of a cell of the curve's grid.
        let bit = 63 - (first ^ last).leading_zeros();
        let middle = range.start + codes[range.clone()].partition_point(|(code, _)| code >> bit & 1 == 0);
        open.push(range.start..middle);
        open.push(middle..range.end);
    }
    (codes.into_par_iter().map(|(_, place)| place).collect(), regions)
}

/// The spheres along a curve on which neighbours are mostly neighbours in space, with their places on it.
fn along_a_curve(spheres: &[Bounded<'_>]) -> Vec<(u64, u32)> {
    let lowest = spheres.par_iter().map(Bounded::center).reduce(|| DVec3::INFINITY, DVec3::min);
    let highest = spheres.par_iter().map(Bounded::center).reduce(|| DVec3::NEG_INFINITY, DVec3::max);
    let size = (highest - lowest).max_element().max(f64::MIN_POSITIVE);
    let code = |sphere: &Bounded| {
        let place = (sphere.center() - lowest) / size * f64::from((1 << 21) - 1);
        morton_encode_u64(place.x as u32, place.y as u32, place.z as u32)
    };
    let mut codes: Vec<(u64, u32)> =
        spheres.par_iter().enumerate().map(|(place, sphere)| (code(sphere), place as u32)).collect();
    codes.par_sort_unstable();
    codes
}

/// The spheres in their order along the curve.
#[cfg(test)]
pub(super) fn on_a_curve<'a, 'b>(spheres: &'a [Bounded<'b>]) -> Vec<&'a Bounded<'b>> {
    along_a_curve(spheres).into_iter().map(|(_, place)| &spheres[place as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Sphere;
    use crate::scene::builtin::field;

    #[test]
    fn regions_are_disjoint_and_hold_every_sphere_once() {
        let mut spheres = field(60_000).0.spheres;
        // More in one place than a region may have.
        spheres.extend([spheres[7]; 6000]);
        let bounded = Bounded::all(&spheres, &DVec3::ZERO);
        let (order, mut regions) = divided(&bounded, Effort::Quick, Method::Clustered);
        regions.sort_by_key(|region| region.start);
        assert!(regions.len() > 8, "{}", regions.len());
        assert!(regions.windows(2).all(|pair| pair[0].end == pair[1].start), "{regions:?}");
        assert_eq!(regions.iter().map(Range::len).sum::<usize>(), spheres.len());
        let is_one_place = |region: &Range<usize>| {
            let mut own = order[region.clone()].iter().map(|place| spheres[*place as usize].center);
            let first = own.next().unwrap();
            own.all(|center| center == first)
        };
        assert!(regions.iter().all(|region| region.len() <= REGION_LIMITS[0] || is_one_place(region)));
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..spheres.len() as u32));
        assert_eq!(divided(&bounded, Effort::Thorough, Method::Clustered).1.len(), 1);
    }

    #[test]
    fn a_cancelled_build_has_no_result() {
        let spheres: Vec<Sphere> = field(100).0.spheres;
        let bounded = Bounded::all(&spheres, &DVec3::ZERO);
        for is_cancelled in [false, true] {
            let cancel = AtomicBool::new(is_cancelled);
            let built = Forest::build(
                &bounded,
                Leaves::SINGLE,
                Effort::Quick,
                Method::Clustered,
                &cancel,
                |tree, _, places| (tree.primitive_indices.len(), places.len()),
            );
            assert_eq!(built.map(|forest| forest.trees), (!is_cancelled).then(|| vec![(101, 101)]));
        }
    }
}
