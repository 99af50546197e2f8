//! Checks the properties of a prepared scene that kernels rely on: lists of the right length, ties in order, boxes that
//! enclose their contents.

use super::*;
use crate::job::recipe::Recipe;
use crate::kernel::{EYE, LoadShading, Node, STACK_SIZE};
use crate::scene::builtin::BuiltinScene;
use crate::stages::Stage;

/// Returns a message unless a condition holds.
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
    /// Checks what kernels rely on in the prepared scene of `job`. The error describes the first violation. Unit tests
    /// check every scene that is prepared.
    pub(super) fn validate(&self, job: &RenderJob) -> Result<(), String> {
        let listed = self.opaque.len() + self.two_root.len();
        let count = listed + self.anchored.len();
        ensure!(count < EYE as usize, "{count} spheres have no numbers below {EYE}");
        let records = self.records.len();
        ensure!(records == count.max(1), "{count} spheres have {records} shading records");
        let limit = self.block_limit;
        ensure!(limit.is_power_of_two() && limit <= 128, "a block has {limit} samples");
        let features = Features::of(job, &self.sorted());
        ensure!(features == self.features, "the features are {:?}, not {features:?}", self.features);
        self.validate_order()?;
        self.validate_rows()?;
        match &self.hierarchy {
            Some(hierarchy) => {
                // The CPU would also loop over the opaque spheres, while the GPU only uses the hierarchy.
                ensure!(self.opaque.is_empty(), "{} spheres are beside the hierarchy", self.opaque.len());
                validate_hierarchy(hierarchy, &self.two_root, self.groups.opaque.len())
            }
            None => {
                let mut listed = self.opaque.iter().chain(&self.two_root);
                let has_sign = listed.any(|[.., radius2]| radius2.to_f64().is_sign_negative());
                ensure!(!has_sign, "a sphere of a list has a negative squared radius");
                Ok(())
            }
        }
    }

    /// Checks the order of the list, which decides between hits at the same distance.
    fn validate_order(&self) -> Result<(), String> {
        let groups = &self.groups;
        let anchored: Vec<u32> = groups.anchored.iter().map(|anchored| anchored.index).collect();
        for group in [&groups.opaque, &groups.two_root, &anchored] {
            ensure!(group.is_sorted_by(|a, b| a < b), "a group does not stand in the order of the scene");
        }
        let mut listed = groups.in_list_order();
        if let Some(hierarchy) = &self.hierarchy {
            let mut sorted = hierarchy.ranks.clone();
            sorted.sort_unstable();
            ensure!(sorted.into_iter().eq(0..listed.len() as u32), "the ranks are not each number once");
            listed = hierarchy.ranks.iter().map(|rank| listed[*rank as usize]).collect();
        }
        listed.extend(anchored);
        ensure!(self.scene_index == listed, "the spheres do not stand in the order of the groups");
        Ok(())
    }

    fn validate_rows(&self) -> Result<(), String> {
        let listed = self.opaque.iter().chain(&self.two_root).map(|[x, y, z, _]| ([*x, *y, *z], false));
        let anchored = self.anchored.iter().map(|sphere| (sphere.anchor, true));
        for (number, (row, (place, is_anchored))) in
            self.records.iter().zip(listed.chain(anchored)).enumerate()
        {
            ensure!(
                row.0.iter().all(|x| x.to_f64().is_finite()),
                "the shading record of sphere {number} is {row:?}"
            );
            let is_own = row.reference() == place && is_anchored == (row.anchoring() > R::default());
            ensure!(is_own, "the shading record of sphere {number} is of another");
        }
        Ok(())
    }
}

/// Checks that each node has one parent and is inside its box, and that each sphere is in one leaf and inside its box.
fn validate_hierarchy<R: Real>(
    hierarchy: &Hierarchy<R>,
    spheres: &[[R; 4]],
    one_root: usize,
) -> Result<(), String> {
    let Hierarchy { nodes, extent, ranks, wide } = hierarchy;
    for (number, ([.., radius2], rank)) in spheres.iter().zip(ranks).enumerate() {
        let has_one_root = radius2.to_f64() < 0.0;
        ensure!(has_one_root == ((*rank as usize) < one_root), "sphere {number} has a wrong number of roots");
    }
    if wide.is_some() || nodes.is_empty() {
        // The GPU's nodes are checked when they are built, and are later on the device only.
        return Ok(());
    }
    let (mut reached, mut held) = (0, vec![false; spheres.len()]);
    let mut open = vec![(0_usize, 1_usize)];
    while let Some((index, depth)) = open.pop() {
        let Some(node) = nodes.get(index) else {
            return Err(format!("node {index} is named, but there are {}", nodes.len()));
        };
        reached += 1;
        ensure!(reached <= nodes.len() && depth <= STACK_SIZE, "node {index} is reached twice or too deep");
        let mut corners = node.low.iter().chain(&node.high);
        let is_within = corners.all(|x| x.to_f64().abs() <= extent.to_f64());
        ensure!(is_within, "node {index} reaches farther than {extent:?}");
        let (first, count) = (node.first as usize, node.sphere_count() as usize);
        if count == 0 {
            for child in [first, first + 1] {
                let is_within = nodes.get(child).is_none_or(|child| holds(node, child.low, child.high));
                ensure!(is_within, "node {child} reaches out of its parent {index}");
                open.push((child, depth + 1));
            }
        }
        for number in first..first + count {
            ensure!(held.get(number) == Some(&false), "sphere {number} is in two leaves, or out of range");
            held[number] = true;
            let [x, y, z, radius2] = spheres[number].map(R::to_f64);
            let radius = radius2.abs().sqrt();
            let [low, high] =
                [-radius, radius].map(|reach| [x, y, z].map(|center| R::from_f64(center + reach)));
            ensure!(holds(node, low, high), "sphere {number} reaches out of the leaf {index}");
        }
    }
    ensure!(
        reached == nodes.len() && held.iter().all(|is_held| *is_held),
        "a node or a sphere is not reached"
    );
    Ok(())
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

fn assert_valid(name: &str, job: &RenderJob) {
    assert_eq!(PreparedScene::<f32>::new(job).validate(job), Ok(()), "{name}");
    assert_eq!(PreparedScene::<f64>::new(job).validate(job), Ok(()), "{name}");
    assert_eq!(PreparedScene::<f32>::as_list(job).validate(job), Ok(()), "{name}");
    let mut announced = None;
    let for_gpu =
        PreparedScene::<f32>::for_gpu(&AtomicBool::new(false), job, |needed| announced = Some(*needed));
    let for_gpu = for_gpu.expect("it is not cancelled");
    assert_eq!(for_gpu.validate(job), Ok(()), "{name}");
    assert!(announced.is_none_or(|announced| announced == for_gpu.features), "{name}");
}

#[test]
fn prepared_stages_and_scenes_are_valid() {
    Stage::ALL.iter().for_each(|stage| assert_valid(stage.id, &stage.recipe().job().expect("valid")));
    BuiltinScene::ALL.iter().for_each(|scene| assert_valid(scene.name, &job(scene.name)));
    assert_valid("ground", &on_the_ground());
    for case in crate::measure::stress::cases().iter().filter(|case| case.recipe.scene.spheres.len() < 5000) {
        case.forms().iter().for_each(|(_, recipe)| assert_valid(&case.id, &recipe.job().expect("valid")));
    }
}

#[test]
fn scene_following_camera_is_valid() {
    let before = job("field:300");
    let mut camera = *before.camera();
    camera.look_from.x += 0.25;
    let moved = before.seen_by(camera, *before.settings()).expect("valid");
    let mut prepared = PreparedScene::<f32>::new(&before);
    assert!(prepared.try_reuse(&before, &moved));
    assert_eq!(prepared.validate(&moved), Ok(()));
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
