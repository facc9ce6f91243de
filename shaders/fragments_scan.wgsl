// Fragments of each pixel to where each pixel's list starts: an exclusive
// prefix sum. Three dispatches, no barrier outside the small middle one:
//
//   sum_blocks   one invocation per block of BLOCK pixels sums it
//   scan_blocks  one workgroup: each lane scans a run of blocks
//   write_starts one invocation per block writes the starts of its pixels
//
// Sums saturate, so that too many fragments are seen as `u32::MAX`.

override WORKGROUP: u32;
override BLOCK: u32;

struct Window {
    resolution: u32,
    first_pixel: u32,
    pixel_count: u32,
    first_fragment: u32,
}

@group(0) @binding(0) var<uniform> window: Window;
// In: fragments of each pixel. Out: where its list starts, to be counted up
// while fragments are emitted.
@group(0) @binding(1) var<storage, read_write> per_pixel: array<u32>;
@group(0) @binding(2) var<storage, read_write> blocks: array<u32>;
// One more than pixels: the last is the number of all fragments.
@group(0) @binding(3) var<storage, read_write> starts: array<u32>;
// Word 0: fragments. Word 1: those of the fullest pixel.
@group(0) @binding(4) var<storage, read_write> totals: array<atomic<u32>, 2>;

const LANES: u32 = 64u;
var<workgroup> run_sums: array<u32, LANES>;

fn saturating_add(a: u32, b: u32) -> u32 {
    return a + min(b, ~a);
}

@compute @workgroup_size(WORKGROUP)
fn sum_blocks(@builtin(global_invocation_id) id: vec3<u32>) {
    let first = id.x * BLOCK;
    let end = min(first + BLOCK, window.pixel_count);
    if first >= end {
        return;
    }
    var sum = 0u;
    var most = 0u;
    for (var k = first; k < end; k++) {
        sum = saturating_add(sum, per_pixel[k]);
        most = max(most, per_pixel[k]);
    }
    blocks[id.x] = sum;
    atomicMax(&totals[1], most);
}

@compute @workgroup_size(LANES)
fn scan_blocks(@builtin(local_invocation_index) lane: u32) {
    let block_count = (window.pixel_count + BLOCK - 1u) / BLOCK;
    let run = (block_count + LANES - 1u) / LANES;
    let first = min(lane * run, block_count);
    let end = min(first + run, block_count);
    var sum = 0u;
    for (var k = first; k < end; k++) {
        sum = saturating_add(sum, blocks[k]);
    }
    run_sums[lane] = sum;
    workgroupBarrier();
    var start = 0u;
    for (var k = 0u; k < lane; k++) {
        start = saturating_add(start, run_sums[k]);
    }
    for (var k = first; k < end; k++) {
        let size = blocks[k];
        blocks[k] = start;
        start = saturating_add(start, size);
    }
    if lane == LANES - 1u {
        starts[window.pixel_count] = start;
        atomicStore(&totals[0], start);
    }
}

@compute @workgroup_size(WORKGROUP)
fn write_starts(@builtin(global_invocation_id) id: vec3<u32>) {
    let first = id.x * BLOCK;
    let end = min(first + BLOCK, window.pixel_count);
    if first >= end {
        return;
    }
    var start = blocks[id.x];
    for (var k = first; k < end; k++) {
        let size = per_pixel[k];
        per_pixel[k] = start;
        starts[k] = start;
        start = saturating_add(start, size);
    }
}
