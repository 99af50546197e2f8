//! Sizes dispatches in blocks of samples and tiles of the picture, by measured time.

use super::layout::GpuBlock;
use crate::job::render::RenderSettings;
use crate::kernel::sampling::SampleBlock;
use std::collections::VecDeque;
use std::ops::Range;
use std::time::Duration;

/// Paths in the first dispatch: few enough for the slowest adapter.
pub const FIRST_PATHS: f64 = 4096.0;

/// Largest growth in paths from one dispatch to the next, as a factor.
pub const GROWTH_LIMIT: f64 = 4.0;

/// The smallest and the largest budget in paths.
pub const BUDGET_LIMITS: [f64; 2] = [64.0, 1e12];

/// Maximum number of blocks in a dispatch: the capacity of their buffer.
pub const BLOCK_LIMIT: usize = 1024;

/// A dispatch takes at least this many times its overhead, so that most of its time is spent on paths.
const TIMES_OVERHEAD: f64 = 3.0;

/// Longest time in seconds that a dispatch is given because of its overhead.
const LONGEST_GOAL: f64 = 0.12;

/// Growth of the shortest time from one dispatch to the next, so that it is eventually forgotten.
const FORGETTING: f64 = 1.002;

/// Share of the overhead that remains from one dispatch to the next, so that the budget moves and the overhead is measured
/// again.
const KEPT_OVERHEAD: f64 = 0.995;

/// Two dispatches reveal the overhead if their numbers of paths differ by this factor.
const TELLING_FACTOR: f64 = 1.25;

/// Weight of a new measurement of the overhead.
const OVERHEAD_WEIGHT: f64 = 0.3;

/// The number of paths that a dispatch should have, learnt from earlier dispatches. Twin: `Budget` in companion/assets/film.js,
/// which does not estimate the overhead.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    paths: f64,
    target: Duration,
    /// Seconds that a dispatch takes however few paths it has. A driver that runs on a busy processor can need longer for
    /// that than the target, and smaller dispatches would only add to it.
    overhead: f64,
    /// The shortest dispatch, in seconds; no overhead is longer.
    shortest: f64,
    /// Paths and seconds of an earlier dispatch, with which later ones are compared.
    earlier: Option<(f64, f64)>,
}

impl Budget {
    /// Starts with a small budget. `target` is the target time of a dispatch.
    pub fn new(target: Duration) -> Self {
        Budget { paths: FIRST_PATHS, target, overhead: 0.0, shortest: f64::INFINITY, earlier: None }
    }

    /// Number of paths for the next dispatch.
    pub fn paths(&self) -> u64 {
        self.paths as u64
    }

    /// Learns from a dispatch: halves the budget if the dispatch took more than twice its goal, otherwise moves it
    /// gradually towards the goal.
    pub fn learn(&mut self, paths: u64, took: Duration) {
        let (paths, took) = (paths as f64, took.as_secs_f64().max(1e-9));
        self.learn_overhead(paths, took);
        let ratio = self.goal() / took;
        let fitting = paths * ratio;
        // A dispatch far below the budget measures the cost of starting one, not the device's throughput.
        let least = if 2.0 * paths < self.paths { self.paths } else { self.paths / 2.0 };
        self.paths = if ratio < 0.5 {
            self.paths.min(paths) / 2.0
        } else {
            fitting.clamp(least, self.paths * GROWTH_LIMIT)
        }
        .clamp(BUDGET_LIMITS[0], BUDGET_LIMITS[1]);
    }

    /// The time that a dispatch should take, in seconds: the target, or more where most of it would be overhead.
    fn goal(&self) -> f64 {
        self.target.as_secs_f64().max((TIMES_OVERHEAD * self.overhead).min(LONGEST_GOAL))
    }

    /// Fits a straight line to time over paths; the overhead is its value at 0.
    fn learn_overhead(&mut self, paths: f64, took: f64) {
        self.shortest = (FORGETTING * self.shortest).min(took);
        self.overhead *= KEPT_OVERHEAD;
        match self.earlier {
            Some((earlier, time)) if earlier.max(paths) >= TELLING_FACTOR * earlier.min(paths) => {
                let found = (took * earlier - time * paths) / (earlier - paths);
                self.overhead += OVERHEAD_WEIGHT * (found.clamp(0.0, self.shortest) - self.overhead);
                self.earlier = Some((paths, took));
            }
            Some(_) => {}
            None => self.earlier = Some((paths, took)),
        }
        self.overhead = self.overhead.min(self.shortest);
    }
}

/// Samples that remain to be traced, as blocks.
#[derive(Debug)]
pub struct Blocks {
    settings: RenderSettings,
    left: VecDeque<SampleBlock>,
}

impl Blocks {
    /// All samples of `range`; `limit` is the most that a 32-bit sum can hold.
    pub fn of_range(range: Range<u64>, settings: &RenderSettings, limit: u32) -> Self {
        let left = SampleBlock::split(range, limit).into();
        Blocks { settings: *settings, left }
    }

    /// Takes the next blocks, together at most `samples` samples but at least one, and returns them with their sample
    /// count.
    pub fn take(&mut self, samples: u64) -> (Vec<GpuBlock>, u64) {
        let (mut taken, mut total) = (Vec::new(), 0);
        while taken.len() < BLOCK_LIMIT {
            let Some(mut block) = self.left.pop_front() else { break };
            let room = samples.max(1) - total;
            if u64::from(block.count) > room {
                if room == 0 || !taken.is_empty() {
                    self.left.push_front(block);
                    break;
                }
                // Takes the first part of the block; the rest is split into parts that double in size.
                let part = 1_u32 << room.ilog2();
                let mut end = block.count;
                while end > part {
                    self.left.push_front(SampleBlock {
                        half: block.half,
                        first: block.first + end / 2,
                        count: end / 2,
                    });
                    end /= 2;
                }
                block.count = part;
            }
            let (counter, step) = block.counter(&self.settings);
            taken.push(GpuBlock { half: block.half, counter, step, count: block.count });
            total += u64::from(block.count);
        }
        (taken, total)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reversed sample indices within a half.
    fn indices(blocks: &[GpuBlock]) -> Vec<(u32, u32)> {
        let mut all = Vec::new();
        for block in blocks {
            for i in 0..block.count {
                let counter = block.counter.wrapping_add(i.wrapping_mul(block.step));
                all.push((block.half, counter.reverse_bits()));
            }
        }
        all
    }

    #[test]
    fn parts_are_the_whole_once() {
        for piece in [1, 2, 3, 5, 16, 100, 1000] {
            let mut blocks = Blocks::of_range(37..1111, &RenderSettings::default(), 128);
            let mut all = Vec::new();
            loop {
                let (taken, total) = blocks.take(piece);
                if taken.is_empty() {
                    break;
                }
                assert!(total <= piece);
                all.extend(indices(&taken));
            }
            all.sort_unstable();
            let mut expected: Vec<_> = (37..1111_u32).map(|i| (i % 2, i / 2)).collect();
            expected.sort_unstable();
            assert_eq!(all, expected, "{piece}");
        }
    }

    #[test]
    fn slow_dispatches_halve_the_budget() {
        let mut budget = Budget::new(Duration::from_millis(50));
        dispatches(&mut budget, 20, 1e-4, 1e-9);
        let before = budget.paths();
        budget.learn(before, Duration::from_secs(1));
        assert_eq!(budget.paths(), before / 2);
        // If a small dispatch was too slow, the new budget is half of its size, not half of the old budget.
        budget.learn(before / 8, Duration::from_secs(1));
        assert_eq!(budget.paths(), before / 16);
    }

    /// Dispatches of a device that needs `overhead` seconds for each, and `per_path` for each path.
    fn dispatches(budget: &mut Budget, count: usize, overhead: f64, per_path: f64) -> Vec<f64> {
        let one = |_| {
            let took = overhead + budget.paths() as f64 * per_path;
            budget.learn(budget.paths(), Duration::from_secs_f64(took));
            took
        };
        (0..count).map(one).collect()
    }

    #[test]
    fn overhead_beyond_target_keeps_a_budget() {
        for overhead in [0.003, 0.007, 0.012, 0.02, 0.035] {
            for per_path in [1e-7, 5e-6, 2e-5] {
                let mut budget = Budget::new(Duration::from_millis(8));
                dispatches(&mut budget, 100, overhead, per_path);
                let last = dispatches(&mut budget, 50, overhead, per_path);
                let share = overhead / last.iter().copied().fold(f64::INFINITY, f64::min);
                assert!((0.2..0.6).contains(&share), "{overhead} {per_path}: {share}");
                // Once the processor has time again, the dispatches are as short as they should be.
                let later = dispatches(&mut budget, 1000, 1e-4, per_path);
                assert!((later[999] - 0.008).abs() < 5e-4, "{overhead} {per_path}: {}", later[999]);
            }
        }
    }

    #[test]
    fn slow_device_without_overhead_keeps_target() {
        for per_path in [1e-9, 1e-6, 2e-5, 1e-4] {
            let mut budget = Budget::new(Duration::from_millis(8));
            for took in &dispatches(&mut budget, 200, 0.0, per_path)[20..] {
                assert!((took - 0.008).abs() < 1e-3, "{per_path}: {took}");
            }
        }
        // Even if the overhead were a second, a dispatch would not be given three.
        let mut budget = Budget::new(Duration::from_millis(8));
        dispatches(&mut budget, 100, 1.0, 1e-6);
        assert_eq!((budget.goal(), budget.paths()), (LONGEST_GOAL, 64));
    }

    #[test]
    fn blocks_are_taken_whole_where_they_fit() {
        let mut blocks = Blocks::of_range(0..64, &RenderSettings::default(), 32);
        let mut taken = |most| blocks.take(most).0.iter().map(|block| block.count).collect::<Vec<u32>>();
        // Of a block that is too large, a power of two is taken; the rest is left in parts that double.
        assert_eq!([taken(7), taken(4), taken(23), taken(0)], [[4], [4], [8], [1]]);
        assert_eq!([taken(1000), taken(1000)], [vec![1, 2, 4, 8, 32], vec![]]);
        let mut many = Blocks::of_range(0..2 * BLOCK_LIMIT as u64, &RenderSettings::default(), 1);
        assert_eq!([u64::MAX, 10].map(|most| many.take(most).0.len()), [BLOCK_LIMIT, 10]);
    }
}
