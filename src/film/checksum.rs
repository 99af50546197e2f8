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
