//! Reads a path that the device recorded.
//!
//! On the device: shaders/record.wgsl

use crate::film::PixelSum;
use crate::kernel::path_record::{PathRecord, RecordedHit, RecordedRay};
use crate::kernel::{GpuRecordHead, GpuRecordedRay, GpuSuspendedPath, NONE, word_count};
use bytemuck::{Pod, Zeroable};
use glam::DVec3;

/// Number of words before those of the suspended path.
pub fn first_suspended(max_depth: u32) -> usize {
    first_of_ray(max_depth as usize)
}

fn first_of_ray(number: usize) -> usize {
    word_count::<GpuRecordHead>() + word_count::<GpuRecordedRay>() * number
}

/// The words for recording the path at `pixel`, including the shader's input.
pub fn words_for([column, row]: [u32; 2], max_depth: u32) -> Vec<u32> {
    let mut words = vec![0; first_suspended(max_depth) + word_count::<GpuSuspendedPath>()];
    let head = GpuRecordHead { column, row, ..GpuRecordHead::default() };
    words[..word_count::<GpuRecordHead>()].copy_from_slice(bytemuck::cast_slice(&[head]));
    words
}

/// Returns whether the path was suspended and the shader must resume it; `rays` becomes the number of rays recorded
/// so far. Returns `None` if the path has not advanced since `rays` were recorded.
pub fn is_suspended(words: &[u32], max_depth: u32, rays: &mut u32) -> Option<bool> {
    if read::<GpuSuspendedPath>(words, first_suspended(max_depth)).state == 0 {
        return Some(false);
    }
    let before = std::mem::replace(rays, read::<GpuRecordHead>(words, 0).ray_count);
    (*rays != before).then_some(true)
}

/// Decodes the path from the words. `scene_index` maps a sphere's number to its index in the scene; positions are
/// relative to `origin`.
pub fn from_words(words: &[u32], max_depth: u32, scene_index: &[u32], origin: DVec3) -> PathRecord {
    let head: GpuRecordHead = read(words, 0);
    let count = head.ray_count.min(max_depth) as usize;
    let rays: Vec<GpuRecordedRay> = (0..count).map(|number| read(words, first_of_ray(number))).collect();
    let vector = |of: [f32; 3]| of.map(f64::from);
    let position = |of: [f32; 3]| (DVec3::from_array(vector(of)) + origin).to_array();
    let recorded = |(number, ray): (usize, &GpuRecordedRay)| RecordedRay {
        origin: position(ray.origin),
        direction: vector(ray.direction),
        throughput: vector(ray.throughput),
        hit: (ray.sphere != NONE).then(|| RecordedHit {
            sphere: scene_index.get(ray.sphere as usize).map_or(usize::MAX, |index| *index as usize),
            distance: f64::from(ray.distance),
            position: rays.get(number + 1).map(|next| position(next.origin)),
        }),
    };
    PathRecord {
        rays: rays.iter().enumerate().map(recorded).collect(),
        radiance: PixelSum(head.sums.map(u64::from)).radiance(),
    }
}

/// The record that begins at word `first`; all zeros if it is not there.
fn read<T: Pod>(words: &[u32], first: usize) -> T {
    let its_words = words.get(first..first + word_count::<T>());
    its_words.map_or_else(Zeroable::zeroed, |its_words| {
        bytemuck::pod_read_unaligned(bytemuck::cast_slice(its_words))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stores a record from the word `first` on.
    fn put<T: Pod>(words: &mut [u32], first: usize, record: T) {
        words[first..first + word_count::<T>()].copy_from_slice(bytemuck::cast_slice(&[record]));
    }

    #[test]
    fn suspended_path_resumes_while_it_advances() {
        let mut words = words_for([7, 5], 4);
        assert_eq!((read::<GpuRecordHead>(&words, 0).column, read::<GpuRecordHead>(&words, 0).row), (7, 5));
        let mut rays = 0;
        assert_eq!((is_suspended(&words, 4, &mut rays), rays), (Some(false), 0));
        put(
            &mut words,
            first_suspended(4),
            GpuSuspendedPath { state: 1 << 16, ..GpuSuspendedPath::default() },
        );
        for ray_count in [2, 3] {
            put(&mut words, 0, GpuRecordHead { ray_count, ..GpuRecordHead::default() });
            assert_eq!((is_suspended(&words, 4, &mut rays), rays), (Some(true), ray_count));
        }
        assert_eq!(is_suspended(&words, 4, &mut rays), None, "it stands still");
        // It has ended, with as many rays as before.
        put(&mut words, first_suspended(4), GpuSuspendedPath::default());
        assert_eq!(is_suspended(&words, 4, &mut rays), Some(false));
    }
}
