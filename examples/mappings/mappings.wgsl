// Three ways to divide a picture's samples among threads. The functions are the program's own; `own_block` is the first
// of the blocks of samples that a thread traces, and `film` is atomic where several threads add to one pixel.

var<private> own_block: u32;

// Where thread `thread` of the group in tile `tile` is in the picture.
fn place(tile: u32, thread: u32) -> vec2u {
    let tile_height = WORKGROUP_SIZE / job.tile_width;
    let tiles_across = (job.width + job.tile_width - 1u) / job.tile_width;
    let corner = vec2u(tile % tiles_across * job.tile_width, tile / tiles_across * tile_height);
    return corner + vec2u(thread % job.tile_width, thread / job.tile_width);
}

fn trace_at(position: vec2u) {
    if position.x < job.width && position.y < job.height {
        let traced = trace(position, position.y * job.width + position.x, 0u);
        if traced.unfinished > 0u {
            atomicAdd(&counters.dispatch.unfinished, 1u);
        }
    }
}

// One thread per pixel, a group for each tile.
@compute @workgroup_size(WORKGROUP_SIZE)
fn pixels(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    own_block = 0u;
    trace_at(place(group.x, thread));
}

// One thread per sample: a group has the same sample of each pixel of a tile.
@compute @workgroup_size(WORKGROUP_SIZE)
fn samples_of_a_tile(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    own_block = group.y;
    trace_at(place(group.x, thread));
}

// One thread per sample: a group has as many samples of one pixel.
@compute @workgroup_size(WORKGROUP_SIZE)
fn samples_of_a_pixel(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    own_block = group.y * WORKGROUP_SIZE + thread;
    let number = group.x + group.z * 65535u;
    trace_at(vec2u(number % job.width, number / job.width));
}
