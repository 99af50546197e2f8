//! The floating-point precisions of records.

/// A number in a record: `f32`, or `f64` for the reference.
pub trait Real: Copy + Default + Send + Sync + PartialOrd + std::fmt::Debug + 'static {
    /// Rounds to nearest.
    fn from_f64(x: f64) -> Self;
    /// Lossless.
    fn to_f64(self) -> f64;
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
}
