//! From a recipe to a checked job, and the files in between: scene files, pictures, saved films, plans.

pub mod output;
pub mod plan;
pub mod recipe;
pub mod render;
pub mod saved;
