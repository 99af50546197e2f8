//! A third arithmetic: the nearest hit of a ray in numbers of 106 bits, twice those of `f64`, compared with the
//! tracer's.
//!
//! A number is the sum of two `f64`s that do not overlap. Sums and products of such pairs are exact to `2^-104`, which
//! leaves 50 bits even after the squares of an ordinary `f64` scene have cancelled. Unlike intervals or fractions,
//! pairs are fast enough to check thousands of rays.
//!
//! Source: Dekker, "A Floating-Point Technique for Extending the Available Precision", 1971. Fused multiplication
//! makes Dekker's splitting unnecessary.

use glam::DVec3;
use std::ops::{Add, Mul, Sub};
use weekender::job::recipe::Recipe;
use weekender::measure::stress::cases;
use weekender::render_cpu::{Isa, PathRecorder};
use weekender::scene::{Material, Scene, Sphere};

/// A number of 106 bits: `high + low`, with `low` below half a unit in the last place of `high`.
#[derive(Clone, Copy)]
struct Double {
    high: f64,
    low: f64,
}

impl Double {
    /// The nearest `f64`.
    fn to_f64(self) -> f64 {
        self.high + self.low
    }

    /// The sum of two numbers that may overlap slightly, where `|high| >= |low|`.
    fn normalised(high: f64, low: f64) -> Self {
        let sum = high + low;
        Double { high: sum, low: low - (sum - high) }
    }

    /// Must not be negative.
    fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Double::from(0.0);
        }
        let root = Double::from(self.high.sqrt());
        let rest = self - root * root;
        root + Double::from(rest.to_f64() / (2.0 * root.high))
    }

    /// `other` must not be 0.
    fn over(self, other: Double) -> Self {
        let first = Double::from(self.high / other.high);
        let rest = self - first * other;
        first + Double::from(rest.high / other.high)
    }
}

impl From<f64> for Double {
    fn from(value: f64) -> Self {
        Double { high: value, low: 0.0 }
    }
}

impl Add for Double {
    type Output = Double;

    fn add(self, other: Double) -> Double {
        let (high, rest) = exact_sum(self.high, other.high);
        let (low, last) = exact_sum(self.low, other.low);
        let first = Double::normalised(high, rest + low);
        Double::normalised(first.high, first.low + last)
    }
}

impl Sub for Double {
    type Output = Double;

    fn sub(self, other: Double) -> Double {
        self + Double { high: -other.high, low: -other.low }
    }
}

impl Mul for Double {
    type Output = Double;

    fn mul(self, other: Double) -> Double {
        let high = self.high * other.high;
        let rest = self.high.mul_add(other.high, -high);
        Double::normalised(high, rest + (self.high * other.low + self.low * other.high))
    }
}

/// The rounded sum and its rounding error.
fn exact_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// The first sphere that a ray hits: its index, and the distance in units of the direction's length. Surfaces at
/// distance 0 are left, not hit. At equal distance, the scene's first sphere wins.
fn first_hit(scene: &Scene, origin: DVec3, direction: DVec3) -> Option<(usize, f64)> {
    let mut nearest: Option<(usize, Double)> = None;
    for (index, sphere) in scene.spheres.iter().enumerate() {
        let Some(distance) = distance(sphere, origin, direction) else { continue };
        if nearest.is_none_or(|(_, best)| (best - distance).high > 0.0) {
            nearest = Some((index, distance));
        }
    }
    nearest.map(|(index, distance)| (index, distance.to_f64()))
}

/// The smaller positive root.
fn distance(sphere: &Sphere, origin: DVec3, direction: DVec3) -> Option<Double> {
    let exact = |v: DVec3| v.to_array().map(Double::from);
    let (center, origin, direction) = (exact(sphere.center), exact(origin), exact(direction));
    let to_center = [0, 1, 2].map(|axis| center[axis] - origin[axis]);
    let dot = |a: [Double; 3], b: [Double; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let radius = Double::from(sphere.radius);
    let a = dot(direction, direction);
    let h = dot(direction, to_center);
    let c = dot(to_center, to_center) - radius * radius;
    let discriminant = h * h - a * c;
    if discriminant.high < 0.0 {
        return None;
    }
    // The root of larger magnitude has no cancellation; the other follows from their product, c / a.
    let sum = if h.high >= 0.0 { h + discriminant.sqrt() } else { h - discriminant.sqrt() };
    let mut roots = [sum.over(a), if sum.high == 0.0 { Double::from(0.0) } else { c.over(sum) }];
    if (roots[0] - roots[1]).high > 0.0 {
        roots.swap(0, 1);
    }
    roots.into_iter().find(|root| root.high > 0.0)
}

/// Larger scenes are not checked, because each ray is tested against all spheres.
const CHECKED_SPHERES: usize = 5000;

/// Pixels per axis whose first ray is checked.
const CHECKED_PIXELS: u32 = 8;

/// Allowed error of a hit's distance, relative to that distance and to the focus distance.
const DISTANCE_TOLERANCE: f64 = 1e-5;

/// How many rays from the eye were checked, and how many hit the same surface as in 106-bit arithmetic.
fn first_hits(recipe: &Recipe) -> [usize; 2] {
    let job = recipe.job().unwrap();
    let recorder = PathRecorder::new(&job, *Isa::available().last().unwrap(), None);
    let eye = outside(&recipe.scene, recipe.camera.look_from);
    let margin = DISTANCE_TOLERANCE * recipe.camera.effective_focus_distance();
    let (mut rays, mut agree) = (0, 0);
    for step in 0..CHECKED_PIXELS * CHECKED_PIXELS {
        let share = |step: u32, pixels: u32| step * pixels / CHECKED_PIXELS;
        let pixel = [
            share(step % CHECKED_PIXELS, job.settings().width),
            share(step / CHECKED_PIXELS, job.settings().height),
        ];
        let record = recorder.record(pixel, 0);
        let Some(ray) = record.rays.first() else { continue };
        let exact = first_hit(&recipe.scene, eye, DVec3::from_array(ray.direction));
        rays += 1;
        agree += usize::from(match (ray.hit.map(|hit| hit.distance), exact) {
            (Some(hit), Some((_, exact))) => (hit - exact).abs() <= DISTANCE_TOLERANCE * exact + margin,
            (hit, exact) => hit.is_none() && exact.is_none(),
        });
    }
    [rays, agree]
}

/// The eye; if `f64` cannot tell it from a surface, moved outside by the smallest distance that `f64` can tell.
fn outside(scene: &Scene, eye: DVec3) -> DVec3 {
    let mut outside = eye;
    for sphere in &scene.spheres {
        let away = eye - sphere.center;
        let digits =
            f64::EPSILON * (eye.abs().max_element() + sphere.center.abs().max_element() + sphere.radius);
        if (away.length() - sphere.radius).abs() <= 4.0 * digits {
            outside = sphere.center + (sphere.radius + 8.0 * digits) * away.normalize();
        }
    }
    outside
}

#[test]
fn first_hits_match_106_bits() {
    let is_checked = |recipe: &Recipe| {
        recipe.camera.defocus_angle_degrees == 0.0 && recipe.scene.spheres.len() <= CHECKED_SPHERES
    };
    let wrong: Vec<_> = cases()
        .iter()
        .filter(|case| is_checked(&case.recipe))
        .map(|case| (&case.id, first_hits(&case.recipe)))
        // One in twenty may just graze an edge.
        .filter(|(_, [rays, agree])| *rays == 0 || 20 * (rays - agree) > *rays)
        .collect();
    assert!(wrong.is_empty(), "{wrong:?}");
}

fn scene(balls: &[(DVec3, f64)]) -> Scene {
    let mut scene = Scene::default();
    let material = scene.add_material("matte", Material::Lambertian { albedo: DVec3::ONE });
    for (center, radius) in balls {
        scene.add_sphere(*center, *radius, material);
    }
    scene
}

#[test]
fn exact_hits_beyond_f64() {
    // A gap of 1e-9 in front of a ball at 1e9: f64 cannot resolve its square.
    let far = scene(&[(DVec3::new(1e9, 0.0, 0.0), 1e9 - 1e-3)]);
    let (_, distance) = first_hit(&far, DVec3::ZERO, DVec3::X).unwrap();
    let expected = 1e9 - (1e9 - 1e-3);
    assert!((distance - expected).abs() < 1e-12 * expected, "{distance} {expected}");
}

#[test]
fn ray_leaves_its_surface() {
    let ball = scene(&[(DVec3::ZERO, 1.0)]);
    assert_eq!(first_hit(&ball, DVec3::Y, DVec3::new(1.0, 1.0, 0.0)), None);
    assert_eq!(first_hit(&ball, DVec3::Y, -DVec3::Y), Some((0, 2.0)));
    assert_eq!(first_hit(&ball, DVec3::ZERO, DVec3::Z), Some((0, 1.0)));
    assert_eq!(first_hit(&ball, 3.0 * DVec3::Y, DVec3::Y), None);
    // Along the surface, both roots are 0.
    assert_eq!(first_hit(&ball, DVec3::Y, DVec3::X), None);
}
