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

    use crate::job::recipe::Recipe;

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
}
