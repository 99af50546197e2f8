//! Checks that a prepared scene has the properties that kernels rely on: indices in range, ties in order, boxes that
//! enclose their contents.

use super::PreparedScene;
use super::hierarchy::Hierarchy;
use crate::kernel::{
    AnchoredSphere, COUNT_MASK, EYE, Features, LoadShading, Node, ROOTS_MASK, Real, RecordColumns, Roots,
    STACK_SIZE, UNDER_EYE,
};
use crate::render::RenderJob;

/// Returns from the function with a message unless a condition holds.
macro_rules! ensure {
    ($condition:expr, $($message:tt)+) => {
        // A comparison with NaN counts as a failure.
        let holds: bool = $condition;
        if !holds {
            return Err(format!($($message)+));
        }
    };
}

impl<R: Real> PreparedScene<R> {
    /// Checks everything that kernels rely on in the prepared scene of `job`. Debug builds check every prepared scene.
    ///
    /// # Errors
    /// A description of the first violation.
    pub fn validate(&self, job: &RenderJob) -> Result<(), String> {
        self.validate_lists(job)?;
        self.validate_order()?;
        match &self.hierarchy {
            Some(hierarchy) => {
                let one_root = self.groups.opaque.len();
                validate_hierarchy(hierarchy, &self.two_root, one_root)?;
            }
            None => {
                for (number, [.., radius2]) in self.opaque.iter().chain(&self.two_root).enumerate() {
                    ensure!(
                        *radius2 >= R::default(),
                        "sphere {number} of a list has the squared radius {radius2:?}"
                    );
                }
            }
        }
        for (number, sphere) in self.anchored.iter().enumerate() {
            validate_anchored(number, sphere)?;
        }
        self.validate_rows()
    }

    /// Checks the lengths of all lists, and that the features agree with them.
    fn validate_lists(&self, job: &RenderJob) -> Result<(), String> {
        let listed = self.opaque.len() + self.two_root.len();
        let count = listed + self.anchored.len();
        ensure!(count < EYE as usize, "{count} spheres have no numbers below {EYE}");
        // With a hierarchy, the CPU also loops over the list of opaque spheres, while the GPU uses the hierarchy alone.
        ensure!(
            self.hierarchy.is_none() || self.opaque.is_empty(),
            "{} opaque spheres are beside the hierarchy",
            self.opaque.len()
        );
        let records = self.records.len();
        ensure!(records == count.max(1), "{count} spheres have {records} shading records");
        let indices = self.scene_index.len();
        ensure!(indices == count, "{count} spheres have {indices} indices of the scene");
        let of_scene = job.scene().spheres.len();
        let mut is_listed = vec![false; of_scene];
        for index in &self.scene_index {
            let Some(is_listed) = is_listed.get_mut(*index as usize) else {
                return Err(format!("sphere {index} is listed of a scene of {of_scene}"));
            };
            ensure!(!*is_listed, "sphere {index} of the scene is listed twice");
            *is_listed = true;
        }
        let features = Features::of(job, &self.sorted());
        ensure!(features == self.features, "the features are {:?}, not {features:?}", self.features);
        let limit = self.block_limit;
        ensure!(limit.is_power_of_two() && limit <= 128, "a block has {limit} samples");
        Ok(())
    }

    /// Checks the order of the list, which decides between two hits at the same distance.
    fn validate_order(&self) -> Result<(), String> {
        let groups = &self.groups;
        let anchored: Vec<u32> = groups.anchored.iter().map(|anchored| anchored.index).collect();
        for (name, group) in
            [("opaque", &groups.opaque), ("two-root", &groups.two_root), ("anchored", &anchored)]
        {
            let is_rising = group.is_sorted_by(|a, b| a < b);
            ensure!(is_rising, "the {name} spheres do not stand in the order of the scene");
        }
        let mut listed = groups.in_list_order();
        let count = self.opaque.len() + self.two_root.len();
        ensure!(listed.len() == count, "{count} spheres are listed of {}", listed.len());
        if let Some(hierarchy) = &self.hierarchy {
            let ranks = &hierarchy.ranks;
            ensure!(ranks.len() == count, "{count} spheres have {} ranks", ranks.len());
            let mut sorted = ranks.clone();
            sorted.sort_unstable();
            let is_permutation = sorted.iter().copied().eq(0..count as u32);
            ensure!(is_permutation, "the ranks are not the numbers 0 to {} once each", count - 1);
            listed = ranks.iter().map(|rank| listed[*rank as usize]).collect();
        }
        listed.extend(anchored);
        for (number, (is, should)) in self.scene_index.iter().zip(&listed).enumerate() {
            ensure!(is == should, "sphere {number} is {is} of the scene, but should be {should}");
        }
        Ok(())
    }

    /// Compares the shading records with their spheres.
    fn validate_rows(&self) -> Result<(), String> {
        let zero = R::default();
        for (number, (row, [x, y, z, radius2])) in
            self.records.iter().zip(self.opaque.iter().chain(&self.two_root)).enumerate()
        {
            validate_record(number, row)?;
            ensure!(row.reference() == [*x, *y, *z], "the shading record of sphere {number} is of another");
            ensure!(row.anchoring() == zero, "sphere {number} is in a list and anchored");
            let is_opaque = number < self.opaque.len() || *radius2 < zero;
            ensure!(
                !is_opaque || row.refraction_index() == zero,
                "sphere {number} has one root and a refraction index"
            );
        }
        let first = self.opaque.len() + self.two_root.len();
        for (number, (row, sphere)) in self.records[first..].iter().zip(&self.anchored).enumerate() {
            validate_record(first + number, row)?;
            let anchoring = if sphere.roots() == Roots::Farther { 2.0 } else { 1.0 };
            ensure!(
                row.anchoring().to_f64() == anchoring
                    && row.reference() == sphere.anchor
                    && row.inward() == sphere.inward,
                "the shading record of the anchored sphere {number} is of another"
            );
        }
        Ok(())
    }
}

fn validate_record<R: Real>(number: usize, row: &RecordColumns<R>) -> Result<(), String> {
    let zero = R::default();
    ensure!(row.0.iter().all(|x| x.to_f64().is_finite()), "the shading record of sphere {number} is {row:?}");
    ensure!(row.radius() > zero && row.curvature() > zero, "sphere {number} has no radius: {row:?}");
    let is_glass = row.refraction_index() > zero;
    ensure!(is_glass == (row.inverse_index() > zero), "sphere {number} is glass and is not: {row:?}");
    let weight = row.weight().to_f64();
    ensure!((-1.0..=1.0).contains(&weight), "the unit vector's part at sphere {number} is {weight}");
    Ok(())
}

fn validate_anchored<R: Real>(number: usize, sphere: &AnchoredSphere<R>) -> Result<(), String> {
    let flags = sphere.flags;
    let is_known = flags & !(ROOTS_MASK | UNDER_EYE) == 0 && flags & ROOTS_MASK <= Roots::Farther as u32;
    ensure!(is_known, "the anchored sphere {number} has the flags {flags:#x}");
    let length2: f64 = sphere.inward.iter().map(|x| x.to_f64() * x.to_f64()).sum();
    ensure!((length2 - 1.0).abs() < 1e-5, "the anchored sphere {number} has a normal of length^2 {length2}");
    ensure!(sphere.curvature > R::default(), "the anchored sphere {number} has no curvature");
    Ok(())
}

/// Checks that each node has one parent and is inside its box, and that each sphere is in one leaf and inside its box.
fn validate_hierarchy<R: Real>(
    hierarchy: &Hierarchy<R>,
    spheres: &[[R; 4]],
    one_root: usize,
) -> Result<(), String> {
    let Hierarchy { nodes, extent, ranks } = hierarchy;
    for (number, ([.., radius2], rank)) in spheres.iter().zip(ranks).enumerate() {
        let has_one_root = *radius2 < R::default();
        ensure!(
            has_one_root == ((*rank as usize) < one_root) && radius2.to_f64().abs() > 0.0,
            "sphere {number} of rank {rank} has the squared radius {radius2:?}, but {one_root} have one root"
        );
    }
    let mut is_reached = vec![false; nodes.len()];
    let mut is_held = vec![false; spheres.len()];
    let mut open = vec![(0_usize, 1_usize)];
    while let Some((index, depth)) = open.pop() {
        let Some(node) = nodes.get(index) else {
            return Err(format!("node {index} is named, but there are {}", nodes.len()));
        };
        ensure!(!is_reached[index], "node {index} has two parents");
        is_reached[index] = true;
        ensure!(depth <= STACK_SIZE, "the hierarchy has more than {STACK_SIZE} levels");
        let corners = node.low.iter().chain(&node.high);
        ensure!(
            corners.clone().all(|x| x.to_f64().abs() <= extent.to_f64()),
            "node {index} reaches farther than {extent:?}"
        );
        let (first, count) = (node.first as usize, (node.count & COUNT_MASK) as usize);
        if count == 0 {
            ensure!(node.count >> 30 < 3, "the children of node {index} lie apart along no axis");
            for child in [first, first + 1] {
                let is_within = nodes.get(child).is_none_or(|child| holds(node, child.low, child.high));
                ensure!(is_within, "node {child} reaches out of its parent {index}");
                open.push((child, depth + 1));
            }
            continue;
        }
        ensure!(
            first + count <= spheres.len(),
            "node {index} names the spheres {first} to {}, but there are {}",
            first + count - 1,
            spheres.len()
        );
        for number in first..first + count {
            ensure!(!is_held[number], "sphere {number} is in two leaves");
            is_held[number] = true;
            let [x, y, z, radius2] = spheres[number].map(R::to_f64);
            let radius = radius2.abs().sqrt();
            let [low, high] =
                [-radius, radius].map(|reach| [x, y, z].map(|center| R::from_f64(center + reach)));
            ensure!(holds(node, low, high), "sphere {number} reaches out of the leaf {index}");
        }
    }
    let lost = is_reached.iter().position(|is_reached| !is_reached);
    ensure!(lost.is_none(), "node {} has no parent", lost.unwrap_or_default());
    let lost = is_held.iter().position(|is_held| !is_held);
    ensure!(lost.is_none(), "sphere {} is in no leaf", lost.unwrap_or_default());
    Ok(())
}

fn holds<R: Real>(node: &Node<R>, low: [R; 3], high: [R; 3]) -> bool {
    (0..3).all(|axis| node.low[axis] <= low[axis] && high[axis] <= node.high[axis])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recipe::Recipe;
    use crate::scene::builtin::BuiltinScene;
    use crate::stages::Stage;
    use glam::DVec3;

    fn job(scene: &str) -> RenderJob {
        Recipe::find(scene).expect("a built-in scene").job().expect("valid")
    }

    /// A job whose prepared scene has anchored spheres beside a hierarchy.
    fn on_the_ground() -> RenderJob {
        let job = job("field:300");
        let mut camera = *job.camera();
        camera.look_from = DVec3::new(4.0, 1e-3, 3.0);
        job.seen_by(camera, *job.settings()).expect("valid")
    }

    #[test]
    fn tables_of_all_stages_and_scenes_are_valid() {
        let stages = Stage::ALL.iter().map(|stage| (stage.id, stage.recipe().job().expect("valid")));
        let scenes = BuiltinScene::ALL.iter().map(|scene| (scene.name, job(scene.name)));
        for (name, job) in stages.chain(scenes).chain([("ground", on_the_ground())]) {
            assert_eq!(PreparedScene::<f32>::new(&job).validate(&job), Ok(()), "{name}");
            assert_eq!(PreparedScene::<f64>::new(&job).validate(&job), Ok(()), "{name}");
            assert_eq!(PreparedScene::<f32>::as_list(&job).validate(&job), Ok(()), "{name}");
        }
    }

    #[test]
    fn tables_of_extreme_scenes_are_valid() {
        let cases =
            crate::measure::stress::cases().iter().filter(|case| case.recipe.scene.spheres.len() < 5000);
        for (case, form) in cases.flat_map(|case| case.forms().iter().map(move |form| (case, *form))) {
            let job = case.recipe_in(form).job().expect("valid");
            assert_eq!(PreparedScene::<f32>::new(&job).validate(&job), Ok(()), "{} {form:?}", case.id);
            assert_eq!(PreparedScene::<f64>::new(&job).validate(&job), Ok(()), "{} {form:?}", case.id);
        }
    }

    #[test]
    fn tables_that_follow_a_camera_are_valid() {
        let before = job("field:300");
        let mut prepared = PreparedScene::<f32>::new(&before);
        let job = on_the_ground().seen_by(*on_the_ground().camera(), *before.settings()).expect("valid");
        let shared = before.seen_by(*job.camera(), *job.settings()).expect("valid");
        if prepared.follow(&before, &shared) {
            assert_eq!(prepared.validate(&shared), Ok(()));
        }
        let mut camera = *before.camera();
        camera.look_from.x += 0.25;
        let moved = before.seen_by(camera, *before.settings()).expect("valid");
        let mut prepared = PreparedScene::<f32>::new(&before);
        assert!(prepared.follow(&before, &moved));
        assert_eq!(prepared.validate(&moved), Ok(()));
    }

    /// How a test damages a prepared scene, and part of the error that the check must report.
    type Damage = (&'static str, fn(&mut PreparedScene<f32>));

    fn refuses(job: &RenderJob, damages: &[Damage]) {
        let whole = PreparedScene::<f32>::new(job);
        assert_eq!(whole.validate(job), Ok(()));
        for (expected, damage) in damages {
            let mut damaged = whole.clone();
            damage(&mut damaged);
            let message = damaged.validate(job).expect_err(expected);
            assert!(message.contains(expected), "{message:?} does not say {expected:?}");
        }
    }

    #[test]
    fn a_damaged_list_is_refused() {
        refuses(
            &job("three-spheres"),
            &[
                ("shading records", |prepared| prepared.records.truncate(1)),
                ("indices of the scene", |prepared| prepared.scene_index.push(0)),
                ("listed of a scene of", |prepared| prepared.scene_index[0] = 77),
                ("listed twice", |prepared| prepared.scene_index[1] = prepared.scene_index[0]),
                ("features are", |prepared| prepared.features.two_root = false),
                ("features are", |prepared| prepared.features.opaque_count += 1),
                ("samples", |prepared| prepared.block_limit = 3),
                ("samples", |prepared| prepared.block_limit = 256),
                ("order of the scene", |prepared| prepared.groups.two_root.reverse()),
                ("but should be", |prepared| prepared.scene_index.swap(0, 1)),
                ("squared radius", |prepared| prepared.two_root[0][3] = -0.25),
                ("squared radius", |prepared| prepared.two_root[0][3] = f32::NAN),
                ("is of another", |prepared| prepared.records.swap(0, 1)),
                ("in a list and anchored", |prepared| prepared.records[0].0[15] = 1.0),
                ("one root and a refraction", |prepared| prepared.records[0].0[9..11].fill(1.5)),
                ("is glass and is not", |prepared| prepared.records[0].0[10] = 1.5),
                ("has no radius", |prepared| prepared.records[0].0[7] = 0.0),
                ("unit vector's part", |prepared| prepared.records[0].0[8] = 1.5),
                ("unit vector's part", |prepared| prepared.records[0].0[8] = -1.5),
                ("shading record of sphere", |prepared| prepared.records[0].0[4] = f32::NAN),
            ],
        );
    }

    #[test]
    fn a_damaged_hierarchy_is_refused() {
        fn tree(prepared: &mut PreparedScene<f32>) -> &mut Hierarchy<f32> {
            prepared.hierarchy.as_mut().expect("a hierarchy")
        }
        fn leaf(prepared: &mut PreparedScene<f32>) -> &mut Node<f32> {
            let nodes = &mut tree(prepared).nodes;
            nodes.iter_mut().rfind(|node| node.count & COUNT_MASK > 0).expect("a leaf")
        }
        refuses(
            &job("field:300"),
            &[
                ("beside the hierarchy", |prepared| {
                    let sphere = prepared.two_root.remove(0);
                    prepared.opaque.push(sphere);
                }),
                ("ranks", |prepared| tree(prepared).ranks.truncate(1)),
                ("once each", |prepared| tree(prepared).ranks[0] = tree(prepared).ranks[1]),
                ("but should be", |prepared| tree(prepared).ranks.swap(0, 1)),
                ("have one root", |prepared| prepared.two_root[0][3] *= -1.0),
                ("two parents", |prepared| tree(prepared).nodes[0].first = 0),
                ("is named, but there are", |prepared| tree(prepared).nodes[0].first = 1 << 20),
                ("two parents", |prepared| {
                    let nodes = &mut tree(prepared).nodes;
                    let root = nodes[0].first as usize;
                    (nodes[root], nodes[root].count) = (nodes[root + 1], nodes[root + 1].count);
                    let whole = nodes[0];
                    (nodes[root].low, nodes[root].high) = (whole.low, whole.high);
                }),
                ("reaches out of", |prepared| tree(prepared).nodes[0].low[0] += 0.5),
                ("reaches out of the leaf", |prepared| {
                    let leaf = leaf(prepared);
                    leaf.high[1] = leaf.low[1];
                }),
                ("reaches farther than", |prepared| tree(prepared).extent = 1.0),
                ("names the spheres", |prepared| leaf(prepared).count += 1000),
                ("no axis", |prepared| tree(prepared).nodes[0].count |= 3 << 30),
                ("is in ", |prepared| leaf(prepared).count -= 1),
            ],
        );
    }

    #[test]
    fn damaged_anchored_spheres_are_refused() {
        refuses(
            &on_the_ground(),
            &[
                ("flags", |prepared| prepared.anchored[0].flags |= 8),
                ("length^2", |prepared| prepared.anchored[0].inward = [0.5, 0.5, 0.5]),
                ("no curvature", |prepared| prepared.anchored[0].curvature = 0.0),
                ("is of another", |prepared| prepared.anchored[0].anchor[0] += 1.0),
                ("features are", |prepared| prepared.anchored[0].flags |= UNDER_EYE),
                ("spheres have", |prepared| prepared.anchored.clear()),
            ],
        );
    }
}
