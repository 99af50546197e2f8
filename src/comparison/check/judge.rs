//! Finds the stage that a picture shows, and decides whether it is right or which mistake explains it.

use super::Mine;
use super::hypothesis::{Compared, Hypothesis, Mistake, Rendered, Rest, Slope, Studio, compare, rough};
use super::mask::{enlarged, grown};
use super::mistakes::applying_to;
use super::noise::{Grain, grain, is_shared};
use super::random::{common, complete, fixed};
use super::written::{Seen, Written};
use crate::job::recipe::Recipe;
use crate::stages::{Stage, SurfaceRule};
use anyhow::{Context, Result};
use std::cmp::Ordering;
use std::sync::Arc;

/// Samples per pixel of the right picture, and of the other candidates.
const FINE: [u64; 2] = [256, 128];

/// Samples per pixel of the first, small pictures, and their width.
const SMALL: u64 = 64;
const SMALL_WIDTH: u32 = 80;

/// Samples per pixel when the stage is unknown.
const TINY: u64 = 16;

/// Mistakes rendered in full size.
const REFINED: usize = 6;

/// A mistake that leaves more than this share of the squared error is not rendered in full size.
const HOPELESS: f64 = 0.7;

/// Nor is one that leaves more than this many times the squared error of the best one, and more than [`NEARLY`].
const FAR: f64 = 10.0;

/// A mistake is offered as a guess if it leaves less than this share of the right picture's squared error.
const EXPLAINED: f64 = 0.3;

/// A hypothesis is rejected if another one leads this far from it towards the reader's picture, significantly.
const LEADS: Slope = Slope { at: 0.4, deviations: 5.0 };

/// As above, for one that leads nearly all the way.
const LEADS_FAR: Slope = Slope { at: 0.6, deviations: 4.0 };

/// As above, to render a mistake in full size.
const LEADS_ROUGHLY: Slope = Slope { at: 0.15, deviations: 3.0 };

/// As above, between pictures that differ only in their encoding, because rounding leads halfway.
const LEADS_IN_BYTES: f64 = 0.6;

/// As above, for shifts (pixels) and for blur (pixels squared).
const SHIFTED: f64 = 0.2;
const BLURRED: f64 = 0.15;

/// Misfits below this are equal; display values squared.
const ALIKE: f64 = 5e-6;

/// Largest misfit at which a changed picture can be recognised; display values squared.
const NEARLY: f64 = 3e-4;

/// Minimum samples per pixel to distinguish a fault from noise.
const SAMPLES_LEAST: f64 = 8.0;

/// Stages judged when the stage is unknown.
const CANDIDATES: usize = 4;

/// Root mean square difference below which a stage counts as recognised, display values.
const FOUND: f64 = 0.03;

/// Stages whose difference exceeds the least one by more than this are not judged.
const NEAR: f64 = 0.02;

/// Least difference between a pixel's neighbours at an edge, linear radiance. Noise stays below it.
const EDGE: f64 = 0.05;

/// Difference between small pictures where a mistake changes something, linear radiance.
const CHANGED: f64 = 0.0015;

#[derive(Clone, Debug)]
pub struct Finding {
    pub stage: &'static Stage,
    pub right: Compared,
    /// The mistake, or the accepted variant; `None` if the picture equals ours, or nothing explains it.
    pub mistake: Option<Compared>,
    /// Whether the right picture, or the one with the mistake, leaves only noise.
    pub is_sure: bool,
    /// Other mistakes that explain the picture as well.
    pub alike: Vec<&'static Mistake>,
    pub grain: Option<Grain>,
    /// Pixels that were not compared, because they depend on where small spheres are placed.
    pub ignored: Option<Arc<[bool]>>,
}

impl Finding {
    /// Whether the picture differs from the book's only by noise.
    pub fn is_right(&self) -> bool {
        self.mistake.is_none() && self.is_sure
    }

    pub fn named(&self) -> Option<&'static Mistake> {
        self.mistake.as_ref()?.hypothesis.mistake
    }

    /// Whether the picture is right for its section, though it differs from ours.
    pub fn is_other_right(&self) -> bool {
        self.is_sure && self.named().is_some_and(|mistake| mistake.is_right)
    }

    /// Adds mistakes that explain the picture as well.
    fn add_alike(&mut self, others: impl IntoIterator<Item = &'static Mistake>) {
        for other in others {
            let known = self.named().into_iter().chain(self.alike.iter().copied());
            if known.into_iter().all(|known| known.id != other.id) {
                self.alike.push(other);
            }
        }
    }

    /// Whether the reader's noise is too strong for a verdict, or something has changed the picture.
    pub fn is_too_little(&self) -> bool {
        let grain = |grain: &Grain| grain.altered.is_some() || grain.samples < SAMPLES_LEAST;
        !self.is_sure && self.grain.as_ref().is_some_and(grain)
    }

    /// Ranks findings of different stages: lower is closer.
    fn rank(&self) -> (u8, f64) {
        let misfit = self.mistake.as_ref().unwrap_or(&self.right).misfit;
        match self.is_sure {
            true if self.mistake.is_none() => (0, misfit),
            true if self.is_other_right() => (1, misfit),
            // A mistake must leave clearly less than what is right elsewhere.
            true => (1, alike_below(misfit)),
            false => (2, misfit),
        }
    }

    fn closeness(&self, other: &Finding) -> Ordering {
        let [(class, misfit), (their_class, their_misfit)] = [self.rank(), other.rank()];
        class.cmp(&their_class).then(misfit.total_cmp(&their_misfit))
    }
}

/// Pictures with misfits below this may be the same as one of this misfit.
fn alike_below(misfit: f64) -> f64 {
    3.0 * misfit.max(0.0) + ALIKE
}

/// Judges a picture, of `stage` if that is known. Reports each attempt to `say`.
pub fn judge(mine: &Mine, stage: Option<&'static Stage>, mut say: impl FnMut(String)) -> Result<Finding> {
    if let Some(stage) = stage {
        return judge_of(mine, stage, &mut say);
    }
    let near = candidates(mine, false, &mut say)?;
    let found = judge_among(mine, &near, &mut say)?;
    let is_settled = |found: &Finding| {
        found.is_sure || found.is_too_little() || found.named().is_some_and(|named| named.id == SHARED)
    };
    if let Some(found) = found.as_ref().filter(|found| is_settled(found)) {
        return Ok(found.clone());
    }
    for stage in Stage::ALL.iter().filter(|stage| stage.setup.has_random_spheres) {
        let last = judge_of(mine, stage, &mut say)?;
        if last.is_sure {
            return Ok(last);
        }
    }
    let mut more = candidates(mine, true, &mut say)?;
    more.retain(|stage| !near.contains(stage));
    let found = found.into_iter().chain(judge_among(mine, &more, &mut say)?);
    found.min_by(Finding::closeness).context("there is no stage to compare with")
}

/// Judges a picture of this stage.
fn judge_of(mine: &Mine, stage: &'static Stage, say: &mut impl FnMut(String)) -> Result<Finding> {
    if stage.setup.has_random_spheres {
        say(format!("looking for what all pictures of {} {} have in common", stage.section, stage.title));
    }
    let fixed = fixed(mine, stage)?;
    let mut found = judge_among(&fixed, &[stage], say)?.context("there is no stage to compare with")?;
    found.ignored.clone_from(&fixed.ignored);
    complete(&mut found.right, found.ignored.as_deref(), stage)?;
    Ok(found)
}

/// The closest finding among these stages.
fn judge_among(
    mine: &Mine,
    stages: &[&'static Stage],
    say: &mut impl FnMut(String),
) -> Result<Option<Finding>> {
    let (mut trials, mut findings) = (Vec::new(), Vec::new());
    for stage in stages {
        say(format!("comparing with {} {}", stage.section, stage.title));
        let trial = Trial::new(mine, stage)?;
        if !trial.right.is_noise {
            trials.push(trial);
            continue;
        }
        let finding = trial.finding()?;
        if finding.is_right() {
            return Ok(Some(finding));
        }
        findings.push(finding);
    }
    for trial in trials {
        if findings.iter().any(Finding::is_other_right) {
            break;
        }
        say(format!("trying the mistakes of {} {}", trial.stage.section, trial.stage.title));
        findings.push(trial.finding()?);
    }
    findings.sort_by(Finding::closeness);
    let mut findings = findings.into_iter();
    let Some(mut best) = findings.next() else { return Ok(None) };
    if let Some(found) = best.mistake.as_ref().filter(|_| best.is_sure && !best.is_other_right()) {
        let limit = alike_below(found.misfit);
        for other in findings {
            // The reader may have meant another stage, whose right picture this is.
            best.is_sure &= other.right.misfit >= limit;
            let is_as_close = other.mistake.as_ref().is_some_and(|found| found.misfit < limit);
            best.add_alike(other.named().filter(|_| other.is_sure && is_as_close));
        }
    }
    Ok(Some(best))
}

/// A picture compared with the right one of a stage.
struct Trial<'a> {
    mine: &'a Mine,
    stage: &'static Stage,
    studio: Studio,
    seen: Seen,
    right: Compared,
}

/// A hypothesis that may explain the picture, and the picture decoded accordingly.
struct Candidate {
    found: Compared,
    seen: Seen,
}

impl<'a> Trial<'a> {
    fn new(mine: &'a Mine, stage: &'static Stage) -> Result<Self> {
        let mut studio = Studio::new(common(stage), [mine.width, mine.height])?;
        let hypothesis = Hypothesis::right(studio.recipe());
        let rendered = studio.halves(&hypothesis, 1, FINE[0], None)?;
        let seen = Seen::of(mine, &hypothesis.written, |_, _| 0.0);
        let right = compare(&seen, hypothesis, rendered);
        Ok(Trial { mine, stage, studio, seen, right })
    }

    fn seen(&self, written: &Written) -> Seen {
        if *written == self.right.hypothesis.written {
            return self.seen.clone();
        }
        Seen::of(self.mine, written, |pixel, channel| self.right.expected[pixel][channel])
    }

    /// The best of the right picture and the mistakes.
    fn finding(mut self) -> Result<Finding> {
        let mut candidates = vec![Candidate { found: self.right.clone(), seen: self.seen.clone() }];
        for (hypothesis, mut mask) in self.screened()? {
            if let Some(ignored) = &self.mine.ignored {
                let mask = mask.get_or_insert_with(|| vec![true; ignored.len()]);
                mask.iter_mut()
                    .zip(ignored.iter())
                    .for_each(|(is_traced, is_ignored)| *is_traced &= !is_ignored);
            }
            // The plain tracer is slow: it takes fewer samples of more pixels.
            let samples = if hypothesis.steps.is_some() && mask.is_none() { FINE[1] / 2 } else { FINE[1] };
            let rendered = match hypothesis.is_right_before_writing(self.studio.recipe()) {
                true => self.right.rendered.clone(),
                false => self.studio.halves(&hypothesis, 1, samples, mask.as_deref())?,
            };
            let halves = [0, 1].map(|half| self.filled(&rendered.halves[half], half));
            let rendered = Rendered { halves, ..rendered };
            let seen = self.seen(&hypothesis.written);
            let found = compare(&seen, hypothesis, rendered);
            // Nothing was fitted: it is the right picture.
            if found.hypothesis.fit.is_none() || found.hypothesis.note.is_some() {
                candidates.push(Candidate { found, seen });
            }
        }
        candidates.sort_by(|a, b| a.found.misfit.total_cmp(&b.found.misfit));
        let mistake_of = |candidate: &Candidate| candidate.found.hypothesis.mistake;
        let fitting: Vec<&Candidate> = (0..candidates.len())
            .filter(|index| fits(&candidates, *index, self.studio.recipe()))
            .map(|index| &candidates[index])
            .collect();
        let limit = fitting.first().map_or(f64::INFINITY, |best| alike_below(best.found.misfit));
        let right = fitting.iter().find(|candidate| mistake_of(candidate).is_none());
        let other_right = || {
            let is_right = |candidate: &&&Candidate| mistake_of(candidate).is_some_and(|it| it.is_right);
            fitting.iter().filter(|candidate| candidate.found.misfit < limit).find(is_right)
        };
        let chosen = right.or_else(other_right).or(fitting.first()).copied();
        let nearest = chosen.unwrap_or(&candidates[0]);
        let is_near = nearest.found.misfit < NEARLY;
        let mut finding = Finding {
            stage: self.stage,
            right: self.right.clone(),
            mistake: None,
            is_sure: true,
            alike: Vec::new(),
            // If the stage does not fit, the noise tells nothing. Where a part of the picture is ignored, most of the rest is
            // sky, which has no noise.
            grain: grain(self.mine, &nearest.seen, &nearest.found)
                .map(|grain| Grain { altered: grain.altered.filter(|_| is_near), ..grain })
                .filter(|grain| is_near || grain.samples >= SAMPLES_LEAST)
                .filter(|_| self.mine.ignored.is_none()),
            ignored: None,
        };
        let is_altered = finding.grain.is_some_and(|grain| grain.altered.is_some());
        if let Some(chosen) = chosen.filter(|_| !is_altered) {
            finding.mistake = mistake_of(chosen).map(|_| chosen.found.clone());
            if finding.mistake.is_some() && !finding.is_other_right() {
                let limit = alike_below(chosen.found.misfit);
                let alike = fitting.iter().filter(|other| other.found.misfit < limit);
                finding.add_alike(alike.filter_map(|other| mistake_of(other)));
            }
            return Ok(finding);
        }
        // Every generator gives another picture, so this one is never sure.
        finding.is_sure = false;
        let shared = applying_to(self.studio.recipe()).find(|mistake| mistake.id == SHARED);
        if let Some(shared) = shared.filter(|shared| is_shared(&self.seen, &self.right, shared)) {
            let mut found = self.right.clone();
            found.hypothesis.mistake = Some(shared);
            finding.mistake = Some(found);
            return Ok(finding);
        }
        let guess = candidates.iter().find(|candidate| candidate.found.hypothesis.mistake.is_some());
        let limit = EXPLAINED * self.right.misfit;
        finding.mistake = guess.map(|guess| guess.found.clone()).filter(|guess| guess.misfit < limit);
        Ok(finding)
    }

    /// Whether the file decodes to the same picture with this encoding.
    fn is_as_right(&self, written: &Written) -> bool {
        let seen = self.seen(written);
        let is_same = |(a, b): (&f64, &f64)| a == b || a.is_nan() && b.is_nan();
        let [a, b] = [&seen, &self.seen].map(|seen| seen.values.as_flattened());
        seen.size == self.seen.size && a.iter().zip(b).all(is_same)
    }

    /// A half of a picture, filled with the right one where the mask left it out.
    fn filled(&self, rendered: &[[f64; 3]], half: usize) -> Vec<[f64; 3]> {
        let right = &self.right.rendered.halves[half];
        let pixels = rendered.iter().zip(right);
        pixels.map(|(pixel, right)| if pixel[0].is_nan() { *right } else { *pixel }).collect()
    }

    /// The mistakes that may explain the picture, judged by small renders, each with a mask of the pixels that it changes.
    fn screened(&mut self) -> Result<Vec<(Hypothesis, Option<Vec<bool>>)>> {
        let recipe = self.studio.recipe().clone();
        let factor = factor(self.right.hypothesis.size(), recipe.rules.antialiasing);
        let [width, height] = self.right.hypothesis.size().map(|side| side as usize);
        let small_right = self.right.rendered.reduced(width, factor as usize);
        let plain_right = {
            let mut plain = self.right.hypothesis.clone();
            plain.plain();
            self.studio.halves(&plain, factor, SMALL, None)?
        };
        let small_seen = self.seen.reduced(factor);
        let (right, _, right_misfit) = rough(&small_seen, self.right.hypothesis.clone(), small_right.clone());
        let rest = Rest::new(&small_seen, &small_right);
        let mut fine: Vec<(Hypothesis, Option<Vec<bool>>)> = Vec::new();
        let mut ranked = Vec::new();
        let edges = edges(&self.right.expected, [width, height]);
        // Where everything is blurred, or cheap to trace, more than the edges are compared.
        let is_masked = recipe.rules.has_bounces() && recipe.camera.defocus_angle_degrees == 0.0;
        for hypothesis in all_mistakes(&recipe) {
            let is_only_scaled = hypothesis.is_right_before_writing(&recipe)
                && Written { levels: 256.0, rounds: false, ..hypothesis.written } == right.written;
            if is_only_scaled {
                fine.push((hypothesis, None));
                continue;
            }
            // The ignored pixels are those of a file in the right order.
            if self.mine.ignored.is_some() && hypothesis.written.order.exchanges_sides() {
                continue;
            }
            if hypothesis.is_fine {
                fine.push((hypothesis, is_masked.then(|| edges.clone())));
                continue;
            }
            let is_right = hypothesis.is_right_before_writing(&recipe);
            let rendered = match is_right {
                true => small_right.clone(),
                false => self.studio.halves(&hypothesis, factor, SMALL, None)?,
            };
            let is_alike = hypothesis.written == right.written;
            if is_right && !is_alike && self.is_as_right(&hypothesis.written) {
                continue;
            }
            let seen =
                if is_alike { small_seen.clone() } else { self.seen(&hypothesis.written).reduced(factor) };
            let base = if hypothesis.steps.is_some() { &plain_right } else { &small_right };
            let mask =
                (!is_right && recipe.rules.antialiasing && !hypothesis.written.order.exchanges_sides())
                    .then(|| changed(&rendered, base, [width, height], factor as usize, &edges));
            let (hypothesis, rendered, misfit) = rough(&seen, hypothesis, rendered);
            let is_plain = hypothesis.steps.is_some();
            let is_leading = is_alike && {
                let to = if is_plain { small_right.changed(&plain_right, &rendered) } else { rendered };
                rest.slopes(&to, false)[0].is_beyond(LEADS_ROUGHLY)
            };
            if misfit < HOPELESS * right_misfit || is_leading || (is_right && self.right.is_noise) {
                ranked.push((misfit, is_leading, hypothesis, mask));
            }
        }
        ranked.sort_by(|(a, ..), (b, ..)| a.total_cmp(b));
        let least = ranked.first().map_or(right_misfit, |(misfit, ..)| misfit.min(right_misfit));
        let is_far = |misfit: f64| misfit > FAR * least.max(0.0) + NEARLY;
        // Far from the right picture, slopes and edges do not matter.
        if is_far(right_misfit) {
            ranked.retain(|(misfit, ..)| !is_far(*misfit));
            fine.retain(|(hypothesis, _)| !hypothesis.is_fine);
        } else {
            ranked.retain(|(misfit, is_leading, ..)| *is_leading || !is_far(*misfit));
        }
        ranked.truncate(REFINED);
        let ranked = ranked.into_iter().map(|(.., hypothesis, mask)| (hypothesis, mask));
        Ok(ranked.chain(fine).collect())
    }
}

/// The mistake whose picture depends on the random numbers.
const SHARED: &str = "same-seed";

/// Whether a candidate leaves only noise, and nothing leads from it towards the reader's picture. `recipe` is that of the
/// right picture.
fn fits(candidates: &[Candidate], index: usize, recipe: &Recipe) -> bool {
    let Candidate { found, seen } = &candidates[index];
    if !found.is_noise {
        return false;
    }
    let own = &found.hypothesis;
    let rest = Rest::new(seen, &found.rendered);
    let leads = |to: &Rendered, at: f64| {
        let slope = rest.slopes(to, false)[0];
        slope.is_beyond(Slope { at, ..LEADS }) || slope.is_beyond(LEADS_FAR)
    };
    // A part of the picture may be shifted or blurred alone.
    let leads_somewhere = |to: &Rendered, at: f64| {
        let slopes = rest.slopes(to, true);
        slopes[0].is_beyond(Slope { at, ..LEADS })
            || slopes[1..].iter().any(|part| part.is_beyond(Slope { at: 1.5 * at, deviations: 6.0 }))
    };
    if own.recipe.rules.antialiasing {
        let width = seen.size[0] as usize;
        let sides = [[1, 0], [-1, 0], [0, 1], [0, -1]];
        let changed = |change: &dyn Fn(f64, Neighbour) -> f64| {
            found.rendered.map(|half| neighbours(half, width, change))
        };
        let moved = |by: [isize; 2]| changed(&|at, of| at + 0.5 * (of(by) - of(by.map(|x| -x))));
        let blurred =
            |sign: f64| changed(&|at, of| at + sign * sides.map(|side| of(side) - at).iter().sum::<f64>());
        if sides.into_iter().any(|side| leads_somewhere(&moved(side), SHIFTED))
            || [1.0, -1.0].into_iter().any(|sign| leads_somewhere(&blurred(sign), BLURRED))
        {
            return false;
        }
    }
    candidates.iter().enumerate().filter(|(other, _)| *other != index).all(|(_, other)| {
        let theirs = &other.found.hypothesis;
        if own.mistake.map(|mistake| mistake.id) == theirs.mistake.map(|mistake| mistake.id) {
            return true;
        }
        // A file that is written differently may contain another mistake, too.
        let is_besides = own.is_right_before_writing(recipe)
            && own.fit.is_none()
            && theirs.written == Written::right(recipe);
        let is_comparable = own.written.order == theirs.written.order
            && own.written.channels == theirs.written.channels
            && own.written.curve == theirs.written.curve;
        let to = match is_comparable {
            true => as_read(&other.found.rendered, &theirs.written, &own.written, seen.size),
            false if is_besides && own.written != theirs.written => other.found.rendered.clone(),
            false => return true,
        };
        let is_in_bytes = own.written != theirs.written
            && own.steps.is_none()
            && theirs.is_right_before_writing(&own.recipe);
        !leads(&to, if is_in_bytes { LEADS_IN_BYTES } else { LEADS.at })
    })
}

/// The linear values of a picture that was written with one encoding and is read with another of the same curve.
fn as_read(rendered: &Rendered, from: &Written, to: &Written, [width, height]: [u32; 2]) -> Rendered {
    if from == to {
        return rendered.clone();
    }
    let [added, taken] = [from, to].map(|written| if written.rounds { 0.5 } else { 0.0 });
    rendered.map(|half| {
        let pixels = half.iter().enumerate();
        let value = |row: usize, x: f64| {
            let byte = from.levels * from.curve.displayed(x.max(0.0), row, height as usize) + added - taken;
            to.curve.linear((byte / to.levels).max(0.0), row, height as usize)
        };
        pixels.map(|(index, pixel)| pixel.map(|x| value(index / width as usize, x))).collect()
    })
}

/// The value beside a pixel, at this offset.
type Neighbour<'a> = &'a dyn Fn([isize; 2]) -> f64;

/// Maps each value and its neighbours; the border is unchanged.
fn neighbours(pixels: &[[f64; 3]], width: usize, change: impl Fn(f64, Neighbour) -> f64) -> Vec<[f64; 3]> {
    let height = pixels.len() / width;
    let at = |index: usize| {
        let (x, y) = (index % width, index / width);
        if x == 0 || y == 0 || x + 1 == width || y + 1 == height {
            return pixels[index];
        }
        [0, 1, 2].map(|channel| {
            let of =
                |[dx, dy]: [isize; 2]| pixels[index.wrapping_add_signed(dy * width as isize + dx)][channel];
            change(pixels[index][channel], &of)
        })
    };
    (0..pixels.len()).map(at).collect()
}

/// The factor by which the first pictures are smaller: a common divisor of both sides, if a suitable one exists.
fn factor([width, height]: [u32; 2], antialiasing: bool) -> u32 {
    if !antialiasing {
        return 1;
    }
    let wanted = (width / SMALL_WIDTH).max(1);
    let divides = |factor: &u32| width.is_multiple_of(*factor) && height.is_multiple_of(*factor);
    (wanted.div_ceil(2)..=2 * wanted)
        .filter(divides)
        .min_by_key(|factor| factor.abs_diff(wanted))
        .unwrap_or(wanted)
}

/// Pixels at an edge.
fn edges(expected: &[[f64; 3]], [width, height]: [usize; 2]) -> Vec<bool> {
    let is_edge = |index: usize| {
        let (x, y) = (index % width, index / width);
        if x == 0 || y == 0 || x + 1 == width || y + 1 == height {
            return false;
        }
        // The Sobel operator.
        (0..3).any(|channel| {
            let step = |by: usize, along: usize| {
                let of = |at: usize| expected[at + by][channel] - expected[at - by][channel];
                (of(index - along) + 2.0 * of(index) + of(index + along)).abs() / 4.0
            };
            step(1, width).max(step(width, 1)) >= EDGE
        })
    };
    let edges: Vec<bool> = (0..expected.len()).map(is_edge).collect();
    // A pixel beside an edge changes, too.
    grown(&edges, [width, height])
}

/// Where the small picture of a mistake differs from the right one, and at edges, in full size.
fn changed(small: &Rendered, right: &Rendered, size: [usize; 2], factor: usize, edges: &[bool]) -> Vec<bool> {
    let (small, right) = (small.mean(), right.mean());
    let pixels = small.iter().zip(&right);
    let is_changed = |(a, b): (&[f64; 3], &[f64; 3])| a.iter().zip(b).any(|(a, b)| (a - b).abs() > CHANGED);
    let changed: Vec<bool> = pixels.map(is_changed).collect();
    let near = enlarged(&grown(&changed, size.map(|side| side / factor)), size, factor);
    near.iter().zip(edges).map(|(is_near, is_edge)| *is_near || *is_edge).collect()
}

fn all_mistakes(recipe: &Recipe) -> Vec<Hypothesis> {
    let is_compared = |mistake: &&Mistake| mistake.id != SHARED;
    applying_to(recipe).filter(is_compared).flat_map(|mistake| mistake.pictures(recipe)).collect()
}

/// The stages that the picture resembles most, rendered correctly or written wrongly, or, if `is_thorough`, with any
/// mistake.
fn candidates(mine: &Mine, is_thorough: bool, mut say: impl FnMut(String)) -> Result<Vec<&'static Stage>> {
    let factor = factor([mine.width, mine.height], true);
    let mut ranked = Vec::new();
    let factor = if is_thorough { 2 * factor } else { factor };
    let what = if is_thorough { "the mistakes of all stages" } else { "all stages" };
    say(format!("comparing with {what}"));
    let mut known: Vec<(Written, Seen)> = Vec::new();
    for stage in Stage::ALL.iter().filter(|stage| !stage.setup.has_random_spheres) {
        let mut studio = Studio::new(stage.recipe(), [mine.width, mine.height])?;
        let right = Hypothesis::right(studio.recipe());
        let recipe = &right.recipe.clone();
        // Without antialiasing, a small render has coarser edges than a reduced one.
        let is_exact = !recipe.rules.antialiasing;
        let mut rendered = |hypothesis: &Hypothesis| -> Result<Rendered> {
            if is_exact {
                let whole = studio.halves(hypothesis, 1, TINY, None)?;
                return Ok(whole.reduced(hypothesis.size()[0] as usize, factor as usize));
            }
            studio.halves(hypothesis, factor, TINY, None)
        };
        let linear = rendered(&right)?;
        let columns = (mine.width / factor).max(1) as usize;
        let mean = linear.mean();
        let expected = |pixel: usize, channel: usize| {
            let (x, y) = (pixel % mine.width as usize, pixel / mine.width as usize);
            let place = y / factor as usize * columns + (x / factor as usize).min(columns - 1);
            mean.get(place).map_or(1.0, |pixel| pixel[channel])
        };
        let is_tried = |picture: &Hypothesis| {
            let is_other_right = picture.mistake.is_some_and(|mistake| mistake.is_right);
            !picture.is_fine && (is_thorough || is_other_right || picture.is_right_before_writing(recipe))
        };
        let mistakes = all_mistakes(recipe).into_iter().filter(is_tried);
        let mut least = f64::INFINITY;
        for hypothesis in std::iter::once(right).chain(mistakes) {
            let written = hypothesis.written;
            let rendered = match hypothesis.is_right_before_writing(recipe) {
                true => linear.clone(),
                false => rendered(&hypothesis)?,
            };
            // What wrapped around is judged by the stage's picture.
            known.retain(|(known, _)| !known.wraps);
            let place = known.iter().position(|(known, _)| *known == written).unwrap_or_else(|| {
                known.push((written, Seen::of(mine, &written, expected).reduced(factor)));
                known.len() - 1
            });
            let seen = &known[place].1;
            let (_, _, misfit) = rough(seen, hypothesis, rendered);
            least = least.min(misfit);
        }
        ranked.push((least, stage));
    }
    // If stages have equal pictures, prefer the one with the closer width.
    let distance = |stage: &Stage| stage.setup.width.abs_diff(mine.width);
    ranked
        .sort_by(|(a, stage_a), (b, stage_b)| a.total_cmp(b).then(distance(stage_a).cmp(&distance(stage_b))));
    let difference = |(misfit, _): &(f64, _)| misfit.max(0.0).sqrt();
    if ranked.first().is_some_and(|nearest| difference(nearest) < FOUND) {
        let limit = 1.5 * difference(&ranked[0]) + NEAR;
        ranked.retain(|stage| difference(stage) < limit);
        let mut near: Vec<_> = ranked.into_iter().map(|(_, stage)| stage).take(CANDIDATES).collect();
        // What 9.3 shows as a fault is right in the sections before it.
        if near.iter().any(|stage| stage.setup.rules.surface == SurfaceRule::Acne) {
            let before = Stage::ALL.iter().filter(|stage| matches!(stage.section, "9.1" | "9.2"));
            let missing: Vec<_> = before.filter(|stage| !near.contains(stage)).collect();
            near.extend(missing);
        }
        return Ok(near);
    }
    // If no mistake of any stage looks like the picture, one stage is enough to say where it differs.
    Ok(ranked.into_iter().map(|(_, stage)| stage).take(usize::from(is_thorough)).collect())
}
