//! One path, ray by ray, as plain data: what every backend can tell of a sample.

use serde::Serialize;

/// What a ray of a path met.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RecordedHit {
    /// Index of the sphere in the scene.
    pub sphere: usize,
    /// Along the ray, scene units.
    pub distance: f64,
    /// Where the path went on from; `None` where it ended.
    pub position: Option<[f64; 3]>,
}

/// A ray of a path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RecordedRay {
    /// Where it starts, scene units.
    pub origin: [f64; 3],
    /// Where it goes, a unit vector.
    pub direction: [f64; 3],
    /// What light that arrives along it counts for in the pixel, linear RGB.
    pub throughput: [f64; 3],
    /// `None`: it left the scene.
    pub hit: Option<RecordedHit>,
}

/// A path, from the camera on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PathRecord {
    /// Rays in order, at least one unless the stage traces none.
    pub rays: Vec<RecordedRay>,
    /// What the sample adds to the pixel, linear RGB; black also where the sample was rejected.
    pub radiance: [f64; 3],
}
