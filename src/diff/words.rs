//! Describes differences in sentences.

use super::compare::{Difference, PathComparison, Quantity, departure};
use crate::console::printable;
use crate::record::{PathRecord, RecordedRay};
use crate::render::RenderJob;
use glam::DVec3;
use std::borrow::Cow;

/// A ray that misses a sphere by less than this fraction of the radius grazes it.
const GRAZING_SHARE: f64 = 0.01;

/// The two paths that are compared, with what is needed to describe them.
#[derive(Clone, Copy)]
pub struct Told<'a> {
    /// The job that was rendered.
    pub job: &'a RenderJob,
    /// Short names of the sides.
    pub names: [&'a str; 2],
    /// The recorded paths.
    pub paths: [&'a PathRecord; 2],
    /// Largest difference that does not count.
    pub tolerance: f64,
}

impl Told<'_> {
    /// The result in one or two sentences.
    pub fn verdict(&self, comparison: &PathComparison) -> String {
        match (comparison.first, comparison.parting) {
            (None, _) if comparison.largest == 0.0 && comparison.radiance == 0.0 => {
                "the paths agree to the bit".to_owned()
            }
            (None, _) => format!(
                "the paths agree: the largest difference is {:.1e}, and up to {:.0e} is allowed",
                comparison.largest.max(comparison.radiance),
                self.tolerance
            ),
            (Some(first), Some(parting)) if first != parting => {
                format!("{}. Then {}", self.sentence(&first), self.sentence(&parting))
            }
            (Some(first), _) => self.sentence(&first),
        }
    }

    /// A difference in a sentence: `ray 2: the paths part: cpu avx2 meets sphere 7 (glass), gpu the sky`. Rays are counted
    /// from 1, as in the window.
    pub fn sentence(&self, difference: &Difference) -> String {
        let Difference { ray: index, quantity, amount } = *difference;
        let number = index + 1;
        let [a, b] = self.names;
        let [ray_a, ray_b] = self.paths.map(|path| path.rays.get(index));
        let drift = |what: &str| {
            format!("ray {number}: {what} differ by {amount:.1e}, but only {:.0e} is allowed", self.tolerance)
        };
        match quantity {
            Quantity::Origin => drift("the origins of the rays"),
            Quantity::Direction => drift("the directions"),
            Quantity::Throughput => drift("the throughputs"),
            Quantity::Distance => drift("the distances"),
            Quantity::Radiance => format!(
                "the radiances differ by {amount:.1e}, but only {:.0e} is allowed, although the rays agree",
                self.tolerance
            ),
            Quantity::Object => {
                let meets = |ray: Option<&RecordedRay>| self.object(ray);
                format!(
                    "ray {number}: the paths part: {a} meets {}, {b} {}{}",
                    meets(ray_a),
                    meets(ray_b),
                    self.near_miss(ray_a, ray_b).unwrap_or_default()
                )
            }
            Quantity::Departure => {
                let word =
                    |path| departure(self.job, path, index).map_or("gone", |departure| departure.word());
                let [word_a, word_b] = self.paths.map(word);
                let at = self.object(ray_a.or(ray_b));
                format!("ray {number}: the paths part at {at}: {a} is {word_a}, {b} is {word_b}")
            }
        }
    }

    /// `sphere 7 (glass)`, or the sky.
    fn object(&self, ray: Option<&RecordedRay>) -> String {
        match ray.map(|ray| ray.hit) {
            None => "nothing".to_owned(),
            Some(None) => "the sky".to_owned(),
            Some(Some(hit)) => match self.material(hit.sphere) {
                Some((name, _)) => format!("sphere {} ({name})", hit.sphere),
                None => format!("sphere {}", hit.sphere),
            },
        }
    }

    /// Name (printable) and kind of a sphere's material.
    pub fn material(&self, sphere: usize) -> Option<(Cow<'_, str>, &'static str)> {
        let scene = self.job.scene();
        let named = scene.materials.get(scene.spheres.get(sphere)?.material)?;
        Some((printable(&named.name), named.material.kind()))
    }

    /// A note if one side only just misses the sphere that the other hits, so that rounding decided.
    fn near_miss(&self, a: Option<&RecordedRay>, b: Option<&RecordedRay>) -> Option<String> {
        let (a, b) = (a?, b?);
        [(a, b, self.names[1]), (b, a, self.names[0])].into_iter().find_map(|(hitting, missing, name)| {
            let sphere = self.job.scene().spheres.get(hitting.hit?.sphere)?;
            let to_center = sphere.center - DVec3::from(missing.origin);
            let miss = to_center.cross(DVec3::from(missing.direction)).length() / sphere.radius.abs() - 1.0;
            (0.0..GRAZING_SHARE)
                .contains(&miss)
                .then(|| format!("; {name} misses that sphere by {miss:.0e} of its radius"))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recipe::Recipe;
    use crate::record::RecordedHit;

    #[test]
    fn a_ray_that_just_misses_what_the_other_hits_is_told() {
        let job = Recipe::find("three-spheres").unwrap().job().unwrap();
        let sphere = job.scene().spheres[1];
        let path = |beside: f64, hit| {
            let origin = sphere.center + sphere.radius * DVec3::new(beside, 0.0, 9.0);
            let ray = RecordedRay {
                origin: origin.to_array(),
                direction: [0.0, 0.0, -1.0],
                throughput: [1.0; 3],
                hit,
            };
            PathRecord { rays: vec![ray], radiance: [0.0; 3] }
        };
        let hitting = path(0.999, Some(RecordedHit { sphere: 1, distance: 1.0, position: None }));
        let told = |beside: f64, is_swapped: bool| {
            let missing = path(beside, None);
            let paths = if is_swapped { [&missing, &hitting] } else { [&hitting, &missing] };
            let told = Told { job: &job, names: ["cpu", "gpu"], paths, tolerance: 1e-3 };
            told.sentence(&Difference { ray: 0, quantity: Quantity::Object, amount: f64::INFINITY })
        };
        assert!(told(1.005, false).ends_with(", gpu the sky; gpu misses that sphere by 5e-3 of its radius"));
        let swapped = told(1.005, true);
        assert!(
            swapped.contains("cpu meets the sky, gpu sphere 1 (") && swapped.contains("; cpu misses"),
            "{swapped}"
        );
        for beside in [0.5, 1.011, 3.0] {
            assert!(!told(beside, false).contains("misses"), "{beside}");
        }
    }

    /// Two paths that meet the second sphere; only the first goes on from there.
    fn paths() -> [PathRecord; 2] {
        let (direction, throughput) = ([0.0, 0.0, -1.0], [1.0; 3]);
        let hit = Some(RecordedHit { sphere: 1, distance: 1.0, position: Some([0.0; 3]) });
        let ray = RecordedRay { origin: [0.0; 3], direction, throughput, hit };
        let on = RecordedRay { direction: [0.0, 1.0, 0.0], hit: None, ..ray };
        [vec![ray, on], vec![ray]].map(|rays| PathRecord { rays, radiance: [0.5; 3] })
    }

    #[test]
    fn each_quantity_has_its_sentence() {
        let job = Recipe::find("three-spheres").unwrap().job().unwrap();
        let [a, b] = paths();
        let told = Told { job: &job, names: ["cpu", "gpu"], paths: [&a, &b], tolerance: 1e-4 };
        let drift = "differ by 2.5e-3, but only 1e-4 is allowed";
        for (quantity, expected) in [
            (Quantity::Origin, format!("ray 1: the origins of the rays {drift}")),
            (Quantity::Direction, format!("ray 1: the directions {drift}")),
            (Quantity::Throughput, format!("ray 1: the throughputs {drift}")),
            (Quantity::Distance, format!("ray 1: the distances {drift}")),
            (Quantity::Radiance, format!("the radiances {drift}, although the rays agree")),
            (
                Quantity::Departure,
                "ray 1: the paths part at sphere 1 (center): cpu is scattered, gpu is shown".to_owned(),
            ),
            (
                Quantity::Object,
                "ray 1: the paths part: cpu meets sphere 1 (center), gpu sphere 1 (center)".to_owned(),
            ),
        ] {
            let said = told.sentence(&Difference { ray: 0, quantity, amount: 2.5e-3 });
            assert_eq!(said, expected, "{quantity:?}");
        }
        // Of the second ray, only one side has anything to tell.
        let said = told.sentence(&Difference { ray: 1, quantity: Quantity::Object, amount: f64::INFINITY });
        assert_eq!(said, "ray 2: the paths part: cpu meets the sky, gpu nothing");
    }

    #[test]
    fn a_verdict_names_the_first_difference_and_where_the_paths_part() {
        let job = Recipe::find("three-spheres").unwrap().job().unwrap();
        let [a, b] = paths();
        let told = Told { job: &job, names: ["cpu", "gpu"], paths: [&a, &b], tolerance: 1e-4 };
        let drift = Difference { ray: 0, quantity: Quantity::Direction, amount: 2e-3 };
        let parting = Difference { ray: 0, quantity: Quantity::Departure, amount: f64::INFINITY };
        let (of_drift, of_parting) = (told.sentence(&drift), told.sentence(&parting));
        let agree = |most: &str| {
            format!("the paths agree: the largest difference is {most}, and up to 1e-4 is allowed")
        };
        for (first, last, largest, radiance, expected) in [
            (None, None, 0.0, 0.0, "the paths agree to the bit".to_owned()),
            (None, None, 3e-5, 2e-5, agree("3.0e-5")),
            (None, None, 2e-5, 4e-5, agree("4.0e-5")),
            (None, None, 0.0, 4e-5, agree("4.0e-5")),
            (None, None, 3e-5, 0.0, agree("3.0e-5")),
            (Some(drift), None, 2e-3, 0.0, of_drift.clone()),
            (Some(parting), Some(parting), 0.0, 0.5, of_parting.clone()),
            (Some(drift), Some(parting), 2e-3, 0.5, format!("{of_drift}. Then {of_parting}")),
        ] {
            let comparison = PathComparison { first, parting: last, largest, radiance };
            assert_eq!(told.verdict(&comparison), expected);
        }
    }
}
