// The inputs and outputs of the shaders. Only this file names groups and bindings. The structs and all constants, tags
// and overrides are declared in src/kernel.

@group(0) @binding(0) var<uniform> job: Job;
@group(0) @binding(1) var<storage, read> spheres: array<vec4f>;
@group(0) @binding(2) var<storage, read> anchored: array<AnchoredSphere>;
@group(0) @binding(3) var<storage, read> records: array<ShadingRecord>;
@group(0) @binding(4) var<storage, read> nodes: array<vec4u>;

@group(1) @binding(0) var<uniform> dispatch: Dispatch;
@group(1) @binding(1) var<storage, read> blocks: array<Block>;
@group(1) @binding(2) var<storage, read_write> film: array<atomic<u32>>;
@group(1) @binding(3) var<storage, read_write> counters: Counters;

@group(2) @binding(0) var<storage, read_write> scratch: array<u32>;

fn load_words(base: u32) -> vec3u {
    return vec3u(scratch[base], scratch[base + 1u], scratch[base + 2u]);
}

fn load_vector(base: u32) -> vec3f {
    return bitcast<vec3f>(load_words(base));
}

fn store_words(base: u32, v: vec3u) {
    scratch[base] = v.x;
    scratch[base + 1u] = v.y;
    scratch[base + 2u] = v.z;
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

// Counts that are known when the kernel is compiled let its loops be unrolled.
fn opaque_count() -> u32 {
    return select(job.opaque_count, OPAQUE_COUNT, FEW_SPHERES);
}

fn two_root_count() -> u32 {
    return select(job.two_root_count, TWO_ROOT_COUNT, FEW_SPHERES);
}

fn anchored_count() -> u32 {
    return select(job.anchored_count, ANCHORED_COUNT, FEW_ANCHORED);
}

fn anchored_at(number: u32) -> AnchoredSphere {
    if FEW_ANCHORED {
        return job.few_anchored[number];
    }
    return anchored[number];
}

// A sphere's place in the list, which differs from its place in the leaves. The places are stored after the nodes.
fn rank_of(number: u32) -> u32 {
    return nodes[NODE_ROWS * job.node_count + number / 4u][number % 4u];
}

// Adds the path's sums to its pixel of the film.
fn add_to_film(path: Path) {
    let row = (path.pixel >> 16u) - dispatch.first_row;
    let pixel = (path.half * dispatch.row_count + row) * job.width + (path.pixel & 0xFFFFu);
    add_wide(6u * pixel, path.sums.x);
    add_wide(6u * pixel + 2u, path.sums.y);
    add_wide(6u * pixel + 4u, path.sums.z);
}

// Adds to a sum, whose low word has number `low` in the film. Several threads may add to it at the same time.
fn add_wide(low: u32, more: u32) {
    if atomicAdd(&film[low], more) > 0xFFFFFFFFu - more {
        atomicAdd(&film[low + 1u], 1u);
    }
}
