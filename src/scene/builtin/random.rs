//! Random numbers for placing things: pure functions of their purpose, the same on every machine.

/// The draws for one thing in a scene, such as a grid cell.
///
/// SplitMix64 (Steele, Lea and Flood 2014, "Fast splittable pseudorandom number generators"), seeded with the scene's
/// seed and the thing's index.
pub(super) struct Draws {
    state: u64,
}

impl Draws {
    pub(super) fn new(seed: u64, index: u64) -> Self {
        Draws { state: mix(mix(seed) ^ index) }
    }

    /// The next number in `[0, 1)`.
    pub(super) fn unit(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        (mix(self.state) >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }

    /// The next number in `[low, high)`.
    pub(super) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Rounds to four decimals, to keep saved scenes short and readable.
pub(super) fn to_four_decimals(x: f64) -> f64 {
    (x * 1e4).round() / 1e4
}
