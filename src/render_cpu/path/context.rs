//! What every phase reads: the lanes, the scene, and which code the kernel has.

use crate::kernel::features::KernelFeatures;
use crate::render_cpu::broadcast::BroadcastScene;
use crate::render_cpu::lanes::Lanes;

/// A kernel with the code that `PARTS` selects, and the scene that it traces.
#[derive(Clone, Copy)]
pub(super) struct Context<'scene, L: Lanes, const PARTS: u32> {
    pub l: L,
    pub broadcast: &'scene BroadcastScene<L::Real>,
}

impl<'scene, L: Lanes, const PARTS: u32> Context<'scene, L, PARTS> {
    #[inline(always)]
    pub fn features(self) -> KernelFeatures<'scene, PARTS> {
        self.broadcast.prepared.features.in_kernel()
    }
}
