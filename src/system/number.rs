//! Numbers in messages.

use std::fmt;
use std::ops::Range;

/// A number as messages print it: with an exponent where plain digits would be hard to count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Number(pub f64);

/// Three numbers as messages print them: `[0, 1e300, -0.5]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Numbers(pub [f64; 3]);

/// Absolute values that are printed without an exponent, apart from 0.
const PLAIN: Range<f64> = 1e-4..1e9;

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Number(value) = self;
        if *value == 0.0 || PLAIN.contains(&value.abs()) {
            write!(f, "{value}")
        } else {
            write!(f, "{value:e}")
        }
    }
}

impl fmt::Display for Numbers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.0.map(Number);
        write!(f, "[{x}, {y}, {z}]")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_whatever_their_size() {
        for (value, text) in [
            (0.0, "0"),
            (-1.5, "-1.5"),
            (16384.0, "16384"),
            (1e-4, "0.0001"),
            (9.9e-5, "9.9e-5"),
            (999_999_999.0, "999999999"),
            (1e9, "1e9"),
            (-1e300, "-1e300"),
            (1e-300, "1e-300"),
            (2.5e-9, "2.5e-9"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(Number(value).to_string(), text);
        }
        assert_eq!(Numbers([0.0, 1e300, -0.5]).to_string(), "[0, 1e300, -0.5]");
    }
}
