// Entry point: one sample of the pixel whose column and row are the first two words, traced as for a picture and
// written down. The third word is the number of rays that are written down already, where the path was put aside. At
// the end the header says the number of rays and what the film got.

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
