//! A top-down tree builder for spheres that bottom-up clustering would chain: nested shells, copies, and crowds around
//! one place. For these, obvhs takes time quadratic in the number of spheres and builds a tree as deep as there are
//! spheres.

use super::bounded::Bounded;
use glam::DVec3;
use obvhs::Boundable;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use rayon::prelude::*;

/// Levels that are split at the lowest cost. Below them nodes are halved, so that the depth of a tree is at most this
/// plus the logarithm of the number of spheres.
const CHOSEN_LEVELS: usize = 32;

/// Bins that a node's spheres are sorted into to choose a split.
const BINS: usize = 16;

/// Up to this many spheres, clustering is fast in any arrangement.
const FEW_SPHERES: usize = 2048;

/// Number of spheres in nested runs from which on a scene counts as crowded.
const CROWD: usize = 1024;

/// Shorter runs of nested spheres are hollow balls and the like.
const NESTED_RUN: usize = 32;

/// A range of spheres that is still to be split, and the node for it.
struct Open {
    node: usize,
    first: usize,
    count: usize,
    depth: usize,
}

/// Whether enough spheres are nested in each other that clustering them would take long.
pub(super) fn is_crowded(spheres: &[Bounded<'_, '_>]) -> bool {
    if spheres.len() < FEW_SPHERES {
        return false;
    }
    let lowest = spheres.par_iter().map(Bounded::center).reduce(|| DVec3::INFINITY, DVec3::min);
    let highest = spheres.par_iter().map(Bounded::center).reduce(|| DVec3::NEG_INFINITY, DVec3::max);
    let size = (highest - lowest).max_element().max(f64::MIN_POSITIVE);
    let mut order: Vec<(u64, u32)> = spheres
        .par_iter()
        .enumerate()
        .map(|(index, sphere)| (morton_code(((sphere.center() - lowest) / size).to_array()), index as u32))
        .collect();
    order.par_sort_unstable();
    let (mut nested, mut run) = (0, 0);
    for pair in order.windows(2) {
        let [a, b] = [0, 1].map(|i| &spheres[pair[i].1 as usize]);
        // Being inside the box is enough here.
        let apart = (a.center() - b.center()).abs().max_element();
        if apart <= (a.radius() - b.radius()).abs() {
            run += 1;
            nested += usize::from(run >= NESTED_RUN);
        } else {
            run = 0;
        }
    }
    nested >= CROWD
}

/// Interleaves 21 bits of each coordinate; coordinates are between 0 and 1.
fn morton_code(place: [f64; 3]) -> u64 {
    place.iter().enumerate().fold(0, |code, (axis, x)| {
        let mut bits = (x * f64::from((1 << 21) - 1)) as u64;
        for (shift, mask) in [
            (32, 0x001F_0000_0000_FFFF),
            (16, 0x001F_0000_FF00_00FF),
            (8, 0x100F_00F0_0F00_F00F),
            (4, 0x10C3_0C30_C30C_30C3),
            (2, 0x1249_2492_4924_9249),
        ] {
            bits = (bits | bits << shift) & mask;
        }
        code | bits << axis
    })
}

/// Builds a tree over at least one box, with at most `leaf_size` per leaf. With `halved`, every node is split in the
/// middle, which gives the lowest tree; otherwise the split with the smallest sum of area times spheres is chosen (Wald
/// 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies").
pub(super) fn build(spheres: &[impl Boundable], leaf_size: usize, halved: bool) -> Bvh2 {
    let chosen_levels = if halved { 0 } else { CHOSEN_LEVELS };
    let mut order: Vec<u32> = (0..spheres.len() as u32).collect();
    let mut nodes = vec![Bvh2Node::default()];
    let mut open = vec![Open { node: 0, first: 0, count: spheres.len(), depth: 0 }];
    while let Some(Open { node, first, count, depth }) = open.pop() {
        let part = &mut order[first..first + count];
        let aabb = part.iter().fold(Aabb::empty(), |all, index| all.union(&spheres[*index as usize].aabb()));
        if count <= leaf_size {
            nodes[node] = Bvh2Node::new(aabb, count as u32, first as u32);
            continue;
        }
        let chosen = if depth < chosen_levels { part_where_it_pays(spheres, part) } else { None };
        let left = chosen.unwrap_or_else(|| part_in_the_middle(spheres, part));
        let children = nodes.len();
        nodes[node] = Bvh2Node::new(aabb, 0, children as u32);
        nodes.extend([Bvh2Node::default(); 2]);
        let depth = depth + 1;
        open.push(Open { node: children, first, count: left, depth });
        open.push(Open { node: children + 1, first: first + left, count: count - left, depth });
    }
    Bvh2 { nodes, primitive_indices: order, children_are_ordered_after_parents: true, ..Bvh2::default() }
}

/// The keys for splitting boxes: the centre along each axis, and the size.
fn keys(aabb: &Aabb) -> [f32; 4] {
    let center = aabb.center();
    [center.x, center.y, center.z, aabb.diagonal().max_element()]
}

/// The smallest and largest value of each key.
fn key_ranges(spheres: &[impl Boundable], part: &[u32]) -> [[f32; 2]; 4] {
    let mut ranges = [[f32::INFINITY, f32::NEG_INFINITY]; 4];
    for index in part {
        for (range, key) in ranges.iter_mut().zip(keys(&spheres[*index as usize].aabb())) {
            *range = [range[0].min(key), range[1].max(key)];
        }
    }
    ranges
}

/// Moves the spheres of one side to the front and returns their number, or `None` if no split leaves spheres on both
/// sides.
fn part_where_it_pays(spheres: &[impl Boundable], part: &mut [u32]) -> Option<usize> {
    let ranges = key_ranges(spheres, part);
    let bin_of = |key: f32, [low, high]: [f32; 2]| {
        let share = f64::from(key - low) / f64::from(high - low);
        ((share * BINS as f64) as usize).min(BINS - 1)
    };
    let mut best: Option<(f64, usize, usize)> = None;
    for (which, range) in ranges.into_iter().enumerate().filter(|(_, [low, high])| high > low) {
        let mut bins = [(Aabb::empty(), 0_usize); BINS];
        for index in part.iter() {
            let aabb = spheres[*index as usize].aabb();
            let (whole, count) = &mut bins[bin_of(keys(&aabb)[which], range)];
            *whole = whole.union(&aabb);
            *count += 1;
        }
        let cost = |side: &[(Aabb, usize)]| {
            let whole = side.iter().fold(Aabb::empty(), |all, bin| all.union(&bin.0));
            let count: usize = side.iter().map(|bin| bin.1).sum();
            if count == 0 { f64::INFINITY } else { f64::from(whole.half_area()) * count as f64 }
        };
        for split in 1..BINS {
            let total = cost(&bins[..split]) + cost(&bins[split..]);
            if total.is_finite() && best.is_none_or(|(least, ..)| total < least) {
                best = Some((total, which, split));
            }
        }
    }
    let (_, which, split) = best?;
    let is_left = |index: &u32| bin_of(keys(&spheres[*index as usize].aabb())[which], ranges[which]) < split;
    let mut left = 0;
    for place in 0..part.len() {
        if is_left(&part[place]) {
            part.swap(place, left);
            left += 1;
        }
    }
    Some(left)
}

/// Moves the lower half along the widest key to the front and returns its size.
fn part_in_the_middle(spheres: &[impl Boundable], part: &mut [u32]) -> usize {
    let widths = key_ranges(spheres, part).map(|[low, high]| high - low);
    let widest = (0..4).max_by(|a, b| widths[*a].total_cmp(&widths[*b])).unwrap_or(0);
    let key = |index: &u32| keys(&spheres[*index as usize].aabb())[widest];
    let middle = part.len() / 2;
    part.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
    middle
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Sphere;

    fn ball(x: f64, radius: f64) -> Sphere {
        Sphere { center: DVec3::X * x, radius, material: 0 }
    }

    fn crowded(spheres: &[Sphere]) -> bool {
        is_crowded(&Bounded::all(spheres, &DVec3::ZERO))
    }

    /// So many shells around the origin, the largest first.
    fn shells(count: u32) -> impl Iterator<Item = Sphere> {
        (0..count).map(|index| ball(0.0, 1.0 - 1e-5 * f64::from(index)))
    }

    /// So many balls beside each other, which are nested in nothing.
    fn row(count: u32) -> impl Iterator<Item = Sphere> {
        (1..=count).map(|place| ball(3.0 * f64::from(place), 0.1))
    }

    #[test]
    fn a_thousand_spheres_in_runs_of_nested_ones_are_a_crowd() {
        // The first 31 pairs of a run do not count.
        let of = |nested: u32, apart: u32| crowded(&shells(nested).chain(row(apart)).collect::<Vec<_>>());
        assert!(of(1056, 1000) && !of(1055, 1001));
        // Few spheres are never a crowd.
        assert!(of(2048, 0) && !of(2047, 0) && of(1100, 948) && !of(1100, 947));
        assert!(!of(0, 3000));
        let hollow = |size: u32, count: u32| -> Vec<Sphere> {
            let of =
                |place: u32| move |index: u32| ball(3.0 * f64::from(place), 1.0 - 0.01 * f64::from(index));
            (0..count).flat_map(|place| (0..size).map(of(place))).collect()
        };
        assert!(!crowded(&hollow(32, 100)), "hollow balls");
        // Each run of 64 pairs counts 33.
        let apart: Vec<Sphere> = (0..40).map(|place| ball(1e3 + 3.0 * f64::from(place), 0.1)).collect();
        assert!(crowded(&hollow(65, 32)) && !crowded(&[hollow(65, 31), apart].concat()));
    }

    #[test]
    fn neighbours_in_space_have_neighbouring_codes() {
        assert_eq!(morton_code([0.0; 3]), 0);
        assert_eq!(morton_code([1.0; 3]), (1 << 63) - 1);
        let unit = 1.0 / f64::from((1 << 21) - 1);
        for (number, code) in [(1, 0b1), (2, 0b1000), (3, 0b1001), (5, 0b100_0001), (1 << 20, 1 << 60)] {
            // A little more, so that rounding does not take the number below.
            let x = (f64::from(number) + 0.5) * unit;
            for axis in 0..3 {
                let mut place = [0.0; 3];
                place[axis] = x;
                assert_eq!(morton_code(place), code << axis, "{number} on axis {axis}");
            }
        }
    }

    /// The numbers on either side of the best split, in order.
    fn sides(spheres: &[Sphere]) -> Option<[Vec<u32>; 2]> {
        let mut part: Vec<u32> = (0..spheres.len() as u32).collect();
        let left = part_where_it_pays(&Bounded::all(spheres, &DVec3::ZERO), &mut part)?;
        let (a, b) = part.split_at(left);
        Some([a, b].map(|side| {
            let mut side = side.to_vec();
            side.sort_unstable();
            side
        }))
    }

    #[test]
    fn a_split_pays_most_where_area_times_spheres_is_least() {
        // One ball in each of the sixteen bins.
        let even: Vec<Sphere> = (0..16).map(|place| ball(f64::from(place), 0.25)).collect();
        let all: Vec<u32> = (0..16).collect();
        assert_eq!(sides(&even), Some([all[..8].to_vec(), all[8..].to_vec()]));
        let backwards: Vec<Sphere> = even.iter().rev().copied().collect();
        assert_eq!(sides(&backwards), Some([all[8..].to_vec(), all[..8].to_vec()]));
        for axis in [DVec3::Y, DVec3::Z] {
            let turned = even.iter().map(|ball| Sphere { center: ball.center.x * axis, ..*ball });
            assert_eq!(sides(&turned.collect::<Vec<_>>()), sides(&even), "{axis}");
        }
        // Many balls at one end draw the split towards them.
        let heavy: Vec<Sphere> = even.iter().copied().chain([even[1]; 30]).collect();
        let [left, _] = sides(&heavy).unwrap();
        assert_eq!(left, [0, 1].into_iter().chain(16..46).collect::<Vec<u32>>());
        // Balls around the same place are parted by size, the small ones first.
        let nested: Vec<Sphere> = (0..6).map(|index| ball(0.0, [8.0, 1.0][index % 2])).collect();
        assert_eq!(sides(&nested), Some([vec![1, 3, 5], vec![0, 2, 4]]));
        assert_eq!(sides(&[ball(1.0, 2.0); 5]), None, "copies cannot be parted");
    }

    #[test]
    fn a_half_is_taken_along_the_widest_key() {
        let place = |index: u32| DVec3::new(f64::from(index % 2), -f64::from(index), 0.5 * f64::from(index));
        let spheres: Vec<Sphere> =
            (0..7).map(|index| Sphere { center: place(index), radius: 0.1, material: 0 }).collect();
        let mut part: Vec<u32> = (0..7).collect();
        let left = part_in_the_middle(&Bounded::all(&spheres, &DVec3::ZERO), &mut part);
        part[..left].sort_unstable();
        assert_eq!((left, &part[..left]), (3, &[4, 5, 6][..]));
        // Of equal keys, the first of the scene come first.
        let mut part: Vec<u32> = (0..4).rev().collect();
        let left = part_in_the_middle(&Bounded::all(&[ball(0.0, 1.0); 4], &DVec3::ZERO), &mut part);
        part[..left].sort_unstable();
        assert_eq!(part[..left], [0, 1]);
    }

    #[test]
    fn a_tree_holds_every_sphere_once_in_leaves_that_are_not_too_full() {
        let spheres: Vec<Sphere> = row(100).chain(shells(30)).collect();
        let bounded = Bounded::all(&spheres, &DVec3::ZERO);
        for (leaf_size, halved) in [(1, false), (1, true), (4, false), (4, true), (130, false)] {
            let tree = build(&bounded, leaf_size, halved);
            let mut order = tree.primitive_indices.clone();
            order.sort_unstable();
            assert!(order.into_iter().eq(0..130));
            let mut places = Vec::new();
            for node in &tree.nodes {
                let places_of = node.first_index..node.first_index + node.prim_count;
                if node.is_leaf() {
                    assert!(node.prim_count as usize <= leaf_size);
                    places.extend(places_of.clone());
                }
                for place in places_of {
                    let inner = bounded[tree.primitive_indices[place as usize] as usize].aabb();
                    assert_eq!(node.aabb().union(&inner), *node.aabb(), "a box holds its spheres");
                }
            }
            places.sort_unstable();
            assert!(places.into_iter().eq(0..130), "leaves of {leaf_size}");
            assert!(leaf_size < 130 || tree.nodes.len() == 1, "no more nodes than are needed");
            assert!(leaf_size > 1 || tree.nodes.len() == 2 * 130 - 1, "each node has two children");
        }
    }
}
