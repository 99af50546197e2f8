//! A plain tracer that follows the book's chapters step by step, in `f64` and without any of this program's speed, so
//! that it can make the mistakes of readers that no scene, camera or rule of a stage expresses. What the book leaves to
//! a rule of the stage is a rule here, too.

use super::mistake::Mistake;
use crate::recipe::Recipe;
use crate::sampling::pcg4d;
use crate::scene::{Camera, Look, Scene, Sphere};
use crate::stages::{DielectricLaws, Diffuse, Rules, Shading};
use glam::DVec3;
use rayon::prelude::*;

/// A ray. As in the book, its direction has any length.
#[derive(Clone, Copy)]
struct Ray {
    origin: DVec3,
    direction: DVec3,
}

struct Hit {
    point: DVec3,
    normal: DVec3,
    is_front_face: bool,
    material: usize,
}

/// Random numbers of one pixel.
struct Random {
    counter: u32,
    pixel: u32,
}

impl Random {
    /// Two numbers in `0..1`.
    fn pair(&mut self) -> [f64; 2] {
        self.counter += 1;
        let [a, b, ..] = pcg4d([self.counter, self.pixel, 0x1D1E, 0xC4EC]);
        [a, b].map(|bits| f64::from(bits) / 4_294_967_296.0)
    }

    fn number(&mut self) -> f64 {
        self.pair()[0]
    }

    /// A point on the unit sphere.
    fn unit_vector(&mut self) -> DVec3 {
        let [u, v] = self.pair();
        let z = 1.0 - 2.0 * u;
        let radius = (1.0 - z * z).max(0.0).sqrt();
        let (sin, cos) = (std::f64::consts::TAU * v).sin_cos();
        DVec3::new(radius * cos, radius * sin, z)
    }

    /// A point on the unit disk.
    fn in_disk(&mut self) -> [f64; 2] {
        let [u, v] = self.pair();
        let (sin, cos) = (std::f64::consts::TAU * v).sin_cos();
        [u.sqrt() * cos, u.sqrt() * sin]
    }
}

/// The camera's frame in the picture plane.
struct View {
    center: DVec3,
    first_pixel: DVec3,
    across: DVec3,
    down: DVec3,
    lens: [DVec3; 2],
}

impl View {
    fn new(camera: &Camera, [width, height]: [u32; 2], mistake: Option<Mistake>) -> View {
        let [columns, rows] = [f64::from(width), f64::from(height)];
        let theta = match mistake {
            Some(Mistake::VfovRadians) => camera.vfov_degrees,
            _ => camera.vfov_degrees.to_radians(),
        };
        let focus = match mistake {
            Some(Mistake::FocusDistanceOne) => 1.0,
            _ => camera.effective_focus_distance(),
        };
        let viewport_height = 2.0 * (theta / 2.0).tan() * focus;
        let ratio = match mistake {
            Some(Mistake::IntegerAspect) => (width / height).max(1).into(),
            _ => columns / rows,
        };
        let basis = camera.basis();
        let (steps_across, steps_down) = match mistake {
            Some(Mistake::WidthLessOne) => (columns - 1.0, rows - 1.0),
            _ => (columns, rows),
        };
        let across = basis.u * viewport_height * ratio;
        let down = -basis.v * viewport_height;
        let corner = camera.look_from - focus * basis.w - (across + down) / 2.0;
        let (across, down) = (across / steps_across.max(1.0), down / steps_down.max(1.0));
        let half = match mistake {
            Some(Mistake::HalfPixelUp) => 0.0,
            Some(Mistake::HalfPixelDown) => 1.0,
            _ => 0.5,
        };
        let radius = focus * (camera.defocus_angle_degrees.to_radians() / 2.0).tan();
        View {
            center: camera.look_from,
            first_pixel: corner + half * (across + down),
            across,
            down,
            lens: [basis.u * radius, basis.v * radius],
        }
    }
}

/// What a picture is made of, with a mistake.
pub struct Tracer<'a> {
    scene: &'a Scene,
    rules: Rules,
    max_depth: u32,
    size: [u32; 2],
    view: View,
    has_lens: bool,
    t_min: f64,
    mistake: Option<Mistake>,
}

impl<'a> Tracer<'a> {
    /// A tracer of `recipe` that makes `mistake`.
    pub fn new(recipe: &'a Recipe, mistake: Option<Mistake>) -> Self {
        let size = [recipe.settings.width, recipe.settings.height];
        let t_min = recipe.rules.surface.smallest_distance().unwrap_or(crate::stages::BOOK_T_MIN);
        Tracer {
            scene: &recipe.scene,
            rules: recipe.rules,
            max_depth: recipe.settings.max_depth,
            size,
            view: View::new(&recipe.camera, size, mistake),
            has_lens: recipe.camera.defocus_angle_degrees > 0.0,
            t_min: if mistake == Some(Mistake::ZeroTMin) { 0.0 } else { t_min },
            mistake,
        }
    }

    fn makes(&self, mistake: Mistake) -> bool {
        self.mistake == Some(mistake)
    }

    /// The means of all pixels, linear RGB, row by row from the top.
    pub fn means(&self, samples: u32) -> Vec<[f64; 3]> {
        let [width, height] = self.size;
        (0..width * height)
            .into_par_iter()
            .with_min_len(256)
            .map(|pixel| {
                let mut random = Random { counter: 0, pixel };
                let (column, row) = (pixel % width, pixel / width);
                let sum: DVec3 = (0..samples).map(|_| self.sample(column, row, &mut random)).sum();
                (sum / f64::from(samples)).to_array()
            })
            .collect()
    }

    fn sample(&self, column: u32, row: u32, random: &mut Random) -> DVec3 {
        let offset = if self.rules.antialiasing { random.pair().map(|x| x - 0.5) } else { [0.0; 2] };
        let view = &self.view;
        let target = view.first_pixel
            + (f64::from(column) + offset[0]) * view.across
            + (f64::from(row) + offset[1]) * view.down;
        let origin = if self.has_lens {
            let [x, y] = random.in_disk();
            view.center + x * view.lens[0] + y * view.lens[1]
        } else {
            view.center
        };
        self.colour(Ray { origin, direction: target - origin }, column, random)
    }

    fn colour(&self, mut ray: Ray, column: u32, random: &mut Random) -> DVec3 {
        let mut throughput = DVec3::ONE;
        for _ in 0..self.max_depth {
            let Some(hit) = self.hit(&ray) else { return throughput * self.sky(ray.direction) };
            match self.rules.shading {
                Shading::FirstHitRed => return DVec3::X,
                Shading::Normals => return 0.5 * (hit.normal + 1.0),
                Shading::Path | Shading::ImageGradient => {}
            }
            let Some((attenuation, direction)) = self.scatter(&ray, &hit, random) else {
                return DVec3::ZERO;
            };
            let strip = [0.1, 0.3, 0.5, 0.7, 0.9][(column * 5 / self.size[0]).min(4) as usize];
            throughput *= if self.rules.reflectance_strips { DVec3::splat(strip) } else { attenuation };
            ray = Ray { origin: hit.point, direction };
        }
        DVec3::ZERO
    }

    fn sky(&self, direction: DVec3) -> DVec3 {
        let a = 0.5 * (direction.normalize().y + 1.0);
        self.scene.sky.bottom.lerp(self.scene.sky.top, a)
    }

    fn hit(&self, ray: &Ray) -> Option<Hit> {
        let mut closest = f64::INFINITY;
        let mut found = None;
        for sphere in &self.scene.spheres {
            let limit = if self.makes(Mistake::LastHitWins) { f64::INFINITY } else { closest };
            if let Some(t) = self.root(sphere, ray, limit) {
                closest = t;
                found = Some((sphere, t));
            }
        }
        let (sphere, t) = found?;
        let point = ray.origin + t * ray.direction;
        let length = if self.makes(Mistake::NormalNotUnit) { 1.0 } else { sphere.radius };
        let outward = (point - sphere.center) / length;
        let is_front_face = self.makes(Mistake::NormalsNotFlipped) || ray.direction.dot(outward) < 0.0;
        let normal = if is_front_face { outward } else { -outward };
        Some(Hit { point, normal, is_front_face, material: sphere.material })
    }

    fn root(&self, sphere: &Sphere, ray: &Ray, limit: f64) -> Option<f64> {
        let to_center = sphere.center - ray.origin;
        let a = ray.direction.length_squared();
        let h = ray.direction.dot(to_center);
        let c = to_center.length_squared() - sphere.radius * sphere.radius;
        let discriminant = h * h - a * c;
        if discriminant < 0.0 {
            return None;
        }
        let h = if self.makes(Mistake::HalfBSign) { -h } else { h };
        let square_root = discriminant.sqrt();
        let is_in = |t: &f64| self.t_min < *t && *t < limit;
        [(h - square_root) / a, (h + square_root) / a].into_iter().find(is_in)
    }

    fn scatter(&self, ray: &Ray, hit: &Hit, random: &mut Random) -> Option<(DVec3, DVec3)> {
        let material = &self.scene.materials[hit.material].material;
        let attenuation = material.albedo().unwrap_or(DVec3::ONE);
        match material.look() {
            Look::Matte => Some((attenuation, self.diffuse(hit, random))),
            Look::Mirror { fuzz } => {
                let reflected = reflect(ray.direction, hit.normal);
                let reflected =
                    if self.makes(Mistake::FuzzUnnormalised) { reflected } else { reflected.normalize() };
                let direction = reflected + fuzz * random.unit_vector();
                (direction.dot(hit.normal) > 0.0).then_some((attenuation, direction))
            }
            Look::Glass { refraction_index } => {
                Some((attenuation, self.refract_or_reflect(ray, hit, refraction_index, random)))
            }
        }
    }

    fn diffuse(&self, hit: &Hit, random: &mut Random) -> DVec3 {
        let unit = random.unit_vector();
        if self.rules.diffuse == Diffuse::Hemisphere {
            return if unit.dot(hit.normal) > 0.0 { unit } else { -unit };
        }
        let length = if self.makes(Mistake::PointInSphere) { random.number().cbrt() } else { 1.0 };
        let direction = hit.normal + length * unit;
        if direction.abs().max_element() < 1e-8 { hit.normal } else { direction }
    }

    fn refract_or_reflect(&self, ray: &Ray, hit: &Hit, index: f64, random: &mut Random) -> DVec3 {
        let is_entering = hit.is_front_face != self.makes(Mistake::IndexInverted);
        let ratio = if is_entering { 1.0 / index } else { index };
        let direction = match self.makes(Mistake::RefractUnnormalised) {
            true => ray.direction,
            false => ray.direction.normalize(),
        };
        let cos_theta = (-direction).dot(hit.normal).min(1.0);
        let sin_theta = (1.0 - cos_theta * cos_theta).max(0.0).sqrt();
        let reflects = match self.rules.dielectric {
            DielectricLaws::RefractOnly => false,
            DielectricLaws::TotalReflection => ratio * sin_theta > 1.0,
            DielectricLaws::Schlick => ratio * sin_theta > 1.0 || schlick(cos_theta, ratio) > random.number(),
        };
        if reflects {
            return reflect(direction, hit.normal);
        }
        let across = ratio * (direction + cos_theta * hit.normal);
        across - (1.0 - across.length_squared()).abs().sqrt() * hit.normal
    }
}

fn reflect(v: DVec3, normal: DVec3) -> DVec3 {
    v - 2.0 * v.dot(normal) * normal
}

fn schlick(cosine: f64, ratio: f64) -> f64 {
    let r0 = ((1.0 - ratio) / (1.0 + ratio)).powi(2);
    r0 + (1.0 - r0) * (1.0 - cosine).powi(5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glass_reflects_a_twenty_fifth_from_above_and_all_at_a_grazing_angle() {
        for ratio in [1.5, 1.0 / 1.5] {
            for (cosine, share) in [(1.0, 0.04), (0.5, 0.04 + 0.96 / 32.0), (0.0, 1.0)] {
                let reflected = schlick(cosine, ratio);
                assert!((reflected - share).abs() < 1e-12, "{reflected} at {cosine}, {ratio}");
            }
        }
    }

    #[test]
    fn random_vectors_lie_where_they_should() {
        let mut random = Random { counter: 0, pixel: 7 };
        let (mut sphere, mut disk, mut squares) = (DVec3::ZERO, [0.0; 2], [0.0; 4]);
        for _ in 0..10_000 {
            let unit = random.unit_vector();
            assert!((unit.length() - 1.0).abs() < 1e-12, "{unit}");
            sphere += unit;
            let [x, y] = random.in_disk();
            assert!(x * x + y * y <= 1.0, "{x} {y}");
            disk = [disk[0] + x, disk[1] + y];
            let all = [unit.x, unit.y, unit.z, x.hypot(y)];
            squares.iter_mut().zip(all).for_each(|(square, x)| *square += x * x);
            assert!((0.0..1.0).contains(&random.number()));
        }
        assert!(sphere.length() < 300.0 && disk[0].hypot(disk[1]) < 300.0, "{sphere} {disk:?}");
        // A third of the unit square on each axis; half of it on a disk.
        for (square, share) in squares.into_iter().zip([3.0, 3.0, 3.0, 2.0]) {
            assert!((square - 1e4 / share).abs() < 150.0, "{squares:?}");
        }
    }
}
