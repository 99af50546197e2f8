// Entry point: traces one sample of one pixel as for a picture and records it. The first two words are the pixel's
// column and row; the third is the number of rays already recorded, if the path was put aside. On completion the header
// contains the number of rays and the sums added to the film.

@compute @workgroup_size(WORKGROUP_SIZE)
fn path_record(@builtin(local_invocation_index) thread: u32) {
    if thread > 0u {
        return;
    }
    let traced = trace(vec2u(words[0], words[1]), 0u, order.first_aside);
    let sum = film[blocks[0].half * job.width * order.row_count];
    words[0] = words[2] + traced.rays;
    words[1] = sum.red.x;
    words[2] = sum.green.x;
    words[3] = sum.blue.x;
}
