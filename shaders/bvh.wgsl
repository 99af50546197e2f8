// Traversal of the hierarchy by a single ray.
//
// Twin: src/render_cpu/bvh.rs

// A ray prepared for box tests: 1/d, and the origin moved outwards by the largest possible rounding error.
struct Slabs {
    inverse: vec3f,
    low: vec3f,
    high: vec3f,
}

// `margin_share` is the rounding error relative to the largest coordinate.
fn slabs_of(ray: Ray, extent: f32, margin_share: f32) -> Slabs {
    let o = abs(ray.origin);
    let margin = max(max(o.x, o.y), max(o.z, extent)) * margin_share;
    let d = ray.direction;
    let inverse = vec3f(inverse_of(d.x), inverse_of(d.y), inverse_of(d.z));
    return Slabs(inverse, (ray.origin + margin) * inverse, (ray.origin - margin) * inverse);
}

// 1/d, finite even where d is 0.
fn inverse_of(d: f32) -> f32 {
    return copysign(1.0 / max(abs(d), LEAST_COMPONENT), d);
}

// Returns the bits of the distance at which the ray enters the box, or MISS_KEY if it does not hit the box before
// distance `limit`.
fn box_key(slabs: Slabs, low: vec3f, high: vec3f, limit: f32) -> u32 {
    let a = fma(low, slabs.inverse, -slabs.low);
    let b = fma(high, slabs.inverse, -slabs.high);
    let near = min(a, b);
    let far = max(a, b);
    let enter = max(max(near.x, near.y), max(near.z, 0.0));
    let leave = min(min(far.x, far.y), min(far.z, limit));
    // The factor covers the rounding of the distances themselves.
    return select(MISS_KEY, bitcast<u32>(enter), leave * BOX_WIDENING >= enter);
}

// Finds the nearest hit among the spheres of the hierarchy.
fn traverse(ray: Ray, found: Nearest) -> Nearest {
    var nearest = found;
    let slabs = slabs_of(ray, job.extent, BOX_MARGIN);
    var stack: array<u32, STACK_SIZE>;
    var depth = 0u;
    var node = node_at(0u);
    if box_key(slabs, node.low, node.high, bitcast<f32>(nearest.key)) == MISS_KEY {
        return nearest;
    }
    ray_is_cut = true;
    var is_leaf_cut = false;
    // The `break` ends this loop before its limit, because no node is visited twice.
    for (var visits = 0u; visits < job.node_count; visits++) {
        turns += 1u;
        let count = node.count & COUNT_MASK;
        var next = NONE;
        if count > 0u {
            var i = 0u;
            // Terminates, because a leaf has at most COUNT_MASK spheres.
            for (; i < count; i++) {
                let number = node.first + i;
                nearest = take_in_any_order(nearest, signed_root(ray, sphere_at(number), number), number);
            }
            turns += count;
            is_leaf_cut = i < count;
        } else {
            let left = node_at(node.first);
            let right = node_at(node.first + 1u);
            let limit = bitcast<f32>(nearest.key);
            let left_key = box_key(slabs, left.low, left.high, limit);
            let right_key = box_key(slabs, right.low, right.high, limit);
            let left_is_near = left_key <= right_key;
            if min(left_key, right_key) != MISS_KEY {
                next = node.first + select(1u, 0u, left_is_near);
                if max(left_key, right_key) != MISS_KEY {
                    stack[depth] = node.first + select(0u, 1u, left_is_near);
                    depth++;
                }
            }
        }
        if next == NONE {
            if depth == 0u {
                ray_is_cut = is_leaf_cut;
                break;
            }
            depth--;
            next = stack[depth];
        }
        node = node_at(next);
    }
    return nearest;
}
