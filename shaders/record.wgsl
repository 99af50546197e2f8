// Records a path ray by ray: a RECORD_HEAD for the path, then a RECORDED_RAY for each ray.
//
// Twin: src/render_gpu/record.rs

fn record_ray(number: u32, path: Path, nearest: Nearest) {
    let base = RECORD_HEAD_WORDS + number * RECORDED_RAY_WORDS;
    if base + RECORDED_RAY_WORDS > order.first_aside {
        return;
    }
    store_vector(base + RECORDED_RAY_ORIGIN, path.ray.origin);
    store_vector(base + RECORDED_RAY_DIRECTION, path.ray.direction);
    store_vector(base + RECORDED_RAY_THROUGHPUT, path.throughput);
    words[base + RECORDED_RAY_SPHERE] = nearest.sphere;
    words[base + RECORDED_RAY_DISTANCE] = nearest.key;
}
