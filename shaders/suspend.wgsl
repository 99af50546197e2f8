// A thread that has used up its iterations suspends its path. The next dispatch of the same tiles resumes it. Each
// dispatch is therefore short, however long a thread's work is.
//
// Each thread has SUSPENDED_WORDS words: see `GpuSuspendedPath` in src/kernel/packed.rs.
//
// On the host: src/render_gpu/dispatches.rs

const ABSORBED_BIT = 0x80000000u;

fn suspend(path: Path, base: u32) {
    store_vector(base + SUSPENDED_ORIGIN, path.ray.origin);
    scratch[base + SUSPENDED_LEFT] = path.ray.left;
    store_vector(base + SUSPENDED_DIRECTION, path.ray.direction);
    scratch[base + SUSPENDED_INSIDE] = path.ray.inside;
    store_vector(base + SUSPENDED_THROUGHPUT, path.throughput);
    // A path has at most 10,000 rays, and a block at most 128 samples.
    scratch[base + SUSPENDED_STATE] = path.bounce | (path.remaining << 16u) | select(0u, ABSORBED_BIT, path.absorbed);
    scratch[base + SUSPENDED_BLOCK] = path.block;
    store_words(base + SUSPENDED_SUMS, path.sums);
    scratch[base + SUSPENDED_SINE2] = bitcast<u32>(path.sine2);
}

// If nothing was suspended, no samples are left.
fn resume(path: ptr<function, Path>, tile: Tile, base: u32) {
    let state = scratch[base + SUSPENDED_STATE];
    let remaining = (state & ~ABSORBED_BIT) >> 16u;
    (*path).remaining = remaining;
    if remaining == 0u {
        return;
    }
    scratch[base + SUSPENDED_STATE] = 0u;
    (*path).ray = Ray(
        load_vector(base + SUSPENDED_ORIGIN),
        load_vector(base + SUSPENDED_DIRECTION),
        scratch[base + SUSPENDED_LEFT],
        scratch[base + SUSPENDED_INSIDE],
    );
    (*path).throughput = load_vector(base + SUSPENDED_THROUGHPUT);
    (*path).bounce = state & 0xFFFFu;
    (*path).absorbed = (state & ABSORBED_BIT) != 0u;
    (*path).sine2 = bitcast<f32>(scratch[base + SUSPENDED_SINE2]);
    (*path).block = scratch[base + SUSPENDED_BLOCK];
    enter_block(path, tile, blocks[(*path).block / (tile.size.x * tile.size.y)].count - remaining);
    (*path).sums = load_words(base + SUSPENDED_SUMS);
}
