//! Properties that every scene must have.

use crate::film::Film;
use crate::recipe::Recipe;
use crate::scene::{Scene, Sphere};
use crate::stress::backend::{Backend, Traced};
use crate::stress::families::build::moved;
use crate::stress::far::with_far_spheres;
use crate::stress::figures::{Level, Paired};
use crate::stress::verdict::{Against, judge};
use glam::DVec3;
use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// By how much a mean may differ apart from noise, linear radiance.
const TOLERANCE: f64 = 1e-5;

/// A difference is looked at again with this many times the samples. Where rounding differs, chaotic paths diverge at
/// random, a few in a thousand in glass; a wrong picture stays wrong whatever the seed.
const SECOND_LOOK: f64 = 64.0;

/// About how long a second look may take, seconds; it takes fewer samples if necessary.
const SECOND_LOOK_TIME: f64 = 5.0;

/// Seeds of the second looks, added to the scene's. If few pixels have most of the noise, one look is not enough.
const SEEDS: [u32; 2] = [0, 1];

/// A property that is checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Check {
    /// `f32` gives the same picture as `f64`.
    Rounding,
    /// Adding forty distant spheres, and thereby a hierarchy, changes nothing.
    Hierarchy,
    /// Multiplying all lengths by four changes nothing but the last bits.
    Scaling,
    /// Removing copies of matte and metal spheres changes nothing.
    Copies,
    /// No pixel is brighter than the sky.
    Energy,
    /// Moving everything by a few lengths of the scene changes nothing.
    Translation,
}

impl Check {
    const ALL: [Check; 6] =
        [Check::Rounding, Check::Hierarchy, Check::Scaling, Check::Copies, Check::Energy, Check::Translation];

    /// Its name in messages and saved scenes.
    pub fn name(self) -> &'static str {
        match self {
            Check::Rounding => "f32 against f64",
            Check::Hierarchy => "list against hierarchy",
            Check::Scaling => "the scene times 4",
            Check::Translation => "the scene moved",
            Check::Copies => "copies removed",
            Check::Energy => "brighter than the sky",
        }
    }
}

/// Results of a scene, by backend index (`None`: the reference).
type Outcomes = HashMap<Option<usize>, Result<Traced, String>>;

/// Checks scenes on the backends, with the reference to compare them with.
pub struct Checker {
    backends: Vec<Backend>,
    reference: Backend,
    /// Results of the last scene, unchanged, since every check starts with them.
    last: Option<(Recipe, Outcomes)>,
}

impl Checker {
    /// A checker that has not seen a scene yet.
    pub fn new(backends: Vec<Backend>, reference: Backend) -> Self {
        Checker { backends, reference, last: None }
    }

    /// The first check that fails, and the reason.
    pub fn first_failure(&mut self, recipe: &Recipe, interrupt: &AtomicBool) -> Option<(Check, String)> {
        Check::ALL.into_iter().find_map(|check| Some((check, self.fails(check, recipe, interrupt)?)))
    }

    /// Why a check fails; `None` if it passes. A refused scene passes, because the user was told.
    pub fn fails(&mut self, check: Check, recipe: &Recipe, interrupt: &AtomicBool) -> Option<String> {
        let pair = Pair::of(check, recipe)?;
        for index in 0..self.backends.len() {
            let name = self.backends[index].name.clone();
            let reason = match self.on(index, &pair, interrupt) {
                Ok(()) => continue,
                Err(_) if interrupt.load(Ordering::Relaxed) => return None,
                Err(reason) => reason,
            };
            return Some(format!("{name}: {reason}"));
        }
        None
    }

    fn on(&mut self, index: usize, pair: &Pair, interrupt: &AtomicBool) -> Result<(), String> {
        let begin = Instant::now();
        let first_look = self.compare(index, pair, Against::Picture, interrupt);
        if first_look.is_ok() || pair.check == Check::Energy {
            return first_look;
        }
        let factor = more_samples(begin.elapsed().as_secs_f64());
        right_or_last(
            SEEDS.into_iter().map(|seed| {
                self.compare(index, &pair.second_look(factor, seed), Against::Estimate, interrupt)
            }),
        )
    }

    fn compare(
        &mut self,
        index: usize,
        pair: &Pair,
        against: fn(Paired) -> Against,
        interrupt: &AtomicBool,
    ) -> Result<(), String> {
        let one = self.traced(Some(index), &pair.one, interrupt)?;
        if !one.warnings.is_empty() {
            // The backend warned about what f32 cannot represent.
            return Ok(());
        }
        let film = one.film;
        let other = match (pair.check, &pair.other) {
            (Check::Rounding, _) => self.traced(None, &pair.one, interrupt)?,
            (_, Some(other)) => self.backends[index].trace(other, interrupt)?,
            (_, None) => return has_no_more_light(&pair.one, &film),
        };
        if pair.check != Check::Rounding && !other.warnings.is_empty() {
            return Ok(());
        }
        let against = against(Paired::of(&other.film, &film));
        let verdict = judge(&Level::of(&film), against, TOLERANCE, film.rejected() + other.film.rejected());
        if verdict.is_right() { Ok(()) } else { Err(verdict.reason().to_owned()) }
    }
}

/// How many times the samples a second look takes if the first one has taken so many seconds.
fn more_samples(seconds: f64) -> u64 {
    (SECOND_LOOK_TIME / seconds).clamp(4.0, SECOND_LOOK) as u64
}

/// The first look at which nothing is wrong, otherwise the last.
fn right_or_last(looks: impl Iterator<Item = Result<(), String>>) -> Result<(), String> {
    let mut last = Ok(());
    for look in looks {
        last = look;
        if last.is_ok() {
            break;
        }
    }
    last
}

/// The two pictures that a check compares.
struct Pair {
    check: Check,
    one: Recipe,
    /// Must give the same picture as `one`; `None` if `one` is compared with something else.
    other: Option<Recipe>,
}

impl Pair {
    /// `None` if there is nothing to check or a scene is refused.
    fn of(check: Check, recipe: &Recipe) -> Option<Self> {
        let [one, other] = match check {
            Check::Rounding | Check::Energy => {
                recipe.job().ok()?;
                return Some(Pair { check, one: recipe.clone(), other: None });
            }
            Check::Hierarchy => [recipe.clone(), with_far_spheres(recipe, extent(recipe))],
            Check::Scaling => [recipe.clone(), moved(recipe, 4.0, DVec3::ZERO)],
            Check::Translation => there_and_back(recipe)?,
            Check::Copies => [recipe.clone(), without_copies(recipe)?],
        };
        one.job().ok()?;
        other.job().ok()?;
        Some(Pair { check, one, other: Some(other) })
    }

    fn second_look(&self, factor: u64, seed: u32) -> Self {
        let more = |recipe: &Recipe| {
            let mut more = recipe.clone();
            more.samples_per_pixel *= factor;
            more.settings.seed = more.settings.seed.wrapping_add(seed);
            more
        };
        Pair { check: self.check, one: more(&self.one), other: self.other.as_ref().map(more) }
    }
}

impl Checker {
    /// The unchanged scene, traced once for all checks.
    fn traced(
        &mut self,
        backend: Option<usize>,
        recipe: &Recipe,
        interrupt: &AtomicBool,
    ) -> Result<Traced, String> {
        if self.last.as_ref().is_none_or(|(last, _)| last != recipe) {
            self.last = None;
        }
        let (_, known) = self.last.get_or_insert_with(|| (recipe.clone(), HashMap::new()));
        if let Some(traced) = known.get(&backend) {
            return traced.clone();
        }
        let tracer = match backend {
            Some(index) => &mut self.backends[index],
            None => &mut self.reference,
        };
        let traced = tracer.trace(recipe, interrupt);
        known.insert(backend, traced.clone());
        traced
    }
}

/// The scene moved away, and the same moved back, so that both have lost the same digits. `None` if only those digits
/// tell on which side of a surface the eye is.
fn there_and_back(recipe: &Recipe) -> Option<[Recipe; 2]> {
    // A power of two, so that coordinates keep their digits.
    let length = extent(recipe).log2().round().exp2();
    let way = length * DVec3::new(4.0, -8.0, 2.0);
    let there = moved(recipe, 1.0, way);
    let rounding = 32.0 * f64::EPSILON * way.abs().max_element();
    let eye = recipe.camera.look_from;
    let is_clear = |s: &Sphere| (s.center.distance(eye) - s.radius).abs() > rounding;
    recipe.scene.spheres.iter().all(is_clear).then(|| [moved(&there, 1.0, -way), there])
}

/// Distance within which most of the scene lies around the eye; much larger things do not count.
fn extent(recipe: &Recipe) -> f64 {
    recipe.camera.look_from.distance(recipe.camera.look_at)
}

fn without_copies(recipe: &Recipe) -> Option<Recipe> {
    let mut scene = Scene::clone(&recipe.scene);
    let all = recipe.scene.spheres.clone();
    let mut kept = Vec::new();
    for sphere in &all {
        if scene.material_of(sphere).is_transparent() || !kept.contains(sphere) {
            kept.push(*sphere);
        }
    }
    let is_less = kept.len() < all.len();
    scene.spheres = kept;
    is_less.then(|| Recipe { scene: Arc::new(scene), ..recipe.clone() })
}

fn has_no_more_light(recipe: &Recipe, film: &Film) -> Result<(), String> {
    let sky = recipe.scene.sky;
    let most = sky.bottom.max(sky.top).to_array();
    for pixel in 0..film.width() as usize * film.height() as usize {
        let mean = film.mean(pixel);
        if let Some(channel) = (0..3).find(|channel| mean[*channel] > most[*channel] * (1.0 + 1e-5)) {
            return Err(format!("pixel {pixel} is {}; the sky is at most {}", mean[channel], most[channel]));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
