//! A path step by step: what each ray meets, and how the next ray's direction was chosen.

use crate::film::HALVES;
use crate::job::render::{RenderJob, RenderSettings};
use crate::kernel::path_record::PathRecord;
use crate::kernel::sampling::{HalfKey, SampleBlock};
use crate::render_cpu::lanes::{Scalar, Word, unit_float};
use crate::render_cpu::rng;
use crate::scene::{Look, Material, Sphere};
use crate::stages::{DielectricLaws, Diffuse, Rules, Shading};
use glam::DVec3;

/// One ray of a path and what happens at its end.
#[derive(Clone, Debug)]
pub struct Step {
    /// Start of the ray, scene units.
    pub origin: DVec3,
    pub direction: DVec3,
    /// Factor by which light that arrives along the ray contributes to the pixel, linear RGB.
    pub throughput: DVec3,
    /// Where and what the ray hits; `None` if it leaves the scene.
    pub hit: Option<Hit>,
    pub event: Event,
}

/// The end of a ray on a sphere.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    pub sphere: usize,
    /// The point, scene units.
    pub point: DVec3,
    /// Unit normal on the side that the ray comes from.
    pub normal: DVec3,
    /// Whether the ray comes from outside the sphere.
    pub is_outside: bool,
}

/// The event at the end of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// The ray leaves the scene, and the path collects light of the sky.
    Sky,
    /// Stages before light transport: the surface is shown by a colour, and the path ends.
    Shown,
    /// The path has reached its ray limit and ends without light.
    Limit,
    /// The fuzzy reflection points into the metal, which absorbs it.
    Absorbed(Lobe),
    /// The path continues in a direction drawn from the lobe.
    Scattered(Lobe),
}

/// The lobe that the next ray is drawn from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lobe {
    /// A uniform direction on the side of the normal.
    Hemisphere,
    /// The normal plus a uniform unit vector.
    Lambertian,
    /// The mirrored direction plus `fuzz` times a uniform unit vector.
    Metal {
        mirrored: DVec3,
        /// Length of the random part, `0..=1`.
        fuzz: f64,
    },
    /// One of two directions.
    Glass {
        mirrored: DVec3,
        /// The refracted unit direction; `None` where Snell's law has no solution.
        refracted: Option<DVec3>,
        /// The probability of reflection: 1 where Snell's law has no solution and the rules handle that.
        reflectance: f64,
        /// The random number in `[0, 1)`; the ray is reflected if it is less than `reflectance`.
        coin: f64,
        refracts: bool,
    },
}

/// Explains the path of sample `index` of a pixel, ray by ray. `record` must be that path of `job`.
pub fn steps(job: &RenderJob, pixel: [u32; 2], index: u64, record: &PathRecord) -> Vec<Step> {
    (0..record.rays.len()).filter_map(|bounce| step(job, pixel, index, record, bounce)).collect()
}

/// Explains one ray of the path, as [`steps`].
fn step(job: &RenderJob, [x, y]: [u32; 2], index: u64, record: &PathRecord, bounce: usize) -> Option<Step> {
    let ray = record.rays.get(bounce)?;
    let (origin, direction) = (DVec3::from(ray.origin), DVec3::from(ray.direction));
    let hit = ray.hit.map(|hit| {
        let sphere = job.scene().spheres[hit.sphere];
        let point = hit.position.map_or(origin + direction * hit.distance, DVec3::from);
        hit_of(&sphere, hit.sphere, point, direction)
    });
    let next = record.rays.get(bounce + 1).map(|next| DVec3::from(next.direction));
    let coin = coin(job.settings(), x | y << 16, index, bounce as u32 + 1);
    let event = hit.map_or(Event::Sky, |hit| event_of(job, &hit, direction, next, bounce, coin));
    Some(Step { origin, direction, throughput: DVec3::from(ray.throughput), hit, event })
}

/// The first number that sample `index` draws for its ray `ray`; 0 is the ray from the camera.
fn coin(settings: &RenderSettings, pixel: u32, index: u64, ray: u32) -> f64 {
    let lane = Scalar::<false>;
    let (half, first) = ((index % HALVES) as u32, (index / HALVES) as u32);
    let (counter, _) = SampleBlock { half, first, count: 1 }.counter(settings);
    let key = rng::sampler_key(lane, HalfKey::new(settings, half), Word(pixel));
    let numbers = rng::numbers(lane, settings, Word(pixel), Word(counter), key, key + Word(ray), false);
    let [[first, _], _] = numbers;
    f64::from(unit_float(lane, first).0)
}

fn hit_of(sphere: &Sphere, number: usize, point: DVec3, direction: DVec3) -> Hit {
    let outward = (point - sphere.center).normalize_or_zero();
    let is_outside = direction.dot(outward) < 0.0;
    Hit { sphere: number, point, normal: if is_outside { outward } else { -outward }, is_outside }
}

/// The event at a hit. `next` is the direction of the path's next ray, if it has one.
fn event_of(
    job: &RenderJob,
    hit: &Hit,
    direction: DVec3,
    next: Option<DVec3>,
    bounce: usize,
    coin: f64,
) -> Event {
    if job.rules().shading != Shading::Path {
        return Event::Shown;
    }
    let material = job.scene().material_of(&job.scene().spheres[hit.sphere]);
    let lobe = lobe_of(material, job.rules(), hit, direction, next, coin);
    match next {
        Some(_) => Event::Scattered(lobe),
        None if bounce + 1 >= job.settings().max_depth as usize => Event::Limit,
        None => Event::Absorbed(lobe),
    }
}

fn lobe_of(
    material: &Material,
    rules: &Rules,
    hit: &Hit,
    direction: DVec3,
    next: Option<DVec3>,
    coin: f64,
) -> Lobe {
    let cosine = (-direction.dot(hit.normal)).clamp(0.0, 1.0);
    let mirrored = (direction + hit.normal * (2.0 * cosine)).normalize_or_zero();
    match material.look() {
        Look::Matte if rules.diffuse == Diffuse::Hemisphere => Lobe::Hemisphere,
        Look::Matte => Lobe::Lambertian,
        Look::Mirror { fuzz } => Lobe::Metal { mirrored, fuzz },
        Look::Glass { refraction_index } => {
            let ratio = if hit.is_outside { 1.0 / refraction_index } else { refraction_index };
            let across = direction + hit.normal * cosine;
            let refracted_sine2 = ratio * ratio * across.length_squared();
            let refracted = (refracted_sine2 <= 1.0)
                .then(|| across * ratio - hit.normal * (1.0 - refracted_sine2).max(0.0).sqrt());
            let f0 = ((1.0 - refraction_index) / (1.0 + refraction_index)).powi(2);
            let reflectance = match rules.dielectric {
                DielectricLaws::RefractOnly => 0.0,
                _ if refracted.is_none() => 1.0,
                DielectricLaws::TotalReflection => 0.0,
                DielectricLaws::Schlick => f0 + (1.0 - f0) * (1.0 - cosine).powi(5),
            };
            let refracts = next.is_some_and(|next| next.dot(hit.normal) < 0.0);
            Lobe::Glass { mirrored, refracted, reflectance, coin, refracts }
        }
    }
}

impl Step {
    /// Describes the event at the end of the ray in one or two sentences.
    pub fn sentence(&self, job: &RenderJob) -> String {
        let Some(hit) = self.hit else {
            return "The ray leaves the scene and brings back the light of the sky.".to_owned();
        };
        let degrees = |direction: DVec3| direction.dot(hit.normal).abs().min(1.0).acos().to_degrees();
        let angle = degrees(self.direction);
        match self.event {
            Event::Sky | Event::Shown => {
                "The surface is hit. This stage shows it in a colour and ends the path here.".to_owned()
            }
            Event::Limit => {
                let limit = job.settings().max_depth;
                format!("This is the last of {limit} rays that a path may have: it ends here and brings no light.")
            }
            Event::Absorbed(_) => {
                "Metal: the fuzzy reflection points into the surface, so the ray is absorbed.".to_owned()
            }
            Event::Scattered(Lobe::Hemisphere) => {
                "Matte: the new direction is any direction above the surface, all equally likely.".to_owned()
            }
            Event::Scattered(Lobe::Lambertian) => {
                "Matte: the new direction is the normal plus a random unit vector, so directions near the normal are \
                 more likely."
                    .to_owned()
            }
            Event::Scattered(Lobe::Metal { fuzz: 0.0, .. }) => {
                format!("Mirror: the ray arrives at {angle:.0}° to the normal and leaves at the same angle.")
            }
            Event::Scattered(Lobe::Metal { fuzz, .. }) => format!(
                "Metal: the ray is mirrored at {angle:.0}°, then moved by a random vector of length {fuzz}, its fuzz."
            ),
            Event::Scattered(Lobe::Glass { refracted, reflectance, coin, refracts, .. }) => {
                let side = if hit.is_outside { "from outside" } else { "from inside" };
                let what = match (job.rules().dielectric, refracted.map(degrees)) {
                    (DielectricLaws::RefractOnly, None) => {
                        "Snell's law has no solution; this stage refracts all the same, wrongly.".to_owned()
                    }
                    (_, None) => "Snell's law has no solution: total reflection.".to_owned(),
                    (DielectricLaws::Schlick, Some(inner)) => {
                        let end =
                            if refracts { format!("refracted, to {inner:.0}°") } else { "reflected".to_owned() };
                        let chance = 100.0 * reflectance;
                        format!("Schlick says {chance:.1} % reflect; the coin is {coin:.3}: {end}.")
                    }
                    (_, Some(inner)) => format!("It is refracted, to {inner:.0}°."),
                };
                format!("Glass: the ray arrives {side}, at {angle:.0}°. {what}")
            }
        }
    }
}
