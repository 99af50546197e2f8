//! A number by which changed data is told from what was written.

/// FNV-1a over words of 64 bits. It finds damage, not intent.
///
/// Each step maps states one to one, and for one state words one to one. So of two lists of equal length that differ
/// in a single word, the sums differ, without exception.
#[derive(Clone, Copy, Debug)]
pub struct Checksum(u64);

impl Default for Checksum {
    fn default() -> Self {
        Checksum(0xcbf2_9ce4_8422_2325)
    }
}

impl Checksum {
    /// Adds a word.
    pub fn word(&mut self, word: u64) {
        self.0 = (self.0 ^ word).wrapping_mul(0x0000_0100_0000_01b3);
        // The product carries upwards only: without this, high bits of a word would reach few bits.
        self.0 ^= self.0 >> 32;
    }

    /// Adds several words.
    pub fn words(&mut self, words: &[u64]) {
        words.iter().for_each(|word| self.word(*word));
    }

    /// Adds a text: its length, then byte by byte.
    pub fn text(&mut self, text: &[u8]) {
        self.word(text.len() as u64);
        text.iter().for_each(|byte| self.word(u64::from(*byte)));
    }

    /// What it has come to: 16 digits of base 16.
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
