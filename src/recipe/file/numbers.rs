//! Numbers of a scene file. Integers and fractions of any size are read, so that a number that cannot be used is refused
//! with its limits.

use super::error::Reason;
use serde::de::{self, Visitor};
use serde::{Deserialize, Deserializer};
use std::fmt;

/// A number, written with or without a fraction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Real(pub f64);

/// A number where a whole one is needed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Whole {
    /// A whole number. Those that are too large for the type are its extremes.
    Integer(i128),
    /// A number that is written with a fraction or an exponent.
    Fraction(f64),
}

impl fmt::Display for Whole {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Whole::Integer(number) => write!(f, "{number}"),
            Whole::Fraction(number) => write!(f, "{number:?}"),
        }
    }
}

impl Whole {
    /// The number of the key `what`, which must be whole and within these limits.
    pub(super) fn within(
        self,
        what: &'static str,
        [lowest, highest]: [u64; 2],
        remedy: &'static str,
    ) -> Result<u64, Reason> {
        let number = match self {
            Whole::Integer(number) => u64::try_from(number).ok(),
            Whole::Fraction(_) => None,
        };
        number.filter(|number| (lowest..=highest).contains(number)).ok_or_else(|| {
            let (value, is_whole) = (self.to_string().into(), matches!(self, Whole::Integer(_)));
            Reason::Whole { what, value, is_whole, lowest, highest, remedy }
        })
    }
}

impl<'de> Deserialize<'de> for Real {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Any;
        impl Visitor<'_> for Any {
            type Value = Real;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number")
            }
            fn visit_f64<E: de::Error>(self, number: f64) -> Result<Real, E> {
                Ok(Real(number))
            }
            fn visit_i64<E: de::Error>(self, number: i64) -> Result<Real, E> {
                Ok(Real(number as f64))
            }
            fn visit_u64<E: de::Error>(self, number: u64) -> Result<Real, E> {
                Ok(Real(number as f64))
            }
            fn visit_i128<E: de::Error>(self, number: i128) -> Result<Real, E> {
                Ok(Real(number as f64))
            }
            fn visit_u128<E: de::Error>(self, number: u128) -> Result<Real, E> {
                Ok(Real(number as f64))
            }
        }
        deserializer.deserialize_f64(Any)
    }
}

impl<'de> Deserialize<'de> for Whole {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Any;
        impl Visitor<'_> for Any {
            type Value = Whole;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a whole number")
            }
            fn visit_f64<E: de::Error>(self, number: f64) -> Result<Whole, E> {
                Ok(Whole::Fraction(number))
            }
            fn visit_i64<E: de::Error>(self, number: i64) -> Result<Whole, E> {
                Ok(Whole::Integer(number.into()))
            }
            fn visit_u64<E: de::Error>(self, number: u64) -> Result<Whole, E> {
                Ok(Whole::Integer(number.into()))
            }
            fn visit_i128<E: de::Error>(self, number: i128) -> Result<Whole, E> {
                Ok(Whole::Integer(number))
            }
            fn visit_u128<E: de::Error>(self, number: u128) -> Result<Whole, E> {
                Ok(Whole::Integer(number.try_into().unwrap_or(i128::MAX)))
            }
        }
        deserializer.deserialize_i64(Any)
    }
}
