//! The processor: packets that wait for their longest path, and packets whose lanes are refilled.
//!
//! The loop is a short version of `render_cpu::path` for scenes without a lens, a hierarchy and anchored spheres. It has one
//! packet instead of four, and calls the program's own functions for rays, hits, scattering and random numbers.

use super::{Comparison, Mapping, Options, SIZE, Traced, compare, job, timed};
use fearless_simd::Level;
use std::rc::Rc;
use std::sync::atomic::AtomicBool;
use weekender::film::PixelSum;
use weekender::job::render::{RenderJob, Renderer};
use weekender::kernel::sampling::{HalfKey, SampleBlock};
use weekender::kernel::{Columns, GROUP, LoadShading, NONE, RECORD_COLUMNS};
use weekender::prepared::PreparedScene;
use weekender::render_cpu::broadcast::BroadcastScene;
use weekender::render_cpu::camera::{pinhole_ray, screen};
use weekender::render_cpu::lanes::{
    Float, Instructions, Lanes, Lanes4, Lanes8, Lanes16, Mask, Scalar, Unsigned, V3, WideU, rows_of,
    unit_float,
};
use weekender::render_cpu::material::{incidence_of, material_of, scatter};
use weekender::render_cpu::rng::{numbers, sampler_key};
use weekender::render_cpu::sphere::{Nearest, Rays, Spheres, near_root, nearest_root, surface_point};
use weekender::render_cpu::{CpuOptions, CpuRenderer, Isa};
use weekender::stages::DielectricLaws;

pub fn measure(options: &Options) -> anyhow::Result<Comparison> {
    let job = job()?;
    let scene = Rc::new(BroadcastScene::new(PreparedScene::<f32>::new(&job)));
    let lanes = Isa::available().last().map_or(1, |isa| isa.native_lanes());
    let mut mappings: Vec<Box<dyn Mapping>> = Vec::new();
    for refill in [false, true] {
        let (scene, samples) = (Rc::clone(&scene), options.samples);
        mappings.push(Box::new(Packets { scene, samples, lanes, refill }));
    }
    let cpu = CpuOptions { lanes: Some(lanes), threads: Some(1), ..CpuOptions::default() };
    mappings.push(Box::new(Tracer {
        renderer: CpuRenderer::new(cpu)?,
        job,
        samples: options.samples,
        lanes,
    }));
    compare(options, format!("{}, 1 thread", super::processor()), &mut mappings)
}

/// The program's own tracer: four packets that take turns.
struct Tracer {
    renderer: CpuRenderer,
    job: RenderJob,
    samples: u64,
    lanes: usize,
}

impl Mapping for Tracer {
    fn name(&self) -> String {
        format!("the tracer: refilled, four packets of {} in turn", self.lanes)
    }

    fn trace(&mut self) -> anyhow::Result<Traced> {
        let mut film = self.job.new_film();
        let cancel = AtomicBool::new(false);
        self.renderer.prepare(&self.job, &cancel)?;
        let stats = self.renderer.accumulate(&self.job, 0..self.samples, &mut film, &cancel)?;
        let film = (0..self.pixels()).map(|pixel| film.pixel_sum(pixel)).collect();
        let in_use = Some(stats.busy_lanes as f64 / stats.offered_lanes as f64);
        Ok(Traced { seconds: stats.trace.as_secs_f64(), film, in_use })
    }
}

impl Tracer {
    fn pixels(&self) -> usize {
        SIZE[0] as usize * SIZE[1] as usize
    }
}

/// One packet that goes through the whole picture.
struct Packets {
    scene: Rc<BroadcastScene<f32>>,
    samples: u64,
    lanes: usize,
    refill: bool,
}

impl Mapping for Packets {
    fn name(&self) -> String {
        let lanes = self.lanes;
        if self.refill {
            format!("{lanes} lanes, each starts its next path at once")
        } else {
            format!("{lanes} lanes that wait for the longest path")
        }
    }

    fn trace(&mut self) -> anyhow::Result<Traced> {
        let mut work = Work::new(&self.scene, self.samples);
        let (counts, seconds) = timed(|| run(self.lanes, self.refill, &self.scene, &mut work));
        Ok(Traced { seconds, film: work.film, in_use: Some(counts.busy as f64 / counts.offered as f64) })
    }
}

/// Lanes that traced a ray, and all lanes, summed over the steps.
#[derive(Default)]
struct Counts {
    busy: u64,
    offered: u64,
}

/// Compiles the loop for the best level with this many lanes.
fn run(lanes: usize, refill: bool, scene: &BroadcastScene<f32>, work: &mut Work) -> Counts {
    let level = Level::new();
    #[cfg(target_arch = "x86_64")]
    {
        if let (16, Some(simd)) = (lanes, level.as_avx512()) {
            return at(simd, lanes, refill, scene, work);
        }
        if let Some(simd) = level.as_avx2() {
            return at(simd, lanes, refill, scene, work);
        }
        if let Some(simd) = level.as_sse4_2() {
            return at(simd, lanes, refill, scene, work);
        }
    }
    #[cfg(target_arch = "aarch64")]
    if let Some(simd) = level.as_neon() {
        return at(simd, lanes, refill, scene, work);
    }
    let _ = level;
    trace(Scalar::<false>, refill, scene, work)
}

fn at<S: Instructions>(
    simd: S,
    lanes: usize,
    refill: bool,
    scene: &BroadcastScene<f32>,
    work: &mut Work,
) -> Counts {
    match lanes {
        4 => simd.vectorize(
            #[inline(always)]
            || trace(Lanes4(simd), refill, scene, work),
        ),
        8 => simd.vectorize(
            #[inline(always)]
            || trace(Lanes8(simd), refill, scene, work),
        ),
        16 => simd.vectorize(
            #[inline(always)]
            || trace(Lanes16(simd), refill, scene, work),
        ),
        _ => trace(Scalar::<false>, refill, scene, work),
    }
}

/// The paths of a picture in the order in which lanes take them: neighbouring pixels with the same sample.
struct Work {
    /// `x | y << 16`, in squares of four by four.
    places: Vec<u32>,
    /// The half and the sampler's counter of each sample.
    counters: Vec<[u32; 2]>,
    width: usize,
    half_keys: [HalfKey; 2],
    next: usize,
    film: Vec<PixelSum>,
}

/// Pixels of a square, which are traced sample by sample.
const SQUARE: usize = 16;

impl Work {
    fn new(scene: &BroadcastScene<f32>, samples: u64) -> Self {
        let settings = &scene.prepared.settings;
        let (width, height) = (settings.width, settings.height);
        let mut places = Vec::new();
        for top in (0..height).step_by(4) {
            for left in (0..width).step_by(4) {
                for y in top..(top + 4).min(height) {
                    places.extend((left..(left + 4).min(width)).map(|x| x | y << 16));
                }
            }
        }
        let counters = (0..samples)
            .flat_map(|sample| SampleBlock::split(sample..sample + 1, 1))
            .map(|block| [block.half, block.counter(settings).0])
            .collect();
        Work {
            film: vec![PixelSum::default(); places.len()],
            places,
            counters,
            width: width as usize,
            half_keys: [0, 1].map(|half| HalfKey::new(settings, half)),
            next: 0,
        }
    }

    /// The pixel, and the half and the counter, of the next path.
    #[inline(always)]
    fn take(&mut self) -> Option<(u32, [u32; 2])> {
        let of_square = SQUARE * self.counters.len();
        let (square, within) = (self.next / of_square, self.next % of_square);
        let first = SQUARE * square;
        let pixels = SQUARE.min(self.places.len().checked_sub(first).filter(|left| *left > 0)?);
        let (sample, pixel) = (within / pixels, within % pixels);
        self.next += if within + 1 == pixels * self.counters.len() { of_square - within } else { 1 };
        Some((self.places[first + pixel], self.counters[sample]))
    }

    #[inline(always)]
    fn add(&mut self, pixel: u32, sums: [u32; 3]) {
        let sum = &mut self.film[(pixel >> 16) as usize * self.width + (pixel & 0xFFFF) as usize];
        for (sum, more) in sum.0.iter_mut().zip(sums) {
            *sum += u64::from(more);
        }
    }
}

/// The records of the hits.
struct ShadingRecords<L: Lanes> {
    columns: [[L::F; GROUP]; RECORD_COLUMNS / GROUP],
}

impl<L: Lanes> Columns<L::Real> for ShadingRecords<L> {
    type Number = L::F;
    type Vector = V3<L::F>;

    #[inline(always)]
    fn number(&self, column: usize) -> L::F {
        self.columns[column / GROUP][column % GROUP]
    }

    #[inline(always)]
    fn vector(&self, column: usize) -> V3<L::F> {
        V3 { x: self.number(column), y: self.number(column + 1), z: self.number(column + 2) }
    }
}

#[inline(always)]
fn hit_records<L: Lanes<Real = f32>>(l: L, scene: &BroadcastScene<f32>, hit: L::U) -> ShadingRecords<L> {
    let mut columns = [[l.constant(0.0); GROUP]; RECORD_COLUMNS / GROUP];
    if scene.prepared.records.len() <= L::PERMUTED_ROWS {
        for (column, number) in columns.iter_mut().flatten().enumerate() {
            *number = l.permute(&scene.columns[column], hit);
        }
    } else {
        let rows = rows_of::<L>(&scene.prepared.records, l.keep(!hit.eq(l.splat_u(NONE)), hit));
        for (group, columns) in columns.iter_mut().enumerate() {
            *columns = l.gather(&rows, group);
        }
    }
    ShadingRecords { columns }
}

#[inline(always)]
fn trace<L: Lanes<Real = f32>>(l: L, refill: bool, scene: &BroadcastScene<f32>, work: &mut Work) -> Counts {
    let (zero, one, none) = (l.constant(0.0), l.constant(1.0), l.splat_u(NONE));
    let nowhere = V3 { x: zero, y: zero, z: zero };
    let settings = &scene.prepared.settings;
    let [mut pixels, mut halves, mut counters] = [WideU::default(); 3];
    let [mut pixel, mut counter, mut key, mut stream] = [l.splat_u(0); 4];
    let mut corner = [zero; 2];
    let mut rays: Rays<L> = Rays { origin: nowhere, direction: nowhere, left: none, inside: none };
    let mut nearest = Nearest::nothing(l);
    let mut throughput = nowhere;
    // The lanes that have a path.
    let mut busy = 0_u32;
    let mut counts = Counts::default();
    loop {
        // Light of rays that miss; paths that end.
        let hit = nearest.sphere;
        let miss = hit.eq(none);
        let lit = miss.bits() & busy;
        if lit != 0 {
            add_light(l, scene, &rays, throughput, lit, &pixels, work);
        }
        let is_last = stream.eq(key + l.load_u(&scene.last_bounce));
        busy &= !(miss | is_last).bits();

        // New paths: for every idle lane, or once all lanes are idle.
        let mut started = 0;
        if refill || busy == 0 {
            let mut idle = !busy & (u32::MAX >> (32 - L::WIDTH));
            while idle != 0 {
                let lane = idle.trailing_zeros() as usize;
                idle &= idle - 1;
                let Some((place, [half, sample])) = work.take() else { break };
                (pixels.0[lane], halves.0[lane], counters.0[lane]) = (place, half, sample);
                started |= 1 << lane;
            }
            if started | busy == 0 {
                return counts;
            }
        }
        if started != 0 {
            (pixel, counter) = (l.load_u(&pixels), l.load_u(&counters));
            let [first, second] = work.half_keys.map(|half| sampler_key(l, half, pixel));
            key = l.load_u(&halves).eq(l.splat_u(0)).select(first, second);
            let position = [L::float_of(pixel & l.splat_u(0xFFFF)), L::float_of(pixel >> 16)];
            corner = screen(l, &scene.camera, position[0], position[1]);
        }
        let new = l.mask(started);
        stream = new.select(key, stream + l.splat_u(1));
        let [drawn, _] = numbers(l, settings, pixel, counter, key, stream, false);
        let [u0, u1] = [unit_float(l, drawn[0]), unit_float(l, drawn[1])];

        // The next rays: from the hits, or from the camera.
        let (sine, cosine) = l.sin_cos_turns(u1);
        let rho = (u0 * (one - u0)).sqrt();
        let rho = rho + rho;
        let unit = V3 { x: rho * cosine, y: one - (u0 + u0), z: rho * sine };
        let record = hit_records(l, scene, hit);
        let (reference, curvature) = (record.reference(), record.curvature());
        let point = surface_point(l, &rays, nearest.distance(), reference, curvature, record.radius());
        let outward_cosine = rays.direction.dot(point.outward);
        let front = outward_cosine.lt(zero) & !rays.inside.eq(hit);
        let normal = point.outward.negate_where(l, !front);
        let incidence = incidence_of(l, outward_cosine);
        let material = material_of(&record);
        let laws = DielectricLaws::Schlick;
        let scattered =
            scatter::<L, true>(l, &material, laws, rays.direction, normal, &incidence, front, unit, u0);
        let inward = !(front ^ scattered.refracts);
        let camera = pinhole_ray(l, &scene.camera, corner, [u0, u1]);
        let direction = new.select(camera.direction, scattered.direction);
        let absorbed = scattered.is_metal & !zero.lt(direction.dot(normal)) & !new;
        let direction = direction.scale(one / direction.dot(direction).sqrt());
        rays = Rays {
            origin: new.select(camera.origin, point.position),
            direction,
            left: l.fill(new | inward, hit),
            inside: l.fill(new | !inward, hit),
        };
        throughput = new.select(V3 { x: one, y: one, z: one }, throughput.times(record.albedo()));
        busy = (busy | started) & !absorbed.bits();

        nearest = Nearest::nothing(l);
        for sphere in &scene.opaque {
            let sphere = Spheres::load(l, sphere);
            nearest.take(l, near_root(l, &rays, &sphere), sphere.number);
        }
        for sphere in &scene.two_root {
            let sphere = Spheres::load(l, sphere);
            nearest.take(l, nearest_root(l, &rays, &sphere), sphere.number);
        }
        counts.busy += u64::from(busy.count_ones());
        counts.offered += L::WIDTH as u64;
    }
}

/// Adds the sky's light to the pixels of these lanes.
#[inline(always)]
fn add_light<L: Lanes<Real = f32>>(
    l: L,
    scene: &BroadcastScene<f32>,
    rays: &Rays<L>,
    throughput: V3<L::F>,
    lanes: u32,
    pixels: &WideU,
    work: &mut Work,
) {
    let height = rays.direction.y;
    let channel = |channel: usize| {
        let (middle, slope) = (l.load(&scene.sky_middle[channel]), l.load(&scene.sky_slope[channel]));
        l.constant(0.0).max(slope.mul_add(height, middle))
    };
    let light = V3 { x: channel(0), y: channel(1), z: channel(2) }.times(throughput);
    let mut sums = [WideU::default(); 3];
    for (sum, light) in sums.iter_mut().zip([light.x, light.y, light.z]) {
        L::store_u(l.fixed_point(light), sum);
    }
    let mut left = lanes;
    while left != 0 {
        let lane = left.trailing_zeros() as usize;
        left &= left - 1;
        work.add(pixels.0[lane], [0, 1, 2].map(|channel: usize| sums[channel].0[lane]));
    }
}
