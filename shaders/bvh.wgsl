// Traversal of a hierarchy with eight children per node by a single ray. (Ylitie, Karras and Laine 2017, "Efficient
// Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", sections 3 and 4, but with boxes of 32-bit bounds:
// compressed ones take a third of the memory and 1.3 times as long.)
//
// Twin: src/render_cpu/bvh.rs

// The 8 bits of a mask of hits that stand for nodes; the node to visit first has the highest bit. The 24 bits below
// stand for spheres.
const NODE_HITS = 0xFF000000u;

// Rows of a node: the bounds of children 0 to 3 and 4 to 7, lower then upper, along x, y and z; the
// bits that each child adds to a mask of hits; first child, first sphere and mask of nodes; one row of padding, because
// 16 rows are two cache lines and make cheap addresses.
const NODE_ROWS = 16u;

// A ray prepared for box tests: 1/d, and the origin moved outwards by the largest possible rounding error.
struct Slabs {
    inverse: vec3f,
    low: vec3f,
    high: vec3f,
}

// `extent` is the largest coordinate of the boxes.
fn slabs_of(ray: Ray, extent: f32) -> Slabs {
    let o = abs(ray.origin);
    let margin = max(max(o.x, o.y), max(o.z, extent)) * BOX_MARGIN;
    let d = ray.direction;
    let inverse = vec3f(inverse_of(d.x), inverse_of(d.y), inverse_of(d.z));
    return Slabs(inverse, (ray.origin + margin) * inverse, (ray.origin - margin) * inverse);
}

// 1/d, finite even where d is 0.
fn inverse_of(d: f32) -> f32 {
    return copysign(1.0 / max(abs(d), LEAST_COMPONENT), d);
}

// A ray as it goes through the hierarchy: the origin times 1/d for the planes where boxes are entered and left, and the
// axes along which it goes backward.
struct Slope {
    inverse: vec3f,
    near: vec3f,
    far: vec3f,
    backward: vec3<bool>,
    // The bits of a child's slot say which side of its node it lies on, x in the highest bit. The slot of the ray's own
    // octant is the nearest.
    octant: u32,
}

fn slope_of(slabs: Slabs) -> Slope {
    let backward = slabs.inverse < vec3f(0.0);
    let forward = select(vec3u(4u, 2u, 1u), vec3u(0u), backward);
    return Slope(
        slabs.inverse,
        select(slabs.low, slabs.high, backward),
        select(slabs.high, slabs.low, backward),
        backward,
        forward.x | forward.y | forward.z,
    );
}

// The children of a node that a ray hits, as bits. Nodes are adjacent from `first_child` on, in the order of `nodes`,
// which has a bit for each slot; spheres are adjacent from `first_sphere` on.
struct Hits {
    bits: u32,
    first_child: u32,
    first_sphere: u32,
    nodes: u32,
}

// The `bits` of the boxes that a ray enters before `limit`, given the distances to the planes where it enters and leaves
// four boxes.
fn hit_bits(
    near_x: vec4f, near_y: vec4f, near_z: vec4f,
    far_x: vec4f, far_y: vec4f, far_z: vec4f,
    limit: f32, bits: vec4u,
) -> u32 {
    let enter = max(max(near_x, near_y), max(near_z, vec4f(0.0)));
    let leave = min(min(far_x, far_y), min(far_z, vec4f(limit)));
    // The factor covers the rounding of the distances themselves.
    let hits = select(vec4u(0u), bits, leave * BOX_WIDENING >= enter);
    return hits.x | hits.y | hits.z | hits.w;
}

// Distances to four planes.
fn planes_at(row: u32, inverse: f32, origin: f32) -> vec4f {
    return fma(bitcast<vec4f>(nodes[row]), vec4f(inverse), vec4f(-origin));
}

// The hits among four children. `near` and `far` are the rows of the entry and exit planes.
fn four_hits(near: vec3u, far: vec3u, slope: Slope, limit: f32, bits: vec4u) -> u32 {
    return hit_bits(
        planes_at(near.x, slope.inverse.x, slope.near.x),
        planes_at(near.y, slope.inverse.y, slope.near.y),
        planes_at(near.z, slope.inverse.z, slope.near.z),
        planes_at(far.x, slope.inverse.x, slope.far.x),
        planes_at(far.y, slope.inverse.y, slope.far.y),
        planes_at(far.z, slope.inverse.z, slope.far.z),
        limit,
        bits,
    );
}

fn hits_of(number: u32, slope: Slope, limit: f32) -> Hits {
    let first = number * NODE_ROWS;
    let flip = select(vec3u(0u), vec3u(2u), slope.backward);
    let near = first + vec3u(0u, 4u, 8u) + flip;
    let far = first + vec3u(2u, 6u, 10u) - flip;
    let last = nodes[first + 14u];
    let bits = four_hits(near, far, slope, limit, nodes[first + 12u])
        | four_hits(near + 1u, far + 1u, slope, limit, nodes[first + 13u]);
    return Hits(in_order(bits, slope.octant), last.x, last.y, last.z);
}

// Moves the bit of each node from its slot to slot ^ octant.
fn in_order(hits: u32, octant: u32) -> u32 {
    var m = hits & NODE_HITS;
    m = select(m, ((m & 0x55000000u) << 1u) | ((m >> 1u) & 0x55000000u), (octant & 1u) != 0u);
    m = select(m, ((m & 0x33000000u) << 2u) | ((m >> 2u) & 0x33000000u), (octant & 2u) != 0u);
    m = select(m, ((m & 0x0F000000u) << 4u) | ((m >> 4u) & 0x0F000000u), (octant & 4u) != 0u);
    return m | (hits & ~NODE_HITS);
}

// The groups of children that are still to be visited. Not a variable of the function, which would be cleared for each
// ray.
var<private> stack: array<vec2u, WIDE_STACK_SIZE>;

// Finds the nearest hit among the spheres of the hierarchy.
fn traverse(ray: Ray, found: Nearest) -> Nearest {
    var nearest = found;
    // The sphere that the ray starts on. Only glass has another root for a ray inside.
    var start = ray.left;
    if ray.inside < job.opaque_count + job.two_root_count && !has_one_root(sphere_at(ray.inside)) {
        start = ray.inside;
        let key = chord_end(ray, sphere_at(start));
        // At a tie, spheres of the hierarchy come before the anchored ones, which were tested before.
        if key <= nearest.key {
            nearest = Nearest(key, start);
        }
    }
    let slope = slope_of(slabs_of(ray, job.extent));
    // The children of one parent that are still to be visited: the first child, and the hits with the parent's mask of
    // nodes below. The traversal starts with the root as an only child.
    var group = vec2u(0u, 1u << 31u);
    var depth = 0u;
    ray_is_cut = true;
    // The `break` ends this loop before its limit, because no node is visited twice.
    for (var visits = 0u; visits < job.node_count; visits++) {
        iterations += 1u;
        let bit = firstLeadingBit(group.y);
        let slot = (bit - 24u) ^ slope.octant;
        let number = group.x + countOneBits(group.y & ((1u << slot) - 1u));
        group.y &= ~(1u << bit);
        if group.y >= 1u << 24u {
            stack[depth] = group;
            depth++;
        }
        let limit = bitcast<f32>(nearest.key);
        let hits = hits_of(number, slope, limit);
        var left = hits.bits & ~NODE_HITS;
        // Terminates, because each iteration clears one of 24 bits.
        for (; left != 0u; left &= left - 1u) {
            iterations += 1u;
            let sphere = hits.first_sphere + firstTrailingBit(left);
            nearest = take_in_any_order(nearest, signed_root(ray, sphere_at(sphere), sphere, start), sphere);
        }
        group = vec2u(hits.first_child, (hits.bits & NODE_HITS) | hits.nodes);
        if group.y < 1u << 24u {
            if depth == 0u {
                ray_is_cut = left != 0u;
                break;
            }
            depth--;
            group = stack[depth];
        }
    }
    return nearest;
}
