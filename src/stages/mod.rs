//! The book's chapters as data.

mod rules;

pub use rules::{DielectricLaws, Diffuse, Rules, Shading, Surface, Transfer};
