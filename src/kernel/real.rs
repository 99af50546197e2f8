//! The precisions of records.

/// A number of a record: `f32`, or `f64` for the reference.
pub trait Real: Copy + Default + Send + Sync + PartialOrd + std::fmt::Debug + 'static {
    /// The nearest number of this precision.
    fn from_f64(x: f64) -> Self;
    /// Without loss.
    fn to_f64(self) -> f64;
    /// With the other sign.
    fn negated(self) -> Self;
}

impl Real for f32 {
    #[inline(always)]
    fn from_f64(x: f64) -> Self {
        x as f32
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    #[inline(always)]
    fn negated(self) -> Self {
        -self
    }
}

impl Real for f64 {
    #[inline(always)]
    fn from_f64(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
    #[inline(always)]
    fn negated(self) -> Self {
        -self
    }
}
