//! The spheres that are nearest to a sphere in place and size, among many.

use crate::scene::Sphere;
use glam::DVec3;

/// The number of neighbours that are looked for.
pub(super) const NEIGHBOURS: usize = 4;

/// Most spheres in a part that is not divided further.
const LEAF_SPHERES: usize = 8;

/// The greatest distance between two surfaces if one sphere is inside the other; otherwise more than that.
pub(super) fn thickness(first: &Sphere, second: &Sphere) -> f64 {
    first.center.distance(second.center) + (first.radius - second.radius).abs()
}

/// A tree over spheres, by place and size: each part is halved along the direction in which it is widest.
pub(super) struct Nearest<'scene> {
    spheres: &'scene [Sphere],
    /// Indices of the spheres, so that each part is a range of them.
    order: Vec<u32>,
    /// The bounds of each part. Those of the halves of part `i` are at `2 i + 1` and `2 i + 2`.
    bounds: Vec<Bounds>,
}

/// Ranges of places and radii.
#[derive(Clone, Copy, Default)]
struct Bounds {
    center: [DVec3; 2],
    radius: [f64; 2],
}

impl Bounds {
    fn of(spheres: &[Sphere], part: &[u32]) -> Self {
        let none = Bounds {
            center: [DVec3::INFINITY, DVec3::NEG_INFINITY],
            radius: [f64::INFINITY, f64::NEG_INFINITY],
        };
        part.iter().map(|index| &spheres[*index as usize]).fold(none, |all, sphere| Bounds {
            center: [all.center[0].min(sphere.center), all.center[1].max(sphere.center)],
            radius: [all.radius[0].min(sphere.radius), all.radius[1].max(sphere.radius)],
        })
    }

    /// What [`thickness`] is at least between this sphere and one within the bounds.
    fn least_thickness(&self, sphere: &Sphere) -> f64 {
        let [low, high] = self.center;
        let apart = (low - sphere.center).max(sphere.center - high).max(DVec3::ZERO).length();
        apart + (self.radius[0] - sphere.radius).max(sphere.radius - self.radius[1]).max(0.0)
    }

    /// The coordinate that varies most: 0 to 2 for the place, 3 for the radius.
    fn widest(&self) -> usize {
        let [x, y, z] = (self.center[1] - self.center[0]).to_array();
        let widths = [x, y, z, self.radius[1] - self.radius[0]];
        (0..4).max_by(|a, b| widths[*a].total_cmp(&widths[*b])).unwrap_or(0)
    }
}

/// A part of the tree: its number, and its range in the order.
#[derive(Clone, Copy)]
struct Part {
    number: usize,
    first: usize,
    count: usize,
}

impl Part {
    /// The halves of a part that is divided.
    fn halves(self) -> Option<[Part; 2]> {
        let Part { number, first, count } = self;
        let half = count / 2;
        (count > LEAF_SPHERES).then_some([
            Part { number: 2 * number + 1, first, count: half },
            Part { number: 2 * number + 2, first: first + half, count: count - half },
        ])
    }
}

impl<'scene> Nearest<'scene> {
    /// Sorts the `members` of a scene.
    pub fn new(spheres: &'scene [Sphere], members: Vec<u32>) -> Self {
        let mut tree = Nearest { spheres, order: members, bounds: Vec::new() };
        let mut open = vec![tree.whole()];
        while let Some(part) = open.pop() {
            let members = &mut tree.order[part.first..part.first + part.count];
            let bounds = Bounds::of(spheres, members);
            if tree.bounds.len() <= part.number {
                tree.bounds.resize(part.number + 1, Bounds::default());
            }
            tree.bounds[part.number] = bounds;
            let Some(halves) = part.halves() else { continue };
            let which = bounds.widest();
            let key = |index: &u32| {
                let Sphere { center, radius, .. } = spheres[*index as usize];
                [center.x, center.y, center.z, radius][which]
            };
            let by_key = |a: &u32, b: &u32| key(a).total_cmp(&key(b)).then(a.cmp(b));
            members.select_nth_unstable_by(halves[0].count, by_key);
            open.extend(halves);
        }
        tree
    }

    fn whole(&self) -> Part {
        Part { number: 0, first: 0, count: self.order.len() }
    }

    /// The members, in no particular order.
    pub fn members(&self) -> &[u32] {
        &self.order
    }

    /// Up to [`NEIGHBOURS`] members, the nearest first, whose surfaces are everywhere closer than `reach` to that of sphere
    /// `index`.
    pub fn to(&self, index: u32, reach: f64) -> Vec<u32> {
        let sphere = &self.spheres[index as usize];
        let mut found: Vec<(f64, u32)> = Vec::with_capacity(NEIGHBOURS + 1);
        let limit = |found: &[(f64, u32)]| found.get(NEIGHBOURS - 1).map_or(reach, |last| last.0);
        let mut open = vec![(0.0, self.whole())];
        while let Some((least, part)) = open.pop() {
            if least > limit(&found) {
                continue;
            }
            if let Some(halves) = part.halves() {
                let mut halves = halves.map(|half| (self.bounds[half.number].least_thickness(sphere), half));
                halves.sort_by(|a, b| b.0.total_cmp(&a.0));
                open.extend(halves);
                continue;
            }
            for other in &self.order[part.first..part.first + part.count] {
                let thickness = thickness(sphere, &self.spheres[*other as usize]);
                if *other != index && thickness < limit(&found) {
                    let place = found.partition_point(|(before, _)| *before <= thickness);
                    found.insert(place, (thickness, *other));
                    found.truncate(NEIGHBOURS);
                }
            }
        }
        found.into_iter().map(|(_, other)| other).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_are_those_of_all() {
        let random =
            |i: u32, k: u32| f64::from(crate::sampling::pcg4d([i, k, 1, 0])[0]) / f64::from(u32::MAX);
        let sphere = |i: u32| Sphere {
            // A third of them in one place, and many of one size.
            center: DVec3::new(random(i, 0), random(i, 1), random(i, 2)) * f64::from(i % 3),
            radius: 1.0 + if i.is_multiple_of(2) { random(i, 3) } else { 0.0 },
            material: 0,
        };
        for count in [1, 8, 9, 200] {
            let spheres: Vec<Sphere> = (0..count).map(sphere).collect();
            let tree = Nearest::new(&spheres, (0..count).collect());
            let mut members = tree.members().to_vec();
            members.sort_unstable();
            assert!(members.into_iter().eq(0..count));
            for index in 0..count {
                for reach in [0.05, 0.5, 10.0] {
                    let to = |other: &u32| thickness(&spheres[index as usize], &spheres[*other as usize]);
                    let mut all: Vec<f64> =
                        (0..count).filter(|other| *other != index).map(|other| to(&other)).collect();
                    all.retain(|thickness| *thickness < reach);
                    all.sort_by(f64::total_cmp);
                    all.truncate(NEIGHBOURS);
                    let found: Vec<f64> = tree.to(index, reach).iter().map(to).collect();
                    assert_eq!(found, all, "{index} of {count}, {reach}");
                }
            }
        }
    }
}
