//! The scene file: a [`Recipe`](super::Recipe) as TOML.
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
//! A file can also have `[render]`, `[sky]` and, for stages, `[rules]`. A sphere may have its material as an inline
//! table. Instead of `[sky]`, `[materials]` and `[[spheres]]`, a file may name a built-in scene, as pictures of many
//! spheres do: `scene = "field:1000000"`. With it comes `scene_mark`, a checksum that shows whether the scene has changed.
//!
//! Scenes of many spheres have a table of them: `spheres = "FILE.csv"`, or the table itself as a string of several lines.
//!
//! ```csv
//! x,y,z,radius,material
//! 0.0,-1000.0,0.0,1000.0,ground
//! ```
//!
//! `[[keyframes]]` move the camera of an animation: each has a `frame` and the keys of `[camera]`.
//!
//! A recipe that is written and read back is the same to the bit, except for its name, which is that of the file.

mod growing;
mod named;
mod read;
mod table;
mod write;

pub use read::{load, parse};
pub use table::inputs;
pub use write::{to_picture_toml, to_toml};
