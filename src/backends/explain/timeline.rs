//! What each lane of a packet does, step by step.

use crate::kernel::path_record::PathRecord;
use crate::scene::{Look, Scene};

/// The activity of a lane in one step of its packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activity {
    /// Traces a ray from the camera.
    Camera,
    /// Traces a ray that a matte surface scattered.
    Matte,
    /// Traces a ray that a metal, or a similar surface, reflected.
    Metal,
    /// Traces a ray that glass reflected or refracted.
    Glass,
    /// Waits for the other lanes.
    Waits,
}

/// The steps of a packet: a row per lane, all equally long.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Timeline {
    pub lanes: Vec<Vec<Activity>>,
}

impl Timeline {
    pub fn len(&self) -> usize {
        self.lanes.first().map_or(0, Vec::len)
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Share of lanes that trace, `0..=1`, over all steps.
    pub fn share_at_work(&self) -> f64 {
        let all = (self.len() * self.lanes.len()).max(1);
        let waiting = self.lanes.iter().flatten().filter(|activity| **activity == Activity::Waits).count();
        1.0 - waiting as f64 / all as f64
    }
}

/// Lays out the paths of each lane over time as a packet traces them. With `refill`, a lane starts its next path at
/// once; otherwise all lanes start their next paths when the longest has ended. `paths` holds each lane's paths in
/// order, recorded from a job with this `scene`.
pub fn timeline(scene: &Scene, paths: &[Vec<PathRecord>], refill: bool) -> Timeline {
    let rays = |path: &PathRecord| -> Vec<Activity> {
        let after = |ray: usize| match path.rays[ray].hit {
            Some(hit) => match scene.material_of(&scene.spheres[hit.sphere]).look() {
                Look::Matte => Activity::Matte,
                Look::Mirror { .. } => Activity::Metal,
                Look::Glass { .. } => Activity::Glass,
            },
            None => Activity::Camera,
        };
        (0..path.rays.len()).map(|ray| if ray == 0 { Activity::Camera } else { after(ray - 1) }).collect()
    };
    let mut lanes: Vec<Vec<Activity>> = vec![Vec::new(); paths.len()];
    let rounds = paths.iter().map(Vec::len).max().unwrap_or_default();
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

/// Makes all lanes wait for the longest.
fn even_out(lanes: &mut [Vec<Activity>]) {
    let longest = lanes.iter().map(Vec::len).max().unwrap_or_default();
    lanes.iter_mut().for_each(|lane| lane.resize(longest, Activity::Waits));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::path_record::{RecordedHit, RecordedRay};
    use crate::scene::Material;
    use glam::DVec3;

    /// A path that meets these spheres, then the sky.
    fn path(spheres: &[usize]) -> PathRecord {
        let hit = |sphere| RecordedHit { sphere, distance: 1.0, position: Some([0.0; 3]) };
        let ray =
            |hit| RecordedRay { origin: [0.0; 3], direction: [0.0, 0.0, 1.0], throughput: [1.0; 3], hit };
        let hits = spheres.iter().map(|sphere| Some(hit(*sphere))).chain([None]);
        PathRecord { rays: hits.map(ray).collect(), radiance: [1.0; 3] }
    }

    /// Lanes with a letter for each step: `c`amera, matte, metal, glass as 0, 1, 2, and `-` for waiting.
    fn drawn(timeline: &Timeline) -> Vec<String> {
        let letter = |activity: &Activity| match activity {
            Activity::Camera => 'c',
            Activity::Matte => '0',
            Activity::Metal => '1',
            Activity::Glass => '2',
            Activity::Waits => '-',
        };
        timeline.lanes.iter().map(|lane| lane.iter().map(letter).collect()).collect()
    }

    #[test]
    fn lanes_wait_after_each_path_or_only_at_the_end() {
        let mut scene = Scene::default();
        let albedo = DVec3::ONE;
        for material in [
            Material::Lambertian { albedo },
            Material::Metal { albedo, fuzz: 0.0 },
            Material::Dielectric { refraction_index: 1.5 },
        ] {
            let material = scene.add_material("m", material);
            scene.add_sphere(DVec3::ZERO, 1.0, material);
        }
        let paths = [vec![path(&[0, 1]), path(&[])], vec![path(&[2]), path(&[0]), path(&[])]];
        let plain = timeline(&scene, &paths, false);
        assert_eq!(drawn(&plain), ["c01c--", "c2-c0c"]);
        assert_eq!((plain.len(), plain.is_empty(), plain.share_at_work()), (6, false, 0.75));
        let refilled = timeline(&scene, &paths, true);
        assert_eq!(drawn(&refilled), ["c01c-", "c2c0c"]);
        assert_eq!(refilled.share_at_work(), 0.9);
        let none = timeline(&scene, &[], true);
        assert_eq!((none.len(), none.is_empty(), none.share_at_work()), (0, true, 1.0));
    }
}
