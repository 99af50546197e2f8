//! Reads a path that the device recorded.
//!
//! Twin: shaders/record.wgsl

use crate::film::PixelSum;
use crate::kernel::{ASIDE_STRIDE, NONE, RECORD_HEADER, RECORD_STRIDE};
use crate::record::{PathRecord, RecordedHit, RecordedRay};
use glam::DVec3;

/// Number of words before those in which the path is put aside.
pub fn first_aside(max_depth: u32) -> usize {
    RECORD_HEADER + RECORD_STRIDE * max_depth as usize
}

/// The words for recording the path at `pixel`, including the shader's input.
pub fn words_for([x, y]: [u32; 2], max_depth: u32) -> Vec<u32> {
    let mut words = vec![0; first_aside(max_depth) + ASIDE_STRIDE as usize];
    words[..2].copy_from_slice(&[x, y]);
    words
}

/// Returns whether the path was put aside. If so, prepares the words for the shader to continue the path. Returns
/// `None` if the path has not advanced since `rays` were recorded.
pub fn is_aside(words: &mut [u32], [x, y]: [u32; 2], max_depth: u32, rays: &mut u32) -> Option<bool> {
    // This word is 0 if nothing was put aside.
    const STATE: usize = 11;
    if words.get(first_aside(max_depth) + STATE).is_none_or(|state| *state == 0) {
        return Some(false);
    }
    let recorded = words.first().copied().unwrap_or_default();
    if recorded == *rays {
        return None;
    }
    *rays = recorded;
    words.get_mut(..3)?.copy_from_slice(&[x, y, recorded]);
    Some(true)
}

/// Decodes the path from the words. `scene_index` maps a sphere's number to its index in the scene; positions are
/// relative to `origin`.
pub fn from_words(words: &[u32], scene_index: &[u32], origin: DVec3) -> PathRecord {
    let (header, rays) = words.split_at(RECORD_HEADER.min(words.len()));
    let count = header.first().map_or(0, |count| *count as usize);
    let rays: Vec<&[u32]> = rays.chunks_exact(RECORD_STRIDE).take(count).collect();
    let vector = |three: &[u32]| [0, 1, 2].map(|i| three.get(i).map_or(0.0, |word| float(*word)));
    let position = |three: &[u32]| (DVec3::from_array(vector(three)) + origin).to_array();
    let recorded = |number: usize, ray: &&[u32]| RecordedRay {
        origin: position(&ray[..3]),
        direction: vector(&ray[3..6]),
        throughput: vector(&ray[6..9]),
        hit: (ray[9] != NONE).then(|| RecordedHit {
            sphere: scene_index.get(ray[9] as usize).map_or(usize::MAX, |index| *index as usize),
            distance: float(ray[10]),
            position: rays.get(number + 1).map(|next| position(&next[..3])),
        }),
    };
    let radiance = PixelSum([1, 2, 3].map(|i| header.get(i).copied().map_or(0, u64::from))).radiance();
    PathRecord {
        rays: rays.iter().enumerate().map(|(number, ray)| recorded(number, ray)).collect(),
        radiance,
    }
}

fn float(word: u32) -> f64 {
    f64::from(f32::from_bits(word))
}
