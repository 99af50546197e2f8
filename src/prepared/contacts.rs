//! Contacts that light inside a glass sphere keeps coming back to.

use super::groups::{Eye, touch};
use crate::render::RenderJob;
use crate::scene::Sphere;

/// The eye is in line with a contact if the sine of their angle at the centre is at most this. With an eye .1 above a
/// contact in a sphere of radius 1, the mean of the picture is off by 2.7e-4 in line, by 3e-5 at a sine of .001 and by
/// 4e-6 at this limit, which other views inside the glass reach, too.
const IN_LINE: f64 = 0.01;

/// Most glass spheres around the eye that are examined, those with the nearest surfaces first: each is compared with all
/// spheres, again after each move of the camera.
const CANDIDATE_LIMIT: usize = 64;

/// Whether the eye is inside glass and in line with the centre and a point where the glass touches another sphere.
///
/// Light that is reflected inside a sphere stays in a plane through the eye and the centre. In line, every such plane
/// contains the contact, so paths come to it again and again. Near it, the two surfaces have the same distance in single
/// precision, and a path may hit the one behind.
pub(super) fn warning(job: &RenderJob) -> Option<String> {
    let (spheres, eye) = (&job.scene().spheres, Eye::of(job.camera()));
    let glass = spheres.iter().enumerate().filter(|(_, s)| job.scene().material_of(s).is_transparent());
    let mut around: Vec<(usize, f64)> =
        glass.map(|(index, s)| (index, eye.height(s))).filter(|(_, height)| *height < 0.0).collect();
    around.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    around.truncate(CANDIDATE_LIMIT);
    around.sort_by_key(|(index, _)| *index);
    around.into_iter().find_map(|(a, _)| {
        let glass = &spheres[a];
        let to_eye = (eye.position - glass.center).normalize_or_zero();
        let is_in_line = |other: &Sphere| {
            let to_other = (other.center - glass.center).normalize_or_zero();
            to_other.cross(to_eye).length() <= IN_LINE
        };
        let meets = |other: &Sphere| other.center != glass.center && touch(glass, other) && is_in_line(other);
        let b = spheres.iter().position(meets)?;
        Some(format!(
            "the eye is inside sphere {a}, in line with the point where sphere {b} touches it; light that is reflected \
             inside comes back to that point, where single precision cannot tell the two surfaces apart; move the eye \
             aside, or render with --device reference"
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::RenderSettings;
    use crate::scene::{Camera, Material, Scene};
    use crate::stages::Rules;
    use glam::DVec3;

    const GLASS: Material = Material::Dielectric { refraction_index: 1.5 };

    /// What is said of a ball of radius 1 about (0, 1, 0) above one of radius 3, seen from `eye`.
    fn told(material: Material, eye: DVec3, gap: f64) -> Option<String> {
        let mut scene = Scene::default();
        let ground = scene.add_material("ground", Material::Lambertian { albedo: DVec3::splat(0.5) });
        scene.add_sphere(DVec3::new(0.0, -3.0 - gap, 0.0), 3.0, ground);
        let ball = scene.add_material("ball", material);
        scene.add_sphere(DVec3::Y, 1.0, ball);
        warning_of(scene, eye)
    }

    fn warning_of(scene: Scene, eye: DVec3) -> Option<String> {
        let camera = Camera { look_from: eye, look_at: eye + DVec3::X, ..Camera::default() };
        warning(&RenderJob::new(scene, camera, RenderSettings::default(), Rules::default()).unwrap())
    }

    #[test]
    fn of_a_crowd_around_the_eye_the_nearest_are_examined() {
        // Concentric shells, of which only that of radius 1 touches the ball below.
        let told = |radii: Vec<f64>| {
            let mut scene = Scene::default();
            let glass = scene.add_material("glass", GLASS);
            radii.into_iter().for_each(|radius| scene.add_sphere(DVec3::Y, radius, glass));
            scene.add_sphere(DVec3::Y, 1.0, glass);
            scene.add_sphere(DVec3::NEG_Y * 3.0, 3.0, glass);
            warning_of(scene, DVec3::Y * 0.1)
        };
        let (outer, inner) = (|i: u32| 10.0 + f64::from(i), |i: u32| 0.91 + 1e-4 * f64::from(i));
        assert!(told((0..200).map(outer).collect()).is_some());
        assert!(told((0..63).map(inner).chain((0..200).map(outer)).collect()).is_some());
        assert!(told((0..64).map(inner).collect()).is_none());
    }

    #[test]
    fn an_eye_in_glass_in_line_with_a_contact_is_told() {
        for height in [1e-9, 0.1, 1.9] {
            let words = told(GLASS, DVec3::Y * height, 0.0).unwrap_or_default();
            assert!(
                words
                    .starts_with("the eye is inside sphere 1, in line with the point where sphere 0 touches")
            );
        }
        let eye = DVec3::Y * 0.1;
        assert_eq!(told(GLASS, eye + DVec3::X * 0.02, 0.0), None, "aside");
        assert_eq!(told(GLASS, eye, 1e-4), None, "the balls are apart");
        assert_eq!(told(GLASS, DVec3::Y * 2.1, 0.0), None, "from outside, paths pass the contact once");
        assert_eq!(told(Material::Lambertian { albedo: DVec3::ONE }, eye, 0.0), None, "an opaque ball");
    }

    #[test]
    fn an_eye_is_in_line_up_to_a_hundredth_of_a_radian() {
        // The eye is .5 from the centre of the ball, below it and aside at an angle with this sine.
        let told = |sine: f64| {
            let below = f64::sqrt(1.0 - sine * sine);
            told(GLASS, DVec3::Y + 0.5 * DVec3::new(sine, -below, 0.0), 0.0).is_some()
        };
        assert_eq!(
            [0.0, 0.0099, -0.0099, 0.0101, -0.0101, 0.5].map(told),
            [true, true, true, false, false, false]
        );
        // Above the centre it is in line, too: light comes to the contact through the centre.
        assert!(told_of(DVec3::Y * 1.5) && !told_of(DVec3::new(0.5, 1.0, 0.0)));
    }

    fn told_of(eye: DVec3) -> bool {
        told(GLASS, eye, 0.0).is_some()
    }
}
