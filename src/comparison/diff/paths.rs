//! Compares two records of the same path: where they differ, in which quantity, and by how much.

use crate::backends::explain::{Event, Lobe, step};
use crate::film::FIXED_POINT_SCALE;
use crate::job::render::RenderJob;
use crate::kernel::path_record::{PathRecord, RecordedHit, RecordedRay};
use crate::system::console::printable;
use glam::DVec3;
use serde::Serialize;

/// A difference above the tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Index of the ray in the path; 0 is the camera's.
    pub ray: usize,
    /// Label of the row, or `radiance`.
    pub quantity: &'static str,
    /// Relative to the larger value; infinite if the quantity has no magnitude.
    pub amount: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PathComparison {
    /// First difference above the tolerance.
    pub first: Option<Difference>,
    /// First difference after which the paths are no longer the same. Their numbers may drift apart before that.
    pub parting: Option<Difference>,
    /// Largest difference before the paths diverge.
    pub largest: f64,
    /// Relative difference of the radiances.
    pub radiance: f64,
}

/// A quantity of a ray on both sides.
pub struct Row {
    pub label: &'static str,
    /// `None` where a side has none.
    pub values: [Option<String>; 2],
    /// Relative difference.
    pub amount: f64,
}

/// Two records of the same path, with the context for comparing and describing them.
#[derive(Clone, Copy)]
pub struct Pair<'a> {
    pub job: &'a RenderJob,
    /// Short names of the sides.
    pub names: [&'a str; 2],
    pub paths: [&'a PathRecord; 2],
    /// Largest difference that is ignored.
    pub tolerance: f64,
}

impl Pair<'_> {
    /// Length of the longer path.
    pub fn rays(&self) -> usize {
        self.paths.iter().map(|path| path.rays.len()).max().unwrap_or(0)
    }

    pub fn compare(&self) -> PathComparison {
        let [a, b] = self.paths;
        let radiance = radiance_amount(a.radiance, b.radiance);
        let mut comparison = PathComparison { first: None, parting: None, largest: 0.0, radiance };
        for (ray, row) in (0..self.rays()).flat_map(|ray| self.rows(ray).map(|row| (ray, row))) {
            let difference = Difference { ray, quantity: row.label, amount: row.amount };
            if row.amount > self.tolerance {
                comparison.first.get_or_insert(difference);
            }
            if row.amount.is_infinite() {
                comparison.parting = Some(difference);
                break;
            }
            comparison.largest = comparison.largest.max(row.amount);
        }
        if radiance > self.tolerance {
            let ray = self.rays().saturating_sub(1);
            let difference = Difference { ray, quantity: "radiance", amount: radiance };
            comparison.first.get_or_insert(difference);
        }
        comparison
    }

    /// The quantities of the ray at `index`.
    pub fn rows(&self, index: usize) -> [Row; 6] {
        let rays = self.paths.map(|path| path.rays.get(index));
        let departures = self.paths.map(|path| self.departure(path, index));
        // Positions are only as exact as the largest coordinate the path has passed through.
        let length = |ray: &RecordedRay| DVec3::from(ray.origin).length();
        let extent = self.paths[0].rays.iter().take(index + 1).map(length).fold(0.0, f64::max);
        let apart = |is_apart: bool| if is_apart { f64::INFINITY } else { 0.0 };
        let amounts = match rays {
            [Some(a), Some(b)] => [
                share((DVec3::from(a.origin) - DVec3::from(b.origin)).length(), extent.max(length(b))),
                (DVec3::from(a.direction) - DVec3::from(b.direction)).length(),
                vector_share(a.throughput, b.throughput, 0.0),
                apart(a.hit.map(|hit| hit.sphere) != b.hit.map(|hit| hit.sphere)),
                a.hit.zip(b.hit).map_or(0.0, |(a, b)| {
                    share((a.distance - b.distance).abs(), a.distance.abs().max(b.distance.abs()))
                }),
                apart(departures[0] != departures[1]),
            ],
            // If only one side has this ray, the paths have diverged.
            _ => [f64::INFINITY; 6],
        };
        let vectors = |of: fn(&RecordedRay) -> [f64; 3]| rays.map(|ray| ray.map(|ray| vector(of(ray))));
        let row = |place: usize, label, values| Row { label, values, amount: amounts[place] };
        [
            row(0, "origin", vectors(|ray| ray.origin)),
            row(1, "direction", vectors(|ray| ray.direction)),
            row(2, "throughput", vectors(|ray| ray.throughput)),
            row(3, "object", rays.map(|ray| ray.map(|ray| self.numbered(ray)))),
            row(4, "distance", rays.map(|ray| Some(number(ray?.hit?.distance).trim_start().to_owned()))),
            row(5, "departure", departures.map(|word| word.map(str::to_owned))),
        ]
    }

    /// The fate of a path after the ray at `index`, as a word that can follow "is"; `None` if the ray hits no sphere.
    fn departure(&self, path: &PathRecord, index: usize) -> Option<&'static str> {
        // The words need no random numbers, so any pixel and sample will do.
        match step(self.job, [0, 0], 0, path, index)?.event {
            Event::Sky => None,
            Event::Shown => Some("shown"),
            Event::Limit => Some("cut off"),
            Event::Absorbed(_) => Some("absorbed"),
            Event::Scattered(Lobe::Hemisphere | Lobe::Lambertian) => Some("scattered"),
            Event::Scattered(Lobe::Glass { refracts: true, .. }) => Some("refracted"),
            Event::Scattered(Lobe::Glass { .. } | Lobe::Metal { .. }) => Some("reflected"),
        }
    }

    /// The verdict in one or two sentences.
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

    /// A difference as a sentence: `ray 2: the paths diverge in object: cpu avx2 #7 glass (dielectric), gpu the sky`.
    /// Rays count from 1, as in the window.
    pub fn sentence(&self, difference: &Difference) -> String {
        let Difference { ray, quantity, amount } = *difference;
        let allowed = format!("by {amount:.1e}, but only {:.0e} is allowed", self.tolerance);
        if quantity == "radiance" {
            return format!("the radiances differ {allowed}, although the rays agree");
        }
        if amount.is_finite() {
            return format!("ray {}: {quantity} differs {allowed}", ray + 1);
        }
        let row = self.rows(ray).into_iter().find(|row| row.label == quantity);
        let values = row.map_or([None, None], |row| row.values);
        let [a, b] = values.map(|value| value.unwrap_or("nothing".to_owned()).trim().to_owned());
        let [name_a, name_b] = self.names;
        format!("ray {}: the paths diverge in {quantity}: {name_a} {a}, {name_b} {b}", ray + 1)
    }

    /// `#7 glass (dielectric)`, with a printable name of the material, or the sky.
    fn numbered(&self, ray: &RecordedRay) -> String {
        let Some(RecordedHit { sphere, .. }) = ray.hit else { return "the sky".to_owned() };
        let scene = self.job.scene();
        let named = &scene.materials[scene.spheres[sphere].material];
        format!("#{sphere} {} ({})", printable(&named.name), named.material.kind())
    }
}

/// Relative difference of two radiances, ignoring the film's last unit either way.
pub fn radiance_amount(a: [f64; 3], b: [f64; 3]) -> f64 {
    vector_share(a, b, 2.0 / FIXED_POINT_SCALE)
}

/// Largest component difference beyond `forgiven`, relative to the largest component.
fn vector_share(a: [f64; 3], b: [f64; 3], forgiven: f64) -> f64 {
    let (a, b) = (DVec3::from(a), DVec3::from(b));
    let difference = (a - b).abs().max_element() - forgiven;
    share(difference.max(0.0), a.abs().max_element().max(b.abs().max_element()))
}

fn share(difference: f64, of: f64) -> f64 {
    match difference / of {
        _ if difference == 0.0 => 0.0,
        share if share.is_nan() => f64::INFINITY,
        share => share,
    }
}

pub fn vector(v: [f64; 3]) -> String {
    v.map(number).join(" ")
}

/// Exactly nine characters, with as many digits as fit.
fn number(x: f64) -> String {
    let text = match x.abs() {
        0.0 => "0".to_owned(),
        size if !(1e-4..1e5).contains(&size) => format!("{x:.2e}"),
        size => format!("{x:.*}", 6 - (size.log10().floor().max(0.0) as usize).min(4)),
    };
    format!("{text:>9}")
}
