//! The numbers of scene and camera: which one was typed wrong? Derivatives of the picture, with the same random numbers on
//! both sides, tell what each number would change; Gauss-Newton finds its value.

use super::fit::Fit;
use super::hypothesis::{Hypothesis, Number, Rendered, What};
use super::mistakes::bubble;
use super::screen::Screen;
use super::written::Seen;
use crate::scene::{Material, Scene, VFOV_LIMITS_DEGREES};
use anyhow::{Context, Result};
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
        if all.iter().filter(|what| matches!(what, What::Index(_))).count() > 1 {
            all.push(What::Glass);
        }
        all.extend((0..2).flat_map(|end| (0..3).map(move |c| What::Sky(end, c))));
        all.extend((0..2).flat_map(|axis| [What::Scale(axis), What::Shift(axis)]));
        all
    }

    /// Groups of numbers that are typed together.
    fn groups(all: &[What]) -> Vec<Vec<What>> {
        let of = |is_in: &dyn Fn(&What) -> bool| {
            all.iter().copied().filter(|what| is_in(what)).collect::<Vec<_>>()
        };
        let mut groups: Vec<Vec<What>> = Vec::new();
        for what in all {
            groups.push(match *what {
                What::Albedo(material, 0) => of(&|it| matches!(it, What::Albedo(m, _) if *m == material)),
                What::Sky(end, 0) => of(&|it| matches!(it, What::Sky(e, _) if *e == end)),
                What::Center(sphere, 0) => of(&|it| matches!(it, What::Center(s, _) if *s == sphere)),
                What::Radius(sphere) => {
                    of(&|it| matches!(it, What::Center(s, _) | What::Radius(s) if *s == sphere))
                }
                What::Eye(0) => of(&|it| matches!(it, What::Eye(_))),
                What::Scale(0) => of(&|it| matches!(it, What::Scale(_) | What::Shift(_))),
                _ => continue,
            });
        }
        for (index, first) in all.iter().enumerate() {
            groups.extend(all[index + 1..].iter().map(|second| vec![*first, *second]));
        }
        groups
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
        if let What::Glass = self {
            let scene = Arc::make_mut(&mut of.recipe.scene);
            let indices = scene.materials.iter_mut().filter_map(|named| match &mut named.material {
                Material::Dielectric { refraction_index } => Some(refraction_index),
                _ => None,
            });
            let mut first = 1.5;
            for index in indices {
                let is_air = *index < 1.0;
                first = if is_air { index.recip() } else { *index };
                if let Some(value) = value {
                    *index = if is_air { value.recip() } else { value };
                }
            }
            return first;
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
            What::Eye(_) | What::Target(_) => (0.02, 1.0, [-1e3, 1e3]),
            What::FieldOfView => (1.0, 60.0, [1.0, VFOV_LIMITS_DEGREES[1] - 1.0]),
            What::DefocusAngle => (0.5, 20.0, [0.0, 90.0]),
            What::FocusDistance => (0.05, 5.0, [0.05, 1e3]),
            What::Center(sphere, _) => (0.02, if is_big(sphere) { 5.0 } else { 1.0 }, [-2e3, 2e3]),
            What::Radius(sphere) if is_big(sphere) => (0.05, 5.0, [1.0, 2e3]),
            What::Radius(_) => (0.01, 0.6, [0.01, 50.0]),
            What::Albedo(..) => (0.04, 1.0, [0.0, 1.0]),
            What::Fuzz(_) => (0.05, 1.0, [0.0, 1.0]),
            What::Index(_) | What::Glass => (0.03, 1.5, [0.2, 4.0]),
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
            What::Glass => format!("the refraction index of glass is {is}"),
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
            What::Glass => (section, "dielectric(1.50)".to_owned()),
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

/// The solution of `matrix * x = right` for at most four numbers; numbers that change nothing stay.
fn solved(matrix: &[Vec<f64>], right: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
    let count = right.len();
    let (mut all, mut vector) = (DMat4::IDENTITY, DVec4::ZERO);
    let scale: Vec<f64> = (0..count).map(|index| matrix[index][index].max(1e-300).sqrt()).collect();
    for i in 0..count {
        for j in 0..count {
            let ridge = if i == j { 1.0 + 1e-6 } else { 1.0 };
            all.col_mut(i)[j] = ridge * matrix[i][j] / (scale[i] * scale[j]);
        }
        vector[i] = right[i] / scale[i];
    }
    let inverse = all.inverse();
    let found = inverse * vector;
    let deviations = (0..count).map(|i| inverse.col(i)[i].max(0.0).sqrt() / scale[i]).collect();
    found.is_finite().then(|| ((0..count).map(|i| found[i] / scale[i]).collect(), deviations))
}

/// A hypothesis with these numbers, each within its limits.
fn with(base: &Hypothesis, whats: &[What], values: &[f64]) -> Hypothesis {
    let mut changed = base.clone();
    for (what, value) in whats.iter().zip(values) {
        let Reach { limits: [low, high], .. } = what.reach(base);
        what.access(&mut changed, Some(value.clamp(low, high)));
    }
    changed
}

/// The pictures on both sides of a number, and their distance.
fn sides(at: &Hypothesis, what: What) -> ([Hypothesis; 2], f64) {
    let Reach { step, limits: [low, high], .. } = what.reach(at);
    let value = what.of(at);
    let ends = [value - step, value + step].map(|end| end.clamp(low, high));
    (ends.map(|end| with(at, &[what], &[end])), ends[1] - ends[0])
}

/// Numbers, and the hypothesis that has them.
pub type Start = (Vec<What>, Hypothesis);

/// Numbers that may explain what is left of a base, each as a hypothesis, the likeliest first; those that are typed together
/// come after the single ones.
pub fn candidates(screen: &mut Screen) -> Result<[Vec<Start>; 2]> {
    /// A step of a number must explain at least this share of what is left.
    const LEAST: f64 = 0.01;
    const TRIED: [usize; 2] = [8, 8];
    const KEPT: usize = 3;
    /// A solution must leave less than this share of what is left.
    const MOST: f64 = 0.5;
    let base = screen.base.clone();
    let all = What::all(&base);
    let weights = screen.weights(true);
    let rest = screen.rest(&base, None)?;
    let near = screen.weights(false);
    let start: f64 = rest.iter().zip(&near).map(|(rest, weight)| weight * rest * rest).sum();
    let mut derivatives = Vec::new();
    for what in &all {
        derivatives.push(derivative(screen, &base, *what)?);
    }
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).zip(&weights).map(|((a, b), w)| w * a * b).sum::<f64>();
    let square = dot(&rest, &rest);
    let along: Vec<f64> = derivatives.iter().map(|derivative| dot(derivative, &rest)).collect();
    let matrix: Vec<Vec<f64>> =
        derivatives.iter().map(|a| derivatives.iter().map(|b| dot(a, b)).collect()).collect();
    // The share of what is left that one step explains.
    let gain = |group: &[What]| {
        let places: Vec<usize> =
            group.iter().filter_map(|what| all.iter().position(|it| it == what)).collect();
        if places.iter().any(|i| matrix[*i][*i] <= 0.0) {
            return 0.0;
        }
        let right: Vec<f64> = places.iter().map(|i| along[*i]).collect();
        let part: Vec<Vec<f64>> =
            places.iter().map(|i| places.iter().map(|j| matrix[*i][*j]).collect()).collect();
        let found = solved(&part, &right);
        found.map_or(0.0, |(step, _)| step.iter().zip(&right).map(|(a, b)| a * b).sum::<f64>() / square)
    };
    let singles: Vec<Vec<What>> = all.iter().map(|what| vec![*what]).collect();
    let mut found = [Vec::new(), Vec::new()];
    for (kind, groups) in [singles, What::groups(&all)].into_iter().enumerate() {
        let mut groups: Vec<(f64, Vec<What>)> =
            groups.into_iter().map(|group| (gain(&group), group)).filter(|(gain, _)| *gain > LEAST).collect();
        // Of a group, its parts must not explain as much.
        groups.retain(|(whole, group)| {
            group.len() == 1 || group.iter().all(|part| gain(&[*part]) < whole - 0.3 * (1.0 - whole).min(0.1))
        });
        groups.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        groups.truncate(TRIED[kind]);
        let mut solutions = Vec::new();
        for (_, group) in groups {
            if let Some((quality, solution)) =
                solve(screen, &base, &group)?.filter(|(it, _)| *it < MOST * start)
            {
                solutions.push((quality, group, solution));
            }
        }
        solutions.sort_by(|(a, ..), (b, ..)| a.total_cmp(b));
        found[kind] =
            solutions.into_iter().take(KEPT).map(|(_, group, solution)| (group, solution)).collect();
    }
    Ok(found)
}

fn derivative(screen: &mut Screen, at: &Hypothesis, what: What) -> Result<Vec<f64>> {
    let ([below, above], distance) = sides(at, what);
    let [below, above] = [screen.rest(&below, None)?, screen.rest(&above, None)?];
    Ok(below.iter().zip(&above).map(|(below, above)| (below - above) / distance).collect())
}

/// Gauss-Newton over a group of numbers on a small picture: first with equal weights, as far away the noise says little, then
/// with those of the noise. Returns what is left, and the hypothesis.
fn solve(screen: &mut Screen, base: &Hypothesis, group: &[What]) -> Result<Option<(f64, Hypothesis)>> {
    const STEPS: usize = 6;
    let home: Vec<f64> = group.iter().map(|what| what.of(base)).collect();
    let reaches: Vec<Reach> = group.iter().map(|what| what.reach(base)).collect();
    let (mut at, mut best) = (home.clone(), f64::INFINITY);
    for is_far in [true, false] {
        let weights = screen.weights(is_far);
        let quality = |rest: &[f64]| rest.iter().zip(&weights).map(|(rest, w)| w * rest * rest).sum::<f64>();
        let mut rest = screen.rest(&with(base, group, &at), None)?;
        best = quality(&rest);
        for _ in 0..STEPS {
            let here = with(base, group, &at);
            let mut derivatives = Vec::new();
            for what in group {
                derivatives.push(derivative(screen, &here, *what)?);
            }
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).zip(&weights).map(|((a, b), w)| w * a * b).sum();
            let matrix: Vec<Vec<f64>> =
                derivatives.iter().map(|a| derivatives.iter().map(|b| dot(a, b)).collect()).collect();
            let right: Vec<f64> = derivatives.iter().map(|a| dot(a, &rest)).collect();
            let Some((step, _)) = solved(&matrix, &right) else { break };
            let mut is_moved = false;
            for share in [1.0, 0.4, 0.15] {
                let next: Vec<f64> = (0..group.len())
                    .map(|i| {
                        let Reach { most, limits: [low, high], .. } = reaches[i];
                        let step = (share * step[i]).clamp(-most / 2.0, most / 2.0);
                        (at[i] + step).clamp(home[i] - most, home[i] + most).clamp(low, high)
                    })
                    .collect();
                let there = screen.rest(&with(base, group, &next), None)?;
                if quality(&there) < 0.999 * best {
                    is_moved = (0..group.len()).any(|i| (next[i] - at[i]).abs() > reaches[i].step / 20.0);
                    (best, rest, at) = (quality(&there), there, next);
                    break;
                }
            }
            if !is_moved {
                break;
            }
        }
    }
    Ok((at != home).then(|| (best, with(base, group, &at))))
}

/// The last steps, at the reader's size, with pictures that `render` makes: in full, or with few samples of the program's own
/// tracer. Returns the hypothesis with its numbers, its picture and how it fits.
pub fn finished(
    render: &mut dyn FnMut(&Hypothesis, bool) -> Result<Rendered>,
    seen: &Seen,
    base: &Hypothesis,
    group: &[What],
    start: Hypothesis,
) -> Result<(Hypothesis, Rendered, Fit)> {
    const STEPS: usize = 3;
    /// From such a score, no few steps lead to a picture that fits.
    const HOPELESS: f64 = 2000.0;
    let mut at = start;
    let mut best: Option<(Hypothesis, Rendered, Fit)> = None;
    for _ in 0..=STEPS {
        let rendered = render(&at, true)?;
        let fit = Fit::new(seen, &at.written, &rendered);
        // Below the limit, a score is no better than another.
        let is_better = best.as_ref().is_none_or(|(.., before)| fit.score < before.score || fit.is_enough());
        if fit.score > HOPELESS && best.is_none() {
            return Ok((at, rendered, fit));
        }
        let mut derivatives = Vec::new();
        for what in group {
            let ([below, above], distance) = sides(&at, *what);
            let (below, above) = (render(&below, false)?.mean(), render(&above, false)?.mean());
            let pixels = below.iter().zip(&above).zip(&fit.steps);
            let derivative: Vec<[f64; 3]> = pixels
                .map(|((below, above), step)| [0, 1, 2].map(|c| (above[c] - below[c]) / (distance * step[c])))
                .collect();
            derivatives.push(fit.in_blocks(seen, &derivative));
        }
        let rest = fit.in_blocks(seen, &fit.left);
        let noise = fit.in_blocks(seen, &fit.variance);
        let dot = |a: &[f64], b: &[f64]| {
            a.iter()
                .zip(b)
                .zip(&noise)
                .map(|((a, b), noise)| a * b / noise)
                .filter(|x| x.is_finite())
                .sum::<f64>()
        };
        let matrix: Vec<Vec<f64>> =
            derivatives.iter().map(|a| derivatives.iter().map(|b| dot(a, b)).collect()).collect();
        let right: Vec<f64> = derivatives.iter().map(|a| dot(a, &rest)).collect();
        let solution = solved(&matrix, &right);
        // Channels share their noise.
        let deviations = solution.as_ref().map(|(_, all)| all.iter().map(|one| 3.0_f64.sqrt() * one));
        let mut named = at.clone();
        for (what, deviation) in group.iter().zip(deviations.into_iter().flatten()) {
            named.numbers.push(what.number(what.of(&at), deviation, base));
        }
        if is_better {
            best = Some((named, rendered, fit));
        }
        let Some((step, deviations)) = solution.filter(|_| is_better) else { break };
        if step.iter().zip(&deviations).all(|(step, deviation)| step.abs() < 0.5 * deviation) {
            break;
        }
        let values: Vec<f64> = group
            .iter()
            .zip(step)
            .map(|(what, step)| {
                let most = what.reach(base).most / 5.0;
                what.of(&at) + step.clamp(-most, most)
            })
            .collect();
        at = with(&at, group, &values);
    }
    let (mut found, rendered, fit) = best.context("no picture was rendered")?;
    // People type round numbers.
    let round: Vec<f64> = group.iter().map(|what| (10.0 * what.of(&found)).round() / 10.0).collect();
    let is_close = |what: &What, round: f64| (what.of(&found) - round).abs() < 2.0 * what.reach(base).step;
    if !fit.is_enough() && group.iter().zip(&round).all(|(what, round)| is_close(what, *round)) {
        let at = with(&found, group, &round);
        let (rendered, fit) = {
            let rendered = render(&at, true)?;
            let fit = Fit::new(seen, &at.written, &rendered);
            (rendered, fit)
        };
        if fit.is_enough() {
            let deviations: Vec<f64> = found.numbers.iter().map(|number| number.deviation).collect();
            found = at;
            found.numbers =
                group.iter().zip(deviations).map(|(what, d)| what.number(what.of(&found), d, base)).collect();
            return Ok((found, rendered, fit));
        }
    }
    Ok((found, rendered, fit))
}
