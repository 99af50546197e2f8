//! The camera as kernels read it.

use super::{Real, rounded};
use crate::scene::Camera;
use glam::DVec3;

/// The camera in the form that gives a ray with a few multiplications and no difference of far points.
///
/// A pixel position `p` (with the point in the pixel) lies at `s = p scale + offset` on the plane at distance 1.
/// With a point `xi` of the unit disk on the lens, the direction is
/// `(s.x - tau xi.x) u + (s.y - tau xi.y) v - w`, the origin `eye + focus_tau (xi.x u + xi.y v)`.
#[derive(Clone, Copy, Debug)]
pub struct CameraTable<R> {
    /// The eye.
    pub eye: [R; 3],
    /// Right.
    pub u: [R; 3],
    /// Up.
    pub v: [R; 3],
    /// Against the view.
    pub w: [R; 3],
    /// Of x and y.
    pub scale: [R; 2],
    /// Of x and y.
    pub offset: [R; 2],
    /// Tangent of half the defocus angle; 0 without a lens.
    pub tau: R,
    /// Radius of the lens.
    pub focus_tau: R,
}

impl<R: Real> CameraTable<R> {
    /// For a picture of `width` by `height` pixels, with coordinates measured from `origin`.
    pub fn new(camera: &Camera, width: u32, height: u32, origin: DVec3) -> Self {
        let basis = camera.basis();
        let half_height = (camera.vfov_degrees.to_radians() / 2.0).tan();
        let half_width = half_height * f64::from(width) / f64::from(height);
        let tau = (camera.defocus_angle_degrees.to_radians() / 2.0).tan();
        CameraTable {
            eye: rounded(camera.look_from - origin),
            u: rounded(basis.u),
            v: rounded(basis.v),
            w: rounded(basis.w),
            scale: [
                R::from_f64(2.0 * half_width / f64::from(width)),
                R::from_f64(-2.0 * half_height / f64::from(height)),
            ],
            offset: [R::from_f64(-half_width), R::from_f64(half_height)],
            tau: R::from_f64(tau),
            focus_tau: R::from_f64(camera.effective_focus_distance() * tau),
        }
    }
}

impl<R: Copy> CameraTable<R> {
    /// The same in another form of number.
    pub fn map<T>(&self, f: impl Fn(R) -> T) -> CameraTable<T> {
        CameraTable {
            eye: self.eye.map(&f),
            u: self.u.map(&f),
            v: self.v.map(&f),
            w: self.w.map(&f),
            scale: self.scale.map(&f),
            offset: self.offset.map(&f),
            tau: f(self.tau),
            focus_tau: f(self.focus_tau),
        }
    }
}
