//! Finds the section, the edition and the writing that a picture shows, and decides whether it is right, or which mistake or
//! number explains it.

use super::Mine;
use super::fit::{Compared, Fit};
use super::hypothesis::{Added, Hypothesis, Mistake, Rendered, Studio};
use super::mask::{enlarged, grown};
use super::mistakes::applying_to;
use super::noise::{altered, is_shared};
use super::numbers::Start;
use super::random::{common, complete, fixed};
use super::screen::{Screen, small};
use super::written::{Seen, Written, reduced};
use crate::stages::Stage;
use anyhow::{Context, Result, ensure};
use std::collections::HashSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Samples per pixel of a picture in full size, by the program's own tracer and by the plain one: in the first look, in the
/// second, and in the third, at what the plain tracer renders and is nearly enough.
const LOOKS: [[u64; 2]; 3] = [[32, 16], [256, 64], [256, 256]];

/// After the second look, what scores more than this is not enough; after the first one, what scores more than this is far
/// off, and what scores more than this no number brings near.
const NOT_ENOUGH: f64 = 30.0;
const FAR_OFF: f64 = 60.0;
const HOPELESS: f64 = 500.0;

/// Width of the small pictures, pixels, and their samples per pixel by each tracer.
const SMALL_WIDTH: u32 = 40;
const SMALL: [u64; 2] = [64, 16];

/// Width of the pictures that tell which pixels depend on something.
const MASK_WIDTH: u32 = 80;

/// Bases on which numbers are tried, and how many of them may be wrong at once.
const NUMBERED: usize = 2;
const NUMBERS: usize = 3;

/// Right pictures that are compared in full size, mistakes that are tried on better small pictures, and of these in full size:
/// if the best may be enough, and if it may only be a guess.
const COMPARED: [usize; 4] = [6, 20, 7, 2];

/// Samples per pixel of a mistake on a small picture: of each, and of those that are near.
const SCREENED: [u64; 2] = [8, 64];

/// Mean square of the blocks' means, in bytes, below which a mistake may only show in single pixels; and what a small picture
/// of the right hypothesis may leave.
const FINE_MOST: f64 = 4.0;
const ENOUGH_MOST: f64 = 3.0 * FINE_MOST;

/// Bases on which mistakes are tried.
const BASES: usize = 6;

/// Root mean square difference below which a base is near, displayed values, and how much farther another may be.
const FOUND: f64 = 0.03;
const NEAR: f64 = 0.02;

/// The most that a value counts, in squared displayed values.
const ROUGH_MOST: f64 = 0.01;

/// Mean square of the blocks' means, in bytes, above which nothing is explained; and above which no other levels of bytes
/// explain it, as they differ by a byte at most.
const FAR: f64 = 100.0;
const LEVELS: f64 = 2.0;

/// Share of differing blocks from which on a picture may be one of the random scene.
const RANDOM_LEAST: f64 = 0.5;

/// A guess must leave less than this share of what differs.
const EXPLAINED: f64 = 0.5;

#[derive(Clone, Debug)]
pub struct Finding {
    pub stage: &'static Stage,
    /// The right picture that is closest: of an edition, written in some way.
    pub right: Compared,
    /// What explains the picture, or most of it; `None` if it is right, or nothing does.
    pub found: Option<Compared>,
    /// Whether the right picture, or what was found, leaves only noise.
    pub is_sure: bool,
    /// Others that explain it as well.
    pub alike: Vec<Hypothesis>,
    /// What seems to have changed the file since it was written.
    pub altered: Option<&'static str>,
    /// Pixels that were not compared, because they depend on where small spheres are placed.
    pub ignored: Option<Arc<[bool]>>,
}

impl Finding {
    /// Whether the picture is right, perhaps for another edition.
    pub fn is_right(&self) -> bool {
        self.found.is_none() && self.is_sure
    }

    /// The mistake, or what the reader does otherwise and is right.
    pub fn named(&self) -> Option<&'static Mistake> {
        self.found.as_ref().unwrap_or(&self.right).hypothesis.named()
    }

    /// The reader's samples per pixel, if the noise tells.
    pub fn samples(&self) -> Option<f64> {
        self.found.as_ref().unwrap_or(&self.right).fit.samples
    }

    fn is_settled(&self) -> bool {
        self.is_sure || self.found.is_some()
    }
}

/// Judges a picture, of `stage` if that is known. Reports each attempt to `say`.
///
/// # Errors
/// If memory does not suffice, or after `stop` is set.
pub fn judge(
    mine: &Mine,
    stage: Option<&'static Stage>,
    stop: &AtomicBool,
    mut say: impl FnMut(String),
) -> Result<Finding> {
    let say: &mut dyn FnMut(String) = &mut say;
    if let Some(stage) = stage.filter(|stage| stage.setup.has_random_spheres) {
        return judge_random(mine, stage, stop, say, true);
    }
    let stages: Vec<&Stage> = match stage {
        Some(stage) => vec![stage],
        None => Stage::walk().filter(|stage| !stage.setup.has_random_spheres).collect(),
    };
    let mut search = Search { mine, studio: Studio::new(stop)?, known: Vec::new(), say };
    let (found, bases) = search.judged(&stages)?;
    if found.is_settled() {
        return Ok(found);
    }
    if stage.is_none() && found.right.fit.differing > RANDOM_LEAST {
        for stage in Stage::walk().filter(|stage| stage.setup.has_random_spheres) {
            let last = judge_random(mine, stage, stop, search.say, false)?;
            if last.is_sure {
                return Ok(last);
            }
        }
    }
    search.wrong(found.right, &bases)
}

/// Judges a picture of a stage whose small spheres each program places elsewhere; mistakes are only tried if `is_thorough`.
fn judge_random(
    mine: &Mine,
    stage: &'static Stage,
    stop: &AtomicBool,
    say: &mut dyn FnMut(String),
    is_thorough: bool,
) -> Result<Finding> {
    say(format!("looking for what all pictures of {} {} have in common", stage.section, stage.title));
    let mut studio = Studio::new(stop)?;
    let fixed = fixed(mine, stage, &mut studio, factor([mine.width, mine.height], MASK_WIDTH))?;
    let mut search = Search { mine: &fixed, studio, known: Vec::new(), say };
    let (mut found, bases) = search.judged(&[stage])?;
    if is_thorough && !found.is_settled() {
        found = search.wrong(found.right, &bases)?;
    }
    complete(&mut found.right, &fixed, &mut search.studio)?;
    found.ignored.clone_from(&fixed.ignored);
    Ok(found)
}

struct Search<'a> {
    mine: &'a Mine,
    studio: Studio<'a>,
    /// Right pictures in full size, each with its look.
    known: Vec<(Hypothesis, usize, Rendered)>,
    say: &'a mut dyn FnMut(String),
}

impl Search<'_> {
    /// Compares with the right pictures of these stages, and those that are only written otherwise. Returns the bases on which
    /// mistakes are tried if none of them explains the picture.
    fn judged(&mut self, stages: &[&'static Stage]) -> Result<(Finding, Vec<Hypothesis>)> {
        let ranked = self.ranked(stages)?;
        let distance = |misfit: f64| misfit.max(0.0).sqrt();
        let least = ranked.first().map_or(f64::INFINITY, |(misfit, _)| distance(*misfit));
        let is_near = least < FOUND;
        let limit = if is_near { 1.5 * least + NEAR } else { least };
        let near = || ranked.iter().filter(|(misfit, _)| distance(*misfit) <= limit).map(|(_, it)| it);
        let mut rights: Vec<(Compared, Hypothesis)> = Vec::new();
        for hypothesis in near().filter(|it| it.is_right()).take(COMPARED[0]) {
            let stage = hypothesis.stage;
            (self.say)(format!("comparing with {} {}", stage.section, stage.title));
            let found = self.compared(hypothesis)?;
            if found.fit.is_enough() {
                return Ok((self.finding(found, None, Vec::new()), Vec::new()));
            }
            rights.push((found, hypothesis.clone()));
        }
        // An edition must be nearer than the book.
        let key = |it: &Compared| it.fit.differing * if it.hypothesis.rows.is_empty() { 1.0 } else { 1.2 };
        rights.sort_by(|(a, _), (b, _)| key(a).total_cmp(&key(b)));
        // As they were ranked, since a mistake may look like other levels of bytes.
        let nearest: Vec<Hypothesis> = rights.iter().map(|(_, it)| it.clone()).collect();
        let right = match rights.into_iter().next() {
            Some((right, _)) => right,
            None => {
                let nearest = ranked.iter().find(|(_, it)| it.is_right());
                self.compared(&nearest.context("there is no stage to compare with")?.1)?
            }
        };
        let mut enough = Vec::new();
        let wrapped = variants(&right.hypothesis).filter(|it| it.written.wraps && self.has_wrapped(&right));
        let wrapped: Vec<_> = wrapped.collect();
        for hypothesis in near().filter(|it| !it.is_right()).take(COMPARED[0]).chain(&wrapped) {
            let found = self.compared(hypothesis)?;
            if found.fit.is_enough() {
                enough.push(found);
            }
        }
        if let Some(finding) = self.explained(&right, enough) {
            return Ok((finding, Vec::new()));
        }
        let bases = bases(&nearest, &ranked, is_near);
        let right = if is_near { right } else { self.compared(&bases[0])? };
        Ok((self.finding(right, None, Vec::new()), bases))
    }

    /// Whether the reader's picture is black where ours is white.
    fn has_wrapped(&self, right: &Compared) -> bool {
        let seen = self.seen(&right.hypothesis.written, None);
        let pixels = seen.values.iter().zip(&right.rendered.halves[0]);
        pixels.filter(|(seen, ours)| (0..3).any(|c| seen[c] < 0.01 && ours[c] > 0.9)).count() > 5
    }

    /// The finding if some of these explain the picture.
    fn explained(&self, right: &Compared, mut enough: Vec<Compared>) -> Option<Finding> {
        if enough.is_empty() {
            return None;
        }
        let first = enough.remove(0);
        let mut alike: Vec<Hypothesis> = Vec::new();
        for other in enough {
            if alike.iter().chain([&first.hypothesis]).all(|known| !is_same(known, &other.hypothesis)) {
                alike.push(other.hypothesis);
            }
        }
        Some(self.finding(right.clone(), Some(first), alike))
    }

    fn finding(&self, right: Compared, found: Option<Compared>, alike: Vec<Hypothesis>) -> Finding {
        let explains = found.as_ref().unwrap_or(&right);
        Finding {
            stage: explains.hypothesis.stage,
            is_sure: explains.fit.is_enough(),
            altered: altered(self.mine),
            right,
            found,
            alike,
            ignored: None,
        }
    }

    /// Tries mistakes and numbers on these bases, of which `right` is the first.
    fn wrong(&mut self, right: Compared, bases: &[Hypothesis]) -> Result<Finding> {
        let nearest = bases.iter().take_while(|base| base.stage.id == bases[0].stage.id).count();
        let (mut compared, mut searches) = (Vec::new(), Vec::new());
        let enough =
            |compared: &[Compared]| compared.iter().filter(|it| it.fit.is_enough()).cloned().collect();
        for bases in [&bases[..nearest], &bases[nearest..]] {
            let screens = self.mistakes(&right, bases, &mut compared)?;
            if let Some(finding) = self.explained(&right, enough(&compared)) {
                return Ok(finding);
            }
            // Others than the book must be nearer.
            let key = |(base, (nothing, _)): &(&Hypothesis, (f64, Screen))| {
                nothing * if base.rows.is_empty() { 1.0 } else { 1.5 }
            };
            let mut order: Vec<_> = bases.iter().zip(screens).collect();
            order.sort_by(|a, b| key(a).total_cmp(&key(b)));
            for (base, (_, mut screen)) in order.into_iter().take(NUMBERED) {
                let mut start = screen.start(&mut self.studio)?;
                self.numbers(base, &mut start, &mut screen, &mut compared)?;
                searches.push((base, start, screen));
            }
            if let Some(finding) = self.explained(&right, enough(&compared)) {
                return Ok(finding);
            }
        }
        for _ in 1..NUMBERS {
            for (base, best, screen) in searches.iter_mut().take(NUMBERED) {
                self.numbers(base, best, screen, &mut compared)?;
            }
            if let Some(finding) = self.explained(&right, enough(&compared)) {
                return Ok(finding);
            }
        }
        let mut finding = self.finding(right, None, Vec::new());
        let shared = applying_to(&finding.right.hypothesis.recipe).find(|mistake| mistake.id == SHARED);
        let shared = shared.and_then(|shared| shared.pictures(&finding.right.hypothesis).pop());
        let seen = self.seen(&finding.right.hypothesis.written, None);
        let wrong = compared.into_iter().filter(|it| !it.hypothesis.is_right());
        let nearest = wrong.min_by(|a, b| a.fit.excess.total_cmp(&b.fit.excess));
        let nearest = nearest.filter(|it| it.fit.excess < FAR.min(EXPLAINED * finding.right.fit.excess));
        let guess = nearest.or_else(|| {
            let hypothesis =
                shared.filter(|shared| is_shared(&seen, &finding.right, shared, self.studio.stop))?;
            Some(Compared { hypothesis, ..finding.right.clone() })
        });
        ensure!(!self.studio.stop.load(Ordering::Relaxed), "the check was stopped");
        if let Some(guess) = guess {
            (finding.stage, finding.found) = (guess.hypothesis.stage, Some(guess));
        }
        Ok(finding)
    }

    /// Tries the mistakes that can be made on the way to these bases. Returns what is left of each base on a small picture.
    fn mistakes(
        &mut self,
        right: &Compared,
        bases: &[Hypothesis],
        compared: &mut Vec<Compared>,
    ) -> Result<Vec<(f64, Screen)>> {
        let factor = factor(right.hypothesis.size(), SMALL_WIDTH);
        let (mut screens, mut screened, mut whole) = (Vec::new(), Vec::new(), Vec::new());
        for (rank, base) in bases.iter().enumerate() {
            let (stage, is_nearest) = (base.stage, base.stage.id == right.hypothesis.stage.id);
            (self.say)(format!("trying the mistakes of {} {}", stage.section, stage.title));
            let seen = self.seen(&base.written, None);
            let mut screen = Screen::new(&mut self.studio, base, &seen, factor, right.fit.samples)?;
            let nothing = screen.excess(&mut self.studio, base, SCREENED[1])?[0].max(0.0);
            for mistake in applying_to(&base.recipe).filter(|it| !it.is_right && it.id != SHARED) {
                for hypothesis in mistake.pictures(base) {
                    if hypothesis.added.is_some() || hypothesis.written.blackens || hypothesis.is_fine {
                        let is_possible = if hypothesis.is_fine {
                            rank == 0 && right.fit.excess < FINE_MOST
                        } else if hypothesis.written.blackens {
                            self.mine.has_zeros()
                        } else {
                            screen.brightened() < EXPLAINED * nothing + FINE_MOST
                        };
                        if is_nearest && is_possible {
                            whole.push(hypothesis);
                        }
                    } else if !hypothesis.is_traced_as(base) && !hypothesis.written.order.exchanges_sides() {
                        let excess = screen.excess(&mut self.studio, &hypothesis, SCREENED[0])?;
                        let is_alike = (excess[0] - nothing).abs() < 0.1 * nothing.max(0.1);
                        if !is_alike && lowest(excess) < EXPLAINED * nothing + 2.0 * FINE_MOST {
                            screened.push((excess, rank, hypothesis));
                        }
                    }
                }
            }
            screens.push((nothing, screen));
        }
        screened.sort_by(|(a, ..), (b, ..)| a[0].total_cmp(&b[0]));
        let least = screened.first().map_or(0.0, |(excess, ..)| excess[0].max(0.0));
        screened.retain(|(excess, ..)| lowest(*excess) < 3.0 * least + 4.0 * FINE_MOST);
        screened.truncate(COMPARED[1]);
        let mut near = Vec::new();
        for (_, rank, hypothesis) in screened {
            let (nothing, screen) = &mut screens[rank];
            let excess = screen.excess(&mut self.studio, &hypothesis, SCREENED[1])?;
            if lowest(excess) < EXPLAINED * *nothing + FINE_MOST {
                near.push((lowest(excess), hypothesis));
            }
        }
        // Of those that are as near, what differs less from the book comes first.
        let key = |(excess, it): &(f64, Hypothesis)| ((excess.max(0.0) / FINE_MOST) as u64, it.rows.len());
        near.sort_by(|a, b| key(a).cmp(&key(b)).then(a.0.total_cmp(&b.0)));
        let least = near.first().map_or(0.0, |(excess, _)| excess.max(0.0));
        near.retain(|(excess, _)| *excess < FAR.min(1.5 * least + ENOUGH_MOST));
        near.dedup_by(|(a, it), (b, other)| a == b && is_same(it, other));
        near.truncate(COMPARED[if least < ENOUGH_MOST { 2 } else { 3 }]);
        let mut limit = f64::INFINITY;
        for (excess, hypothesis) in near {
            if excess < limit {
                let tried = self.tried(&hypothesis)?;
                if tried.fit.is_enough() {
                    // What explains the picture as well is about as near.
                    limit = excess.max(0.0) + FINE_MOST;
                }
                compared.push(tried);
            }
        }
        for hypothesis in &whole {
            compared.push(self.tried(hypothesis)?);
        }
        Ok(screens)
    }

    fn tried(&mut self, hypothesis: &Hypothesis) -> Result<Compared> {
        let named = hypothesis.named().map_or("a mistake", |named| named.title);
        (self.say)(format!("comparing: {named}"));
        self.compared(hypothesis)
    }

    /// Tries one number more than `best` has.
    fn numbers(
        &mut self,
        base: &Hypothesis,
        best: &mut Start,
        screen: &mut Screen,
        compared: &mut Vec<Compared>,
    ) -> Result<()> {
        let stage = base.stage;
        (self.say)(format!("trying the numbers of {} {}", stage.section, stage.title));
        let seen = self.seen(&base.written, None);
        let more = screen.one_more(&mut self.studio, best)?;
        for (rank, start) in more.iter().enumerate() {
            // What leaves more is at most a guess, as the best may be.
            let limit = if rank == 0 { FAR } else { ENOUGH_MOST };
            if lowest(screen.excess(&mut self.studio, &start.at, SCREENED[1])?) < limit {
                compared.push(self.with_numbers(&seen, base, start)?);
            }
        }
        if let Some(next) = more.into_iter().next() {
            *best = next;
        }
        Ok(())
    }

    fn with_numbers(&mut self, seen: &Seen, base: &Hypothesis, start: &Start) -> Result<Compared> {
        /// Steps in full size.
        const STEPS: usize = 4;
        let words = start.whats.iter().map(|what| what.words(what.of(&start.at), base)).collect::<Vec<_>>();
        (self.say)(format!("comparing: {}", words.join(", ")));
        let (mut start, mut known) = (start.clone(), None);
        for _ in 0..STEPS {
            let here = self.compared_by(&start.at, 0)?;
            if here.fit.score > HOPELESS {
                return Ok(Compared { hypothesis: start.named(base, None), ..here });
            }
            let mut render = |of: &Hypothesis| self.studio.render(&of.fast(), 1, LOOKS[0][0], None);
            let Some((deviations, is_long)) = start.step(base, seen, &here, &mut render)? else { break };
            known = Some(deviations);
            if !is_long {
                break;
            }
        }
        self.compared(&start.named(base, known.as_deref()))
    }

    /// The reader's picture, written in this way; `expected` tells which zeros are whites that wrapped around.
    fn seen(&self, written: &Written, expected: Option<&[[f64; 3]]>) -> Seen {
        Seen::of(self.mine, written, |pixel, channel| expected.map_or(0.0, |pixels| pixels[pixel][channel]))
    }

    /// A hypothesis in full size, with the levels of bytes that fit best.
    fn compared(&mut self, hypothesis: &Hypothesis) -> Result<Compared> {
        let mut seen = self.compared_by(hypothesis, 0)?;
        if seen.fit.score < FAR_OFF {
            seen = self.compared_by(&seen.hypothesis, 1)?;
        }
        let is_nearly = !seen.fit.is_enough() && seen.fit.score < NOT_ENOUGH;
        if is_nearly && hypothesis.steps.is_some() { self.compared_by(&seen.hypothesis, 2) } else { Ok(seen) }
    }

    fn compared_by(&mut self, hypothesis: &Hypothesis, look: usize) -> Result<Compared> {
        let mut hypothesis = hypothesis.clone();
        let mut rendered = self.rendered(&hypothesis, look)?;
        let mean = hypothesis.written.wraps.then(|| rendered.mean());
        let fit = |hypothesis: &Hypothesis, rendered: &Rendered| {
            let mut seen = self.seen(&hypothesis.written, mean.as_deref());
            seen.tolerance = seen.tolerance.max(hypothesis.tolerance());
            Fit::new(&seen, &hypothesis.written, rendered)
        };
        if let Some(added) = hypothesis.added {
            let seen = self.seen(&hypothesis.written, None);
            (rendered, hypothesis.note) = with_added(&seen, &hypothesis.written, rendered, added);
        }
        let mut best = Compared { fit: fit(&hypothesis, &rendered), hypothesis, rendered };
        if best.fit.excess > LEVELS || best.hypothesis.written.wraps {
            return Ok(best);
        }
        // As in the book's first sections.
        let mut early = best.hypothesis.clone();
        early.written.levels = 255.999;
        let others: Vec<_> = variants(&best.hypothesis).filter(Hypothesis::is_right).collect();
        for other in [early].into_iter().chain(others) {
            let is_level = other.is_written_unlike(&best.hypothesis)
                && other.written.curve == best.hypothesis.written.curve;
            if is_level && !best.fit.is_enough() {
                let fit = fit(&other, &best.rendered);
                if fit.score < best.fit.score {
                    best = Compared { hypothesis: other, fit, ..best };
                }
            }
        }
        Ok(best)
    }

    fn rendered(&mut self, of: &Hypothesis, look: usize) -> Result<Rendered> {
        let is_same = |(known, known_look, _): &&(Hypothesis, usize, Rendered)| {
            *known_look == look && known.stage.id == of.stage.id && known.is_traced_as(of)
        };
        if let Some((.., rendered)) = self.known.iter().find(is_same) {
            return Ok(rendered.clone());
        }
        let rendered = self.traced(of, LOOKS[look])?;
        if of.is_right() {
            self.known.push((of.clone(), look, rendered.clone()));
        }
        Ok(rendered)
    }

    fn traced(&mut self, of: &Hypothesis, [own, plain]: [u64; 2]) -> Result<Rendered> {
        if of.steps.is_none() || of.is_exact() {
            return self.studio.render(of, 1, own, None);
        }
        let mut fast = of.fast();
        let whole = self.studio.render(&fast, 1, own, None)?;
        // The plain tracer is slow: it renders only what its steps change.
        let factor = factor(of.size(), MASK_WIDTH);
        fast.plain();
        let [with, without] =
            [of, &fast].map(|it| self.studio.render(it, factor, SMALL[1], None).map(|it| it.halves));
        let (with, without) = (with?, without?);
        let size = of.size().map(|side| side as usize);
        let is_changed = |pixel: usize| (0..2).any(|half| with[half][pixel] != without[half][pixel]);
        let changed: Vec<bool> = (0..with[0].len()).map(is_changed).collect();
        let small = size.map(|side| side / factor as usize);
        let mut mask = enlarged(&grown(&changed, small), size, factor as usize);
        if let Some(ignored) = &self.mine.ignored {
            mask.iter_mut().zip(ignored.iter()).for_each(|(is_traced, is_ignored)| *is_traced &= !is_ignored);
        }
        Ok(whole.under(&self.studio.render(of, 1, plain, Some(&mask))?))
    }

    /// Right pictures of these stages, and pictures that are only written otherwise, the most similar first.
    fn ranked(&mut self, stages: &[&'static Stage]) -> Result<Vec<(f64, Hypothesis)>> {
        (self.say)("comparing with all sections and editions".to_owned());
        let size = [self.mine.width, self.mine.height];
        let factor = factor(size, SMALL_WIDTH);
        let (mut ranked, mut known) = (Vec::new(), Vec::<(Written, Vec<[f64; 3]>)>::new());
        for stage in stages {
            let right = Hypothesis::right(stage, common(stage), size);
            let editions = variants(&right).filter(|it| it.is_right() && !it.is_traced_as(&right));
            for base in [right.clone()].into_iter().chain(editions) {
                let is_written_otherwise = |it: &Hypothesis| match it.written.order.exchanges_sides() {
                    true => size[0] != size[1] && base.rows.is_empty(),
                    false => it.is_written_unlike(&base) && it.written.levels == base.written.levels,
                };
                let others = variants(&base).filter(|it| is_written_otherwise(it) && !it.written.wraps);
                let samples = SMALL[usize::from(base.steps.is_some())];
                let as_base = small(&mut self.studio, &base, factor, samples)?;
                for hypothesis in [base.clone()].into_iter().chain(others) {
                    let written = hypothesis.written;
                    let rendered = match hypothesis.is_traced_as(&base) {
                        true => &as_base,
                        false => &small(&mut self.studio, &hypothesis, factor, samples)?,
                    };
                    let place = known.iter().position(|(known, _)| *known == written).unwrap_or_else(|| {
                        let seen = self.seen(&written, None);
                        known.push((written, reduced(&seen.values, seen.size[0] as usize, factor as usize)));
                        known.len() - 1
                    });
                    ranked.push((rough(&known[place].1, rendered, written.linear(255, 0, 1)[0]), hypothesis));
                }
            }
        }
        // If stages have equal pictures, prefer what differs less from the book, and then the closer width.
        let bin = |misfit: &f64| (misfit.max(0.0).sqrt() * 500.0) as u64;
        let key = |it: &Hypothesis| (it.rows.len(), it.stage.setup.width.abs_diff(size[0]));
        ranked.sort_by(|(a, it), (b, other)| bin(a).cmp(&bin(b)).then(key(it).cmp(&key(other))));
        // All have the same random numbers, so that pictures are equal if their misfits are.
        let mut known = HashSet::new();
        ranked.retain(|(misfit, _)| misfit.is_infinite() || known.insert(misfit.to_bits()));
        Ok(ranked)
    }
}

/// The least that what is left may be, for its deviation.
fn lowest([excess, deviation]: [f64; 2]) -> f64 {
    excess - 2.0 * deviation
}

/// The mistake whose picture depends on the random numbers.
const SHARED: &str = "same-seed";

/// Whether both say the same to the reader.
fn is_same(a: &Hypothesis, b: &Hypothesis) -> bool {
    let id = |it: &Hypothesis| it.named().map(|named| named.id);
    let numbers = |it: &Hypothesis| it.numbers.iter().map(|number| number.what).collect::<Vec<_>>();
    id(a) == id(b) && numbers(a) == numbers(b)
}

/// The right pictures on which mistakes are tried: of the nearest section the nearest one, the plainest that is written in the
/// same way, the book's, and, if that is the nearest but not near, an older edition's; of each further section one.
fn bases(nearest: &[Hypothesis], ranked: &[(f64, Hypothesis)], is_near: bool) -> Vec<Hypothesis> {
    let mut bases: Vec<Hypothesis> = Vec::new();
    let rights = || ranked.iter().filter(|(_, it)| it.is_right() && is_simple(it));
    for stage in nearest.iter().chain(rights().map(|(_, it)| it)).map(|it| it.stage.id) {
        if bases.len() >= BASES || bases.iter().any(|base| base.stage.id == stage) {
            continue;
        }
        let of_stage = || rights().filter(|(_, it)| it.stage.id == stage);
        let of_book = |it: &Hypothesis| it.rows.is_empty();
        let of_edition = |it: &Hypothesis| it.rows.iter().any(|row| row.id.starts_with("edition"));
        let any = |is: &dyn Fn(&Hypothesis) -> bool| of_stage().map(|(_, it)| it).find(|it| is(it));
        let own: Vec<&Hypothesis> = if bases.is_empty() {
            let all = || nearest.iter().chain(rights().map(|(_, it)| it));
            let first = all().find(|it| it.stage.id == stage && is_simple(it));
            let as_written = of_stage()
                .map(|(_, it)| it)
                .filter(|it| first.is_some_and(|first| first.written == it.written));
            let edition = any(&of_edition).filter(|_| !is_near && first.is_some_and(of_book));
            first
                .into_iter()
                .chain(as_written.min_by_key(|it| it.rows.len()))
                .chain(any(&of_book))
                .chain(edition)
                .collect()
        } else {
            // An edition must be nearer than the book.
            let key = |(misfit, it): &(f64, Hypothesis)| misfit * if it.rows.is_empty() { 1.0 } else { 1.5 };
            of_stage().min_by(|a, b| key(a).total_cmp(&key(b))).map(|(_, it)| it).into_iter().collect()
        };
        for it in own {
            let is_same =
                |other: &Hypothesis| other.is_traced_as(it) && other.written.curve == it.written.curve;
            if !bases.iter().any(is_same) {
                bases.push(it.clone());
            }
        }
    }
    bases
}

/// Whether a picture differs from the book's only by its edition and its bytes.
fn is_simple(it: &Hypothesis) -> bool {
    it.rows.iter().all(|row| {
        row.id.starts_with("edition") || matches!(row.section, "8.2" | "9.5") && row.id != "reflectance"
    })
}

/// All that can be done otherwise than in this picture.
fn variants(of: &Hypothesis) -> impl Iterator<Item = Hypothesis> {
    applying_to(&of.recipe).flat_map(|it| it.pictures(of))
}

/// Mean squared difference of small pictures in displayed values. The two halves of ours have independent noise, so that it adds
/// nothing.
fn rough(seen: &[[f64; 3]], rendered: &Rendered, most: f64) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    let [first, second] = rendered.halves.each_ref().map(|half| half.as_flattened());
    for ((value, first), second) in seen.as_flattened().iter().zip(first).zip(second) {
        let [first, second] = [first, second].map(|ours| ours.clamp(0.0, most));
        let roots = (value.max(0.02).sqrt() + f64::midpoint(first, second).max(0.02).sqrt()).powi(2);
        let square = (value - first) * (value - second) / roots;
        if square.is_finite() {
            // What differs in a part of the picture must not look like another curve of all of it.
            sum += square.min(ROUGH_MOST);
            count += 1.0;
        }
    }
    if 4.0 * count > seen.len() as f64 { sum / count } else { f64::INFINITY }
}

/// The picture with what fits best added, and a remark.
pub fn with_added(
    seen: &Seen,
    written: &Written,
    rendered: Rendered,
    added: Added,
) -> (Rendered, Option<String>) {
    const STEPS: usize = 5;
    let from = |index: usize| match added {
        Added::Gain => index,
        Added::Carry => index.saturating_sub(1),
    };
    let (right, mut times, mut at) = (rendered.mean(), 0.0, rendered.clone());
    for _ in 0..STEPS {
        let fit = Fit::new(seen, written, &at);
        let (mut product, mut square) = (0.0, 1e-9);
        for (index, left) in fit.left.iter().enumerate() {
            for channel in (0..3).filter(|channel| left[*channel].is_finite()) {
                // A value at the top of its range is only a lower bound.
                if seen.values[index][channel] < 0.98 {
                    let direction = right[from(index)][channel] / fit.steps[index][channel];
                    product += direction * left[channel] / fit.variance[index][channel];
                    square += direction * direction / fit.variance[index][channel];
                }
            }
        }
        let least = if added == Added::Gain { -0.99 } else { 0.0 };
        let before = times;
        times = (times + product / square).max(least);
        at = rendered.plus(times, from);
        if (times - before).abs() < 1e-4 {
            break;
        }
    }
    let note = match added {
        Added::Gain => {
            format!("your picture is {:.3} times as bright as ours, in linear values", 1.0 + times)
        }
        Added::Carry => format!("each pixel holds about 1/{:.0} of the one before", 1.0 / times),
    };
    (at, Some(note))
}

/// The factor by which the first pictures are smaller: a common divisor of both sides, if a suitable one exists.
fn factor([width, height]: [u32; 2], small: u32) -> u32 {
    let wanted = (width / small).max(1);
    let divides = |factor: &u32| width.is_multiple_of(*factor) && height.is_multiple_of(*factor);
    (wanted.div_ceil(2)..=2 * wanted)
        .filter(divides)
        .min_by_key(|factor| factor.abs_diff(wanted))
        .unwrap_or(wanted)
}
