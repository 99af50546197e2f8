// Entry point: traces samples, with one workgroup per tile of the picture.

var<workgroup> group_rays: atomic<u32>;
var<workgroup> group_rejected: atomic<u32>;
var<workgroup> group_finished: atomic<u32>;
var<workgroup> group_unfinished: atomic<u32>;
var<workgroup> group_stuck: atomic<u32>;

@compute @workgroup_size(WORKGROUP_SIZE)
fn path_trace(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) thread: u32,
) {
    let number = group.x + group.y * groups.x;
    let tile = dispatch.first_tile + number;
    let tile_height = WORKGROUP_SIZE / job.tile_width;
    let tiles_across = (job.width + job.tile_width - 1u) / job.tile_width;
    let corner = vec2u((tile % tiles_across) * job.tile_width, (tile / tiles_across) * tile_height);
    let size = min(vec2u(job.tile_width, tile_height), vec2u(job.width, dispatch.row_count) - corner);
    let first_suspended = dispatch.first_suspended + number * WORKGROUP_SIZE * SUSPENDED_WORDS;
    if SUSPENDS {
        if thread == 0u && dispatch.resumes > 0u {
            atomicStore(&next_block, scratch[first_suspended + SUSPENDED_NEXT_BLOCK]);
        }
        workgroupBarrier();
    }
    if number < dispatch.tile_count && (SUSPENDS || thread < size.x * size.y) {
        let traced = trace(
            Tile(vec2u(corner.x, corner.y + dispatch.first_row), size),
            thread,
            first_suspended + thread * SUSPENDED_WORDS,
        );
        atomicAdd(&group_rays, traced.rays);
        atomicAdd(&group_finished, traced.finished);
        if traced.rejected > 0u {
            atomicAdd(&group_rejected, traced.rejected);
        }
        if traced.unfinished > 0u {
            atomicAdd(&group_unfinished, 1u);
            atomicAdd(&group_stuck, traced.stuck);
        }
    }
    workgroupBarrier();
    if thread == 0u {
        let rays = atomicLoad(&group_rays);
        if atomicAdd(&counters.rays, rays) > 0xFFFFFFFFu - rays {
            atomicAdd(&counters.rays_high, 1u);
        }
        let rejected = atomicLoad(&group_rejected);
        if rejected > 0u && atomicAdd(&counters.rejected, rejected) > 0xFFFFFFFFu - rejected {
            atomicAdd(&counters.rejected_high, 1u);
        }
        let finished = atomicLoad(&group_finished);
        if atomicAdd(&counters.dispatch.finished, finished) > 0xFFFFFFFFu - finished {
            atomicAdd(&counters.dispatch.finished_high, 1u);
        }
        let unfinished = atomicLoad(&group_unfinished);
        if unfinished > 0u {
            atomicAdd(&counters.dispatch.unfinished, unfinished);
            atomicAdd(&counters.dispatch.stuck, atomicLoad(&group_stuck));
            if SUSPENDS {
                scratch[first_suspended + SUSPENDED_NEXT_BLOCK] = atomicLoad(&next_block);
            }
        }
    }
}
