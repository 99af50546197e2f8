//! A plain `f64` tracer that follows the book step by step, without any of this program's optimisations. Steps that
//! readers get wrong are functions that a mistake can replace; what the book leaves to a stage's rules is a rule here,
//! too.

use crate::job::recipe::Recipe;
use crate::job::render::Viewport;
use crate::kernel::sampling::pcg4d;
use crate::scene::{Look, Scene, Sphere};
use crate::stages::{BOOK_T_MIN, DielectricLaws, Diffuse, Rules, Shading};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

/// A direction, from two random vectors, the normal and the point.
type Scatter = fn([DVec3; 2], DVec3, DVec3) -> DVec3;

/// The replaceable steps.
#[derive(Clone, Copy, Debug)]
pub struct Steps {
    /// Number of the sequence of random numbers that a pixel uses.
    pub random: fn(u32) -> u32,
    /// The first picture's colour, from column and row as shares of the last ones, and of the whole sides.
    pub gradient: fn([f64; 2], [f64; 2]) -> DVec3,
    /// Width of the square over which the samples of a pixel are spread, pixels.
    pub filter: f64,
    /// Minimum distance of a hit; `None` for the stage's.
    pub t_min: Option<f64>,
    /// Upper limit on a hit's distance, given the closest hit so far.
    pub t_max: fn(f64) -> f64,
    /// The distances of a sphere's two surfaces, from `a`, `h` and `c` of the quadratic; NaN if there are none.
    pub roots: fn(f64, f64, f64) -> [f64; 2],
    /// The distance of the hit, from these two and the interval of valid ones.
    pub root: fn([f64; 2], [f64; 2]) -> Option<f64>,
    /// The vector by which a ray moves along its direction in one unit of distance.
    pub along: fn(DVec3) -> DVec3,
    /// How far a bounced ray starts above the surface, scene units.
    pub lift: f64,
    /// Outward normal, from the vector centre to point and the radius.
    pub normal: fn(DVec3, f64) -> DVec3,
    /// Whether a ray with this direction meets the front of a surface with this outward normal.
    pub is_front: fn(DVec3, DVec3) -> bool,
    /// The colour of a normal where normals are shown.
    pub normal_colour: fn(DVec3) -> DVec3,
    /// The height of a direction in the sky's gradient, 0 to 1; that of the ray, and that of the camera's ray.
    pub sky: fn(DVec3, DVec3) -> f64,
    /// The value of a sample that is added to its pixel.
    pub sample: fn(DVec3) -> DVec3,
    /// The random vector of matte surfaces, which should be a unit vector.
    pub vector: fn(&mut Random) -> DVec3,
    /// The random vector of fuzz, likewise.
    pub fuzz: fn(&mut Random) -> DVec3,
    /// The direction from a matte surface; `None` for the stage's.
    pub scatter: Option<Scatter>,
    /// The light that a bounce off a surface of this albedo adds, and the factor of the light from later bounces.
    pub combine: fn(DVec3) -> [DVec3; 2],
    /// How many times a reflection subtracts the component along the normal: 2 in the book.
    pub reflects: f64,
    /// The reflected direction before fuzz is added, from what `reflect` returned and the incoming direction.
    pub before_fuzz: fn(DVec3, DVec3) -> DVec3,
    /// Whether a direction below the surface of metal ends the path.
    pub absorbs_below: bool,
    /// Transforms the incoming direction before glass refracts or reflects it.
    pub before_glass: fn(DVec3) -> DVec3,
    /// Probability that glass reflects, from the cosine and the ratio of the refraction indices.
    pub reflectance: fn(f64, f64) -> f64,
    /// The length of a refracted direction's component along the normal, from its square; negative means outwards.
    pub inwards: fn(f64) -> f64,
    /// Attenuation of glass.
    pub glass: DVec3,
    /// Whether glass refracts where it should reflect, and reflects where it should refract.
    pub swaps_glass: bool,
    /// The point of the lens, of radius 1, from two random numbers.
    pub disk: fn([f64; 2]) -> [f64; 2],
    /// Origin and direction of a ray, from the eye, the point on the lens and the target in the plane in focus.
    pub lens: fn(DVec3, DVec3, DVec3) -> [DVec3; 2],
}

impl Steps {
    pub const OF_THE_BOOK: Steps = Steps {
        random: |pixel| pixel,
        gradient: |[x, y], _| DVec3::new(x, y, 0.0),
        filter: 1.0,
        t_min: None,
        t_max: |closest_so_far| closest_so_far,
        roots: |a, h, c| {
            let discriminant = h * h - a * c;
            if discriminant < 0.0 {
                return [f64::NAN; 2];
            }
            let sqrtd = discriminant.sqrt();
            [(h - sqrtd) / a, (h + sqrtd) / a]
        },
        root: |roots, interval| roots.into_iter().find(|root| surrounds(interval, *root)),
        along: |direction| direction,
        lift: 0.0,
        normal: |to_point, radius| to_point / radius,
        is_front: |direction, outward| direction.dot(outward) < 0.0,
        normal_colour: |normal| 0.5 * (normal + 1.0),
        sky: |direction, _| 0.5 * (direction.normalize().y + 1.0),
        sample: |light| light,
        vector: Random::unit_vector,
        fuzz: Random::unit_vector,
        scatter: None,
        combine: |albedo| [DVec3::ZERO, albedo],
        reflects: 2.0,
        before_fuzz: |reflected, _| reflected.normalize(),
        absorbs_below: true,
        before_glass: DVec3::normalize,
        reflectance: schlick,
        inwards: |square| square.abs().sqrt(),
        glass: DVec3::ONE,
        swaps_glass: false,
        disk: |[u, v]| on_circle(u.sqrt(), v),
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
    pub fn pair(&mut self) -> [f64; 2] {
        self.counter += 1;
        let [a, b, ..] = pcg4d([self.counter, self.sequence, 0x1D1E, 0xC4EC]);
        [a, b].map(|bits| f64::from(bits) / 4_294_967_296.0)
    }

    /// Marsaglia's method, which needs neither sines nor cosines.
    pub fn unit_vector(&mut self) -> DVec3 {
        loop {
            let [x, y] = self.pair().map(|x| 2.0 * x - 1.0);
            let square = x * x + y * y;
            if square < 1.0 {
                let stretch = 2.0 * (1.0 - square).sqrt();
                return DVec3::new(stretch * x, stretch * y, 1.0 - 2.0 * square);
            }
        }
    }

    pub fn in_unit_sphere(&mut self) -> DVec3 {
        let unit = self.unit_vector();
        self.pair()[0].cbrt() * unit
    }

    /// Three numbers in `0..1`.
    pub fn triple(&mut self) -> DVec3 {
        let ([x, y], [z, _]) = (self.pair(), self.pair());
        DVec3::new(x, y, z)
    }
}

/// The point on a circle at `turn` of a whole turn.
pub fn on_circle(radius: f64, turn: f64) -> [f64; 2] {
    let (sin, cos) = (std::f64::consts::TAU * turn).sin_cos();
    [radius * cos, radius * sin]
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
    /// The tracer of a picture, whose pixels each stand for `factor` x `factor` of the reader's.
    pub fn new(recipe: &'a Recipe, steps: Steps, viewport: &Viewport, factor: u32) -> Self {
        let Recipe { camera, settings, rules, .. } = recipe;
        let size @ [width, height] = [settings.width, settings.height];
        let focus = camera.effective_focus_distance();
        let viewport_height = 2.0 * (camera.vfov_degrees.to_radians() / 2.0).tan() * focus;
        let basis = camera.basis();
        let across = basis.u * viewport_height * f64::from(width) / f64::from(height);
        let down = -basis.v * viewport_height;
        let Viewport { scale, shift } = viewport;
        let middle = camera.look_from - focus * basis.w + shift[0] * across + shift[1] * down;
        let (across, down) = (across * scale[0], down * scale[1]);
        let corner = middle - (across + down) / 2.0;
        let (across, down) = (across / f64::from(width), down / f64::from(height));
        let radius = focus * (camera.defocus_angle_degrees.to_radians() / 2.0).tan();
        let t_min = rules.surface.smallest_distance().unwrap_or(BOOK_T_MIN);
        Tracer {
            scene: &recipe.scene,
            rules: *rules,
            max_depth: settings.max_depth,
            size,
            center: camera.look_from,
            first_pixel: corner + (across + down) / 2.0,
            across,
            down,
            lens: (radius > 0.0).then(|| [basis.u * radius, basis.v * radius]),
            t_min: steps.t_min.unwrap_or(t_min),
            steps: Steps { filter: (steps.filter - 1.0) / f64::from(factor) + 1.0, ..steps },
        }
    }

    /// Mean and variance of these samples of each pixel: linear RGB, row by row from the top; NaN where `mask` leaves a
    /// pixel out, and after `stop` is set.
    pub fn moments(
        &self,
        samples: Range<u32>,
        mask: Option<&[bool]>,
        stop: &AtomicBool,
    ) -> Vec<[[f64; 3]; 2]> {
        let [width, height] = self.size;
        let pixel = |pixel: u32| {
            if mask.is_some_and(|mask| !mask[pixel as usize]) || stop.load(Ordering::Relaxed) {
                return [[f64::NAN; 3]; 2];
            }
            let sequence = (self.steps.random)(pixel);
            let (mut sum, mut square, mut count) = (DVec3::ZERO, DVec3::ZERO, 0.0_f64);
            for sample in samples.clone() {
                // Each has its own numbers, so that paths which a mistake does not change stay equal.
                let mut random = Random { counter: sample << 10, sequence };
                let value = (self.steps.sample)(self.sample(pixel % width, pixel / width, &mut random));
                if value.is_finite() {
                    sum += value;
                    square += value * value;
                    count += 1.0;
                }
            }
            let count = count.max(1.0);
            let mean = sum / count;
            let variance = (square / count - mean * mean) * (count / (count - 1.0).max(1.0));
            let variance = variance.max(DVec3::ZERO);
            [mean, variance].map(|of| of.to_array())
        };
        (0..width * height).into_par_iter().with_min_len(64).map(pixel).collect()
    }

    pub fn width(&self) -> usize {
        self.size[0] as usize
    }

    /// The sphere that the middle of each pixel shows; `None` for the sky.
    pub fn spheres(&self) -> Vec<Option<&'a Sphere>> {
        let [width, height] = self.size;
        let target = |pixel: u32| {
            self.first_pixel + f64::from(pixel % width) * self.across + f64::from(pixel / width) * self.down
        };
        let ray = |pixel: u32| Ray { origin: self.center, direction: target(pixel) - self.center };
        (0..width * height).map(|pixel| Some(self.nearest(&ray(pixel))?.1)).collect()
    }

    fn sample(&self, column: u32, row: u32, random: &mut Random) -> DVec3 {
        if self.rules.shading == Shading::ImageGradient {
            let share = |less: u32| {
                let of = |at: u32, side: u32| f64::from(at) / f64::from((side - less).max(1));
                [of(column, self.size[0]), of(row, self.size[1])]
            };
            return (self.steps.gradient)(share(1), share(0));
        }
        let offset = if self.rules.antialiasing {
            random.pair().map(|x| (x - 0.5) * self.steps.filter)
        } else {
            [0.0; 2]
        };
        let target = self.first_pixel
            + (f64::from(column) + offset[0]) * self.across
            + (f64::from(row) + offset[1]) * self.down;
        let on_lens = self.lens.map_or(self.center, |lens| {
            let [x, y] = (self.steps.disk)(random.pair());
            self.center + x * lens[0] + y * lens[1]
        });
        let [origin, direction] = (self.steps.lens)(self.center, on_lens, target);
        self.colour(Ray { origin, direction }, column, random)
    }

    fn colour(&self, mut ray: Ray, column: u32, random: &mut Random) -> DVec3 {
        let (mut light, mut throughput, seen) = (DVec3::ZERO, DVec3::ONE, ray.direction);
        for _ in 0..self.max_depth {
            let Some(hit) = self.hit(&ray) else { return light + throughput * self.sky(ray.direction, seen) };
            match self.rules.shading {
                Shading::FirstHitRed => return DVec3::X,
                Shading::Normals => return (self.steps.normal_colour)(hit.normal),
                Shading::Path | Shading::ImageGradient => {}
            }
            let Some((attenuation, direction)) = self.scatter(&ray, &hit, random) else {
                return light;
            };
            let strip = [0.1, 0.3, 0.5, 0.7, 0.9][(column * 5 / self.size[0]).min(4) as usize];
            let attenuation = if self.rules.reflectance_strips { DVec3::splat(strip) } else { attenuation };
            let [added, factor] = (self.steps.combine)(attenuation);
            light += throughput * added;
            throughput *= factor;
            ray = Ray { origin: hit.point + self.steps.lift * hit.normal, direction };
        }
        light
    }

    fn sky(&self, direction: DVec3, seen: DVec3) -> DVec3 {
        self.scene.sky.bottom.lerp(self.scene.sky.top, (self.steps.sky)(direction, seen))
    }

    fn nearest(&self, ray: &Ray) -> Option<(f64, &'a Sphere)> {
        let mut found = None;
        for sphere in &self.scene.spheres {
            let closest_so_far = found.map_or(f64::INFINITY, |(t, _)| t);
            if let Some(t) = self.root(sphere, ray, (self.steps.t_max)(closest_so_far)) {
                found = Some((t, sphere));
            }
        }
        found
    }

    fn hit(&self, ray: &Ray) -> Option<Hit> {
        let (t, sphere) = self.nearest(ray)?;
        let point = ray.origin + t * (self.steps.along)(ray.direction);
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
        (self.steps.root)((self.steps.roots)(a, h, c), [self.t_min, t_max])
    }

    fn scatter(&self, ray: &Ray, hit: &Hit, random: &mut Random) -> Option<(DVec3, DVec3)> {
        let material = &self.scene.materials[hit.material].material;
        let attenuation = material.albedo().unwrap_or(self.steps.glass);
        match material.look() {
            Look::Matte => Some((attenuation, self.diffuse(hit, random))),
            Look::Mirror { fuzz } => {
                let reflected =
                    (self.steps.before_fuzz)(self.reflect(ray.direction, hit.normal), ray.direction);
                let direction = reflected + fuzz * (self.steps.fuzz)(random);
                let is_absorbed = self.steps.absorbs_below && direction.dot(hit.normal) <= 0.0;
                (!is_absorbed).then_some((attenuation, direction))
            }
            Look::Glass { refraction_index } => {
                let ratio = if hit.is_front { 1.0 / refraction_index } else { refraction_index };
                Some((attenuation, self.refract_or_reflect(ray, hit.normal, ratio, random)))
            }
        }
    }

    fn diffuse(&self, hit: &Hit, random: &mut Random) -> DVec3 {
        let vector = (self.steps.vector)(random);
        if let Some(scatter) = self.steps.scatter {
            return scatter([vector, (self.steps.vector)(random)], hit.normal, hit.point);
        }
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
                ratio * sin_theta > 1.0 || (self.steps.reflectance)(cos_theta, ratio) > random.pair()[0]
            }
        };
        if reflects != self.steps.swaps_glass {
            return self.reflect(direction, normal);
        }
        let across = ratio * (direction + cos_theta * normal);
        across - (self.steps.inwards)(1.0 - across.length_squared()) * normal
    }

    fn reflect(&self, v: DVec3, normal: DVec3) -> DVec3 {
        v - self.steps.reflects * v.dot(normal) * normal
    }
}

/// Whether a distance is inside the interval of valid ones.
pub fn surrounds([min, max]: [f64; 2], root: f64) -> bool {
    min < root && root < max
}

pub fn schlick(cosine: f64, ratio: f64) -> f64 {
    reflectance(((1.0 - ratio) / (1.0 + ratio)).powi(2), cosine, 5)
}

/// Schlick's approximation from the reflectance `r0` at normal incidence.
pub fn reflectance(r0: f64, cosine: f64, power: i32) -> f64 {
    r0 + (1.0 - r0) * (1.0 - cosine).powi(power)
}
