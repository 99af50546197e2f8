// Entry point: converts the film to a picture, with one word per pixel: red in the lowest byte, 255 in the highest.
//
// Twin: src/film/mod.rs, to_byte

fn to_byte(linear: f32, gamma: bool) -> u32 {
    let value = select(linear, sqrt(max(linear, 0.0)), gamma);
    return u32(256.0 * clamp(value, 0.0, 0.999));
}

fn film_sum(index: u32) -> vec2u {
    return vec2u(atomicLoad(&film[index]), atomicLoad(&film[index + 1u]));
}

fn mean_of(sum: vec2u, count: f32) -> f32 {
    return (f32(sum.y) * 4294967296.0 + f32(sum.x)) / FIXED_POINT_SCALE / count;
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn resolve(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) thread: u32,
) {
    let index = (group.x + group.y * groups.x) * WORKGROUP_SIZE + thread;
    if index >= job.width * dispatch.row_count {
        return;
    }
    let row = dispatch.first_row + index / job.width;
    let lower = row >= job.height / 2u;
    let gamma = dispatch.transfer == TRANSFER_GAMMA2 || (dispatch.transfer == TRANSFER_LINEAR_ABOVE_GAMMA2 && lower);
    let count = max(f32(dispatch.sample_count), 1.0);
    let red = to_byte(mean_of(film_sum(6u * index), count), gamma);
    let green = to_byte(mean_of(film_sum(6u * index + 2u), count), gamma);
    let blue = to_byte(mean_of(film_sum(6u * index + 4u), count), gamma);
    scratch[index] = red | (green << 8u) | (blue << 16u) | 0xFF000000u;
}
