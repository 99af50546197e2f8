// The inputs and outputs of the shaders. Only this file names groups and bindings. The structs and all constants, tags
// and overrides are declared in src/kernel.

@group(0) @binding(0) var<uniform> job: Job;
@group(0) @binding(1) var<storage, read> spheres: array<vec4f>;
@group(0) @binding(2) var<storage, read> anchored: array<AnchoredSphere>;
@group(0) @binding(3) var<storage, read> records: array<ShadingRecord>;
@group(0) @binding(4) var<storage, read> nodes: array<vec4u>;

@group(1) @binding(0) var<uniform> order: Dispatch;
@group(1) @binding(1) var<storage, read> blocks: array<Block>;
@group(1) @binding(2) var<storage, read_write> film: array<PixelSum>;
@group(1) @binding(3) var<storage, read_write> counters: Counters;

@group(2) @binding(0) var<storage, read_write> words: array<u32>;

fn load_words(base: u32) -> vec3u {
    return vec3u(words[base], words[base + 1u], words[base + 2u]);
}

fn load_vector(base: u32) -> vec3f {
    return bitcast<vec3f>(load_words(base));
}

fn store_words(base: u32, v: vec3u) {
    words[base] = v.x;
    words[base + 1u] = v.y;
    words[base + 2u] = v.z;
}

fn store_vector(base: u32, v: vec3f) {
    store_words(base, bitcast<vec3u>(v));
}

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

fn cwbvh_node_at(number: u32) -> CwbvhNode {
    let first = 5u * number;
    let low = nodes[first];
    let more = nodes[first + 1u];
    return CwbvhNode(
        bitcast<vec3f>(low.xyz), low.w, more.x, more.y, more.zw, nodes[first + 2u], nodes[first + 3u], nodes[first + 4u],
    );
}

// A sphere's place in the list, which differs from its place in the leaves. The places are stored after the nodes.
fn rank_of(number: u32) -> u32 {
    return nodes[select(WHOLE_ROWS, 5u, CWBVH) * job.node_count + number / 4u][number % 4u];
}

// Adds sums to a pixel of the film. No other thread writes to this pixel.
fn add_to_film(half: u32, pixel: u32, sums: vec3u) {
    let index = half * job.width * order.row_count + pixel;
    let sum = film[index];
    film[index] = PixelSum(wide_sum(sum.red, sums.x), wide_sum(sum.green, sums.y), wide_sum(sum.blue, sums.z));
}

fn wide_sum(sum: vec2u, more: u32) -> vec2u {
    let low = sum.x + more;
    return vec2u(low, sum.y + select(0u, 1u, low < more));
}
