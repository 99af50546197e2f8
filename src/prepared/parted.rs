//! A top-down tree builder for spheres that bottom-up clustering would chain: nested shells, copies, straight rows, and
//! spheres over many scales. For these, obvhs takes quadratic time and builds a tree as deep as there are spheres.

use super::bounded::Bounded;
use obvhs::Boundable;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use std::sync::atomic::{AtomicBool, Ordering};

/// Levels split at the lowest cost. Below them nodes are halved, which limits a tree's depth to this plus the logarithm
/// of the number of spheres.
const CHOSEN_LEVELS: usize = 32;

/// Bins for choosing a node's split.
const BINS: usize = 16;

/// Up to this many spheres, clustering is fast in any arrangement.
pub(super) const FEW_SPHERES: usize = 2048;

/// With this many spheres in nested runs, a scene counts as crowded.
const CROWD: usize = 1024;

/// Maximum number of clusters that [`ROUNDS`] of pairing may leave.
const LEFT_ALONE: usize = 256;

/// Rounds of pairing. Millions of scattered spheres end as one cluster.
const ROUNDS: usize = 64;

/// Shorter runs of nested spheres are hollow balls and similar objects.
const NESTED_RUN: usize = 32;

/// A range of spheres still to be split, and its node.
struct Open {
    node: usize,
    first: usize,
    count: usize,
    depth: usize,
}

/// Whether clustering would take long: enough spheres are nested in each other, or pair one at a time. They come along
/// a curve, with their boxes.
pub(super) fn is_crowded(spheres: &[&Bounded<'_>], boxes: &[Aabb]) -> bool {
    spheres.len() >= FEW_SPHERES && (has_nested_runs(spheres) || pairs_slowly(boxes))
}

fn has_nested_runs(spheres: &[&Bounded<'_>]) -> bool {
    let (mut nested, mut run) = (0, 0);
    for pair in spheres.windows(2) {
        // Being inside the box is enough here.
        let apart = (pair[0].center() - pair[1].center()).abs().max_element();
        if apart <= (pair[0].radius() - pair[1].radius()).abs() {
            run += 1;
            nested += usize::from(run >= NESTED_RUN);
        } else {
            run = 0;
        }
    }
    nested >= CROWD
}

/// Whether many clusters remain after [`ROUNDS`] of pairing neighbours. If sizes or distances grow along a line, each
/// sphere is nearest to the one before it, so only one pair forms per round.
fn pairs_slowly(boxes: &[Aabb]) -> bool {
    let mut clusters = paired(boxes);
    for _ in 1..ROUNDS {
        if clusters.len() <= LEFT_ALONE {
            return false;
        }
        clusters = paired(&clusters);
    }
    clusters.len() > LEFT_ALONE
}

/// Merges mutual nearest neighbours, as obvhs does among more neighbours.
fn paired(clusters: &[Aabb]) -> Vec<Aabb> {
    let costs: Vec<f32> = clusters.windows(2).map(|pair| pair[0].union(&pair[1]).half_area()).collect();
    let cost = |place: usize| costs.get(place).copied().unwrap_or(f32::INFINITY);
    let mut pairs = Vec::with_capacity(clusters.len());
    let (mut place, mut before) = (0, f32::INFINITY);
    while let Some(cluster) = clusters.get(place) {
        let next = clusters.get(place + 1).filter(|_| cost(place) <= before && cost(place) < cost(place + 1));
        pairs.push(next.map_or(*cluster, |next| cluster.union(next)));
        place += if next.is_some() { 2 } else { 1 };
        before = cost(place - 1);
    }
    pairs
}

/// Builds a tree over at least one box, with at most `leaf_size` per leaf. With `halved`, splits every node in the
/// middle for the lowest tree; otherwise minimises the sum of area times spheres (Wald 2007, "On fast Construction of
/// SAH-based Bounding Volume Hierarchies"). Once `cancel` is set, splits the rest at random, for a tree that will not
/// be used.
pub(super) fn build(spheres: &[impl Boundable], leaf_size: usize, halved: bool, cancel: &AtomicBool) -> Bvh2 {
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
        let left = if cancel.load(Ordering::Relaxed) {
            count / 2
        } else {
            let chosen = if depth < chosen_levels { part_where_it_pays(spheres, part) } else { None };
            chosen.unwrap_or_else(|| part_in_the_middle(spheres, part))
        };
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
mod tests;
