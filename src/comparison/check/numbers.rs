//! The numbers of scene and camera: which one was typed wrong? Derivatives of the picture, with the same random numbers on
//! both sides, tell what each number would change; Gauss-Newton finds its value.

use super::fit::Compared;
use super::hypothesis::{Hypothesis, Number, Rendered, Studio, What};
use super::mistakes::bubble;
use super::screen::Screen;
use super::written::Seen;
use crate::scene::{Material, Scene, VFOV_LIMITS_DEGREES};
use anyhow::Result;
use glam::{DMat4, DVec3, DVec4};
use std::sync::Arc;

/// The smallest change that shows, the farthest from the start, and the limits of a number.
struct Reach {
    step: f64,
    most: f64,
    limits: [f64; 2],
}

impl What {
    /// All numbers of a hypothesis.
    pub fn all(of: &Hypothesis) -> Vec<What> {
        let (scene, camera) = (&of.recipe.scene, &of.recipe.camera);
        let mut all = vec![What::Target(0), What::Target(1), What::FieldOfView];
        all.extend((0..3).map(What::Eye));
        if camera.defocus_angle_degrees > 0.0 {
            all.extend([What::DefocusAngle, What::FocusDistance]);
        }
        for sphere in 0..scene.spheres.len() {
            all.extend((0..3).map(|axis| What::Center(sphere, axis)));
            all.push(What::Radius(sphere));
        }
        for (index, named) in scene.materials.iter().enumerate() {
            match named.material {
                Material::Lambertian { .. } => all.extend((0..3).map(|c| What::Albedo(index, c))),
                Material::Metal { .. } => {
                    all.extend((0..3).map(|c| What::Albedo(index, c)));
                    all.push(What::Fuzz(index));
                }
                Material::Dielectric { .. } => all.push(What::Index(index)),
            }
        }
        all.extend((0..2).flat_map(|end| (0..3).map(move |c| What::Sky(end, c))));
        all.extend((0..2).flat_map(|axis| [What::Scale(axis), What::Shift(axis)]));
        all
    }

    /// Reads the number, or changes it.
    fn access(self, of: &mut Hypothesis, value: Option<f64>) -> f64 {
        let camera = &mut of.recipe.camera;
        if let What::FocusDistance = self {
            if value.is_some() {
                camera.focus_distance = value;
            }
            return camera.effective_focus_distance();
        }
        let slot = match self {
            What::Eye(axis) => &mut camera.look_from[axis],
            What::Target(axis) => &mut camera.look_at[axis],
            What::FieldOfView => &mut camera.vfov_degrees,
            What::DefocusAngle => &mut camera.defocus_angle_degrees,
            What::Scale(axis) => &mut of.viewport.scale[axis],
            What::Shift(axis) => &mut of.viewport.shift[axis],
            _ => {
                let scene = Arc::make_mut(&mut of.recipe.scene);
                match self {
                    What::Center(sphere, axis) => &mut scene.spheres[sphere].center[axis],
                    What::Radius(sphere) => &mut scene.spheres[sphere].radius,
                    What::Sky(0, channel) => &mut scene.sky.bottom[channel],
                    What::Sky(_, channel) => &mut scene.sky.top[channel],
                    What::Albedo(material, channel) => match &mut scene.materials[material].material {
                        Material::Lambertian { albedo } | Material::Metal { albedo, .. } => {
                            &mut albedo[channel]
                        }
                        Material::Dielectric { refraction_index } => refraction_index,
                    },
                    What::Fuzz(material) | What::Index(material) => {
                        match &mut scene.materials[material].material {
                            Material::Metal { fuzz, .. } => fuzz,
                            Material::Dielectric { refraction_index } => refraction_index,
                            Material::Lambertian { albedo } => &mut albedo.x,
                        }
                    }
                    _ => return 0.0,
                }
            }
        };
        if let Some(value) = value {
            *slot = value;
        }
        *slot
    }

    pub fn of(self, hypothesis: &Hypothesis) -> f64 {
        self.access(&mut hypothesis.clone(), None)
    }

    fn reach(self, of: &Hypothesis) -> Reach {
        let is_big = |sphere: usize| of.recipe.scene.spheres[sphere].radius > 50.0;
        let (step, most, limits) = match self {
            What::Eye(_) | What::Target(_) => (0.02, 0.9, [-1e3, 1e3]),
            What::FieldOfView => (1.0, 60.0, [1.0, VFOV_LIMITS_DEGREES[1] - 1.0]),
            What::DefocusAngle => (0.5, 20.0, [0.0, 90.0]),
            What::FocusDistance => (0.05, 5.0, [0.05, 1e3]),
            What::Center(sphere, _) => (0.02, if is_big(sphere) { 5.0 } else { 1.0 }, [-2e3, 2e3]),
            What::Radius(sphere) if is_big(sphere) => (0.05, 5.0, [1.0, 2e3]),
            What::Radius(_) => (0.01, 0.6, [0.01, 50.0]),
            What::Albedo(..) => (0.04, 1.0, [0.0, 1.0]),
            What::Fuzz(_) => (0.05, 1.0, [0.0, 1.0]),
            What::Index(_) => (0.03, 1.5, [0.2, 4.0]),
            What::Sky(..) => (0.04, 1.0, [0.0, 2.0]),
            What::Scale(_) => (0.01, 2.0, [0.1, 5.0]),
            What::Shift(_) => (0.005, 0.6, [-1.0, 1.0]),
        };
        Reach { step, most, limits }
    }

    /// The number in the reader's words; `book` is the picture without it.
    pub fn words(self, value: f64, book: &Hypothesis) -> String {
        let scene = &book.recipe.scene;
        let home = self.of(book);
        let is = format!("{}, and in the book {}", plain(value), plain(home));
        let of_material = |index: usize| {
            let sphere = scene.spheres.iter().position(|sphere| sphere.material == index);
            sphere.map_or_else(|| scene.materials[index].name.clone(), |sphere| ball(scene, sphere))
        };
        let axis = |axis: usize| ["x", "y", "z"][axis];
        let colour = |channel: usize| ["red", "green", "blue"][channel];
        match self {
            What::Eye(a) => format!("the camera's {} is {is}", axis(a)),
            What::Target(a) => format!("the {} of the point that the camera looks at is {is}", axis(a)),
            What::FieldOfView => format!("the field of view is {is} degrees"),
            What::DefocusAngle => format!("the defocus angle is {is} degrees"),
            What::FocusDistance => format!("the focus distance is {is}"),
            What::Center(s, a) => format!("the {} of {} is {is}", axis(a), ball(scene, s)),
            What::Radius(s) => format!("the radius of {} is {is}", ball(scene, s)),
            What::Albedo(m, c) => format!("the {} of {} is {is}", colour(c), of_material(m)),
            What::Fuzz(m) => format!("the fuzz of {} is {is}", of_material(m)),
            What::Index(m) => format!("the refraction index of {} is {is}", of_material(m)),
            What::Sky(end, c) => {
                format!("the {} of the sky's {} colour is {is}", colour(c), ["lower", "upper"][end])
            }
            What::Scale(a) => {
                format!(
                    "the viewport is {} times as {} as it should be",
                    plain(value / home),
                    ["wide", "high"][a]
                )
            }
            What::Shift(a) => {
                let pixels = (home - value) * f64::from(book.size()[a]);
                let side = [["left", "right"], ["up", "down"]][a][usize::from(pixels > 0.0)];
                format!("the picture is moved {side} by {} pixels", plain(pixels.abs()))
            }
        }
    }

    /// Where the book has it: a section, and its code.
    pub fn place(self, book: &Hypothesis) -> (&'static str, String) {
        let (scene, camera, section) = (&book.recipe.scene, &book.recipe.camera, book.stage.section);
        let vector = |name: &str, v: DVec3| format!("{name}({}, {}, {})", plain(v.x), plain(v.y), plain(v.z));
        let is_movable = matches!(book.stage.chapter(), "12" | "13" | "14");
        let of_material = |index: usize| match scene.materials[index].material {
            Material::Lambertian { albedo } => format!("lambertian({})", vector("color", albedo)),
            Material::Metal { albedo, fuzz } => {
                format!("metal({}, {})", vector("color", albedo), plain(fuzz))
            }
            Material::Dielectric { refraction_index } => format!("dielectric({refraction_index:.2})"),
        };
        match self {
            What::Eye(_) if is_movable => {
                ("12.2", format!("lookfrom = {}", vector("point3", camera.look_from)))
            }
            What::Eye(_) => ("4.2", format!("camera_center = {}", vector("point3", camera.look_from))),
            What::Target(_) if is_movable => {
                ("12.2", format!("lookat = {}", vector("point3", camera.look_at)))
            }
            What::Target(_) => ("4.2", "camera_center - vec3(0, 0, focal_length)".to_owned()),
            What::FieldOfView if is_movable => ("12.1", format!("vfov = {}", plain(camera.vfov_degrees))),
            What::FieldOfView => ("4.2", "viewport_height = 2.0".to_owned()),
            What::DefocusAngle => {
                ("13.2", format!("defocus_angle = {}", plain(camera.defocus_angle_degrees)))
            }
            What::FocusDistance => {
                ("13.2", format!("focus_dist = {}", plain(camera.effective_focus_distance())))
            }
            What::Center(sphere, _) | What::Radius(sphere) => {
                let sphere = &scene.spheres[sphere];
                (section, format!("sphere({}, {})", vector("point3", sphere.center), plain(sphere.radius)))
            }
            What::Albedo(material, _) | What::Fuzz(material) | What::Index(material) => {
                (section, of_material(material))
            }
            What::Sky(0, _) => ("4.2", vector("color", scene.sky.bottom)),
            What::Sky(..) => ("4.2", vector("color", scene.sky.top)),
            What::Scale(0) => {
                ("4.2", "viewport_width = viewport_height * (double(image_width) / image_height)".to_owned())
            }
            What::Scale(_) => ("4.2", "pixel_delta_v = viewport_v / image_height".to_owned()),
            What::Shift(_) => (
                "4.2",
                "pixel00_loc = viewport_upper_left + 0.5 * (pixel_delta_u + pixel_delta_v)".to_owned(),
            ),
        }
    }

    fn number(self, value: f64, deviation: f64, book: &Hypothesis) -> Number {
        // As many digits as are known.
        let unit = 10.0_f64.powf((2.0 * deviation).max(1e-3).log10().floor());
        let value = (value / unit).round() * unit;
        let (section, code) = self.place(book);
        Number {
            what: self,
            value,
            deviation,
            right: self.of(book),
            words: self.words(value, book),
            section,
            code,
        }
    }

    /// The sphere that the number belongs to.
    pub fn sphere(self, scene: &Scene) -> Option<usize> {
        match self {
            What::Center(sphere, _) | What::Radius(sphere) => Some(sphere),
            What::Albedo(material, _) | What::Fuzz(material) | What::Index(material) => {
                scene.spheres.iter().position(|sphere| sphere.material == material)
            }
            _ => None,
        }
    }
}

/// A number as people write it.
fn plain(value: f64) -> String {
    let rounded = (value * 1000.0).round() / 1000.0;
    (rounded + 0.0).to_string()
}

/// How the reader calls a sphere.
fn ball(scene: &Scene, sphere: usize) -> String {
    let is_ground = |index: usize| scene.spheres[index].radius > 50.0;
    let name = scene.materials[scene.spheres[sphere].material].name.as_str();
    if is_ground(sphere) {
        return "the ground".to_owned();
    }
    if bubble(scene) == Some(sphere) {
        return "the air inside the glass".to_owned();
    }
    if (0..scene.spheres.len()).filter(|index| !is_ground(*index)).count() == 1 {
        return "the ball".to_owned();
    }
    format!("the {} ball", if name == "center" { "middle" } else { name })
}

/// One step of a linear fit.
struct Step {
    /// By how much each number moves, and one standard deviation of it.
    by: Vec<f64>,
    deviations: Vec<f64>,
    /// Share of the squared rest that the step explains.
    gain: f64,
}

impl Step {
    /// The step along these derivatives, of at most four numbers, that leaves least of `rest`. Two pictures with independent
    /// noise tell each derivative, so that its noise does not count as steepness, and the step is not too short.
    fn new(derivatives: &[[Vec<f64>; 2]], rest: &[f64], weights: &[f64]) -> Option<Step> {
        /// The least part of a derivative's square that counts as steepness.
        const LEAST: f64 = 0.1;
        let dot = |a: &[f64], b: &[f64]| {
            let products = a.iter().zip(b).zip(weights).map(|((a, b), weight)| weight * a * b);
            products.filter(|x| x.is_finite()).sum::<f64>()
        };
        let both = |[a, b]: &[Vec<f64>; 2], [c, d]: &[Vec<f64>; 2]| f64::midpoint(dot(a, d), dot(b, c));
        let scale = |it: &[Vec<f64>; 2]| {
            let whole = f64::midpoint(dot(&it[0], &it[0]), dot(&it[1], &it[1]));
            both(it, it).max(LEAST * whole).max(1e-300).sqrt()
        };
        let scales: Vec<f64> = derivatives.iter().map(scale).collect();
        let (mut matrix, mut right) = (DMat4::IDENTITY, DVec4::ZERO);
        for (i, a) in derivatives.iter().enumerate() {
            for (j, b) in derivatives.iter().enumerate().filter(|(j, _)| *j != i) {
                matrix.col_mut(i)[j] = both(a, b) / (scales[i] * scales[j]);
            }
            // A number that changes nothing stays.
            matrix.col_mut(i)[i] = 1.0 + 1e-6;
            right[i] = f64::midpoint(dot(&a[0], rest), dot(&a[1], rest)) / scales[i];
        }
        let inverse = matrix.inverse();
        let found = inverse * right;
        let each = || scales.iter().enumerate();
        found.is_finite().then(|| Step {
            by: each().map(|(i, scale)| found[i] / scale).collect(),
            deviations: each().map(|(i, scale)| inverse.col(i)[i].max(0.0).sqrt() / scale).collect(),
            gain: found.dot(right) / dot(rest, rest),
        })
    }
}

/// Numbers that are not those of the base, and the hypothesis that has them.
#[derive(Clone, Debug)]
pub struct Start {
    pub whats: Vec<What>,
    pub at: Hypothesis,
    /// What is left on the small picture.
    rest: f64,
}

impl Start {
    fn with(&self, values: &[f64]) -> Hypothesis {
        let mut changed = self.at.clone();
        for (what, value) in self.whats.iter().zip(values) {
            let Reach { limits: [low, high], .. } = what.reach(&self.at);
            what.access(&mut changed, Some(value.clamp(low, high)));
        }
        changed
    }

    fn values(&self) -> Vec<f64> {
        self.whats.iter().map(|what| what.of(&self.at)).collect()
    }

    /// The same hypothesis with one more number to be changed.
    fn and(&self, what: What) -> Start {
        let mut more = self.clone();
        more.whats.push(what);
        more
    }

    /// The hypothesis with its numbers in the reader's words.
    pub fn named(&self, base: &Hypothesis, deviations: Option<&[f64]>) -> Hypothesis {
        let mut named = self.at.clone();
        for (index, what) in self.whats.iter().enumerate() {
            let known = deviations.map(|all| all[index]);
            named.numbers.push(what.number(
                what.of(&self.at),
                known.unwrap_or_else(|| what.reach(base).step),
                base,
            ));
        }
        named
    }

    /// The pictures on both sides of each number, and their distance.
    fn sides(&self) -> Vec<([Hypothesis; 2], f64)> {
        let side = |what: &What| {
            let Reach { step, limits: [low, high], .. } = what.reach(&self.at);
            let value = what.of(&self.at);
            let ends = [value - step, value + step].map(|end| end.clamp(low, high));
            let alone = Start { whats: vec![*what], ..self.clone() };
            (ends.map(|end| alone.with(&[end])), ends[1] - ends[0])
        };
        self.whats.iter().map(side).collect()
    }
}

/// Shares of a number's reach at which it is tried.
const TRIED: [f64; 6] = [-1.0, -0.5, -0.2, 0.2, 0.5, 1.0];

/// Samples per pixel of the small pictures, and of those that are tried first.
const SAMPLES: u64 = 16;
const FEW: u64 = 8;

/// A number must leave less than this share of what is left.
const MOST: f64 = 0.7;

/// The search for numbers on a small picture.
impl Screen {
    /// Where the search begins.
    pub fn start(&mut self, studio: &mut Studio) -> Result<Start> {
        let at = self.base.clone();
        Ok(Start { rest: self.quality(studio, &at, SAMPLES)?, at, whats: Vec::new() })
    }

    /// The square of what is left, to which the noise of the small picture adds nothing.
    fn quality(&mut self, studio: &mut Studio, of: &Hypothesis, samples: u64) -> Result<f64> {
        let [a, b] = self.halves(studio, of, samples)?;
        Ok(a.iter().zip(&b).zip(self.weights(true)).map(|((a, b), weight)| weight * a * b).sum())
    }

    fn derivatives(&mut self, studio: &mut Studio, start: &Start) -> Result<Vec<[Vec<f64>; 2]>> {
        let mut all = Vec::new();
        for ([below, above], distance) in start.sides() {
            let [below, above] =
                [self.halves(studio, &below, SAMPLES)?, self.halves(studio, &above, SAMPLES)?];
            let of = |half: usize| {
                let pixels = below[half].iter().zip(&above[half]);
                pixels.map(|(below, above)| (below - above) / distance).collect()
            };
            all.push([of(0), of(1)]);
        }
        Ok(all)
    }

    /// Hypotheses with one number more, each solved on the small picture, the nearest first.
    pub fn one_more(&mut self, studio: &mut Studio, start: &Start) -> Result<Vec<Start>> {
        const SOLVED: usize = 8;
        const KEPT: usize = 3;
        let weights = self.weights(true);
        let rest = self.rest(studio, &start.at, SAMPLES)?;
        let known = self.derivatives(studio, start)?;
        let mut tried = Vec::new();
        for what in What::all(&start.at).into_iter().filter(|what| !start.whats.contains(what)) {
            let own = self.derivatives(studio, &Start { whats: vec![what], ..start.clone() })?;
            let all: Vec<_> = known.iter().chain(&own).cloned().collect();
            let gain = Step::new(&all, &rest, &weights).map_or(0.0, |step| step.gain);
            let mut best = (1.0 - gain, start.and(what));
            let alone = Start { whats: vec![what], ..start.clone() };
            for share in TRIED.into_iter().filter(|_| start.whats.is_empty()) {
                let at = alone.with(&[what.of(&start.at) + share * what.reach(&start.at).most]);
                let left = self.quality(studio, &at, FEW)? / start.rest;
                if left < best.0 && left < 0.9 {
                    best = (left, Start { at, ..alone.clone() });
                }
            }
            tried.push(best);
        }
        tried.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let mut found = Vec::new();
        let solved = if start.whats.is_empty() { SOLVED } else { SOLVED / 2 };
        for (_, more) in tried.into_iter().filter(|(left, _)| *left < 0.99).take(solved) {
            found.push(self.solved(studio, more, MOST * start.rest)?);
        }
        found.retain(|it| it.rest < MOST * start.rest);
        found.sort_by(|a, b| a.rest.total_cmp(&b.rest));
        found.truncate(KEPT);
        Ok(found)
    }

    /// Gauss-Newton: first with equal weights, as far away the noise says little, then, if less than `most` is left, with those
    /// of the noise.
    fn solved(&mut self, studio: &mut Studio, mut start: Start, most: f64) -> Result<Start> {
        const STEPS: usize = 6;
        let reaches: Vec<Reach> = start.whats.iter().map(|what| what.reach(&self.base)).collect();
        let home: Vec<f64> = start.whats.iter().map(|what| what.of(&self.base)).collect();
        for is_far in [true, false] {
            let weights = self.weights(is_far);
            let mut rest = self.rest(studio, &start.at, SAMPLES)?;
            for _ in 0..STEPS {
                let derivatives = self.derivatives(studio, &start)?;
                let Some(Step { by, .. }) = Step::new(&derivatives, &rest, &weights) else { break };
                let (before, here) = (square(&rest, &weights), start.values());
                let mut is_moved = false;
                for share in [1.0, 0.4, 0.15] {
                    let next: Vec<f64> = (0..by.len())
                        .map(|i| {
                            let most = reaches[i].most;
                            let step = (share * by[i]).clamp(-most / 2.0, most / 2.0);
                            (here[i] + step).clamp(home[i] - most, home[i] + most)
                        })
                        .collect();
                    let at = start.with(&next);
                    let there = self.rest(studio, &at, SAMPLES)?;
                    if square(&there, &weights) < 0.999 * before {
                        is_moved = (0..by.len()).any(|i| (next[i] - here[i]).abs() > reaches[i].step / 20.0);
                        (rest, start.at) = (there, at);
                        break;
                    }
                }
                if !is_moved {
                    break;
                }
            }
            start.rest = self.quality(studio, &start.at, SAMPLES)?;
            if start.rest > most {
                break;
            }
        }
        Ok(start)
    }
}

fn square(rest: &[f64], weights: &[f64]) -> f64 {
    rest.iter().zip(weights).map(|(rest, weight)| weight * rest * rest).sum()
}

impl Start {
    /// One step at the reader's size, from `here`, with pictures of few samples that `render` makes. Returns the deviations of
    /// the numbers, and whether the step was longer than these.
    pub fn step(
        &mut self,
        base: &Hypothesis,
        seen: &Seen,
        here: &Compared,
        render: &mut dyn FnMut(&Hypothesis) -> Result<Rendered>,
    ) -> Result<Option<(Vec<f64>, bool)>> {
        let fit = &here.fit;
        // Above it, all are white.
        let most = base.written.linear(255, 0, 1)[0];
        let (mut derivatives, mut variance) = (Vec::new(), fit.variance.clone());
        for ([below, above], distance) in self.sides() {
            let (below, above) = (render(&below)?, render(&above)?);
            // What one of them happens to lack has no noise there.
            for ((variance, step), errors) in
                variance.iter_mut().zip(&fit.steps).zip(below.error.iter().zip(&above.error))
            {
                (0..3).for_each(|c| variance[c] += f64::midpoint(errors.0[c], errors.1[c]) / step[c].powi(2));
            }
            let of = |half: usize| {
                let pixels = below.halves[half].iter().zip(&above.halves[half]).zip(&fit.steps);
                let derivative: Vec<[f64; 3]> = pixels
                    .map(|((below, above), step)| {
                        [0, 1, 2].map(|c| (above[c].min(most) - below[c].min(most)) / (distance * step[c]))
                    })
                    .collect();
                fit.in_blocks(seen, &derivative)
            };
            derivatives.push([of(0), of(1)]);
        }
        let weights: Vec<f64> = fit.in_blocks(seen, &variance).into_iter().map(f64::recip).collect();
        let Some(step) = Step::new(&derivatives, &fit.in_blocks(seen, &fit.left), &weights) else {
            return Ok(None);
        };
        let values = self.whats.iter().zip(self.values()).zip(&step.by).map(|((what, value), by)| {
            let most = what.reach(base).most / 5.0;
            value + by.clamp(-most, most)
        });
        self.at = self.with(&values.collect::<Vec<_>>());
        // Channels share their noise.
        let deviations: Vec<f64> = step.deviations.iter().map(|one| 3.0_f64.sqrt() * one).collect();
        let is_long = step.by.iter().zip(&deviations).any(|(by, one)| by.abs() > *one) && step.gain > 1e-3;
        Ok(Some((deviations, is_long)))
    }
}
