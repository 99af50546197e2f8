//! Checks the properties of a prepared scene that kernels rely on: lists of the right length, ties in order, boxes that
//! enclose their contents.

use super::*;
use crate::job::recipe::Recipe;
use crate::kernel::{EYE, LoadShading, Node, STACK_SIZE};
use crate::scene::builtin::BuiltinScene;
use crate::stages::Stage;

impl<R: Real> PreparedScene<R> {
    /// Checks what kernels rely on in the prepared scene of `job`.
    pub(super) fn validate(&self, job: &RenderJob) {
        let listed = self.opaque.len() + self.two_root.len();
        let count = listed + self.anchored.len();
        assert!(count < EYE as usize, "{count} spheres have no numbers below {EYE}");
        assert_eq!(self.records.len(), count.max(1), "shading records of {count} spheres");
        let limit = self.block_limit;
        assert!(limit.is_power_of_two() && limit <= 128, "a block has {limit} samples");
        assert_eq!(Features::of(job, &self.sorted()), self.features);
        self.validate_order();
        self.validate_rows();
        if let Some(hierarchy) = &self.hierarchy {
            // The CPU would also loop over the opaque spheres, while the GPU only uses the hierarchy.
            assert!(self.opaque.is_empty(), "{} spheres are beside the hierarchy", self.opaque.len());
            validate_hierarchy(hierarchy, &self.two_root, self.groups.opaque.len());
        } else {
            let mut listed = self.opaque.iter().chain(&self.two_root);
            assert!(listed.all(|[.., radius2]| radius2.to_f64() >= 0.0), "a negative squared radius");
        }
    }

    /// Checks the order of the list, which decides between hits at the same distance.
    fn validate_order(&self) {
        let groups = &self.groups;
        let anchored: Vec<u32> = groups.anchored.iter().map(|anchored| anchored.index).collect();
        for group in [&groups.opaque, &groups.two_root, &anchored] {
            assert!(group.is_sorted_by(|a, b| a < b), "a group does not stand in the order of the scene");
        }
        let mut listed = groups.in_list_order();
        if let Some(hierarchy) = &self.hierarchy {
            let mut sorted = hierarchy.ranks.clone();
            sorted.sort_unstable();
            assert!(sorted.into_iter().eq(0..listed.len() as u32), "the ranks are not each number once");
            listed = hierarchy.ranks.iter().map(|rank| listed[*rank as usize]).collect();
        }
        listed.extend(anchored);
        assert_eq!(self.scene_index, listed, "the order of the groups");
    }

    fn validate_rows(&self) {
        let listed = self.opaque.iter().chain(&self.two_root).map(|[x, y, z, _]| ([*x, *y, *z], false));
        let anchored = self.anchored.iter().map(|sphere| (sphere.anchor, true));
        for (row, (place, is_anchored)) in self.records.iter().zip(listed.chain(anchored)) {
            assert!(row.0.iter().all(|x| x.to_f64().is_finite()), "{row:?}");
            assert!(row.reference() == place && is_anchored == (row.anchoring() > R::default()), "{row:?}");
        }
    }
}

/// Checks that each node has one parent and is inside its box, and that each sphere is in one leaf and inside its box.
fn validate_hierarchy<R: Real>(hierarchy: &Hierarchy<R>, spheres: &[[R; 4]], one_root: usize) {
    let Hierarchy { nodes, extent, ranks, wide } = hierarchy;
    for (number, ([.., radius2], rank)) in spheres.iter().zip(ranks).enumerate() {
        assert_eq!(radius2.to_f64() < 0.0, (*rank as usize) < one_root, "roots of sphere {number}");
    }
    if wide.is_some() || nodes.is_empty() {
        // The GPU's nodes are checked when they are built, and are later on the device only.
        return;
    }
    let (mut reached, mut held) = (0, vec![false; spheres.len()]);
    let mut open = vec![(0_usize, 1_usize)];
    while let Some((index, depth)) = open.pop() {
        let node = &nodes[index];
        reached += 1;
        assert!(reached <= nodes.len() && depth <= STACK_SIZE, "node {index} is reached twice or too deep");
        let mut corners = node.low.iter().chain(&node.high);
        assert!(corners.all(|x| x.to_f64().abs() <= extent.to_f64()), "node {index} is beyond {extent:?}");
        let (first, count) = (node.first as usize, node.sphere_count() as usize);
        if count == 0 {
            for child in [first, first + 1] {
                assert!(holds(node, nodes[child].low, nodes[child].high), "node {child} out of {index}");
                open.push((child, depth + 1));
            }
        }
        for number in first..first + count {
            assert!(!std::mem::replace(&mut held[number], true), "sphere {number} is in two leaves");
            let [x, y, z, radius2] = spheres[number].map(R::to_f64);
            let radius = radius2.abs().sqrt();
            let [low, high] =
                [-radius, radius].map(|reach| [x, y, z].map(|center| R::from_f64(center + reach)));
            assert!(holds(node, low, high), "sphere {number} reaches out of the leaf {index}");
        }
    }
    assert!(reached == nodes.len() && held.iter().all(|is_held| *is_held), "not all is reached");
}

fn holds<R: Real>(node: &Node<R>, low: [R; 3], high: [R; 3]) -> bool {
    (0..3).all(|axis| node.low[axis] <= low[axis] && high[axis] <= node.high[axis])
}

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

#[expect(clippy::disallowed_macros, reason = "a failure shows the last name")]
fn assert_valid(name: &str, job: &RenderJob) {
    println!("{name}");
    PreparedScene::<f32>::new(job).validate(job);
    PreparedScene::<f64>::new(job).validate(job);
    PreparedScene::<f32>::as_list(job).validate(job);
    let mut announced = None;
    let for_gpu =
        PreparedScene::<f32>::for_gpu(&AtomicBool::new(false), job, |needed| announced = Some(*needed));
    let for_gpu = for_gpu.expect("it is not cancelled");
    for_gpu.validate(job);
    assert!(announced.is_none_or(|announced| announced == for_gpu.features), "{name}");
}

#[test]
fn prepared_stages_and_scenes_are_valid() {
    Stage::ALL.iter().for_each(|stage| assert_valid(stage.id, &stage.recipe().job().expect("valid")));
    BuiltinScene::ALL.iter().for_each(|scene| assert_valid(scene.name, &job(scene.name)));
    assert_valid("ground", &on_the_ground());
    assert_valid("regions", &job("field:50000"));
    for case in crate::measure::stress::cases().iter().filter(|case| case.recipe.scene.spheres.len() < 5000) {
        case.forms().iter().for_each(|(_, recipe)| assert_valid(&case.id, &recipe.job().expect("valid")));
    }
    // A scene that follows its camera.
    let before = job("field:300");
    let mut camera = *before.camera();
    camera.look_from.x += 0.25;
    let moved = before.seen_by(camera, *before.settings()).expect("valid");
    let mut prepared = PreparedScene::<f32>::new(&before);
    assert!(prepared.try_reuse(&before, &moved));
    prepared.validate(&moved);
}

#[test]
fn block_sum_fits_32_bits() {
    let limit = |units: f64| block_limit(units / FIXED_POINT_SCALE);
    for power in 1..=7 {
        // 2^power samples of this many units are 2^32 - 2^power, and one unit more makes 2^32.
        let units = f64::from(1_u32 << (32 - power)) - 1.0;
        assert_eq!(limit(units), 1_u32 << power, "{power}");
        assert_eq!([limit(units + 0.5), limit(units + 1.0)], [1_u32 << (power - 1); 2], "{power}");
    }
    assert_eq!([0.0, 0.3, 1.0, 1000.0].map(limit), [128; 4]);
    assert_eq!([4_294_967_295.0, 1e12].map(limit), [1; 2]);
}
