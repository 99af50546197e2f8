//! The path loop.
//!
//! Packets of rays go through three phases: `intersect` finds the nearest hits; `shade` adds light, ends paths and
//! finds the hit points and random numbers of those that continue; `scatter` spawns the next rays, from the hits or
//! from the camera. `schedule` keeps the lanes full and lets packets take turns. `rules` holds what only early
//! stages of the book need.
//!
//! Twin: shaders/path.wgsl

mod context;
mod draw;
mod intersect;
mod packet;
mod record;
mod records;
mod rules;
mod scatter;
mod schedule;
mod shade;

pub use record::record;
pub use schedule::trace;
