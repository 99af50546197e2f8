//! What each lane of a packet does, step by step.

use crate::record::PathRecord;
use crate::scene::{Material, Scene};

/// What a lane does in one step of its packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activity {
    /// Traces a ray from the camera.
    Camera,
    /// Traces a ray that a matte surface scattered.
    Matte,
    /// Traces a ray that a metal reflected.
    Metal,
    /// Traces a ray that glass reflected or refracted.
    Glass,
    /// Waits for the other lanes.
    Waits,
}

/// The steps of a packet: a row per lane, all equally long.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Timeline {
    /// What each lane does in each step.
    pub lanes: Vec<Vec<Activity>>,
}

impl Timeline {
    /// The number of steps.
    pub fn len(&self) -> usize {
        self.lanes.first().map_or(0, Vec::len)
    }

    /// Whether there are no steps.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The share of lanes at work, `0..=1`, over all steps.
    pub fn share_at_work(&self) -> f64 {
        let all = (self.len() * self.lanes.len()).max(1);
        let waiting = self.lanes.iter().flatten().filter(|activity| **activity == Activity::Waits).count();
        1.0 - waiting as f64 / all as f64
    }
}

/// Lays out the paths of each lane over time, as a packet traces them. With `refill`, a lane starts its next path at
/// once; without it, the lanes start their next paths together when the longest one has ended. `paths` holds each
/// lane's paths in order, recorded from a job with this `scene`.
pub fn timeline(scene: &Scene, paths: &[Vec<PathRecord>], refill: bool) -> Timeline {
    let rays = |path: &PathRecord| -> Vec<Activity> {
        let after = |ray: usize| match path.rays[ray].hit {
            Some(hit) => match scene.materials[scene.spheres[hit.sphere].material].material {
                Material::Lambertian { .. } => Activity::Matte,
                Material::Metal { .. } => Activity::Metal,
                Material::Dielectric { .. } => Activity::Glass,
            },
            None => Activity::Camera,
        };
        (0..path.rays.len()).map(|ray| if ray == 0 { Activity::Camera } else { after(ray - 1) }).collect()
    };
    let mut lanes: Vec<Vec<Activity>> = vec![Vec::new(); paths.len()];
    let rounds = paths.iter().map(Vec::len).max().unwrap_or(0);
    for round in 0..rounds {
        for (lane, paths) in lanes.iter_mut().zip(paths) {
            lane.extend(paths.get(round).into_iter().flat_map(rays));
        }
        if !refill {
            even_out(&mut lanes);
        }
    }
    even_out(&mut lanes);
    Timeline { lanes }
}

/// Lets all lanes wait for the longest.
fn even_out(lanes: &mut [Vec<Activity>]) {
    let longest = lanes.iter().map(Vec::len).max().unwrap_or(0);
    lanes.iter_mut().for_each(|lane| lane.resize(longest, Activity::Waits));
}
