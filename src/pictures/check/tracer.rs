//! A plain `f64` tracer that follows the book step by step, without any of this program's optimisations. Steps that
//! readers get wrong are functions that a mistake can replace; what the book leaves to a stage's rules is a rule here,
//! too.

use crate::job::recipe::Recipe;
use crate::kernel::sampling::pcg4d;
use crate::scene::{Look, Scene, Sphere};
use crate::stages::{BOOK_T_MIN, DielectricLaws, Diffuse, Rules, Shading};
use glam::DVec3;
use rayon::prelude::*;

/// The replaceable steps.
#[derive(Clone, Copy, Debug)]
pub struct Steps {
    /// Number of the sequence of random numbers that a pixel uses.
    pub random: fn(u32) -> u32,
    pub aspect: fn(u32, u32) -> f64,
    /// Number of pixel spacings along a side of this many pixels.
    pub spacings: fn(f64) -> f64,
    /// Centre of the first pixel, in pixels from the corner.
    pub first_pixel: f64,
    /// Least distance of a hit; `None` for the stage's.
    pub t_min: Option<f64>,
    /// Upper limit on a hit's distance, given the closest hit so far.
    pub t_max: fn(f64) -> f64,
    /// Both roots of the quadratic, from `a`, `h` and the square root of the discriminant.
    pub roots: fn(f64, f64, f64) -> [f64; 2],
    /// Outward normal, from the vector centre to point and the radius.
    pub normal: fn(DVec3, f64) -> DVec3,
    /// Whether a ray with this direction meets the front of a surface with this outward normal.
    pub is_front: fn(DVec3, DVec3) -> bool,
    /// Offset added to the normal of a matte surface.
    pub diffuse: fn(&mut Random) -> DVec3,
    /// Transforms the reflected direction before fuzz is added.
    pub before_fuzz: fn(DVec3) -> DVec3,
    /// Transforms the incoming direction before glass refracts or reflects it.
    pub before_glass: fn(DVec3) -> DVec3,
    /// Whether glass refracts where it should reflect, and reflects where it should refract.
    pub swaps_glass: bool,
    /// Origin and direction of a ray, from the eye, the point on the lens and the target in the plane in focus.
    pub lens: fn(DVec3, DVec3, DVec3) -> [DVec3; 2],
}

impl Steps {
    pub const OF_THE_BOOK: Steps = Steps {
        random: |pixel| pixel,
        aspect: |width, height| f64::from(width) / f64::from(height),
        spacings: |pixels| pixels,
        first_pixel: 0.5,
        t_min: None,
        t_max: |closest_so_far| closest_so_far,
        roots: |a, h, sqrtd| [(h - sqrtd) / a, (h + sqrtd) / a],
        normal: |to_point, radius| to_point / radius,
        is_front: |direction, outward| direction.dot(outward) < 0.0,
        diffuse: Random::unit_vector,
        before_fuzz: DVec3::normalize,
        before_glass: DVec3::normalize,
        swaps_glass: false,
        lens: |_, on_lens, target| [on_lens, target - on_lens],
    };
}

/// As in the book, the direction need not be normalised.
#[derive(Clone, Copy)]
struct Ray {
    origin: DVec3,
    direction: DVec3,
}

struct Hit {
    point: DVec3,
    normal: DVec3,
    is_front: bool,
    material: usize,
}

/// A sequence of random numbers.
pub struct Random {
    counter: u32,
    sequence: u32,
}

impl Random {
    /// Two numbers in `0..1`.
    fn pair(&mut self) -> [f64; 2] {
        self.counter += 1;
        let [a, b, ..] = pcg4d([self.counter, self.sequence, 0x1D1E, 0xC4EC]);
        [a, b].map(|bits| f64::from(bits) / 4_294_967_296.0)
    }

    fn unit_vector(&mut self) -> DVec3 {
        let [u, v] = self.pair();
        let z = 1.0 - 2.0 * u;
        let radius = (1.0 - z * z).max(0.0).sqrt();
        let (sin, cos) = (std::f64::consts::TAU * v).sin_cos();
        DVec3::new(radius * cos, radius * sin, z)
    }

    pub fn in_unit_sphere(&mut self) -> DVec3 {
        let unit = self.unit_vector();
        self.pair()[0].cbrt() * unit
    }

    fn in_disk(&mut self) -> [f64; 2] {
        let [u, v] = self.pair();
        let (sin, cos) = (std::f64::consts::TAU * v).sin_cos();
        [u.sqrt() * cos, u.sqrt() * sin]
    }
}

pub struct Tracer<'a> {
    scene: &'a Scene,
    rules: Rules,
    max_depth: u32,
    size: [u32; 2],
    center: DVec3,
    first_pixel: DVec3,
    across: DVec3,
    down: DVec3,
    lens: Option<[DVec3; 2]>,
    t_min: f64,
    steps: Steps,
}

impl<'a> Tracer<'a> {
    pub fn new(recipe: &'a Recipe, steps: Steps) -> Self {
        let Recipe { camera, settings, rules, .. } = recipe;
        let size @ [width, height] = [settings.width, settings.height];
        let focus = camera.effective_focus_distance();
        let viewport_height = 2.0 * (camera.vfov_degrees.to_radians() / 2.0).tan() * focus;
        let basis = camera.basis();
        let across = basis.u * viewport_height * (steps.aspect)(width, height);
        let down = -basis.v * viewport_height;
        let corner = camera.look_from - focus * basis.w - (across + down) / 2.0;
        let spacings = |pixels: u32| (steps.spacings)(f64::from(pixels)).max(1.0);
        let (across, down) = (across / spacings(width), down / spacings(height));
        let radius = focus * (camera.defocus_angle_degrees.to_radians() / 2.0).tan();
        let t_min = rules.surface.smallest_distance().unwrap_or(BOOK_T_MIN);
        Tracer {
            scene: &recipe.scene,
            rules: *rules,
            max_depth: settings.max_depth,
            size,
            center: camera.look_from,
            first_pixel: corner + steps.first_pixel * (across + down),
            across,
            down,
            lens: (radius > 0.0).then(|| [basis.u * radius, basis.v * radius]),
            t_min: steps.t_min.unwrap_or(t_min),
            steps,
        }
    }

    /// Pixel means: linear RGB, row by row from the top.
    pub fn means(&self, samples: u32) -> Vec<[f64; 3]> {
        let [width, height] = self.size;
        (0..width * height)
            .into_par_iter()
            .with_min_len(256)
            .map(|pixel| {
                let mut random = Random { counter: 0, sequence: (self.steps.random)(pixel) };
                let (column, row) = (pixel % width, pixel / width);
                let sum: DVec3 = (0..samples).map(|_| self.sample(column, row, &mut random)).sum();
                (sum / f64::from(samples)).to_array()
            })
            .collect()
    }

    fn sample(&self, column: u32, row: u32, random: &mut Random) -> DVec3 {
        let offset = if self.rules.antialiasing { random.pair().map(|x| x - 0.5) } else { [0.0; 2] };
        let target = self.first_pixel
            + (f64::from(column) + offset[0]) * self.across
            + (f64::from(row) + offset[1]) * self.down;
        let on_lens = self.lens.map_or(self.center, |lens| {
            let [x, y] = random.in_disk();
            self.center + x * lens[0] + y * lens[1]
        });
        let [origin, direction] = (self.steps.lens)(self.center, on_lens, target);
        self.colour(Ray { origin, direction }, column, random)
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
        let mut closest_so_far = f64::INFINITY;
        let mut found = None;
        for sphere in &self.scene.spheres {
            if let Some(t) = self.root(sphere, ray, (self.steps.t_max)(closest_so_far)) {
                closest_so_far = t;
                found = Some(sphere);
            }
        }
        let sphere = found?;
        let point = ray.origin + closest_so_far * ray.direction;
        let outward = (self.steps.normal)(point - sphere.center, sphere.radius);
        let is_front = (self.steps.is_front)(ray.direction, outward);
        let normal = if is_front { outward } else { -outward };
        Some(Hit { point, normal, is_front, material: sphere.material })
    }

    fn root(&self, sphere: &Sphere, ray: &Ray, t_max: f64) -> Option<f64> {
        let to_center = sphere.center - ray.origin;
        let a = ray.direction.length_squared();
        let h = ray.direction.dot(to_center);
        let c = to_center.length_squared() - sphere.radius * sphere.radius;
        let discriminant = h * h - a * c;
        if discriminant < 0.0 {
            return None;
        }
        (self.steps.roots)(a, h, discriminant.sqrt()).into_iter().find(|t| self.t_min < *t && *t < t_max)
    }

    fn scatter(&self, ray: &Ray, hit: &Hit, random: &mut Random) -> Option<(DVec3, DVec3)> {
        let material = &self.scene.materials[hit.material].material;
        let attenuation = material.albedo().unwrap_or(DVec3::ONE);
        match material.look() {
            Look::Matte => Some((attenuation, self.diffuse(hit, random))),
            Look::Mirror { fuzz } => {
                let reflected = (self.steps.before_fuzz)(reflect(ray.direction, hit.normal));
                let direction = reflected + fuzz * random.unit_vector();
                (direction.dot(hit.normal) > 0.0).then_some((attenuation, direction))
            }
            Look::Glass { refraction_index } => {
                let ratio = if hit.is_front { 1.0 / refraction_index } else { refraction_index };
                Some((attenuation, self.refract_or_reflect(ray, hit.normal, ratio, random)))
            }
        }
    }

    fn diffuse(&self, hit: &Hit, random: &mut Random) -> DVec3 {
        let vector = (self.steps.diffuse)(random);
        if self.rules.diffuse == Diffuse::Hemisphere {
            return if vector.dot(hit.normal) > 0.0 { vector } else { -vector };
        }
        let direction = hit.normal + vector;
        if direction.abs().max_element() < 1e-8 { hit.normal } else { direction }
    }

    fn refract_or_reflect(&self, ray: &Ray, normal: DVec3, ratio: f64, random: &mut Random) -> DVec3 {
        let direction = (self.steps.before_glass)(ray.direction);
        let cos_theta = (-direction).dot(normal).min(1.0);
        let sin_theta = (1.0 - cos_theta * cos_theta).max(0.0).sqrt();
        let reflects = match self.rules.dielectric {
            DielectricLaws::RefractOnly => false,
            DielectricLaws::TotalReflection => ratio * sin_theta > 1.0,
            DielectricLaws::Schlick => {
                ratio * sin_theta > 1.0 || schlick(cos_theta, ratio) > random.pair()[0]
            }
        };
        if reflects != self.steps.swaps_glass {
            return reflect(direction, normal);
        }
        let across = ratio * (direction + cos_theta * normal);
        across - (1.0 - across.length_squared()).abs().sqrt() * normal
    }
}

fn reflect(v: DVec3, normal: DVec3) -> DVec3 {
    v - 2.0 * v.dot(normal) * normal
}

fn schlick(cosine: f64, ratio: f64) -> f64 {
    let r0 = ((1.0 - ratio) / (1.0 + ratio)).powi(2);
    r0 + (1.0 - r0) * (1.0 - cosine).powi(5)
}
