//! The scene file: a [`Recipe`] as TOML.
//!
//! ```toml
//! [camera]
//! look_from = [13.0, 2.0, 3.0]
//! look_at = [0.0, 0.0, 0.0]
//! vfov_degrees = 20.0
//!
//! [materials.ground]
//! kind = "lambertian"
//! albedo = [0.5, 0.5, 0.5]
//!
//! [[spheres]]
//! center = [0.0, -1000.0, 0.0]
//! radius = 1000.0
//! material = "ground"
//! ```
//!
//! Besides there are `[render]`, `[sky]` and, for stages, `[rules]`. A sphere may hold its material as an inline
//! table. In place of `[sky]`, `[materials]` and `[[spheres]]` a file may name a built-in scene, as pictures of many
//! spheres do: `scene = "field:1000000"`, and with it `scene_mark`, which tells whether it is still the same.
//!
//! What is written and read back is the same recipe to the bit; its name is the file's and stands not in it.

mod error;
mod named;
mod read;
mod write;

pub use error::{FileError, Reason};
pub use read::{load, parse};
pub use write::{to_picture_toml, to_toml};
