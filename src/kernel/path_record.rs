//! One path, ray by ray, as plain data that every backend can report.

use serde::Serialize;

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RecordedHit {
    pub sphere: usize,
    /// Distance along the ray, scene units.
    pub distance: f64,
    /// The point from which the path continued; `None` if it ended there.
    pub position: Option<[f64; 3]>,
}

/// One ray of a recorded path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RecordedRay {
    pub origin: [f64; 3],
    pub direction: [f64; 3],
    /// Factor by which light arriving along the ray contributes to the pixel, linear RGB.
    pub throughput: [f64; 3],
    /// What the ray hit; `None` if it left the scene.
    pub hit: Option<RecordedHit>,
}

/// A recorded path, starting at the camera.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PathRecord {
    /// The rays in order; at least one, unless the stage traces no rays.
    pub rays: Vec<RecordedRay>,
    /// The sample's contribution to the pixel, linear RGB; black if the sample was rejected.
    pub radiance: [f64; 3],
}
