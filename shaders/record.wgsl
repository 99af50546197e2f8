// Records a path ray by ray: a RECORD_HEAD for the path, then a RECORDED_RAY for each ray.
//
// On the host: src/render_gpu/record.rs

fn record_ray(number: u32, path: Path, nearest: Nearest) {
    let base = RECORD_HEAD_WORDS + number * RECORDED_RAY_WORDS;
    if base + RECORDED_RAY_WORDS > dispatch.first_suspended {
        return;
    }
    store_vector(base + RECORDED_RAY_ORIGIN, path.ray.origin);
    store_vector(base + RECORDED_RAY_DIRECTION, path.ray.direction);
    store_vector(base + RECORDED_RAY_THROUGHPUT, path.throughput);
    scratch[base + RECORDED_RAY_SPHERE] = nearest.sphere;
    scratch[base + RECORDED_RAY_DISTANCE] = nearest.key;
}
