//! Mutates inputs, with pseudo-random numbers that depend only on a seed.

/// The SplitMix64 generator.
pub struct Draws(u64);

impl Draws {
    pub fn new(seed: u64) -> Self {
        Draws(seed.wrapping_mul(0xd134_2543_de82_ef95).wrapping_add(1))
    }

    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }

    /// A number below `limit`, which must be above 0.
    pub fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit as u64) as usize
    }

    pub fn pick<'a, T>(&mut self, items: &'a [T]) -> &'a T {
        &items[self.below(items.len())]
    }
}

/// Numbers that often cause errors.
const NUMBERS: &[u64] = &[
    0,
    1,
    2,
    3,
    0x7f,
    0x80,
    0xff,
    0x100,
    0x3fff,
    0x4000,
    0x7fff,
    0xffff,
    0x1_0000,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x1_0000_0000,
    0x7f80_0000,
    0x7fc0_0000,
    0x7fff_ffff_ffff_ffff,
    0x8000_0000_0000_0000,
    u64::MAX,
];

const TEXT_NUMBERS: &[&str] = &[
    "0",
    "-0",
    "-1",
    "1",
    "2",
    "1e308",
    "-1e308",
    "1e-320",
    "nan",
    "-nan",
    "inf",
    "-inf",
    "0.5",
    "4294967296",
    "4294967295",
    "9223372036854775807",
    "-9223372036854775808",
    "18446744073709551615",
    "99999999999999999999999999",
    "1_0",
    "0x7f",
    "1e",
    ".",
    "16384",
    "16385",
    "20000",
];

/// Longest mutated input, bytes.
const LENGTH_LIMIT: usize = 1 << 16;

/// Mutates one of `kept` in one to eight places. `words` are words of the parser's language.
pub fn mutate(draws: &mut Draws, kept: &[Vec<u8>], words: &[&str]) -> Vec<u8> {
    let mut input = draws.pick(kept).clone();
    let count = 1 + (draws.next().leading_zeros() as usize).min(7);
    for _ in 0..count {
        change(draws, &mut input, kept, words);
    }
    input.truncate(LENGTH_LIMIT);
    input
}

fn change(draws: &mut Draws, input: &mut Vec<u8>, kept: &[Vec<u8>], words: &[&str]) {
    if input.is_empty() {
        input.extend_from_slice(draws.pick::<Vec<u8>>(kept));
        return;
    }
    let place = draws.below(input.len());
    match draws.below(12) {
        0 => input[place] ^= 1 << draws.below(8),
        1 => input[place] = draws.next() as u8,
        2 => {
            // Overwrites bytes with a binary number, aligned or not.
            let size = [1, 2, 4, 8][draws.below(4)];
            let number = draws.pick(NUMBERS).wrapping_add(draws.below(3) as u64).wrapping_sub(1);
            let mut bytes = number.to_le_bytes()[..size].to_vec();
            if draws.below(2) == 0 {
                bytes.reverse();
            }
            let end = (place + size).min(input.len());
            input[place..end].copy_from_slice(&bytes[..end - place]);
        }
        3 => {
            let end = (place + 1 + draws.below(16)).min(input.len());
            input.drain(place..end);
        }
        4 => {
            let end = (place + 1 + draws.below(64)).min(input.len());
            let piece = input[place..end].to_vec();
            let at = draws.below(input.len() + 1);
            input.splice(at..at, piece);
        }
        5 => {
            let other = draws.pick(kept);
            if !other.is_empty() {
                let start = draws.below(other.len());
                let end = (start + 1 + draws.below(128)).min(other.len());
                input.splice(place..(place + draws.below(128)).min(input.len()), other[start..end].to_vec());
            }
        }
        6 => input.truncate(place),
        7 | 8 => {
            // Replaces a number in a text.
            let is_digit = |byte: &u8| byte.is_ascii_digit();
            if let Some(start) = (place..input.len()).find(|at| is_digit(&input[*at])) {
                let end = (start..input.len()).find(|at| !is_digit(&input[*at])).unwrap_or(input.len());
                let number = match draws.below(3) {
                    0 => draws.below(100).to_string(),
                    1 => draws.next().to_string(),
                    _ => (*draws.pick(TEXT_NUMBERS)).to_owned(),
                };
                input.splice(start..end, number.into_bytes());
            }
        }
        9 => {
            let byte = draws.next() as u8;
            let count = 1 + draws.below(300);
            input.splice(place..place, std::iter::repeat_n(byte, count));
        }
        _ => {
            let word = if words.is_empty() { &"0" } else { draws.pick(words) };
            let end = if draws.below(2) == 0 { place } else { (place + word.len()).min(input.len()) };
            input.splice(place..end, word.bytes());
        }
    }
}
