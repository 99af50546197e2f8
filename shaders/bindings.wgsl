// All that shaders share with the host, and the only file that names groups and bindings.
//
// Twin: src/render_gpu/layout.rs

// What a job is, the same for all its dispatches.
struct Job {
    camera: Camera,
    // Sky radiance at the horizon in units of the film.
    sky_middle: vec3f,
    // Largest coordinate of any box of the hierarchy.
    extent: f32,
    // Growth of it with the direction's y.
    sky_slope: vec3f,
    max_depth: u32,
    seed: u32,
    opaque_count: u32,
    two_root_count: u32,
    anchored_count: u32,
    width: u32,
    height: u32,
    // Pixels across a workgroup's tile.
    tile_width: u32,
    // Nodes of the hierarchy: a traversal visits each once at most.
    node_count: u32,
    // The spheres where they are few: all threads read one at a time, which constant memory is made for.
    few_spheres: array<vec4f, UNIFORM_SPHERES>,
    few_anchored: array<AnchoredSphere, UNIFORM_ANCHORED>,
}

// What one dispatch is to do: tiles `first_tile ..` of the picture, and the first `block_count` blocks.
struct Dispatch {
    first_tile: u32,
    tile_count: u32,
    block_count: u32,
    // Turns of its loops after which a thread puts its path aside.
    turn_limit: u32,
    // Rows of the picture that the film buffer holds.
    first_row: u32,
    row_count: u32,
    // For resolve: samples in the film.
    sample_count: u32,
    transfer: u32,
    // 1 where threads go on with what they put aside, 0 where they begin.
    resumes: u32,
    // The first of the words in which paths are put aside.
    first_aside: u32,
}

// `count` samples of a half of the film.
struct Block {
    half: u32,
    counter: u32,
    step: u32,
    count: u32,
}

// By sphere, what shading needs.
struct Row {
    // Centre, or anchor.
    reference: vec3f,
    curvature: f32,
    albedo: vec3f,
    weight: f32,
    radius: f32,
    index: f32,
    inverse_index: f32,
    normal_share: f32,
    // From the anchor to the centre.
    inward: vec3f,
    // 1 if anchored, 2 if every ray is inside.
    is_anchored: f32,
}

// Sums in units of 2^-24: low and high word.
struct PixelSum {
    red: vec2u,
    green: vec2u,
    blue: vec2u,
}

// What was counted: low and high words since the film was last sent for,
struct Counters {
    rays: atomic<u32>,
    rays_high: atomic<u32>,
    rejected: atomic<u32>,
    rejected_high: atomic<u32>,
    // and in this dispatch alone: samples whose sums are in the film,
    finished: atomic<u32>,
    finished_high: atomic<u32>,
    // threads that have put a path aside,
    unfinished: atomic<u32>,
    // and those of them that could not trace one ray to its end.
    stuck: atomic<u32>,
}

@group(0) @binding(0) var<uniform> job: Job;
@group(0) @binding(1) var<storage, read> spheres: array<vec4f>;
@group(0) @binding(2) var<storage, read> anchored: array<AnchoredSphere>;
@group(0) @binding(3) var<storage, read> rows: array<Row>;
@group(0) @binding(4) var<storage, read> nodes: array<vec4u>;

@group(1) @binding(0) var<uniform> order: Dispatch;
@group(1) @binding(1) var<storage, read> blocks: array<Block>;
@group(1) @binding(2) var<storage, read_write> film: array<PixelSum>;
@group(1) @binding(3) var<storage, read_write> counters: Counters;

@group(2) @binding(0) var<storage, read_write> words: array<u32>;

fn sphere_at(number: u32) -> vec4f {
    if FEW_SPHERES {
        return job.few_spheres[number];
    }
    return spheres[number];
}

fn anchored_at(number: u32) -> AnchoredSphere {
    if FEW_ANCHORED {
        return job.few_anchored[number];
    }
    return anchored[number];
}

fn node_at(number: u32) -> Node {
    let low = nodes[2u * number];
    let high = nodes[2u * number + 1u];
    return Node(bitcast<vec3f>(low.xyz), low.w, bitcast<vec3f>(high.xyz), high.w);
}

fn cwbvh_node_at(number: u32) -> CwbvhNode {
    let first = 5u * number;
    let low = nodes[first];
    let more = nodes[first + 1u];
    return CwbvhNode(
        bitcast<vec3f>(low.xyz), low.w, more.x, more.y, more.zw, nodes[first + 2u], nodes[first + 3u], nodes[first + 4u],
    );
}

// A sphere's place in the list that the leaves' order is not: it stands behind the nodes.
fn rank_of(number: u32) -> u32 {
    return nodes[select(2u, 5u, CWBVH) * job.node_count + number / 4u][number % 4u];
}

// Adds to a pixel of the film; no other thread has it.
fn add_to_film(half: u32, pixel: u32, sums: vec3u) {
    let index = half * job.width * order.row_count + pixel;
    let sum = film[index];
    film[index] = PixelSum(wide_sum(sum.red, sums.x), wide_sum(sum.green, sums.y), wide_sum(sum.blue, sums.z));
}

fn wide_sum(sum: vec2u, more: u32) -> vec2u {
    let low = sum.x + more;
    return vec2u(low, sum.y + select(0u, 1u, low < more));
}
