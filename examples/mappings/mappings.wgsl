// Ways to divide a picture's samples among threads. The functions are the program's own; with one thread per sample, a
// thread traces the block `own_item` of its tile.

var<private> own_item: u32;

// The pixels of tile `number`.
fn tile_at(number: u32) -> Tile {
    let size = vec2u(job.tile_width, WORKGROUP_SIZE / job.tile_width);
    let tiles_across = (job.width + size.x - 1u) / size.x;
    let corner = vec2u(number % tiles_across, number / tiles_across) * size;
    return Tile(corner, min(size, vec2u(job.width, job.height) - corner));
}

fn trace_in(tile: Tile, thread: u32) {
    let traced = trace(tile, thread, 0u);
    if traced.unfinished > 0u {
        atomicAdd(&counters.dispatch.unfinished, 1u);
    }
}

// A group for each tile. Its threads have a pixel each, or share the blocks of all its pixels.
@compute @workgroup_size(WORKGROUP_SIZE)
fn pixels(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let tile = tile_at(group.x);
    if thread < tile.size.x * tile.size.y {
        trace_in(tile, thread);
    }
}

// One thread per sample: a group has the same sample of each pixel of a tile.
@compute @workgroup_size(WORKGROUP_SIZE)
fn samples_of_a_tile(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let tile = tile_at(group.x);
    own_item = group.y * tile.size.x * tile.size.y + thread;
    if thread < tile.size.x * tile.size.y {
        trace_in(tile, thread);
    }
}

// One thread per sample: a group's threads have samples of the same pixel.
@compute @workgroup_size(WORKGROUP_SIZE)
fn samples_of_a_pixel(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    own_item = group.y * WORKGROUP_SIZE + thread;
    let number = group.x + group.z * 65535u;
    if number < job.width * job.height {
        trace_in(Tile(vec2u(number % job.width, number / job.width), vec2u(1u)), thread);
    }
}
