// Traversal of the compressed hierarchy, with eight children per node, by a single ray. (Ylitie, Karras and Laine 2017,
// "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", sections 3 and 4.)

// The 8 bits of a hit mask that stand for nodes; the node to visit first has the highest bit. The 24 bits below stand
// for spheres.
const NODE_HITS = 0xFF000000u;

const BYTE_SHIFTS = vec4u(0u, 8u, 16u, 24u);

// A ray prepared for a node's boxes. Along each axis the distance to the entry plane is `bound * step + near`, and to
// the exit plane `bound * step + far`.
struct Grid {
    step: vec3f,
    near: vec3f,
    far: vec3f,
}

fn bytes_of(word: u32) -> vec4u {
    return (vec4u(word) >> BYTE_SHIFTS) & vec4u(0xFFu);
}

// Returns which of four children the ray hits before distance `limit`, as the bits that their marks select. `x`, `y`
// and `z` hold the bounds of the entry and exit planes. `octant` orders the slots of nodes.
fn four_hits(
    grid: Grid, x: vec2u, y: vec2u, z: vec2u, marks: u32, octant: u32, limit: f32,
) -> u32 {
    let near_x = fma(vec4f(bytes_of(x.x)), vec4f(grid.step.x), vec4f(grid.near.x));
    let near_y = fma(vec4f(bytes_of(y.x)), vec4f(grid.step.y), vec4f(grid.near.y));
    let near_z = fma(vec4f(bytes_of(z.x)), vec4f(grid.step.z), vec4f(grid.near.z));
    let far_x = fma(vec4f(bytes_of(x.y)), vec4f(grid.step.x), vec4f(grid.far.x));
    let far_y = fma(vec4f(bytes_of(y.y)), vec4f(grid.step.y), vec4f(grid.far.y));
    let far_z = fma(vec4f(bytes_of(z.y)), vec4f(grid.step.z), vec4f(grid.far.z));
    let enter = max(max(near_x, near_y), max(near_z, vec4f(0.0)));
    let leave = min(min(far_x, far_y), min(far_z, vec4f(limit)));
    let mark = bytes_of(marks);
    let place = mark & vec4u(31u);
    let ordered = select(place, place ^ vec4u(octant), place >= vec4u(24u));
    let bits = select(vec4u(0u), (mark >> vec4u(5u)) << ordered, leave * BOX_WIDENING >= enter);
    return bits.x | bits.y | bits.z | bits.w;
}

// Finds the nearest hit among the spheres of the hierarchy.
fn traverse_cwbvh(ray: Ray, found: Nearest) -> Nearest {
    var nearest = found;
    let slabs = slabs_of(ray, job.extent, CWBVH_MARGIN);
    let backward = slabs.inverse < vec3f(0.0);
    let near_origin = select(slabs.low, slabs.high, backward);
    let far_origin = select(slabs.high, slabs.low, backward);
    // The bits of a child's slot number say which side of the node it lies on, x in the highest bit. The slot of the
    // ray's own octant is the nearest and gets the highest bit.
    let forward = select(vec3u(4u, 2u, 1u), vec3u(0u), backward);
    let octant = forward.x | forward.y | forward.z;
    // The children of one parent that are still to be visited: the first child, and the hits with the parent's mask of
    // nodes below. The traversal starts with the root as an only child.
    var group = vec2u(0u, 1u << 31u);
    var stack: array<vec2u, CWBVH_STACK_SIZE>;
    var depth = 0u;
    ray_is_cut = true;
    // Ends at the latest after `node_count` turns, usually by its `break`: no node is visited twice.
    for (var visits = 0u; visits < job.node_count; visits++) {
        turns += 1u;
        let bit = firstLeadingBit(group.y);
        let slot = (bit - 24u) ^ octant;
        let node = cwbvh_node_at(group.x + countOneBits(group.y & ((1u << slot) - 1u)));
        group.y &= ~(1u << bit);
        if group.y >= 1u << 24u {
            stack[depth] = group;
            depth++;
        }

        // Tests the node's children.
        let unit = bitcast<vec3f>(bytes_of(node.units).xyz << vec3u(23u));
        let grid = Grid(
            unit * slabs.inverse,
            fma(node.low, slabs.inverse, -near_origin),
            fma(node.low, slabs.inverse, -far_origin),
        );
        let x = select(node.x, node.x.zwxy, backward.x);
        let y = select(node.y, node.y.zwxy, backward.y);
        let z = select(node.z, node.z.zwxy, backward.z);
        let limit = bitcast<f32>(nearest.key);
        let hits = four_hits(grid, x.xz, y.xz, z.xz, node.marks.x, octant, limit)
            | four_hits(grid, x.yw, y.yw, z.yw, node.marks.y, octant, limit);

        // Tests the node's spheres.
        var left = hits & ~NODE_HITS;
        // Terminates, because each turn clears one of 24 bits.
        for (; left != 0u; left &= left - 1u) {
            turns += 1u;
            let number = node.first_sphere + firstTrailingBit(left);
            nearest = take_in_any_order(nearest, signed_root(ray, sphere_at(number), number), number);
        }

        group = vec2u(node.first_child, (hits & NODE_HITS) | (node.units >> 24u));
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
