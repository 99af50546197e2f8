//! Rays from the camera. (Book 1, sections 12 and 13.)
//!
//! Twin: shaders/camera.wgsl

use super::lanes::{Float, Lanes, V3, Wide, load3};
use crate::kernel::CameraTable;

/// Where a ray starts and its direction, which is not normalised.
pub struct CameraRays<L: Lanes> {
    /// A point on the lens.
    pub origin: V3<L::F>,
    /// Passes through the pixel's sample position.
    pub direction: V3<L::F>,
}

/// Position of a pixel's left or upper edge on the plane at distance 1.
#[inline(always)]
pub fn screen<L: Lanes>(l: L, camera: &CameraTable<Wide<L::Real>>, x: L::F, y: L::F) -> [L::F; 2] {
    [
        x.mul_add(l.load(&camera.scale_x), l.load(&camera.offset[0])),
        y.mul_add(l.load(&camera.scale_y), l.load(&camera.offset[1])),
    ]
}

/// Rays from the eye through the point `jitter` (each component in `[0, 1)`) of the pixel at `corner`.
#[inline(always)]
pub fn pinhole_ray<L: Lanes>(
    l: L,
    camera: &CameraTable<Wide<L::Real>>,
    corner: [L::F; 2],
    jitter: [L::F; 2],
) -> CameraRays<L> {
    let sx = jitter[0].mul_add(l.load(&camera.scale_x), corner[0]);
    let sy = jitter[1].mul_add(l.load(&camera.scale_y), corner[1]);
    CameraRays { origin: load3(l, &camera.eye), direction: through(l, camera, sx, sy) }
}

/// Like [`pinhole_ray`], but from the point `on_lens` of the unit disk.
#[inline(always)]
pub fn lens_ray<L: Lanes>(
    l: L,
    camera: &CameraTable<Wide<L::Real>>,
    corner: [L::F; 2],
    jitter: [L::F; 2],
    on_lens: [L::F; 2],
) -> CameraRays<L> {
    let (tau, radius) = (l.load(&camera.tau), l.load(&camera.lens_radius));
    let sx = jitter[0].mul_add(l.load(&camera.scale_x), corner[0]);
    let sy = jitter[1].mul_add(l.load(&camera.scale_y), corner[1]);
    let direction = through(l, camera, tau.neg_mul_add(on_lens[0], sx), tau.neg_mul_add(on_lens[1], sy));
    let origin = load3(l, &camera.u).mul_add(radius * on_lens[0], load3(l, &camera.eye));
    CameraRays { origin: load3(l, &camera.v).mul_add(radius * on_lens[1], origin), direction }
}

#[inline(always)]
fn through<L: Lanes>(l: L, camera: &CameraTable<Wide<L::Real>>, sx: L::F, sy: L::F) -> V3<L::F> {
    let (u, v, w) = (load3(l, &camera.u), load3(l, &camera.v), load3(l, &camera.w));
    u.mul_add(sx, V3 { x: v.x.mul_sub(sy, w.x), y: v.y.mul_sub(sy, w.y), z: v.z.mul_sub(sy, w.z) })
}
