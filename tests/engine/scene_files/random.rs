//! Random recipes.

use super::common::assert_round_trip;
use glam::DVec3;
use proptest::prelude::*;
use weekender::job::recipe::Recipe;
use weekender::job::render::{RenderSettings, SamplerKind};
use weekender::scene::animation::{FRAME_LIMIT, Keyframe};
use weekender::scene::{Camera, Material, Scene, Sky};
use weekender::stages::{DielectricLaws, Diffuse, Rules, Shading, SurfaceRule, Transfer};

fn number(within: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    let (low, high) = (within.start, within.end);
    prop_oneof![
        8 => within,
        1 => Just(low),
        1 => (0.0..1.0_f64, -18..0).prop_map(move |(m, e)| (m * 10_f64.powi(e)).clamp(low, high)),
    ]
}

fn vector(within: std::ops::Range<f64>) -> impl Strategy<Value = DVec3> {
    [number(within.clone()), number(within.clone()), number(within)].prop_map(DVec3::from_array)
}

fn material() -> impl Strategy<Value = Material> {
    prop_oneof![
        vector(0.0..1.0).prop_map(|albedo| Material::Lambertian { albedo }),
        (vector(0.0..1.0), number(0.0..9.0)).prop_map(|(albedo, fuzz)| Material::Metal { albedo, fuzz }),
        number(1e-9..1e9).prop_map(|refraction_index| Material::Dielectric { refraction_index }),
    ]
}

fn rules() -> impl Strategy<Value = Rules> {
    use prop::sample::select;
    let shading = [Shading::ImageGradient, Shading::FirstHitRed, Shading::Normals, Shading::Path];
    let dielectric = [DielectricLaws::RefractOnly, DielectricLaws::TotalReflection, DielectricLaws::Schlick];
    let surface = [SurfaceRule::Exact, SurfaceRule::Acne, SurfaceRule::Book];
    let transfer = [Transfer::Linear, Transfer::Gamma2, Transfer::LinearAboveGamma2];
    let laws = (select(&[Diffuse::Hemisphere, Diffuse::Lambertian][..]), select(dielectric.to_vec()));
    let looks = (select(shading.to_vec()), select(surface.to_vec()), select(transfer.to_vec()));
    (laws, looks, any::<[bool; 2]>()).prop_map(
        |((diffuse, dielectric), (shading, surface, transfer), [reflectance_strips, antialiasing])| Rules {
            shading,
            diffuse,
            dielectric,
            surface,
            reflectance_strips,
            antialiasing,
            transfer,
        },
    )
}

fn scene() -> impl Strategy<Value = Scene> {
    let materials = prop::collection::btree_map(any::<String>(), material(), 0..6);
    let sphere = (vector(-1e18..1e18), number(1e-18..1e18), any::<prop::sample::Index>());
    let sky = (vector(0.0..100.0), vector(0.0..100.0)).prop_map(|(bottom, top)| Sky { bottom, top });
    (materials, prop::collection::vec(sphere, 0..60), sky, any::<bool>()).prop_map(
        |(materials, spheres, sky, is_reversed)| {
            let mut scene = Scene { sky, ..Scene::default() };
            for (name, material) in materials {
                scene.add_material(name, material);
            }
            if is_reversed {
                scene.materials.reverse();
            }
            for (center, radius, index) in spheres {
                if !scene.materials.is_empty() {
                    scene.add_sphere(center, radius, index.index(scene.materials.len()));
                }
            }
            scene
        },
    )
}

fn camera() -> impl Strategy<Value = Camera> {
    let focus = prop::option::of(number(1e-18..1e18));
    (vector(-1e3..1e3), vector(-1e3..1e3), vector(-2.0..2.0), number(0.01..179.0), number(0.0..179.0), focus)
        .prop_filter("a direction", |(look_from, look_at, ..)| look_from.distance(*look_at) > 1e-3)
        .prop_filter("an up", |(look_from, look_at, vup, ..)| {
            vup.cross(*look_at - *look_from).length() > 1e-6 * vup.length() * look_from.distance(*look_at)
        })
        .prop_map(|(look_from, look_at, vup, vfov_degrees, defocus_angle_degrees, focus_distance)| Camera {
            look_from,
            look_at,
            vup,
            vfov_degrees,
            defocus_angle_degrees,
            focus_distance,
        })
}

fn recipe() -> impl Strategy<Value = Recipe> {
    let settings = (1..=16_384_u32, 1..=16_384_u32, 1..=10_000_u32, any::<bool>(), any::<u32>()).prop_map(
        |(width, height, max_depth, is_sobol, seed)| {
            let sampler = if is_sobol { SamplerKind::Sobol } else { SamplerKind::Independent };
            let numbers = RenderSettings { width, height, max_depth, seed, ..RenderSettings::default() };
            RenderSettings { sampler, ..numbers }
        },
    );
    let keyframes = prop::collection::btree_map(0..FRAME_LIMIT, camera(), 0..4).prop_map(|cameras| {
        cameras.into_iter().map(|(frame, camera)| Keyframe { frame, camera }).collect::<Vec<_>>()
    });
    (any::<String>(), scene(), camera(), keyframes, settings, rules(), 1..=1_u64 << 32).prop_map(
        |(name, scene, camera, keyframes, settings, rules, samples_per_pixel)| Recipe {
            name,
            scene: scene.into(),
            camera,
            keyframes,
            settings,
            rules,
            samples_per_pixel,
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_recipes_are_read_back_to_the_bit(recipe in recipe()) {
        assert_round_trip(&recipe);
    }
}
