//! A checksum that detects changed data.

/// FNV-1a over 64-bit words. It detects damage, not tampering.
///
/// Each step is a bijection of states for a fixed word, and of words for a fixed state. Two lists of equal length that
/// differ in a single word therefore always have different checksums.
#[derive(Clone, Copy, Debug)]
pub struct Checksum(u64);

impl Default for Checksum {
    fn default() -> Self {
        Checksum(0xcbf2_9ce4_8422_2325)
    }
}

impl Checksum {
    pub fn word(&mut self, word: u64) {
        self.0 = (self.0 ^ word).wrapping_mul(0x0000_0100_0000_01b3);
        // The product only carries upwards: without this step, high bits of a word would affect few bits.
        self.0 ^= self.0 >> 32;
    }

    pub fn words(&mut self, words: &[u64]) {
        words.iter().for_each(|word| self.word(*word));
    }

    /// Adds a text: its length, then byte by byte.
    pub fn text(&mut self, text: &[u8]) {
        self.word(text.len() as u64);
        text.iter().for_each(|byte| self.word(u64::from(*byte)));
    }

    /// The checksum as 16 hexadecimal digits.
    pub fn finish(self) -> String {
        format!("{:016x}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_single_bit_counts() {
        let words: Vec<u64> = (0..9).map(|i| i * 0x0123_4567_89ab_cdef).collect();
        let of = |words: &[u64]| {
            let mut sum = Checksum::default();
            sum.words(words);
            sum.finish()
        };
        let whole = of(&words);
        for bit in 0..9 * 64 {
            let mut other = words.clone();
            other[bit / 64] ^= 1 << (bit % 64);
            assert_ne!(of(&other), whole, "bit {bit}");
        }
    }
}
