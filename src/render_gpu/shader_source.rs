//! The text of the shaders: the declarations from Rust, then the files in order of use.

use crate::kernel;

/// An entry point of the shaders.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EntryPoint {
    /// Traces samples.
    PathTrace,
    /// Converts the film to a picture, for the page.
    Resolve,
}

impl EntryPoint {
    /// All entry points.
    pub const ALL: [EntryPoint; 2] = [EntryPoint::PathTrace, EntryPoint::Resolve];

    /// The entry point's name in the shader.
    pub fn name(self) -> &'static str {
        match self {
            EntryPoint::PathTrace => "path_trace",
            EntryPoint::Resolve => "resolve",
        }
    }

    /// The text that only this entry point has; [`shared`] comes before it.
    pub fn text(self) -> &'static str {
        match self {
            EntryPoint::PathTrace => include_str!("../../shaders/path_trace.wgsl"),
            EntryPoint::Resolve => include_str!("../../shaders/resolve.wgsl"),
        }
    }
}

/// The files with functions and bindings that all entry points share.
const SHARED: [&str; 10] = [
    include_str!("../../shaders/lanes.wgsl"),
    include_str!("../../shaders/rng.wgsl"),
    include_str!("../../shaders/camera.wgsl"),
    include_str!("../../shaders/sphere.wgsl"),
    include_str!("../../shaders/bvh.wgsl"),
    include_str!("../../shaders/bindings.wgsl"),
    include_str!("../../shaders/material.wgsl"),
    include_str!("../../shaders/path.wgsl"),
    include_str!("../../shaders/rules.wgsl"),
    include_str!("../../shaders/suspend.wgsl"),
];

/// The text that all entry points begin with: the declarations from Rust, functions and bindings.
pub fn shared() -> String {
    SHARED.into_iter().fold(kernel::wgsl(), |text, part| text + "\n" + part) + "\n"
}

/// The complete text of a shader.
pub fn source(entry_point: EntryPoint) -> String {
    shared() + entry_point.text()
}
