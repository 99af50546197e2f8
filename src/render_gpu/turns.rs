//! Limits on loop turns (iterations): some drivers end loops that have too many.

use crate::kernel::Features;
use crate::prepared::PreparedScene;
use crate::stages::SurfaceRule;

/// Loop turns that a thread of a dispatch may take over all its loops, not counting its last ray. After that, the
/// thread puts its path aside, and the next dispatch continues it.
///
/// This is half of the smallest limit known. llvmpipe ends every loop once the loops of a thread have taken 65,535
/// turns together; it runs 8 threads in step, and turns that two of them take count twice.
pub const TURN_LIMIT: u32 = 1 << 15;

/// Loop turns over lists for one ray. Twin: `turns_over_lists` in shaders/path.wgsl.
pub(super) fn turns_over_lists(features: &Features, prepared: &PreparedScene<f32>) -> u64 {
    let is_in_hierarchy = features.hierarchy && features.surface == SurfaceRule::Exact;
    let listed = if is_in_hierarchy { 0 } else { prepared.opaque.len() + prepared.two_root.len() };
    (prepared.anchored.len() + listed) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::recipe::Recipe;
    use crate::stages::Rules;

    #[test]
    fn a_ray_tests_all_spheres_that_are_in_no_hierarchy() {
        let turns = |name: &str, surface: SurfaceRule| {
            let mut recipe = Recipe::find(name).unwrap();
            recipe.rules = Rules { surface, ..recipe.rules };
            let prepared = PreparedScene::<f32>::new(&recipe.job().unwrap());
            let listed = prepared.opaque.len() + prepared.two_root.len();
            let turns = turns_over_lists(&prepared.features, &prepared) as usize;
            (turns - prepared.anchored.len(), listed)
        };
        assert_eq!(turns("field:60", SurfaceRule::Exact).0, 0);
        for (name, surface) in [("three-spheres", SurfaceRule::Exact), ("field:60", SurfaceRule::Book)] {
            let (turns, listed) = turns(name, surface);
            assert!(turns == listed && listed > 3, "{name}: {turns} {listed}");
        }
    }
}
