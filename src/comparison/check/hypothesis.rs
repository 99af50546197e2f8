//! Hypotheses: the right picture of a section, of an older edition, or with a mistake or another number; and how they are
//! rendered.

use super::tracer::{Steps, Tracer};
use super::written::{Written, reduced};
use crate::job::recipe::Recipe;
use crate::job::render::{RenderSettings, Renderer, SamplerKind, Viewport};
use crate::render_cpu::{CpuOptions, CpuRenderer};
use crate::stages::Stage;
use anyhow::{Result, bail};
use serde::Serialize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// A common mistake in programs that follow the book, or another way to be right.
#[derive(Debug, Serialize)]
pub struct Mistake {
    pub id: &'static str,
    /// The section of the book to reread.
    pub section: &'static str,
    pub title: &'static str,
    pub remedy: &'static str,
    /// Whether it can show in a picture of this recipe.
    #[serde(skip)]
    pub applies: fn(&Recipe) -> bool,
    /// Whether it is another way to be right.
    pub is_right: bool,
    /// Each makes one variant of the mistake out of another picture.
    #[serde(skip)]
    pub changes: &'static [fn(&mut Hypothesis)],
}

impl Mistake {
    /// One hypothesis per variant, without those that change nothing.
    pub fn pictures(&'static self, base: &Hypothesis) -> Vec<Hypothesis> {
        let picture = |change: &fn(&mut Hypothesis)| {
            let mut picture = base.clone();
            change(&mut picture);
            picture.rows.push(self);
            (picture.written != base.written || picture.added.is_some() || !picture.is_traced_as(base))
                .then_some(picture)
        };
        self.changes.iter().filter_map(picture).collect()
    }
}

/// A number that explains the reader's picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Number {
    #[serde(skip)]
    pub what: What,
    pub value: f64,
    /// One standard deviation.
    pub deviation: f64,
    /// That of the book.
    pub right: f64,
    /// What the number is, in the reader's words.
    pub words: String,
    /// The section that has it, and the book's code there.
    pub section: &'static str,
    pub code: String,
}

/// Axes are 0, 1 and 2; spheres and materials are indices of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum What {
    Eye(usize),
    Target(usize),
    FieldOfView,
    DefocusAngle,
    FocusDistance,
    Center(usize, usize),
    Radius(usize),
    Albedo(usize, usize),
    Fuzz(usize),
    Index(usize),
    /// Of the bottom (0) or the top (1) of the sky.
    Sky(usize, usize),
    /// Width (0) or height (1) of the viewport, as a factor.
    Scale(usize),
    /// The viewport's place, in its widths (0) or heights (1).
    Shift(usize),
}

/// A candidate for the reader's picture: how its linear values are made, and how they become bytes.
#[derive(Clone, Debug)]
pub struct Hypothesis {
    pub stage: &'static Stage,
    /// What is done otherwise than in the book.
    pub rows: Vec<&'static Mistake>,
    /// Numbers of scene and camera that are others than in the book, in the order in which they were found.
    pub numbers: Vec<Number>,
    /// An extra remark for the reader.
    pub note: Option<String>,
    pub recipe: Recipe,
    pub viewport: Viewport,
    /// The steps of the plain tracer; if `None`, the program's own tracer renders the recipe.
    pub steps: Option<Steps>,
    /// Tells pictures of different steps apart.
    traced: usize,
    /// What is added to the picture, as often as fits the reader's.
    pub added: Option<Added>,
    /// Whether only single pixels show it.
    pub is_fine: bool,
    pub written: Written,
}

/// A picture that is added to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Added {
    /// The picture itself: a factor of brightness.
    Gain,
    /// The same, one pixel to the right, as if each pixel began with the mean of the one before.
    Carry,
}

impl Hypothesis {
    /// The right picture of a stage at this size.
    pub fn right(stage: &'static Stage, recipe: Recipe, [width, height]: [u32; 2]) -> Hypothesis {
        let settings = RenderSettings {
            sampler: SamplerKind::Independent,
            // The reader's picture may be one of ours with the default seed.
            seed: 0x6368_6563,
            width: width.max(1),
            height: height.max(1),
            ..recipe.settings
        };
        Hypothesis {
            stage,
            rows: Vec::new(),
            numbers: Vec::new(),
            note: None,
            written: Written::right(&recipe),
            recipe: Recipe { settings, ..recipe },
            viewport: Viewport::WHOLE,
            steps: None,
            traced: 0,
            added: None,
            is_fine: false,
        }
    }

    /// Switches to the plain tracer and returns its steps, to change one.
    pub fn plain(&mut self) -> &mut Steps {
        static LAST: AtomicUsize = AtomicUsize::new(0);
        self.traced = 1 + LAST.fetch_add(1, Ordering::Relaxed);
        self.steps.get_or_insert(Steps::OF_THE_BOOK)
    }

    /// The same without changed steps, for the program's own tracer.
    pub fn fast(&self) -> Hypothesis {
        Hypothesis { steps: None, ..self.clone() }
    }

    /// Whether it has the same linear picture.
    pub fn is_traced_as(&self, other: &Hypothesis) -> bool {
        self.traced == other.traced && self.recipe == other.recipe && self.viewport == other.viewport
    }

    /// Whether only its bytes may be others.
    pub fn is_written_unlike(&self, other: &Hypothesis) -> bool {
        self.is_traced_as(other) && self.added.is_none()
    }

    /// Whether nothing in it is wrong.
    pub fn is_right(&self) -> bool {
        self.numbers.is_empty() && self.rows.iter().all(|row| row.is_right)
    }

    /// The first row that is wrong, or else the first one.
    pub fn named(&self) -> Option<&'static Mistake> {
        self.rows.iter().find(|row| !row.is_right).or_else(|| self.rows.first()).copied()
    }

    pub fn size(&self) -> [u32; 2] {
        [self.recipe.settings.width, self.recipe.settings.height]
    }

    /// Bytes by which its picture may be off besides: how much of it is in shadow acne depends on the rounding of each
    /// program.
    pub fn tolerance(&self) -> f64 {
        if self.steps.is_some_and(|steps| steps.t_min == Some(0.0)) { 1.5 } else { 0.0 }
    }

    /// Whether every sample of a pixel is the same.
    pub fn is_exact(&self) -> bool {
        !self.recipe.rules.antialiasing && self.recipe.samples_per_pixel == 1
    }
}

/// A rendered picture: linear RGB, row by row from the top, as two halves with independent noise.
#[derive(Clone, Debug)]
pub struct Rendered {
    pub halves: [Vec<[f64; 3]>; 2],
    /// Of one sample.
    pub variance: Vec<[f64; 3]>,
    /// Of the mean of both halves.
    pub error: Vec<[f64; 3]>,
}

impl Rendered {
    pub fn mean(&self) -> Vec<[f64; 3]> {
        let [a, b] = &self.halves;
        a.iter().zip(b).map(|(a, b)| [0, 1, 2].map(|channel| 0.5 * (a[channel] + b[channel]))).collect()
    }

    fn new(halves: [Vec<[f64; 3]>; 2], variance: &[[f64; 3]], samples: u64, width: usize) -> Rendered {
        let variance = smoothed(variance, width);
        let error = variance.iter().map(|pixel| pixel.map(|x| x / samples as f64)).collect();
        Rendered { halves, variance, error }
    }

    fn map(
        &self,
        change: impl Fn(&[[f64; 3]], &dyn Fn(&Rendered) -> &[[f64; 3]], f64) -> Vec<[f64; 3]>,
    ) -> Rendered {
        Rendered {
            halves: [
                change(&self.halves[0], &|it| &it.halves[0], 1.0),
                change(&self.halves[1], &|it| &it.halves[1], 1.0),
            ],
            variance: change(&self.variance, &|it| &it.variance, 2.0),
            error: change(&self.error, &|it| &it.error, 2.0),
        }
    }

    /// The mean of each square of `factor` x `factor` pixels.
    pub fn reduced(&self, width: usize, factor: usize) -> Rendered {
        let mut small = self.map(|pixels, _, _| reduced(pixels, width, factor));
        small.error.iter_mut().for_each(|pixel| *pixel = pixel.map(|x| x / (factor * factor) as f64));
        small
    }

    /// This picture, and `other` where that has values.
    pub fn under(&self, other: &Rendered) -> Rendered {
        self.map(|own, of, _| {
            let pixels = own.iter().zip(of(other));
            pixels.map(|(own, other)| if other[0].is_nan() { *own } else { *other }).collect()
        })
    }

    /// This picture plus `times` that of `from` each pixel, which is the pixel itself or another one.
    pub fn plus(&self, times: f64, from: impl Fn(usize) -> usize) -> Rendered {
        self.map(|pixels, _, power| {
            let plus = |at: usize, c: usize| match from(at) {
                from if from == at => (1.0 + times).powf(power) * pixels[at][c],
                from => pixels[at][c] + times.abs().powf(power).copysign(times) * pixels[from][c],
            };
            (0..pixels.len()).map(|at| [0, 1, 2].map(|c| plus(at, c))).collect()
        })
    }
}

/// Renders hypotheses until it is told to stop.
pub struct Studio<'a> {
    fast: CpuRenderer,
    pub stop: &'a AtomicBool,
}

/// The size of the book's pictures: 400 x 225.
const PIXELS: u64 = 90_000;

impl<'a> Studio<'a> {
    pub fn new(stop: &'a AtomicBool) -> Result<Self> {
        Ok(Studio { fast: CpuRenderer::new(CpuOptions::default())?, stop })
    }

    /// Renders a hypothesis: linear RGB in the layout of its file.
    ///
    /// # Errors
    /// If it was told to stop.
    pub fn picture(&mut self, hypothesis: &Hypothesis, samples: u64) -> Result<Vec<[f64; 3]>> {
        let mean = self.render(hypothesis, 1, samples, None)?.mean();
        Ok(hypothesis.written.laid_out(&mean, hypothesis.size()))
    }

    /// Renders a hypothesis, smaller by a factor, within the pixels of `mask`. Pictures larger than [`PIXELS`] get the same
    /// number of paths.
    ///
    /// # Errors
    /// If it was told to stop.
    pub fn render(
        &mut self,
        hypothesis: &Hypothesis,
        factor: u32,
        samples: u64,
        mask: Option<&[bool]>,
    ) -> Result<Rendered> {
        let [width, height] = hypothesis.size().map(|side| (side / factor).max(1));
        let mut recipe = hypothesis.recipe.clone();
        (recipe.settings.width, recipe.settings.height) = (width, height);
        let limit = samples * PIXELS / (u64::from(width) * u64::from(height)).max(PIXELS);
        let samples = if hypothesis.is_exact() { 1 } else { limit.max(2).next_multiple_of(2) };
        let rendered = match hypothesis.steps {
            Some(steps) => {
                let tracer = Tracer::new(&recipe, steps, &hypothesis.viewport, factor);
                self.plain(&tracer, samples as u32, mask)
            }
            None => self.fast(&recipe, hypothesis.viewport, samples)?,
        };
        if self.stop.load(Ordering::Relaxed) {
            bail!("the check was stopped");
        }
        Ok(rendered)
    }

    fn plain(&self, tracer: &Tracer, samples: u32, mask: Option<&[bool]>) -> Rendered {
        let half = samples.div_ceil(2);
        let [first, second] =
            [0, samples - half].map(|from| tracer.moments(from..from + half, mask, self.stop));
        let mean = |half: &[[[f64; 3]; 2]]| half.iter().map(|[mean, _]| *mean).collect();
        let variance = |at: usize| {
            [0, 1, 2].map(|c| {
                let between = (first[at][0][c] - second[at][0][c]).powi(2) * f64::from(half) / 2.0;
                let within = first[at][1][c] + second[at][1][c];
                // The deviation between the halves has one degree of freedom.
                (between + f64::from(half - 1) * within) / f64::from(2 * half - 1)
            })
        };
        let variance: Vec<[f64; 3]> = (0..first.len()).map(variance).collect();
        Rendered::new([mean(&first), mean(&second)], &variance, u64::from(samples), tracer.width())
    }

    /// The picture from films of few samples, whose scatter is its noise.
    fn fast(&mut self, recipe: &Recipe, viewport: Viewport, samples: u64) -> Result<Rendered> {
        const FILMS: u64 = 8;
        let job = recipe.job()?.through(viewport);
        let each = (samples / FILMS).max(samples.min(2));
        let (mut sums, mut squares): ([Vec<[f64; 3]>; 2], Vec<[f64; 3]>) = Default::default();
        let mut parts = 0.0;
        for number in 0..(samples / each).max(1) {
            let mut film = job.new_film();
            let traced = self.fast.accumulate(&job, number * each..(number + 1) * each, &mut film, self.stop);
            if self.stop.load(Ordering::Relaxed) {
                bail!("the check was stopped");
            }
            traced?;
            for (half, pixels) in film.halves().iter().enumerate() {
                let count = film.half_sample_count(half) as f64;
                if count == 0.0 {
                    continue;
                }
                parts += 1.0;
                sums[half].resize(pixels.len(), [0.0; 3]);
                squares.resize(pixels.len(), [0.0; 3]);
                let all = sums[half].iter_mut().zip(&mut squares);
                for ((sum, square), value) in all.zip(pixels) {
                    for (channel, value) in value.radiance().into_iter().enumerate() {
                        sum[channel] += value / count;
                        square[channel] += (value / count).powi(2) * count;
                    }
                }
            }
        }
        if sums[1].is_empty() {
            sums[1] = sums[0].clone();
            parts *= 2.0;
            squares.iter_mut().for_each(|square| *square = square.map(|x| 2.0 * x));
        }
        let count = each as f64 / if samples > 1 { 2.0 } else { 1.0 };
        let variance = squares.iter().enumerate().map(|(at, square)| {
            [0, 1, 2].map(|c| {
                let mean = (sums[0][at][c] + sums[1][at][c]) / parts;
                ((square[c] - count * parts * mean * mean) / (parts - 1.0)).max(0.0)
            })
        });
        let variance: Vec<[f64; 3]> = variance.collect();
        let half = |sum: &Vec<[f64; 3]>| sum.iter().map(|sum| sum.map(|x| 2.0 * x / parts)).collect();
        Ok(Rendered::new(sums.each_ref().map(half), &variance, samples, recipe.settings.width as usize))
    }
}

/// Half of each variance, and half the mean around it: one pixel's own is a poor estimate.
fn smoothed(variance: &[[f64; 3]], width: usize) -> Vec<[f64; 3]> {
    let height = variance.len() / width.max(1);
    let near = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
    let at = |pixel: usize| {
        let (mut sum, mut count) = ([0.0; 3], 0.0);
        for y in near(pixel / width, height) {
            for near in near(pixel % width, width)
                .map(|x| &variance[y * width + x])
                .filter(|near| near[0].is_finite())
            {
                (0..3).for_each(|c| sum[c] += near[c]);
                count += 1.0;
            }
        }
        [0, 1, 2].map(|c| 0.5 * variance[pixel][c] + 0.5 * sum[c] / count)
    };
    (0..variance.len()).map(at).collect()
}
