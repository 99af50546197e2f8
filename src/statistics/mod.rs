//! What the noise of pictures lets one say: tests of equality, fits, distances. Pure functions of numbers.

pub mod blocks;
pub mod fit;
pub mod flip;
pub mod normal;
