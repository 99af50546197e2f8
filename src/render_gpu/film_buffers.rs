//! The film on the device. It stays there from pass to pass. A readback copies it to staging buffers and clears it; the copy
//! is transferred to the host while the device continues tracing.

use super::device::Gpu;
use super::failed;
use super::layout::{GpuBlock, GpuCounters, GpuDispatch, tile_size};
use super::readback::Staging;
use super::schedule::BLOCK_LIMIT;
use crate::film::{Film, HALVES, PixelSum, SampleRanges};
use crate::job::render::{RenderError, RenderSettings, Stats};
use rayon::prelude::*;
use std::ops::Range;
use std::time::{Duration, Instant};

/// Size of a pixel's sums in bytes.
const PIXEL_SIZE: u64 = size_of::<PixelSum>() as u64;

/// 64-bit words per pixel, one per channel.
const PIXEL_WORDS: usize = 3;

/// Pixels that a host thread adds at a time.
const PIXELS_AT_ONCE: usize = 4096;

/// Unrequested readbacks may take at most one part in this many of the time.
const READBACK_SHARE: u32 = 20;

/// The rows of the film that one buffer holds.
pub struct Slab {
    /// The first picture row in the buffer.
    pub first_row: u32,
    /// Number of rows in the buffer.
    pub row_count: u32,
    /// Group 1: the bindings of a dispatch that traces these rows.
    pub group: wgpu::BindGroup,
    sums: wgpu::Buffer,
    staging: Staging,
}

/// A readback in progress.
struct Readback {
    samples: SampleRanges,
    trace: Duration,
    submission: wgpu::SubmissionIndex,
}

/// The buffers of a film, and which samples they contain.
pub struct FilmBuffers {
    /// Width, height and limit.
    shape: (u32, u32, u64),
    /// The slabs, from the top of the picture down.
    pub slabs: Vec<Slab>,
    /// Parameters of a dispatch: a [`GpuDispatch`].
    pub parameters: wgpu::Buffer,
    /// The blocks of samples of a dispatch.
    pub blocks: wgpu::Buffer,
    /// The counters of dispatches: [`GpuCounters`].
    pub counters: wgpu::Buffer,
    counters_staging: Staging,
    traced: SampleRanges,
    trace: Duration,
    readback: Option<Readback>,
    read_back_at: Instant,
    readback_took: Duration,
    /// Total time that the host spent adding sums.
    pub readbacks_took: Duration,
}

impl FilmBuffers {
    /// Allocates empty buffers for films with these settings, each at most `limit` bytes.
    ///
    /// # Errors
    /// If not even one row of tiles fits, or the device runs out of memory.
    pub fn new(gpu: &Gpu, settings: &RenderSettings, limit: u64) -> Result<Self, String> {
        let RenderSettings { width, height, .. } = *settings;
        let row_size = u64::from(width) * HALVES * PIXEL_SIZE;
        let tile_height = tile_size(width, height)[1];
        let fitting = (limit / row_size).min(u64::from(height)) as u32;
        // All slabs but the last consist of whole tiles.
        let slab_rows = if fitting == height { fitting } else { fitting / tile_height * tile_height };
        if slab_rows == 0 {
            return Err(format!(
                "{tile_height} rows of {width} pixels take {} bytes, but the adapter binds at most {limit}; choose a narrower picture or render on the CPU",
                row_size * u64::from(tile_height),
            ));
        }

        use wgpu::BufferUsages as Usages;
        let copied = Usages::STORAGE | Usages::COPY_SRC | Usages::COPY_DST;
        let parameters_size = size_of::<GpuDispatch>() as u64;
        let parameters = gpu.buffer("dispatch", parameters_size, Usages::UNIFORM | Usages::COPY_DST)?;
        let blocks_size = (BLOCK_LIMIT * size_of::<GpuBlock>()) as u64;
        let blocks = gpu.buffer("blocks", blocks_size, Usages::STORAGE | Usages::COPY_DST)?;
        let counters_size = size_of::<GpuCounters>() as u64;
        let counters = gpu.buffer("counters", counters_size, copied)?;
        let counters_staging = Staging::new(gpu, "counters, read", counters_size)?;
        let mut slabs = Vec::new();
        let mut first_row = 0;
        while first_row < height {
            let row_count = slab_rows.min(height - first_row);
            let size = row_size * u64::from(row_count);
            let sums = gpu.buffer("film", size, copied)?;
            let staging = Staging::new(gpu, "film, read", size)?;
            let group = gpu.bind(&gpu.layouts.dispatch, &[&parameters, &blocks, &sums, &counters]);
            slabs.push(Slab { first_row, row_count, group, sums, staging });
            first_row += row_count;
        }
        Ok(FilmBuffers {
            shape: (width, height, limit),
            slabs,
            parameters,
            blocks,
            counters,
            counters_staging,
            traced: SampleRanges::default(),
            trace: Duration::ZERO,
            readback: None,
            read_back_at: Instant::now(),
            readback_took: Duration::ZERO,
            readbacks_took: Duration::ZERO,
        })
    }

    /// Whether these buffers fit a film with these settings and this limit.
    pub fn fit(&self, settings: &RenderSettings, limit: u64) -> bool {
        self.shape == (settings.width, settings.height, limit)
    }

    /// Returns an error if any of these samples are in `film` or on the device.
    pub fn check_new(&self, range: &Range<u64>, film: &Film) -> Result<(), RenderError> {
        let readback = self.readback.as_ref().map(|readback| &readback.samples);
        let mut all_held = [film.samples(), &self.traced].into_iter().chain(readback);
        Ok(all_held.try_for_each(|held| held.check_new(range))?)
    }

    /// Records that the sums will contain `range` once the submitted work is done.
    ///
    /// # Errors
    /// If the sums already contain some of it.
    pub fn note(&mut self, range: Range<u64>, trace: Duration) -> Result<(), RenderError> {
        self.traced.insert(range)?;
        self.trace += trace;
        Ok(())
    }

    /// Whether any samples are on the device or being transferred.
    pub fn holds_samples(&self) -> bool {
        self.readback.is_some() || self.traced.count() > 0
    }

    /// The samples on the device, including those being transferred.
    pub fn held(&self) -> SampleRanges {
        let mut held = self.traced.clone();
        for range in self.readback.iter().flat_map(|readback| readback.samples.iter()) {
            // No sample is traced twice: [`FilmBuffers::check_new`] ensures it.
            let _ = held.insert(range);
        }
        held
    }

    /// Whether a readback is in progress.
    pub fn is_reading_back(&self) -> bool {
        self.readback.is_some()
    }

    /// Whether the last readback is so long ago that another costs little.
    pub fn is_readback_due(&self) -> bool {
        self.read_back_at.elapsed() >= self.readback_took * READBACK_SHARE
    }

    /// Discards everything traced. Sums of work in flight are cleared after that work.
    pub fn discard(&mut self, gpu: &Gpu) {
        self.readback = None;
        self.stagings().for_each(Staging::release);
        self.traced = SampleRanges::default();
        self.trace = Duration::ZERO;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        self.clear(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
    }

    /// Starts a readback of the sums as they will be after the submitted work, and clears them for the next samples.
    pub fn request_readback(&mut self, gpu: &Gpu) {
        if self.readback.is_some() || self.traced.count() == 0 {
            return;
        }
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        for slab in &self.slabs {
            encoder.copy_buffer_to_buffer(&slab.sums, 0, &slab.staging.buffer, 0, slab.sums.size());
        }
        let counters = &self.counters;
        encoder.copy_buffer_to_buffer(counters, 0, &self.counters_staging.buffer, 0, counters.size());
        self.clear(&mut encoder);
        let submission = gpu.queue.submit([encoder.finish()]);
        self.stagings().for_each(Staging::request);
        let (samples, trace) = (std::mem::take(&mut self.traced), std::mem::take(&mut self.trace));
        self.readback = Some(Readback { samples, trace, submission });
    }

    /// Waits for the readback in progress and adds its samples to the film.
    ///
    /// # Errors
    /// The device's error; the film is unchanged.
    pub fn finish_readback(&mut self, gpu: &Gpu, film: &mut Film) -> Result<Stats, RenderError> {
        let Some(readback) = self.readback.take() else { return Ok(Stats::default()) };
        gpu.wait_unless(&readback.submission, None).map_err(failed)?;
        let begin = Instant::now();
        let added = self.add_to(film, &readback.samples);
        self.stagings().for_each(Staging::release);
        let [rays, rejected] = added?;
        self.read_back_at = Instant::now();
        self.readback_took = begin.elapsed();
        self.readbacks_took += self.readback_took;
        let pixels = u64::from(film.width()) * u64::from(film.height());
        Ok(Stats {
            paths: pixels * readback.samples.count(),
            rays,
            rejected,
            busy_lanes: rays,
            offered_lanes: rays,
            trace: readback.trace,
        })
    }

    /// Adds what has been read back. Returns the rays and the rejected samples.
    fn add_to(&self, film: &mut Film, samples: &SampleRanges) -> Result<[u64; 2], RenderError> {
        samples.iter().try_for_each(|range| film.samples().check_new(&range))?;
        let counters = self.counters_staging.view().map_err(failed)?;
        let views = self.slabs.iter().map(|slab| slab.staging.view());
        let views = views.collect::<Result<Vec<_>, _>>().map_err(failed)?;
        let sums = views.iter().map(|view| bytemuck::try_cast_slice(view));
        let sums = sums.collect::<Result<Vec<&[u64]>, _>>();
        let sums = sums.map_err(|error| failed(format!("reading results: {error}")))?;
        let GpuCounters { rays, rays_high, rejected, rejected_high, .. } =
            bytemuck::pod_read_unaligned(&counters);

        // All data is on the host: nothing can fail from here on.
        for (slab, sums) in self.slabs.iter().zip(sums) {
            add_rows(film, slab.first_row, sums);
        }
        let wide = |low: u32, high: u32| u64::from(low) | u64::from(high) << 32;
        let [rays, rejected] = [wide(rays, rays_high), wide(rejected, rejected_high)];
        let mut unrecorded = rejected;
        for range in samples.iter() {
            film.record(range, std::mem::take(&mut unrecorded))?;
        }
        Ok([rays, rejected])
    }

    fn clear(&self, encoder: &mut wgpu::CommandEncoder) {
        for slab in &self.slabs {
            encoder.clear_buffer(&slab.sums, 0, None);
        }
        encoder.clear_buffer(&self.counters, 0, None);
    }

    fn stagings(&mut self) -> impl Iterator<Item = &mut Staging> {
        self.slabs.iter_mut().map(|slab| &mut slab.staging).chain([&mut self.counters_staging])
    }
}

/// Adds a slab's sums, half by half, to the film, starting at row `first_row`.
fn add_rows(film: &mut Film, first_row: u32, sums: &[u64]) {
    let start = first_row as usize * film.width() as usize;
    // Buffer sizes are rounded up to 16 bytes.
    let words = sums.len() / HALVES as usize / PIXEL_WORDS * PIXEL_WORDS;
    for (half, sums) in film.halves_mut().iter_mut().zip(sums.chunks_exact(words)) {
        let pixels = &mut half[start..start + words / PIXEL_WORDS];
        let parts = pixels.par_chunks_mut(PIXELS_AT_ONCE);
        parts.zip(sums.par_chunks(PIXELS_AT_ONCE * PIXEL_WORDS)).for_each(|(pixels, sums)| {
            for (pixel, sum) in pixels.iter_mut().zip(sums.as_chunks::<PIXEL_WORDS>().0) {
                pixel.add(PixelSum(*sum));
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::render::{RenderJob, Renderer};
    use crate::render_gpu::{GpuOptions, GpuRenderer};
    use crate::scene::builtin::{BOOK_CAMERA, field};
    use crate::stages::Rules;
    use std::mem::offset_of;
    use std::sync::atomic::AtomicBool;

    /// A renderer on any adapter. Without an adapter a test prints a note, or fails if `WEEKENDER_REQUIRE_GPU=1` is
    /// set.
    fn renderer() -> Option<GpuRenderer> {
        let adapter = std::env::var("WEEKENDER_TEST_ADAPTER").ok();
        let gpu = GpuRenderer::new(GpuOptions { adapter, allow_software: true, ..GpuOptions::default() });
        if gpu.is_err() && std::env::var("WEEKENDER_REQUIRE_GPU").as_deref() != Ok("1") {
            crate::system::console::note("NOT TESTED: there is no graphics adapter");
            return None;
        }
        Some(gpu.unwrap_or_else(|error| panic!("{error}")))
    }

    fn job() -> RenderJob {
        let settings = RenderSettings { width: 40, height: 24, max_depth: 6, ..RenderSettings::default() };
        RenderJob::new(field(300).0, BOOK_CAMERA, settings, Rules::FINISHED).unwrap()
    }

    /// Sets a pair of words of the device's counters, the low word first.
    fn set(gpu: &GpuRenderer, offset: usize, words: [u32; 2]) {
        let counters = &gpu.loaded.as_ref().unwrap().film.counters;
        gpu.gpu.queue.write_buffer(counters, offset as u64, bytemuck::cast_slice(&words));
    }

    fn traced(gpu: &mut GpuRenderer, job: &RenderJob, samples: Range<u64>) -> (Stats, Film) {
        let mut film = job.new_film();
        let stats = gpu.accumulate(job, samples, &mut film, &AtomicBool::new(false)).unwrap();
        (stats, film)
    }

    #[test]
    fn rays_are_counted_beyond_32_bits() {
        let Some(mut gpu) = renderer() else { return };
        let job = job();
        gpu.prepare(&job, &AtomicBool::new(false)).unwrap();
        let (plain, _) = traced(&mut gpu, &job, 0..4);
        assert!(plain.rays > 40 * 24 * 4 && plain.rays < 40 * 24 * 4 * 6, "{plain:?}");
        // Counters that are about to overflow, and one that has overflowed before.
        for words in [[u32::MAX, 0], [u32::MAX - 1000, 2], [0, 1]] {
            set(&gpu, offset_of!(GpuCounters, rays), words);
            let before = u64::from(words[0]) | u64::from(words[1]) << 32;
            assert_eq!(traced(&mut gpu, &job, 0..4).0.rays, before + plain.rays, "{words:?}");
        }
    }

    #[test]
    fn rejected_samples_are_counted_on_the_device() {
        let Some(mut gpu) = renderer() else { return };
        let job = job();
        // With one ray per path, the picture shows the sky and black.
        let settings = RenderSettings { max_depth: 1, ..*job.settings() };
        let sky = job.seen_by(*job.camera(), settings).unwrap();
        let mut seen = 0;
        for samples in [0..1, 1..2] {
            let (_, clean) = traced(&mut gpu, &sky, samples);
            assert_eq!(clean.rejected(), 0);
            seen += (0..40 * 24).filter(|pixel| clean.pixel_sum(*pixel).0 != [0; 3]).count() as u64;
        }
        assert!(seen > 200 && seen < 2 * 40 * 24, "{seen} samples meet the sky");
        // A sky that no valid scene has, uploaded with the scene's next job.
        gpu.prepare(&job, &AtomicBool::new(false)).unwrap();
        gpu.loaded.as_mut().unwrap().scene.prepared.sky_middle[1] = f32::INFINITY;
        let (stats, film) = traced(&mut gpu, &sky, 0..2);
        assert_eq!(film.rejected(), seen);
        assert_eq!(stats.rejected, film.rejected());
        assert!((0..40 * 24).all(|pixel| film.pixel_sum(pixel).0 == [0; 3]), "none of them is added");
        // The same beyond 32 bits.
        set(&gpu, offset_of!(GpuCounters, rejected), [u32::MAX, 0]);
        let (again, _) = traced(&mut gpu, &sky, 0..2);
        assert_eq!(again.rejected, stats.rejected + u64::from(u32::MAX));
    }

    #[test]
    fn sums_are_added_to_their_rows_half_by_half() {
        // The last has more pixels than a thread takes at a time.
        for (width, height, first_row, rows) in [(3, 4, 1, 2), (1, 2, 1, 1), (5000, 1, 0, 1)] {
            let mut film = Film::new(width, height);
            film.halves_mut().iter_mut().flatten().for_each(|sum| *sum = PixelSum([1000; 3]));
            let (width, of_half) = (width as usize, (width * rows) as usize);
            // Words beyond the last pixel are left out.
            let sums: Vec<u64> = (0..(3 * of_half * 2) as u64 + 1).collect();
            add_rows(&mut film, first_row, &sums);
            for (number, half) in film.halves().iter().enumerate() {
                for (pixel, sum) in half.iter().enumerate() {
                    let place =
                        pixel.checked_sub(first_row as usize * width).filter(|place| *place < of_half);
                    let first = place.map(|place| 3 * (number * of_half + place));
                    let added = first.map_or([0; 3], |first| [0, 1, 2].map(|channel| sums[first + channel]));
                    assert_eq!(sum.0, added.map(|added| 1000 + added), "pixel {pixel} of {width}x{height}");
                }
            }
        }
    }
}
