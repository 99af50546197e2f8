// A thread that has used up its loop turns puts its path aside. The next dispatch of the same tiles takes it up again.
// Each dispatch is therefore short, however long a thread's work is.
//
// Each thread has ASIDE_WORDS words: see `GpuAside` in src/kernel/packed.rs.
//
// Twin: src/render_gpu/dispatches.rs

const ABSORBED_BIT = 0x80000000u;

fn put_aside(path: Path, base: u32) {
    store_vector(base + ASIDE_ORIGIN, path.ray.origin);
    words[base + ASIDE_LEFT] = path.ray.left;
    store_vector(base + ASIDE_DIRECTION, path.ray.direction);
    words[base + ASIDE_INSIDE] = path.ray.inside;
    store_vector(base + ASIDE_THROUGHPUT, path.throughput);
    // A path has at most 10,000 rays, and a block at most 128 samples.
    words[base + ASIDE_STATE] = path.bounce | (path.remaining << 16u) | select(0u, ABSORBED_BIT, path.absorbed);
    words[base + ASIDE_ITEM] = path.item;
    store_words(base + ASIDE_SUMS, path.sums);
    words[base + ASIDE_SINE2] = bitcast<u32>(path.sine2);
}

// If nothing was put aside, no samples are left.
fn take_up(path: ptr<function, Path>, tile: Tile, base: u32) {
    let state = words[base + ASIDE_STATE];
    let remaining = (state & ~ABSORBED_BIT) >> 16u;
    (*path).remaining = remaining;
    if remaining == 0u {
        return;
    }
    words[base + ASIDE_STATE] = 0u;
    (*path).ray = Ray(
        load_vector(base + ASIDE_ORIGIN),
        load_vector(base + ASIDE_DIRECTION),
        words[base + ASIDE_LEFT],
        words[base + ASIDE_INSIDE],
    );
    (*path).throughput = load_vector(base + ASIDE_THROUGHPUT);
    (*path).bounce = state & 0xFFFFu;
    (*path).absorbed = (state & ABSORBED_BIT) != 0u;
    (*path).sine2 = bitcast<f32>(words[base + ASIDE_SINE2]);
    (*path).item = words[base + ASIDE_ITEM];
    enter_block(path, tile, blocks[(*path).item / (tile.size.x * tile.size.y)].count - remaining);
    (*path).sums = load_words(base + ASIDE_SUMS);
}
