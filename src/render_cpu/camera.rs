//! Rays from the camera. (Book 1, sections 12 and 13.)
//!
//! Twin: shaders/camera.wgsl

use super::lanes::{Lanes, V3, mul_add3, splat3};
use crate::tables::CameraTable;

/// Where a ray starts and where it goes; the direction's length is not 1.
pub struct CameraRays<L: Lanes> {
    /// On the lens.
    pub origin: V3<L::F>,
    /// Through the pixel.
    pub direction: V3<L::F>,
}

/// A pixel coordinate on the plane at distance 1, left or upper edge.
#[inline(always)]
pub fn screen<L: Lanes>(l: L, camera: &CameraTable<L::Real>, x: L::F, y: L::F) -> [L::F; 2] {
    [
        L::mul_add(x, l.splat(camera.scale[0]), l.splat(camera.offset[0])),
        L::mul_add(y, l.splat(camera.scale[1]), l.splat(camera.offset[1])),
    ]
}

/// Rays from the eye through the point `jitter` (in `[0, 1)` each) of the pixel at `screen`.
#[inline(always)]
pub fn pinhole_rays<L: Lanes>(
    l: L,
    camera: &CameraTable<L::Real>,
    screen: [L::F; 2],
    jitter: [L::F; 2],
) -> CameraRays<L> {
    let sx = L::mul_add(jitter[0], l.splat(camera.scale[0]), screen[0]);
    let sy = L::mul_add(jitter[1], l.splat(camera.scale[1]), screen[1]);
    CameraRays { origin: splat3(l, camera.eye), direction: through(l, camera, sx, sy) }
}

/// The same from the point `on_lens` of the unit disk.
#[inline(always)]
pub fn lens_rays<L: Lanes>(
    l: L,
    camera: &CameraTable<L::Real>,
    screen: [L::F; 2],
    jitter: [L::F; 2],
    on_lens: [L::F; 2],
) -> CameraRays<L> {
    let (tau, radius) = (l.splat(camera.tau), l.splat(camera.focus_tau));
    let sx = L::mul_add(jitter[0], l.splat(camera.scale[0]), screen[0]);
    let sy = L::mul_add(jitter[1], l.splat(camera.scale[1]), screen[1]);
    let direction =
        through(l, camera, L::neg_mul_add(tau, on_lens[0], sx), L::neg_mul_add(tau, on_lens[1], sy));
    let origin = mul_add3::<L>(splat3(l, camera.u), radius * on_lens[0], splat3(l, camera.eye));
    CameraRays { origin: mul_add3::<L>(splat3(l, camera.v), radius * on_lens[1], origin), direction }
}

#[inline(always)]
fn through<L: Lanes>(l: L, camera: &CameraTable<L::Real>, sx: L::F, sy: L::F) -> V3<L::F> {
    let across = mul_add3::<L>(splat3(l, camera.u), sx, splat3(l, camera.v).scale(sy));
    across - splat3(l, camera.w)
}
