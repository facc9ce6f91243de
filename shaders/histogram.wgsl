// Leaf-ID images to areas. Workgroup (x, y) takes the x-th run of pixels of
// view y; each lane walks every WORKGROUP-th of them. The background, which
// most pixels may hit, is counted in a register, then in workgroup memory, and
// added once; leaves are added one by one. The twin is `cpu::histogram`.

override WORKGROUP: u32;
override PIXELS_PER_WORKGROUP: u32;

struct Shape {
    pixels_per_view: u32,
    // Areas in a row: leaves and the background.
    row: u32,
}

@group(0) @binding(0) var<uniform> shape: Shape;
@group(0) @binding(1) var<storage, read> image: array<u32>;
@group(0) @binding(2) var<storage, read_write> area_px: array<atomic<u32>>;

var<workgroup> background_px: atomic<u32>;

@compute @workgroup_size(WORKGROUP)
fn histogram(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let first = group.x * PIXELS_PER_WORKGROUP;
    let end = min(first + PIXELS_PER_WORKGROUP, shape.pixels_per_view);
    let view_pixel = group.y * shape.pixels_per_view;
    let row = group.y * shape.row;
    var mine = 0u;
    for (var k = first + lane; k < end; k += WORKGROUP) {
        let leaf = image[view_pixel + k];
        if leaf == 0u {
            mine++;
        } else {
            atomicAdd(&area_px[row + leaf], 1u);
        }
    }
    atomicAdd(&background_px, mine);
    workgroupBarrier();
    if lane == 0u {
        atomicAdd(&area_px[row], atomicLoad(&background_px));
    }
}
