//! How many turns of their loops a driver lets threads make.

use crate::kernel::Features;
use crate::prepared::PreparedScene;
use crate::stages::Surface;

/// Turns of all its loops that a thread of a dispatch makes, its last ray's not included; then it puts its path aside
/// and the next dispatch goes on with it.
///
/// Half of the smallest limit known: llvmpipe ends every loop once the loops of a thread have made 65,535 turns
/// together, those counted twice that two of the 8 threads make which it runs in step.
pub const TURN_LIMIT: u32 = 1 << 15;

/// Turns of one ray's loops over lists. Twin: `turns_over_lists` in shaders/path.wgsl.
pub(super) fn turns_over_lists(features: &Features, prepared: &PreparedScene<f32>) -> u64 {
    let is_in_hierarchy = features.hierarchy && features.surface == Surface::Exact;
    let listed = if is_in_hierarchy { 0 } else { prepared.opaque.len() + prepared.two_root.len() };
    (prepared.anchored.len() + listed) as u64
}
