//! One path, ray by ray, as plain data.

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordedHit {
    pub sphere: usize,
    /// Along the ray, scene units.
    pub distance: f64,
    /// Where the path continued; `None` if it ended.
    pub position: Option<[f64; 3]>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordedRay {
    pub origin: [f64; 3],
    pub direction: [f64; 3],
    /// Factor by which light along the ray contributes to the pixel, linear RGB.
    pub throughput: [f64; 3],
    /// `None` if the ray left the scene.
    pub hit: Option<RecordedHit>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct PathRecord {
    /// In order; at least one, unless the stage traces no rays.
    pub rays: Vec<RecordedRay>,
    /// The sample's contribution to the pixel, linear RGB; black if it was rejected.
    pub radiance: [f64; 3],
}
