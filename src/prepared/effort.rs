//! How thoroughly the trees are built.

use obvhs::BvhBuildParams;

/// How long a build may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// About 0.1 s or less on one core, and at most 1 µs per sphere: for a picture that someone waits for.
    Quick,
    /// As long as the best tree takes: up to 20 times as long, on one core.
    Thorough,
}

#[derive(Clone, Copy)]
pub(super) struct Leaves {
    /// Maximum number of spheres in a leaf.
    pub most: u32,
    /// Cost of a packet's visit to a node, in sphere tests. Higher costs make fuller leaves.
    visit_cost: f32,
}

impl Leaves {
    /// One sphere per leaf.
    pub const SINGLE: Leaves = Leaves { most: 1, visit_cost: 0.0 };
    /// For a tree that fits a core's cache. Between costs of 5 and 8, packets differ by less than 3 %, and one lane
    /// prefers 5.
    const SMALL: Leaves = Leaves { most: 12, visit_cost: 5.0 };
    /// For a tree whose nodes come from farther away.
    const FULL: Leaves = Leaves { most: 24, visit_cost: 8.0 };

    /// The leaves that gave the fastest traversal for this many spheres.
    pub fn of(spheres: usize) -> Leaves {
        if spheres <= 20_000 { Leaves::SMALL } else { Leaves::FULL }
    }
}

/// obvhs's build parameters for this many spheres.
pub(super) fn params(spheres: usize, leaves: Leaves, effort: Effort) -> BvhBuildParams {
    let preset = match (spheres, effort) {
        (0..=1_000, _) => BvhBuildParams::medium_build(),
        (1_001..=20_000, _) | (_, Effort::Thorough) => BvhBuildParams::very_slow_build(),
        (20_001..=200_000, Effort::Quick) => BvhBuildParams::slow_build(),
        (_, Effort::Quick) => BvhBuildParams::fast_build(),
    };
    // A split box would list its sphere twice.
    BvhBuildParams {
        pre_split: false,
        max_prims_per_leaf: leaves.most,
        collapse_traversal_cost: leaves.visit_cost,
        ..preset
    }
}
