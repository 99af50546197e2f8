//! The book's program as a reader writes it, with its own scenes and random numbers: recursion, one thread. It shares no
//! code with Weekender. Mistakes are named by their ids in `weekender check --json`.

use glam::DVec3;

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

    fn in_unit_sphere(&mut self) -> DVec3 {
        loop {
            let p = DVec3::new(self.between(-1.0, 1.0), self.between(-1.0, 1.0), self.between(-1.0, 1.0));
            if (1e-160..=1.0).contains(&p.length_squared()) {
                return p;
            }
        }
    }

    fn unit_vector(&mut self) -> DVec3 {
        self.in_unit_sphere().normalize()
    }

    fn in_unit_disk(&mut self) -> DVec3 {
        loop {
            let p = DVec3::new(self.between(-1.0, 1.0), self.between(-1.0, 1.0), 0.0);
            if p.length_squared() < 1.0 {
                return p;
            }
        }
    }
}

struct Ray {
    orig: DVec3,
    dir: DVec3,
}

struct HitRecord {
    p: DVec3,
    normal: DVec3,
    t: f64,
    front_face: bool,
    mat: Material,
}

#[derive(Clone, Copy)]
pub enum Material {
    Lambertian(DVec3),
    Metal(DVec3, f64),
    Dielectric(f64),
}

pub struct Sphere {
    pub center: DVec3,
    pub radius: f64,
    pub mat: Material,
}

fn reflect(v: DVec3, n: DVec3) -> DVec3 {
    v - n * (2.0 * v.dot(n))
}

/// The program of one section, with at most one mistake.
pub struct Book {
    stage: &'static str,
    mistake: &'static str,
    is_edition_3: bool,
    pub world: Vec<Sphere>,
    pub look_from: DVec3,
    look_at: DVec3,
    pub vfov: f64,
    pub defocus_angle: f64,
    pub focus_dist: f64,
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
        let matte = |r, g, b| Material::Lambertian(DVec3::new(r, g, b));
        let mut world = Vec::new();
        let mut ball = |x, y, z, radius, mat| world.push(Sphere { center: DVec3::new(x, y, z), radius, mat });
        match stage {
            "sky" => {}
            "normals-world" | "antialiased" | "diffuse" | "lambertian-gamma" => {
                ball(0.0, 0.0, -1.0, 0.5, matte(0.5, 0.5, 0.5));
                ball(0.0, -100.5, -1.0, 100.0, matte(0.5, 0.5, 0.5));
            }
            _ => {
                ball(0.0, -100.5, -1.0, 100.0, matte(0.8, 0.8, 0.0));
                ball(0.0, 0.0, -1.2, 0.5, matte(0.1, 0.2, 0.5));
                if stage == "metal-fuzzy" {
                    ball(-1.0, 0.0, -1.0, 0.5, Material::Metal(DVec3::splat(0.8), 0.3));
                } else {
                    ball(-1.0, 0.0, -1.0, 0.5, Material::Dielectric(1.5));
                    let inner = if mistake == "hollow-index" { 1.5 } else { 1.0 / 1.5 };
                    if mistake != "hollow-missing" {
                        ball(-1.0, 0.0, -1.0, 0.4, Material::Dielectric(inner));
                    }
                }
                ball(1.0, 0.0, -1.0, 0.5, Material::Metal(DVec3::new(0.8, 0.6, 0.2), 1.0));
            }
        }
        let is_lens = stage == "defocus";
        Book {
            stage,
            mistake,
            is_edition_3: false,
            world,
            look_from: if is_lens { DVec3::new(-2.0, 2.0, 1.0) } else { DVec3::ZERO },
            look_at: DVec3::NEG_Z,
            vfov: if is_lens { 20.0 } else { 90.0 },
            defocus_angle: if is_lens { 10.0 } else { 0.0 },
            focus_dist: if is_lens && mistake != "focus-distance-one" { 3.4 } else { 1.0 },
            max_depth: if mistake == "bounce-limit" { 4 } else { 50 },
        }
    }

    /// The same section in edition 3: another camera, other balls, and fuzz from inside the unit sphere.
    pub fn of_edition_3(stage: &'static str, mistake: &'static str) -> Book {
        let mut book = Book { is_edition_3: true, ..Book::new(stage, mistake) };
        for sphere in &mut book.world {
            match (stage, sphere.mat) {
                ("metal-fuzzy", Material::Lambertian(_)) if sphere.radius < 1.0 => {
                    sphere.mat = Material::Lambertian(DVec3::new(0.7, 0.3, 0.3));
                }
                ("hollow-glass", Material::Metal(albedo, _)) => sphere.mat = Material::Metal(albedo, 0.0),
                _ => {}
            }
            if sphere.radius < 1.0 {
                sphere.center.z = -1.0;
            }
        }
        book
    }

    fn makes(&self, mistake: &str) -> bool {
        self.mistake == mistake
    }

    fn hit(&self, sphere: &Sphere, r: &Ray, t_min: f64, t_max: f64) -> Option<HitRecord> {
        let oc = sphere.center - r.orig;
        let a = r.dir.length_squared();
        let h = r.dir.dot(oc);
        let discriminant = h * h - a * (oc.length_squared() - sphere.radius * sphere.radius);
        if discriminant < 0.0 {
            return None;
        }
        let sqrtd = discriminant.sqrt();
        let h = if self.makes("half-b-sign") { -h } else { h };
        let mut root = (h - sqrtd) / a;
        if root <= t_min || t_max <= root {
            root = (h + sqrtd) / a;
            if root <= t_min || t_max <= root {
                return None;
            }
        }
        let p = r.orig + r.dir * root;
        let scale = if self.makes("normal-not-unit") { 1.0 } else { 1.0 / sphere.radius };
        let outward = (p - sphere.center) * scale;
        let front_face = self.makes("normals-not-flipped") || r.dir.dot(outward) < 0.0;
        let normal = if front_face { outward } else { -outward };
        Some(HitRecord { p, normal, t: root, front_face, mat: sphere.mat })
    }

    fn hit_world(&self, r: &Ray) -> Option<HitRecord> {
        let t_min = if self.makes("zero-t-min") { 0.0 } else { 0.001 };
        let mut closest_so_far = f64::INFINITY;
        let mut rec = None;
        for object in &self.world {
            let t_max = if self.makes("last-hit-wins") { f64::INFINITY } else { closest_so_far };
            if let Some(temp) = self.hit(object, r, t_min, t_max) {
                closest_so_far = temp.t;
                rec = Some(temp);
            }
        }
        rec
    }

    fn scatter(&self, r: &Ray, rec: &HitRecord, rng: &mut Random) -> Option<(DVec3, DVec3)> {
        match rec.mat {
            Material::Lambertian(albedo) => {
                let uniform = match self.stage {
                    "diffuse" => !self.makes("lambertian-early"),
                    _ => self.makes("hemisphere"),
                };
                let direction = if uniform {
                    let v = rng.unit_vector();
                    if v.dot(rec.normal) > 0.0 { v } else { -v }
                } else if self.makes("point-in-sphere") {
                    rec.normal + rng.in_unit_sphere()
                } else {
                    let far = if self.makes("narrow-lobe") { 0.6 } else { 1.0 };
                    let d = rec.normal + rng.unit_vector() * far;
                    if d.abs().max_element() < 1e-8 { rec.normal } else { d }
                };
                Some((if self.makes("albedo-squared") { albedo * albedo } else { albedo }, direction))
            }
            Material::Metal(albedo, fuzz) => {
                let mut reflected = reflect(r.dir, rec.normal);
                if !self.makes("fuzz-unnormalised") {
                    reflected = reflected.normalize();
                }
                if !self.makes("fuzz-missing") {
                    let v = if self.is_edition_3 { rng.in_unit_sphere() } else { rng.unit_vector() };
                    reflected += v * fuzz;
                }
                (reflected.dot(rec.normal) > 0.0).then_some((albedo, reflected))
            }
            Material::Dielectric(index) => {
                let is_front = rec.front_face != self.makes("index-inverted");
                let ri = if is_front { 1.0 / index } else { index };
                let unit = if self.makes("refract-unnormalised") { r.dir } else { r.dir.normalize() };
                let cos_theta = (-unit).dot(rec.normal).min(1.0);
                let sin_theta = (1.0 - cos_theta * cos_theta).max(0.0).sqrt();
                let always = self.makes("always-refract");
                let r0 = ((1.0 - ri) / (1.0 + ri)).powi(2);
                let reflectance = r0 + (1.0 - r0) * (1.0 - cos_theta).powi(5);
                let by_chance = !self.makes("schlick-missing") && reflectance > rng.double();
                let reflects = !always && (ri * sin_theta > 1.0 || by_chance);
                let direction = if reflects != self.makes("glass-swapped") {
                    reflect(unit, rec.normal)
                } else {
                    let perp = (unit + rec.normal * cos_theta) * ri;
                    perp - rec.normal * (1.0 - perp.length_squared()).abs().sqrt()
                };
                let attenuation = if self.makes("glass-black") { 0.0 } else { 1.0 };
                Some((DVec3::splat(attenuation), direction))
            }
        }
    }

    fn ray_color(&self, r: &Ray, depth: u32, rng: &mut Random) -> DVec3 {
        if depth == 0 {
            return DVec3::ZERO;
        }
        if let Some(rec) = self.hit_world(r) {
            if self.stage == "normals-world" || self.stage == "antialiased" {
                return (rec.normal + 1.0) * 0.5;
            }
            return match self.scatter(r, &rec, rng) {
                Some((attenuation, dir)) => {
                    attenuation * self.ray_color(&Ray { orig: rec.p, dir }, depth - 1, rng)
                }
                None => DVec3::ZERO,
            };
        }
        let y = r.dir.normalize().y;
        let a = match self.mistake {
            "sky-reversed" => 0.5 * (1.0 - y),
            "sky-mirrored" => y.abs(),
            "sky-plain" => 0.0,
            _ => 0.5 * (y + 1.0),
        };
        DVec3::ONE.lerp(DVec3::new(0.5, 0.7, 1.0), a)
    }

    /// RGB, row by row from the top.
    pub fn render(&self, width: u32, height: u32, samples: u32, seed: u64) -> Vec<[u8; 3]> {
        let mut rng = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
        let theta =
            if self.makes("vfov-radians") { self.vfov } else { self.vfov * std::f64::consts::PI / 180.0 };
        let viewport_height = 2.0 * (theta / 2.0).tan() * self.focus_dist;
        let aspect = match self.mistake {
            "integer-aspect" => f64::from(width / height),
            _ => f64::from(width) / f64::from(height),
        };
        let w = (self.look_from - self.look_at).normalize();
        let u = DVec3::Y.cross(w).normalize();
        let v = w.cross(u);
        let viewport_u = u * (viewport_height * aspect);
        let viewport_v = v * -viewport_height;
        let less = if self.is_edition_3 || self.makes("width-less-one") { 1 } else { 0 };
        let (delta_u, delta_v) =
            (viewport_u / f64::from(width - less), viewport_v / f64::from(height - less));
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
                let (mut sum, shift) = (DVec3::ZERO, if self.makes("half-pixel-down") { 0.0 } else { 0.5 });
                // Edition 3 counts rows from below.
                let up = if self.is_edition_3 { 1.0 } else { 0.0 };
                for _ in 0..samples {
                    let (x, y) = if is_jittered {
                        (rng.double() - shift, rng.double() - shift - up)
                    } else {
                        (0.0, 0.0)
                    };
                    let pixel = pixel00 + delta_u * (f64::from(i) + x) + delta_v * (f64::from(j) + y);
                    let on_lens = if self.defocus_angle <= 0.0 {
                        self.look_from
                    } else {
                        let p = rng.in_unit_disk();
                        self.look_from + (u * p.x + v * p.y) * radius
                    };
                    let ray = match self.mistake {
                        "lens-origin" => Ray { orig: self.look_from, dir: pixel - on_lens },
                        "lens-centre" => Ray { orig: self.look_from, dir: pixel - self.look_from },
                        "lens-aim" => Ray { orig: on_lens, dir: pixel - self.look_from },
                        _ => Ray { orig: on_lens, dir: pixel - on_lens },
                    };
                    sum += self.ray_color(&ray, self.max_depth, &mut rng);
                }
                let mut mean = sum / f64::from(samples);
                match self.mistake {
                    "tone-mapped" => mean /= DVec3::ONE + mean,
                    "vignette" => mean *= 1.0 - 0.3 * (f64::from(i) / f64::from(width) - 0.5).abs(),
                    "blue-lost" => mean.z *= 0.9,
                    _ => {}
                }
                picture.push(mean.to_array().map(|x| self.byte(x, is_gamma)));
            }
        }
        let rows = picture.chunks(width as usize);
        match self.mistake {
            "flipped-rows" => rows.rev().flatten().copied().collect(),
            "mirrored-columns" => rows.flat_map(|row| row.iter().rev()).copied().collect(),
            "swapped-channels" => picture.iter().map(|[r, g, b]| [*b, *g, *r]).collect(),
            _ => picture,
        }
    }

    fn byte(&self, linear: f64, is_gamma: bool) -> u8 {
        let gamma = |x: f64| if x > 0.0 { x.sqrt() } else { 0.0 };
        let mut x = if is_gamma { gamma(linear) } else { linear };
        match self.mistake {
            "gamma-twice" => x = gamma(x),
            "no-gamma" => x = linear,
            "gamma-early" => x = gamma(linear),
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
