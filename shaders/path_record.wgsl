// Entry point: traces one sample of one pixel as for a picture and records it. The host sets the pixel. On completion
// the head contains the number of rays and the sums added to the film.

@compute @workgroup_size(WORKGROUP_SIZE)
fn path_record(@builtin(local_invocation_index) thread: u32) {
    if thread > 0u {
        return;
    }
    // There is one block; a resumed path has begun it.
    atomicStore(&next_block, dispatch.resumes);
    let pixel = vec2u(scratch[RECORD_HEAD_COLUMN], scratch[RECORD_HEAD_ROW]);
    let traced = trace(Tile(pixel, vec2u(1u)), 0u, dispatch.first_suspended);
    let sum = 6u * blocks[0].half * job.width * dispatch.row_count;
    scratch[RECORD_HEAD_RAY_COUNT] += traced.rays;
    store_words(RECORD_HEAD_SUMS, vec3u(film_sum(sum).x, film_sum(sum + 2u).x, film_sum(sum + 4u).x));
}
