// Entry point: traces one sample of one pixel as for a picture and records it. The host sets the pixel. On completion
// the head contains the number of rays and the sums added to the film.

@compute @workgroup_size(WORKGROUP_SIZE)
fn path_record(@builtin(local_invocation_index) thread: u32) {
    if thread > 0u {
        return;
    }
    let traced = trace(vec2u(words[RECORD_HEAD_COLUMN], words[RECORD_HEAD_ROW]), 0u, order.first_aside);
    let sum = film[blocks[0].half * job.width * order.row_count];
    words[RECORD_HEAD_RAY_COUNT] += traced.rays;
    store_words(RECORD_HEAD_SUMS, vec3u(sum.red.x, sum.green.x, sum.blue.x));
}
