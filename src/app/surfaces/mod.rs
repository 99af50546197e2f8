//! The surfaces around the camera: a camera that moves stops at them and slides along, and a camera inside a sphere is
//! told so.

mod near;

use super::answers::Answers;
use super::model::checked::CheckedScene;
use super::model::document::Document;
use super::navigation;
use crate::prepared::hierarchy::{Effort, Hierarchy};
use crate::scene::{Camera, Pick};
use eframe::egui::Context;
use glam::DVec3;
use near::{Near, Tree};
use std::sync::Arc;

/// With more spheres than this, a hierarchy finds the near ones.
const SCAN_LIMIT: usize = 2_000;

/// How far from a surface the camera stops, as shares of the distance to `look_at`. Between these limits it is the
/// radius of the lens, so that no ray starts inside the sphere.
const GAP_SHARES: [f64; 2] = [1e-3, 0.05];

/// The surfaces of the document's scene.
#[derive(Default)]
pub struct Surfaces {
    /// The scene whose hierarchy was asked for.
    of: Option<Arc<CheckedScene>>,
    tree: Option<Tree>,
    is_asked: bool,
    /// Hierarchies, unless they could not be built.
    answers: Answers<(Arc<CheckedScene>, Option<Tree>)>,
    /// Where the camera was last, and the innermost sphere around it.
    around: Option<(DVec3, Option<usize>)>,
}

impl Surfaces {
    /// Takes the hierarchy of the document's scene once it has been built. `has_picture` says that the tracer has
    /// prepared the scene: before, both would compete for the processor.
    pub fn follow(&mut self, document: &Document, has_picture: bool, context: &Context) {
        if !self.is_of(document) {
            *self = Surfaces { answers: std::mem::take(&mut self.answers), ..Surfaces::default() };
            self.of = Some(Arc::clone(&document.checked));
        }
        if has_picture && !self.is_asked {
            self.is_asked = true;
            if document.scene().spheres.len() > SCAN_LIMIT {
                let (scene, center) =
                    (Arc::clone(&document.checked), document.origin.recipe.camera.look_from);
                let of = Arc::clone(&scene);
                let build = move || {
                    let hierarchy = Hierarchy::build(&scene.scene().spheres, center, Effort::Quick);
                    (scene, Some(Tree { hierarchy, origin: center }))
                };
                let substitute = |reason: String| {
                    log::warn!("every sphere is looked at when the camera moves: {reason}");
                    (of, None)
                };
                self.answers.ask("surfaces", context, build, substitute);
            }
        }
        while let Some((scene, tree)) = self.answers.take() {
            if self.of.as_ref().is_some_and(|of| Arc::ptr_eq(of, &scene)) {
                self.tree = tree;
            }
        }
        let at = document.camera.look_from;
        if self.around.is_none_or(|(before, _)| before != at) {
            self.around = Some((at, self.near(document).innermost(at)));
        }
    }

    /// The sphere that the camera is inside of, in words, if the document's rays can see it.
    pub fn inside(&self, document: &Document) -> Option<String> {
        let (_, sphere) = self.around.filter(|_| self.is_of(document))?;
        let sphere = sphere.filter(|_| document.no_rays().is_none())?;
        let scene = document.scene();
        let material = &scene.materials[scene.spheres[sphere].material].name;
        Some(format!("the camera is inside sphere {sphere} ({material})"))
    }

    /// Where the ray through the point `place` of the picture hits the scene.
    pub fn pick(&self, document: &Document, camera: &Camera, place: [f64; 2]) -> Option<Pick> {
        let direction = camera.direction_through(place, document.aspect());
        self.near(document).pick(camera.look_from, direction)
    }

    /// The camera that a move from `before` to `after` leads to: it stays outside of the spheres that `before` is
    /// outside of. `pivot` is the point that the move keeps where it is in the picture, if there is one.
    pub fn stop(&self, document: &Document, before: &Camera, after: &Camera, pivot: Option<DVec3>) -> Camera {
        if before.look_from == after.look_from {
            return *after;
        }
        let distance = before.look_from.distance(before.look_at);
        let [low, high] = GAP_SHARES.map(|share| share * distance);
        let gap = after.lens_radius().clamp(low, high);
        let near = self.near(document);
        let circled = pivot.filter(|pivot| is_orbit(before, after, *pivot));
        let target = pivot.filter(|_| circled.is_none());
        let look_from = near.slide(before.look_from, after.look_from, gap, target);
        if look_from == after.look_from {
            return *after;
        }
        if let Some(pivot) = circled {
            // Sliding led off the circle.
            let away = (look_from - pivot).normalize_or_zero();
            let onto = pivot + after.look_from.distance(pivot) * away;
            return navigation::orbited_to(after, pivot, near.slide(look_from, onto, gap, None));
        }
        // It looks in the same direction as before, and at a point as far away.
        let look_at = before.look_at + (look_from - before.look_from);
        let stopped = Camera { look_from, look_at, ..*before };
        if stopped.validate().is_ok() { stopped } else { *before }
    }

    /// Whether what is known is about the document's scene, which may have been edited in this frame.
    fn is_of(&self, document: &Document) -> bool {
        self.of.as_ref().is_some_and(|of| Arc::ptr_eq(of, &document.checked))
    }

    fn near<'a>(&'a self, document: &'a Document) -> Near<'a> {
        Near { scene: document.scene(), tree: self.tree.as_ref().filter(|_| self.is_of(document)) }
    }
}

/// Whether a move keeps the distance to the pivot.
fn is_orbit(before: &Camera, after: &Camera, pivot: DVec3) -> bool {
    let [old, new] = [before, after].map(|camera| camera.look_from.distance(pivot));
    (old - new).abs() <= 1e-6 * old
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::origin::{Origin, Source};
    use crate::app::navigation;
    use crate::recipe::Recipe;
    use crate::scene::{Material, Sphere};
    use crate::stages::Stage;
    use std::time::{Duration, Instant};

    fn opened(name: &str) -> (Document, Surfaces) {
        let document = Document::new(Origin::new(Recipe::builtin(name).unwrap(), Source::Builtin));
        let (mut surfaces, context) = (Surfaces::default(), Context::default());
        surfaces.follow(&document, true, &context);
        let begin = Instant::now();
        while surfaces.tree.is_none() && document.scene().spheres.len() > SCAN_LIMIT {
            assert!(begin.elapsed() < Duration::from_secs(60), "never built");
            std::thread::sleep(Duration::from_millis(5));
            surfaces.follow(&document, true, &context);
        }
        (document, surfaces)
    }

    /// The smallest distance from a point to a surface; negative inside.
    fn clearance(document: &Document, at: DVec3) -> f64 {
        let far = |sphere: &Sphere| at.distance(sphere.center) - sphere.radius;
        document.scene().spheres.iter().map(far).fold(f64::INFINITY, f64::min)
    }

    /// Moves the camera many times and checks it each time.
    fn moved(name: &str, step: impl Fn(&Camera) -> (Camera, Option<DVec3>)) -> (Document, Camera) {
        let (document, surfaces) = opened(name);
        let (first, mut camera) = (document.camera, document.camera);
        for _ in 0..400 {
            let (after, pivot) = step(&camera);
            camera = surfaces.stop(&document, &camera, &after, pivot);
            let clearance = clearance(&document, camera.look_from);
            assert!(clearance > 0.0, "{name}: {clearance} at {}", camera.look_from);
        }
        assert_ne!(camera, first);
        (document, camera)
    }

    #[test]
    fn an_orbit_downwards_stays_above_the_ground() {
        for name in ["book", "field:10000"] {
            let (document, camera) = moved(name, |camera| {
                let pivot = camera.look_at;
                (navigation::orbit(camera, pivot, 0.003, -0.02), Some(pivot))
            });
            let (before, after) =
                [document.camera, camera].map(|camera| camera.look_from.distance(camera.look_at)).into();
            assert!(after > 0.5 * before && after < 2.0 * before, "{name}: from {before} to {after}");
        }
    }

    #[test]
    fn an_orbit_along_the_ground_keeps_its_distance() {
        let mut recipe = Recipe::builtin("field:10").unwrap();
        Arc::make_mut(&mut recipe.scene).spheres.truncate(1);
        let document = Document::new(Origin::new(recipe, Source::Builtin));
        let (surfaces, before) = (Surfaces::default(), document.camera);
        for (down, aside) in [(0.02, [0.5, 0.5]), (0.6, [0.5, 0.5]), (0.02, [0.7, 0.8])] {
            let mut camera = before;
            let pivot = match aside {
                [0.5, 0.5] => before.look_at,
                _ => surfaces.pick(&document, &before, aside).unwrap().point,
            };
            for _ in 0..100 {
                let after = navigation::orbit(&camera, pivot, 0.003, -down);
                camera = surfaces.stop(&document, &camera, &after, Some(pivot));
            }
            let [old, new] = [before, camera].map(|camera| camera.look_from.distance(pivot));
            assert!((new / old - 1.0).abs() < 0.01, "{down}: from {old} to {new}");
            assert!(clearance(&document, camera.look_from) < 0.01 * old, "{down}: {}", camera.look_from);
            let place = camera.place_of(pivot, document.aspect()).unwrap();
            let off = [0, 1].map(|axis| (place[axis] - aside[axis]).abs());
            assert!(off[0] < 0.02 && off[1] < 0.02, "{down}: the pivot went from {aside:?} to {place:?}");
        }
    }

    #[test]
    fn a_dolly_stops_in_front_and_a_flight_keeps_its_direction() {
        let (document, camera) = moved("three-spheres", |camera| {
            (navigation::dolly(camera, camera.look_at, 0.9), Some(camera.look_at))
        });
        assert!(clearance(&document, camera.look_from) < 0.01, "close to the ball: {}", camera.look_from);
        let ahead = |camera: &Camera| (camera.look_at - camera.look_from).normalize();
        for by in [DVec3::Z, DVec3::NEG_Y, DVec3::X, DVec3::new(0.3, -1.0, 1.0)] {
            let (document, camera) = moved("book", |camera| (navigation::fly(camera, 0.2 * by), None));
            assert!(ahead(&camera).distance(ahead(&document.camera)) < 1e-9, "{by}");
        }
    }

    #[test]
    fn the_innermost_sphere_is_named() {
        let (mut document, mut surfaces) = opened("three-spheres");
        let context = Context::default();
        assert_eq!(surfaces.inside(&document), None);
        let (index, sphere) = document
            .scene()
            .spheres
            .iter()
            .enumerate()
            .min_by(|a, b| a.1.radius.total_cmp(&b.1.radius))
            .map(|(index, sphere)| (index, *sphere))
            .unwrap();
        document.camera.look_from = sphere.center;
        surfaces.follow(&document, true, &context);
        let words = surfaces.inside(&document).unwrap();
        assert!(words.starts_with(&format!("the camera is inside sphere {index} (")), "{words}");
    }

    /// Puts a sphere around the camera.
    fn enclose(document: &mut Document) {
        let mut scene = document.scene().clone();
        let clear = scene.add_material("clear", Material::Dielectric { refraction_index: 1.5 });
        scene.add_sphere(document.camera.look_from, 0.25, clear);
        document.checked = Arc::new(CheckedScene::new(Arc::new(scene), *document.rules()));
    }

    #[test]
    fn a_sphere_that_comes_to_be_around_the_camera_is_named_where_there_are_rays() {
        for (stage, has_rays) in [("metal", true), ("ppm-gradient", false)] {
            let mut document = Document::new(Origin::of_stage(Stage::find(stage).unwrap()));
            let (mut surfaces, context) = (Surfaces::default(), Context::default());
            surfaces.follow(&document, true, &context);
            enclose(&mut document);
            assert_eq!(surfaces.inside(&document), None, "the changed scene has not been looked at");
            surfaces.follow(&document, true, &context);
            let sphere = document.scene().spheres.len() - 1;
            let words = format!("the camera is inside sphere {sphere} (clear)");
            assert_eq!(surfaces.inside(&document), has_rays.then_some(words), "{stage}");
        }
    }

    #[test]
    fn a_hierarchy_is_asked_for_after_the_picture_and_is_that_of_the_scene() {
        let (mut document, mut surfaces) = opened("field:10000");
        let context = Context::default();
        let (old, tree) = (Arc::clone(&document.checked), surfaces.tree.take());
        assert!(tree.is_some());
        enclose(&mut document);
        surfaces.answers.answer(&context).give((old, tree));
        surfaces.follow(&document, false, &context);
        assert!(surfaces.tree.is_none(), "it is that of another scene");
        assert!(!surfaces.is_asked, "there is no picture yet");
        surfaces.follow(&document, true, &context);
        assert!(surfaces.is_asked);
        let (scene, tree) = surfaces.answers.wait().unwrap();
        assert!(Arc::ptr_eq(&scene, &document.checked) && tree.is_some());
    }

    #[test]
    fn the_hierarchy_finds_what_a_scan_finds() {
        let (document, surfaces) = opened("field:10000");
        let scan = Near { scene: document.scene(), tree: None };
        let tree = surfaces.near(&document);
        let mut found = 0;
        for (index, sphere) in document.scene().spheres.iter().enumerate().skip(1).step_by(97) {
            assert_eq!(tree.innermost(sphere.center), scan.innermost(sphere.center));
            let [from, to] = [2.0, -2.0].map(|up| sphere.center + DVec3::new(0.1, up, 0.2));
            assert_eq!(tree.slide(from, to, 0.01, None), scan.slide(from, to, 0.01, None), "sphere {index}");
            found += 1;
        }
        assert!(found > 50);
    }

    #[test]
    fn the_wheel_never_leads_through_what_is_under_the_pointer() {
        for (name, place) in
            [("three-spheres", [0.62, 0.5]), ("book", [0.3, 0.7]), ("field:10000", [0.5, 0.9])]
        {
            let (document, surfaces) = opened(name);
            let (first, aspect) = (document.camera, document.aspect());
            let direction = first.direction_through(place, aspect);
            let target = surfaces.pick(&document, &first, place).unwrap();
            let mut camera = first;
            for _ in 0..200 {
                let point = surfaces.pick(&document, &camera, place).unwrap().point;
                let after = navigation::dolly(&camera, point, 0.8);
                camera = surfaces.stop(&document, &camera, &after, Some(point));
                assert!(clearance(&document, camera.look_from) > 0.0, "{name}");
            }
            let left = camera.look_from.distance(target.point);
            assert!(left < 0.06 * target.distance, "{name}: {left} of {}", target.distance);
            assert!(camera.direction_through(place, aspect).distance(direction) < 1e-5, "{name}");
            // A blocked wheel does not go on to bring what is looked at nearer.
            let ahead = camera.look_from.distance(camera.look_at);
            assert!(ahead > 0.1 * left, "{name}: looks {ahead} ahead, {left} before the surface");
        }
    }

    #[test]
    fn the_hierarchy_picks_what_a_scan_picks() {
        let (document, surfaces) = opened("field:10000");
        let (camera, scene) = (document.camera, document.scene());
        let mut hits = 0;
        for y in 0..40 {
            for x in 0..60 {
                let place = [(f64::from(x) + 0.5) / 60.0, (f64::from(y) + 0.5) / 40.0];
                let direction = camera.direction_through(place, document.aspect());
                let scanned = scene.pick(camera.look_from, direction);
                assert_eq!(surfaces.pick(&document, &camera, place), scanned, "{place:?}");
                hits += usize::from(scanned.is_some_and(|pick| pick.sphere > 0));
                // From within a sphere, and along the axes of the boxes.
                let eye = scene.spheres[1 + 4 * (60 * y as usize + x as usize)].center;
                for direction in [direction, DVec3::X, DVec3::NEG_Y] {
                    let picked = surfaces.near(&document).pick(eye, direction);
                    assert_eq!(picked, scene.pick(eye, direction), "{eye} {direction}");
                }
            }
        }
        assert!(hits > 300, "{hits}");
    }

    #[test]
    fn a_move_among_a_million_spheres_looks_at_few_of_them() {
        let (document, surfaces) = opened("field:1000000");
        let mut camera = document.camera;
        let mut most = 0;
        for step in 0..300 {
            let pivot = camera.look_at;
            let wanted = match step % 3 {
                0 => navigation::orbit(&camera, pivot, 0.01, -0.02),
                1 => navigation::dolly(&camera, pivot, 0.97),
                _ => navigation::fly(&camera, DVec3::new(0.0, -0.5, 2.0)),
            };
            let (mut count, length) = (0, wanted.look_from.distance(camera.look_from));
            surfaces.near(&document).each(camera.look_from, length, |_, _| count += 1);
            most = most.max(count);
            camera = surfaces.stop(&document, &camera, &wanted, Some(pivot));
        }
        assert!((1..2000).contains(&most), "{most}");
    }

    #[test]
    fn a_camera_stops_as_far_from_a_surface_as_its_lens_is_wide() {
        let mut recipe = Recipe::builtin("field:10").unwrap();
        let scene = Arc::make_mut(&mut recipe.scene);
        scene.spheres.truncate(1);
        (scene.spheres[0].center, scene.spheres[0].radius) = (DVec3::new(0.0, 0.0, -5.0), 1.0);
        let document = Document::new(Origin::new(recipe, Source::Builtin));
        let camera =
            Camera { look_from: DVec3::ZERO, look_at: DVec3::NEG_Z, focus_distance: None, ..Camera::BOOK };
        for (lens, gap) in [(0.0, 0.001), (0.02, 0.02), (0.2, 0.05)] {
            let defocus_angle_degrees = 2.0 * f64::atan(lens).to_degrees();
            let before = Camera { defocus_angle_degrees, ..camera };
            let by = DVec3::new(0.0, 0.0, -10.0);
            let after = Camera { look_from: by, look_at: by + DVec3::NEG_Z, ..before };
            let stopped = Surfaces::default().stop(&document, &before, &after, None);
            assert!((stopped.look_from.z + 4.0 - gap).abs() < 1e-9, "{lens}: {}", stopped.look_from);
            let ahead = stopped.look_at - stopped.look_from;
            assert!(ahead.distance(DVec3::NEG_Z) < 1e-12, "{lens}: {ahead}");
            let turned = Camera { look_at: DVec3::X, ..before };
            assert_eq!(Surfaces::default().stop(&document, &before, &turned, None), turned, "it stays there");
            let away = Camera { look_from: DVec3::Z, look_at: DVec3::ZERO, ..before };
            assert_eq!(Surfaces::default().stop(&document, &before, &away, None), away, "nothing is there");
        }
    }
}
