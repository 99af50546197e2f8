//! The camera in the form that kernels read.

use super::rounded;
use crate::job::render::Viewport;
use crate::kernel::{CameraTable, Real};
use crate::scene::Camera;
use glam::DVec3;

impl<R: Real> CameraTable<R> {
    /// Coordinates are relative to `origin`.
    pub fn new(camera: &Camera, viewport: &Viewport, [width, height]: [u32; 2], origin: DVec3) -> Self {
        let Viewport { scale: [scale_x, scale_y], shift: [right, down] } = viewport;
        let basis = camera.basis();
        let half_height = (camera.vfov_degrees.to_radians() / 2.0).tan();
        let half_width = half_height * f64::from(width) / f64::from(height);
        let tau = camera.defocus_tangent();
        CameraTable {
            eye: rounded(camera.look_from - origin),
            tau: R::from_f64(tau),
            u: rounded(basis.u),
            lens_radius: R::from_f64(camera.lens_radius()),
            v: rounded(basis.v),
            scale_x: R::from_f64(2.0 * half_width / f64::from(width) * scale_x),
            w: rounded(basis.w),
            scale_y: R::from_f64(-2.0 * half_height / f64::from(height) * scale_y),
            offset: [half_width * (2.0 * right - scale_x), half_height * (scale_y - 2.0 * down)]
                .map(R::from_f64),
            size: [width, height].map(|pixels| R::from_f64(f64::from(pixels))),
        }
    }
}
