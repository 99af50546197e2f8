//! The required precision of the arithmetic. Each numbered test is a case of docs/numerics.md with its tolerance;
//! `--nocapture` prints the measured values.
//!
//! Single functions run in lanes of `f32`, with and without fused multiply and add, against closed forms in
//! `f64`; whole pictures run in the widest packets against the `f64` reference, sample by sample. The
//! module [`parity`] tests that the other widths render the same bits.

mod camera;
mod common;
mod film;
mod hierarchy;
mod images;
mod intersection;
mod materials;
mod parity;
mod reflections;
mod sampling;
mod statistics;
mod steep_glass;
mod stiff;
