//! Plans: parts of a picture rendered by separate commands, and their merged film.

mod common;
mod info;
mod merging;
mod parts;
mod refused;
mod scripts;
