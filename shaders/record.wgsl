// Records a path ray by ray, in RECORD_HEADER words for the path and RECORD_STRIDE words for each ray.
//
// Twin: src/render_gpu/record.rs

fn record_ray(number: u32, path: Path, nearest: Nearest) {
    let base = RECORD_HEADER + number * RECORD_STRIDE;
    if base + RECORD_STRIDE > order.first_aside {
        return;
    }
    record_vector(base, path.ray.origin);
    record_vector(base + 3u, path.ray.direction);
    record_vector(base + 6u, path.throughput);
    words[base + 9u] = nearest.sphere;
    words[base + 10u] = nearest.key;
}

fn record_vector(base: u32, v: vec3f) {
    words[base] = bitcast<u32>(v.x);
    words[base + 1u] = bitcast<u32>(v.y);
    words[base + 2u] = bitcast<u32>(v.z);
}
