//! The book's program as a reader writes it, with its own vectors, scenes and random numbers: objects, recursion, one
//! thread. It shares no code with Weekender. Mistakes are named by their ids in `weekender check --json`.

use std::ops::{Add, Mul, Neg, Sub};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vec3(pub f64, pub f64, pub f64);

impl Add for Vec3 {
    type Output = Vec3;
    fn add(self, o: Vec3) -> Vec3 {
        Vec3(self.0 + o.0, self.1 + o.1, self.2 + o.2)
    }
}

impl Sub for Vec3 {
    type Output = Vec3;
    fn sub(self, o: Vec3) -> Vec3 {
        Vec3(self.0 - o.0, self.1 - o.1, self.2 - o.2)
    }
}

impl Neg for Vec3 {
    type Output = Vec3;
    fn neg(self) -> Vec3 {
        Vec3(-self.0, -self.1, -self.2)
    }
}

impl Mul<f64> for Vec3 {
    type Output = Vec3;
    fn mul(self, t: f64) -> Vec3 {
        Vec3(self.0 * t, self.1 * t, self.2 * t)
    }
}

impl Mul for Vec3 {
    type Output = Vec3;
    fn mul(self, o: Vec3) -> Vec3 {
        Vec3(self.0 * o.0, self.1 * o.1, self.2 * o.2)
    }
}

fn dot(a: Vec3, b: Vec3) -> f64 {
    a.0 * b.0 + a.1 * b.1 + a.2 * b.2
}

fn cross(a: Vec3, b: Vec3) -> Vec3 {
    Vec3(a.1 * b.2 - a.2 * b.1, a.2 * b.0 - a.0 * b.2, a.0 * b.1 - a.1 * b.0)
}

fn unit_vector(v: Vec3) -> Vec3 {
    v * (1.0 / dot(v, v).sqrt())
}

/// xorshift64*.
struct Random(u64);

impl Random {
    fn double(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, min: f64, max: f64) -> f64 {
        min + (max - min) * self.double()
    }

    fn in_unit_sphere(&mut self) -> Vec3 {
        loop {
            let p = Vec3(self.between(-1.0, 1.0), self.between(-1.0, 1.0), self.between(-1.0, 1.0));
            if (1e-160..=1.0).contains(&dot(p, p)) {
                return p;
            }
        }
    }

    fn unit_vector(&mut self) -> Vec3 {
        unit_vector(self.in_unit_sphere())
    }

    fn in_unit_disk(&mut self) -> Vec3 {
        loop {
            let p = Vec3(self.between(-1.0, 1.0), self.between(-1.0, 1.0), 0.0);
            if dot(p, p) < 1.0 {
                return p;
            }
        }
    }
}

struct Ray {
    orig: Vec3,
    dir: Vec3,
}

struct HitRecord<'a> {
    p: Vec3,
    normal: Vec3,
    t: f64,
    front_face: bool,
    mat: &'a dyn Material,
}

trait Material {
    fn scatter(&self, book: &Book, r: &Ray, rec: &HitRecord, rng: &mut Random) -> Option<(Vec3, Ray)>;
}

struct Lambertian(Vec3);
struct Metal(Vec3, f64);
struct Dielectric(f64);

fn reflect(v: Vec3, n: Vec3) -> Vec3 {
    v - n * (2.0 * dot(v, n))
}

impl Material for Lambertian {
    fn scatter(&self, book: &Book, _: &Ray, rec: &HitRecord, rng: &mut Random) -> Option<(Vec3, Ray)> {
        let uniform = match book.stage {
            "diffuse" => !book.makes("lambertian-early"),
            _ => book.makes("hemisphere"),
        };
        let direction = if uniform {
            let v = rng.unit_vector();
            if dot(v, rec.normal) > 0.0 { v } else { -v }
        } else if book.makes("point-in-sphere") {
            rec.normal + rng.in_unit_sphere()
        } else {
            let d = rec.normal + rng.unit_vector();
            if d.0.abs() < 1e-8 && d.1.abs() < 1e-8 && d.2.abs() < 1e-8 { rec.normal } else { d }
        };
        Some((self.0, Ray { orig: rec.p, dir: direction }))
    }
}

impl Material for Metal {
    fn scatter(&self, book: &Book, r: &Ray, rec: &HitRecord, rng: &mut Random) -> Option<(Vec3, Ray)> {
        let mut reflected = reflect(r.dir, rec.normal);
        if !book.makes("fuzz-unnormalised") {
            reflected = unit_vector(reflected);
        }
        if !book.makes("fuzz-missing") {
            reflected = reflected + rng.unit_vector() * self.1;
        }
        (dot(reflected, rec.normal) > 0.0).then_some((self.0, Ray { orig: rec.p, dir: reflected }))
    }
}

impl Material for Dielectric {
    fn scatter(&self, book: &Book, r: &Ray, rec: &HitRecord, rng: &mut Random) -> Option<(Vec3, Ray)> {
        let is_front = rec.front_face != book.makes("index-inverted");
        let ri = if is_front { 1.0 / self.0 } else { self.0 };
        let unit = if book.makes("refract-unnormalised") { r.dir } else { unit_vector(r.dir) };
        let cos_theta = dot(-unit, rec.normal).min(1.0);
        let sin_theta = (1.0 - cos_theta * cos_theta).max(0.0).sqrt();
        let cannot_refract = ri * sin_theta > 1.0 && !book.makes("always-refract");
        let r0 = ((1.0 - ri) / (1.0 + ri)) * ((1.0 - ri) / (1.0 + ri));
        let reflectance = r0 + (1.0 - r0) * (1.0 - cos_theta).powf(5.0);
        let by_chance =
            !book.makes("schlick-missing") && !book.makes("always-refract") && reflectance > rng.double();
        let dir = if (cannot_refract || by_chance) != book.makes("glass-swapped") {
            reflect(unit, rec.normal)
        } else {
            let perp = (unit + rec.normal * cos_theta) * ri;
            perp + rec.normal * -(1.0 - dot(perp, perp)).abs().sqrt()
        };
        let attenuation = if book.makes("glass-black") { 0.0 } else { 1.0 };
        Some((Vec3(attenuation, attenuation, attenuation), Ray { orig: rec.p, dir }))
    }
}

struct Sphere {
    center: Vec3,
    radius: f64,
    mat: Box<dyn Material + Sync>,
}

impl Sphere {
    fn hit<'a>(&'a self, book: &Book, r: &Ray, t_min: f64, t_max: f64) -> Option<HitRecord<'a>> {
        let oc = self.center - r.orig;
        let a = dot(r.dir, r.dir);
        let h = dot(r.dir, oc);
        let discriminant = h * h - a * (dot(oc, oc) - self.radius * self.radius);
        if discriminant < 0.0 {
            return None;
        }
        let sqrtd = discriminant.sqrt();
        let h = if book.makes("half-b-sign") { -h } else { h };
        let mut root = (h - sqrtd) / a;
        if root <= t_min || t_max <= root {
            root = (h + sqrtd) / a;
            if root <= t_min || t_max <= root {
                return None;
            }
        }
        let p = r.orig + r.dir * root;
        let scale = if book.makes("normal-not-unit") { 1.0 } else { 1.0 / self.radius };
        let outward = (p - self.center) * scale;
        let front_face = book.makes("normals-not-flipped") || dot(r.dir, outward) < 0.0;
        let normal = if front_face { outward } else { -outward };
        Some(HitRecord { p, normal, t: root, front_face, mat: &*self.mat })
    }
}

/// The program of one section, with at most one mistake.
pub struct Book {
    stage: &'static str,
    mistake: &'static str,
    world: Vec<Sphere>,
    look_from: Vec3,
    look_at: Vec3,
    vfov: f64,
    defocus_angle: f64,
    focus_dist: f64,
    max_depth: u32,
}

/// The sections that this program covers.
pub const STAGES: [&str; 8] = [
    "sky",
    "normals-world",
    "antialiased",
    "diffuse",
    "lambertian-gamma",
    "metal-fuzzy",
    "hollow-glass",
    "defocus",
];

impl Book {
    pub fn new(stage: &'static str, mistake: &'static str) -> Book {
        let matte = |r, g, b| Box::new(Lambertian(Vec3(r, g, b)));
        let ball = |x, y, z, radius, mat| Sphere { center: Vec3(x, y, z), radius, mat };
        let mut world = Vec::new();
        match stage {
            "sky" => {}
            "normals-world" | "antialiased" | "diffuse" | "lambertian-gamma" => {
                world.push(ball(0.0, 0.0, -1.0, 0.5, matte(0.5, 0.5, 0.5) as Box<dyn Material + Sync>));
                world.push(ball(0.0, -100.5, -1.0, 100.0, matte(0.5, 0.5, 0.5)));
            }
            _ => {
                world.push(ball(0.0, -100.5, -1.0, 100.0, matte(0.8, 0.8, 0.0) as Box<dyn Material + Sync>));
                world.push(ball(0.0, 0.0, -1.2, 0.5, matte(0.1, 0.2, 0.5)));
                if stage == "metal-fuzzy" {
                    world.push(ball(-1.0, 0.0, -1.0, 0.5, Box::new(Metal(Vec3(0.8, 0.8, 0.8), 0.3))));
                } else {
                    world.push(ball(-1.0, 0.0, -1.0, 0.5, Box::new(Dielectric(1.5))));
                    let inner = if mistake == "hollow-index" { 1.5 } else { 1.0 / 1.5 };
                    if mistake != "hollow-missing" {
                        world.push(ball(-1.0, 0.0, -1.0, 0.4, Box::new(Dielectric(inner))));
                    }
                }
                world.push(ball(1.0, 0.0, -1.0, 0.5, Box::new(Metal(Vec3(0.8, 0.6, 0.2), 1.0))));
            }
        }
        let is_lens = stage == "defocus";
        Book {
            stage,
            mistake,
            world,
            look_from: if is_lens { Vec3(-2.0, 2.0, 1.0) } else { Vec3(0.0, 0.0, 0.0) },
            look_at: Vec3(0.0, 0.0, -1.0),
            vfov: if is_lens { 20.0 } else { 90.0 },
            defocus_angle: if is_lens { 10.0 } else { 0.0 },
            focus_dist: if is_lens && mistake != "focus-distance-one" { 3.4 } else { 1.0 },
            max_depth: if mistake == "bounce-limit" { 4 } else { 50 },
        }
    }

    fn makes(&self, mistake: &str) -> bool {
        self.mistake == mistake
    }

    fn hit_world(&self, r: &Ray) -> Option<HitRecord<'_>> {
        let t_min = if self.makes("zero-t-min") { 0.0 } else { 0.001 };
        let mut closest_so_far = f64::INFINITY;
        let mut rec = None;
        for object in &self.world {
            let t_max = if self.makes("last-hit-wins") { f64::INFINITY } else { closest_so_far };
            if let Some(temp) = object.hit(self, r, t_min, t_max) {
                closest_so_far = temp.t;
                rec = Some(temp);
            }
        }
        rec
    }

    fn ray_color(&self, r: &Ray, depth: u32, rng: &mut Random) -> Vec3 {
        if depth == 0 {
            return Vec3(0.0, 0.0, 0.0);
        }
        if let Some(rec) = self.hit_world(r) {
            if self.stage == "normals-world" || self.stage == "antialiased" {
                return (rec.normal + Vec3(1.0, 1.0, 1.0)) * 0.5;
            }
            return match rec.mat.scatter(self, r, &rec, rng) {
                Some((attenuation, scattered)) => attenuation * self.ray_color(&scattered, depth - 1, rng),
                None => Vec3(0.0, 0.0, 0.0),
            };
        }
        let a = 0.5 * (unit_vector(r.dir).1 + 1.0);
        let a = if self.makes("sky-reversed") { 1.0 - a } else { a };
        Vec3(1.0, 1.0, 1.0) * (1.0 - a) + Vec3(0.5, 0.7, 1.0) * a
    }

    /// RGB, row by row from the top.
    pub fn render(&self, width: u32, height: u32, samples: u32, seed: u64) -> Vec<[u8; 3]> {
        let mut rng = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
        let theta =
            if self.makes("vfov-radians") { self.vfov } else { self.vfov * std::f64::consts::PI / 180.0 };
        let viewport_height = 2.0 * (theta / 2.0).tan() * self.focus_dist;
        let aspect = if self.makes("integer-aspect") {
            f64::from(width / height)
        } else {
            f64::from(width) / f64::from(height)
        };
        let w = unit_vector(self.look_from - self.look_at);
        let u = unit_vector(cross(Vec3(0.0, 1.0, 0.0), w));
        let v = cross(w, u);
        let viewport_u = u * (viewport_height * aspect);
        let viewport_v = v * -viewport_height;
        let less = if self.makes("width-less-one") { 1 } else { 0 };
        let delta_u = viewport_u * (1.0 / f64::from(width - less));
        let delta_v = viewport_v * (1.0 / f64::from(height - less));
        let corner = self.look_from - w * self.focus_dist - viewport_u * 0.5 - viewport_v * 0.5;
        let half = if self.makes("half-pixel-up") { 0.0 } else { 0.5 };
        let pixel00 = corner + (delta_u + delta_v) * half;
        let radius = self.focus_dist * (self.defocus_angle / 2.0 * std::f64::consts::PI / 180.0).tan();
        let samples = if self.stage == "sky" || self.stage == "normals-world" { 1 } else { samples };
        let is_jittered = samples > 1 && !self.makes("no-antialiasing");
        let is_gamma = !["sky", "normals-world", "antialiased", "diffuse"].contains(&self.stage);
        let mut picture = Vec::new();
        for j in 0..height {
            for i in 0..width {
                if self.makes("same-seed") {
                    rng = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
                }
                let mut sum = Vec3(0.0, 0.0, 0.0);
                for _ in 0..samples {
                    let shift = if self.makes("half-pixel-down") { 0.0 } else { 0.5 };
                    let (x, y) =
                        if is_jittered { (rng.double() - shift, rng.double() - shift) } else { (0.0, 0.0) };
                    let pixel = pixel00 + delta_u * (f64::from(i) + x) + delta_v * (f64::from(j) + y);
                    let on_lens = if self.defocus_angle <= 0.0 || self.makes("lens-centre") {
                        self.look_from
                    } else {
                        let p = rng.in_unit_disk();
                        self.look_from + u * (p.0 * radius) + v * (p.1 * radius)
                    };
                    let ray = match self.mistake {
                        "lens-origin" => Ray { orig: self.look_from, dir: pixel - on_lens },
                        "lens-aim" => Ray { orig: on_lens, dir: pixel - self.look_from },
                        _ => Ray { orig: on_lens, dir: pixel - on_lens },
                    };
                    sum = sum + self.ray_color(&ray, self.max_depth, &mut rng);
                }
                let mean = sum * (1.0 / f64::from(samples));
                picture.push([mean.0, mean.1, mean.2].map(|x| self.byte(x, is_gamma)));
            }
        }
        match self.mistake {
            "flipped-rows" => picture.chunks(width as usize).rev().flatten().copied().collect(),
            "mirrored-columns" => {
                picture.chunks(width as usize).flat_map(|row| row.iter().rev().copied()).collect()
            }
            "swapped-channels" => picture.into_iter().map(|[r, g, b]| [b, g, r]).collect(),
            _ => picture,
        }
    }

    fn byte(&self, linear: f64, is_gamma: bool) -> u8 {
        let gamma = |x: f64| if x > 0.0 { x.sqrt() } else { 0.0 };
        let is_gamma = (is_gamma && !self.makes("no-gamma")) || self.makes("gamma-early");
        let mut x = if is_gamma { gamma(linear) } else { linear };
        match self.mistake {
            "gamma-twice" => x = gamma(x),
            "gamma-2.2" => x = linear.max(0.0).powf(1.0 / 2.2),
            "gamma-srgb" if linear <= 0.003_130_8 => x = 12.92 * linear,
            "gamma-srgb" => x = 1.055 * linear.powf(1.0 / 2.4) - 0.055,
            _ => {}
        }
        match self.mistake {
            "wraps-to-0" => ((256.0 * x) as u32 % 256) as u8,
            "scale-255" => (255.0 * x) as u8,
            "truncated" => (x as u8) * 255,
            _ => (256.0 * x.clamp(0.0, 0.999)) as u8,
        }
    }
}
