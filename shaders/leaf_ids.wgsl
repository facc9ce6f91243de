// The front leaf of each pixel, 0 for the background: one invocation per
// pixel reads the head of its list. The twin is `Fragments::leaf_ids`.

override WORKGROUP: u32;

struct Window {
    resolution: u32,
    first_pixel: u32,
    pixel_count: u32,
    first_fragment: u32,
}

@group(0) @binding(0) var<uniform> window: Window;
@group(0) @binding(1) var<storage, read> starts: array<u32>;
@group(0) @binding(2) var<storage, read> lists: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read_write> image: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn leaf_ids(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= window.pixel_count {
        return;
    }
    let pixel = window.first_pixel + id.x;
    var leaf = 0u;
    if starts[pixel] != starts[pixel + 1u] {
        leaf = lists[starts[pixel] - window.first_fragment].x;
    }
    image[pixel] = leaf;
}
