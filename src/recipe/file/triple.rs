//! Vectors and colours of a scene file.

use super::numbers::Real;
use glam::DVec3;
use serde::de::{self, IgnoredAny, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::fmt;

/// Exactly three numbers.
pub(super) struct Triple(pub DVec3);

impl<'de> Deserialize<'de> for Triple {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Three;
        impl<'de> Visitor<'de> for Three {
            type Value = Triple;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("three numbers, such as [0.0, 1.0, 0.0]")
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut array: A) -> Result<Triple, A::Error> {
                let mut v = DVec3::ZERO;
                for index in 0..3 {
                    let length = || de::Error::invalid_length(index, &self);
                    let Real(number) = array.next_element()?.ok_or_else(length)?;
                    v[index] = number;
                }
                let mut count = 3;
                while array.next_element::<IgnoredAny>()?.is_some() {
                    count += 1;
                }
                if count == 3 { Ok(Triple(v)) } else { Err(de::Error::invalid_length(count, &self)) }
            }
        }
        deserializer.deserialize_seq(Three)
    }
}
