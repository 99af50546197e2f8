//! From a recipe to a checked job, and the files in between: scene files, pictures, saved films.

pub mod output;
pub mod recipe;
pub mod render;
pub mod saved;
