//! Compares two records of the same path: where they differ, in which quantity, and by how much.

use crate::film::FIXED_POINT_SCALE;
use crate::record::{PathRecord, RecordedRay};
use crate::render::RenderJob;
use crate::scene::Look;
use crate::stages::Shading;
use serde::Serialize;

/// A quantity of a ray or of the whole path, in the order in which they are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Quantity {
    /// Origin of the ray.
    Origin,
    /// Direction of the ray.
    Direction,
    /// Throughput of the path before the ray hits anything.
    Throughput,
    /// The sphere that the ray hits, or the sky.
    Object,
    /// Distance to the hit.
    Distance,
    /// How the path continues, or why it ends.
    Departure,
    /// Radiance of the sample.
    Radiance,
}

impl Quantity {
    /// The quantities of a ray.
    pub const OF_RAY: [Quantity; 6] = [
        Quantity::Origin,
        Quantity::Direction,
        Quantity::Throughput,
        Quantity::Object,
        Quantity::Distance,
        Quantity::Departure,
    ];
}

/// What happens to a path at a sphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Departure {
    /// Scattered in a random direction.
    Scattered,
    /// Reflected, with or without fuzz.
    Reflected,
    /// Refracted through the surface.
    Refracted,
    /// Absorbed, because the fuzzy reflection went into the surface.
    Absorbed,
    /// Cut off at the maximum depth.
    CutOff,
    /// Shown as it is: the stage follows no further rays.
    Shown,
}

impl Departure {
    /// A word that can follow "is".
    pub fn word(self) -> &'static str {
        match self {
            Departure::Scattered => "scattered",
            Departure::Reflected => "reflected",
            Departure::Refracted => "refracted",
            Departure::Absorbed => "absorbed",
            Departure::CutOff => "cut off",
            Departure::Shown => "shown",
        }
    }
}

/// What happens to a path after the ray with this index; `None` if that ray hits no sphere.
pub fn departure(job: &RenderJob, path: &PathRecord, index: usize) -> Option<Departure> {
    let ray = path.rays.get(index)?;
    let hit = ray.hit?;
    let sphere = job.scene().spheres.get(hit.sphere)?;
    Some(match (path.rays.get(index + 1), job.scene().material_of(sphere).look()) {
        (Some(next), Look::Glass { .. }) => {
            let outward = glam::DVec3::from(next.origin) - sphere.center;
            let side = |ray: &RecordedRay| glam::DVec3::from(ray.direction).dot(outward) > 0.0;
            if side(ray) == side(next) { Departure::Refracted } else { Departure::Reflected }
        }
        (Some(_), Look::Matte) => Departure::Scattered,
        (Some(_), Look::Mirror { .. }) => Departure::Reflected,
        (None, _) if job.rules().shading != Shading::Path => Departure::Shown,
        (None, _) if index + 1 >= job.settings().max_depth as usize => Departure::CutOff,
        (None, Look::Mirror { .. }) => Departure::Absorbed,
        (None, _) => Departure::Shown,
    })
}

/// A difference above the tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Index of the ray among the path's rays, 0 for the camera's.
    pub ray: usize,
    /// The quantity that differs.
    pub quantity: Quantity,
    /// The difference relative to the larger value; infinite if the quantity has no magnitude.
    pub amount: f64,
}

/// How two paths differ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PathComparison {
    /// The first difference above the tolerance.
    pub first: Option<Difference>,
    /// The first difference after which the paths are not the same. Their numbers may drift apart before that.
    pub parting: Option<Difference>,
    /// Largest difference of any quantity before the paths part.
    pub largest: f64,
    /// Difference of the radiances, relative to the larger one.
    pub radiance: f64,
}

/// Compares two records of the same path of `job`.
pub fn compare(job: &RenderJob, [a, b]: [&PathRecord; 2], tolerance: f64) -> PathComparison {
    let mut comparison = PathComparison {
        first: None,
        parting: None,
        largest: 0.0,
        radiance: radiance_amount(a.radiance, b.radiance),
    };
    let count = a.rays.len().max(b.rays.len());
    'rays: for ray in 0..count {
        for quantity in Quantity::OF_RAY {
            let amount = amount(job, [a, b], ray, quantity);
            let difference = Difference { ray, quantity, amount };
            if amount > tolerance {
                comparison.first.get_or_insert(difference);
            }
            if amount.is_infinite() {
                comparison.parting = Some(difference);
                break 'rays;
            }
            comparison.largest = comparison.largest.max(amount);
        }
    }
    if comparison.radiance > tolerance {
        let ray = count.saturating_sub(1);
        let difference = Difference { ray, quantity: Quantity::Radiance, amount: comparison.radiance };
        comparison.first.get_or_insert(difference);
    }
    comparison
}

/// Difference of a quantity of the ray with this index, relative to the larger value.
pub fn amount(job: &RenderJob, [a, b]: [&PathRecord; 2], index: usize, quantity: Quantity) -> f64 {
    let (ray_a, ray_b) = match (a.rays.get(index), b.rays.get(index)) {
        (Some(ray_a), Some(ray_b)) => (ray_a, ray_b),
        (None, None) => return 0.0,
        _ => return f64::INFINITY,
    };
    let apart = |is_apart: bool| if is_apart { f64::INFINITY } else { 0.0 };
    match quantity {
        Quantity::Origin => {
            // Positions are only as exact as the largest coordinate that the path has passed through.
            let extent = a.rays[..=index].iter().map(|ray| length(ray.origin)).fold(0.0, f64::max);
            share(length(minus(ray_a.origin, ray_b.origin)), extent.max(length(ray_b.origin)))
        }
        Quantity::Direction => length(minus(ray_a.direction, ray_b.direction)),
        Quantity::Throughput => vector_share(ray_a.throughput, ray_b.throughput, 0.0),
        Quantity::Object => apart(ray_a.hit.map(|hit| hit.sphere) != ray_b.hit.map(|hit| hit.sphere)),
        Quantity::Distance => match (ray_a.hit, ray_b.hit) {
            (Some(a), Some(b)) => {
                share((a.distance - b.distance).abs(), a.distance.abs().max(b.distance.abs()))
            }
            _ => 0.0,
        },
        Quantity::Departure => apart(departure(job, a, index) != departure(job, b, index)),
        Quantity::Radiance => radiance_amount(a.radiance, b.radiance),
    }
}

/// Relative difference of two radiances. The last unit of the film in either direction does not count.
pub fn radiance_amount(a: [f64; 3], b: [f64; 3]) -> f64 {
    vector_share(a, b, 2.0 / FIXED_POINT_SCALE)
}

/// Difference of the largest component beyond `forgiven`, relative to the largest component.
fn vector_share(a: [f64; 3], b: [f64; 3], forgiven: f64) -> f64 {
    let largest = |v: [f64; 3]| v.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    share((largest(minus(a, b)) - forgiven).max(0.0), largest(a).max(largest(b)))
}

fn share(difference: f64, of: f64) -> f64 {
    match difference / of {
        _ if difference == 0.0 => 0.0,
        share if share.is_nan() => f64::INFINITY,
        share => share,
    }
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn length(v: [f64; 3]) -> f64 {
    glam::DVec3::from(v).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recipe::Recipe;
    use crate::record::RecordedHit;
    use crate::scene::Material;

    fn job() -> RenderJob {
        Recipe::find("three-spheres").expect("built in").job().expect("valid")
    }

    fn path() -> PathRecord {
        let ray = |direction, hit| RecordedRay { origin: [0.0; 3], direction, throughput: [1.0; 3], hit };
        let hit = RecordedHit { sphere: 1, distance: 2.0, position: Some([0.0; 3]) };
        let rays = vec![ray([0.0, 0.0, -1.0], Some(hit)), ray([0.0, 1.0, 0.0], None)];
        PathRecord { rays, radiance: [0.25, 0.5, 1.0] }
    }

    #[test]
    fn a_path_is_like_itself() {
        let comparison = compare(&job(), [&path(), &path()], 0.0);
        assert_eq!(comparison, PathComparison { first: None, parting: None, largest: 0.0, radiance: 0.0 });
    }

    #[test]
    fn the_first_difference_is_found() {
        type Change = fn(&mut PathRecord);
        let cases: [(usize, Quantity, Change); 7] = [
            (0, Quantity::Direction, |p| p.rays[0].direction[0] = 1e-3),
            (1, Quantity::Origin, |p| p.rays[1].origin[2] = 1e-3),
            (1, Quantity::Throughput, |p| p.rays[1].throughput[1] = 0.99),
            (0, Quantity::Object, |p| p.rays[0].hit = None),
            (0, Quantity::Distance, |p| p.rays[0].hit.as_mut().expect("a hit").distance = 2.001),
            (0, Quantity::Departure, |p| p.rays.truncate(1)),
            (1, Quantity::Radiance, |p| p.radiance[0] = 0.26),
        ];
        for (ray, quantity, change) in cases {
            let mut changed = path();
            change(&mut changed);
            for pair in [[&path(), &changed], [&changed, &path()]] {
                let first = compare(&job(), pair, 1e-4).first.expect("a difference");
                assert_eq!((first.ray, first.quantity), (ray, quantity));
            }
        }
    }

    #[test]
    fn less_than_the_tolerance_is_no_difference() {
        let mut changed = path();
        changed.rays[1].direction[0] = 1e-5;
        let comparison = compare(&job(), [&path(), &changed], 1e-4);
        assert_eq!(comparison.first, None);
        assert!((0.9e-5..1.1e-5).contains(&comparison.largest), "{}", comparison.largest);
        let unit = 1.0 / FIXED_POINT_SCALE;
        assert_eq!(radiance_amount([0.0, unit, unit], [unit, 0.0, unit]), 0.0);
    }

    #[test]
    fn a_path_leaves_a_sphere_as_its_material_and_next_ray_say() {
        let job = job();
        let scene = job.scene();
        let of = |test: fn(&Material) -> bool| {
            scene.spheres.iter().position(|sphere| test(scene.material_of(sphere))).expect("a sphere")
        };
        let matte = of(|material| matches!(material, Material::Lambertian { .. }));
        let metal = of(|material| matches!(material, Material::Metal { .. }));
        let glass = of(|material| matches!(material, Material::Dielectric { .. }));
        // A ray downwards meets the top of the sphere; the next one starts there.
        let found = |sphere: usize, next: Option<[f64; 3]>, index: usize| {
            let center = scene.spheres[sphere].center;
            let top = (center + scene.spheres[sphere].radius * glam::DVec3::Y).to_array();
            let hit = RecordedHit { sphere, distance: 1.0, position: Some(top) };
            let ray = |direction, hit| RecordedRay { origin: top, direction, throughput: [1.0; 3], hit };
            let mut rays = vec![ray([0.0, -1.0, 0.0], Some(hit)); index + 1];
            rays.extend(next.map(|direction| ray(direction, None)));
            departure(&job, &PathRecord { rays, radiance: [0.0; 3] }, index)
        };
        let (up, down) = (Some([0.6, 0.8, 0.0]), Some([0.6, -0.8, 0.0]));
        assert_eq!(found(matte, up, 0), Some(Departure::Scattered));
        assert_eq!(found(metal, up, 0), Some(Departure::Reflected));
        assert_eq!(found(glass, up, 0), Some(Departure::Reflected));
        assert_eq!(found(glass, down, 0), Some(Departure::Refracted));
        assert_eq!(found(metal, None, 0), Some(Departure::Absorbed));
        assert_eq!(found(matte, None, 0), Some(Departure::Shown));
        let last = job.settings().max_depth as usize - 1;
        assert_eq!(found(metal, None, last), Some(Departure::CutOff));
        assert_eq!(found(metal, None, last - 1), Some(Departure::Absorbed));
        assert_eq!(departure(&job, &path(), 1), None, "the sky");
        assert_eq!(departure(&job, &path(), 2), None, "nothing");
    }

    #[test]
    fn a_stage_that_follows_no_rays_shows_what_the_first_one_hits() {
        let path = |sphere: usize| {
            let hit = Some(RecordedHit { sphere, distance: 1.0, position: None });
            let ray =
                RecordedRay { origin: [0.0; 3], direction: [0.0, 0.0, -1.0], throughput: [1.0; 3], hit };
            PathRecord { rays: vec![ray], radiance: [0.5; 3] }
        };
        for shading in [Shading::FirstHitRed, Shading::Normals] {
            for max_depth in [1, 24] {
                let mut recipe = Recipe::find("three-spheres").expect("built in");
                (recipe.rules.shading, recipe.settings.max_depth) = (shading, max_depth);
                let job = recipe.job().expect("valid");
                for sphere in 0..job.scene().spheres.len() {
                    let found = departure(&job, &path(sphere), 0);
                    assert_eq!(found, Some(Departure::Shown), "{shading:?} {max_depth} {sphere}");
                }
            }
        }
    }

    #[test]
    fn what_comes_after_the_paths_have_parted_does_not_count() {
        let mut changed = path();
        changed.rays[0].direction[0] = 1e-3;
        changed.rays[1].origin = [0.0, 2e-3, 0.0];
        changed.rays[1].hit = Some(RecordedHit { sphere: 2, distance: 7.0, position: Some([0.0; 3]) });
        changed.rays.push(RecordedRay { hit: None, ..changed.rays[1] });
        changed.radiance = [0.25, 0.5, 0.75];
        for (pair, tolerance) in
            [([&path(), &changed], 1e-4), ([&changed, &path()], 1e-4), ([&path(), &changed], 1e-2)]
        {
            let found = compare(&job(), pair, tolerance);
            let what = |difference: Difference| (difference.ray, difference.quantity);
            assert_eq!(found.parting.map(what), Some((1, Quantity::Object)));
            // The origin of the second ray is the path's largest coordinate, so all of it differs.
            let first = if tolerance < 1e-3 { (0, Quantity::Direction) } else { (1, Quantity::Origin) };
            assert_eq!(found.first.map(what), Some(first));
            assert_eq!((found.largest, found.radiance), (1.0, 0.25 - 2.0 / FIXED_POINT_SCALE));
        }
    }

    #[test]
    fn differences_are_relative_to_the_larger_value() {
        assert_eq!([share(0.0, 0.0), share(1.0, 0.0), share(1.0, 4.0)], [0.0, f64::INFINITY, 0.25]);
        assert_eq!(share(f64::NAN, 1.0), f64::INFINITY);
        assert_eq!(vector_share([1.0, -4.0, 2.0], [1.0, -3.0, 0.0], 0.0), 0.5);
        assert_eq!(vector_share([1.0, -4.0, 2.0], [1.0, -3.0, 0.0], 1.0), 0.25);
        assert_eq!(vector_share([1.0, -4.0, 2.0], [1.0, -3.0, 0.0], 3.0), 0.0);
        // Places are as exact as the farthest one that the path has come from.
        let mut far = path();
        far.rays[0].origin = [0.0, 8.0, 0.0];
        let mut moved = far.clone();
        moved.rays[1].origin = [0.0, 2.0, 0.0];
        assert_eq!(amount(&job(), [&far, &moved], 1, Quantity::Origin), 0.25);
        assert_eq!(amount(&job(), [&far, &moved], 0, Quantity::Origin), 0.0);
        moved.rays[1].origin = [0.0, 16.0, 0.0];
        assert_eq!(amount(&job(), [&far, &moved], 1, Quantity::Origin), 1.0);
    }
}
