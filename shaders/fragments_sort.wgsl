// Each pixel's list in order, a leaf once: nearest first, at equal depth the
// lowest leaf. One invocation per pixel: insertion where the list is short, a
// heap in place where it is not. Lists longer than HEAP_MAX are left to
// `fragments_sort_long.wgsl`. The twin is `cpu::fragments`.

override WORKGROUP: u32;
override INSERTION_MAX: u32;
override HEAP_MAX: u32;

struct Window {
    resolution: u32,
    first_pixel: u32,
    pixel_count: u32,
    first_fragment: u32,
}

@group(0) @binding(0) var<uniform> window: Window;
@group(0) @binding(1) var<storage, read> starts: array<u32>;
// x is the leaf, y the depth.
@group(0) @binding(2) var<storage, read_write> lists: array<vec2<u32>>;
// How many fragments of each pixel are left; those come first in its list.
@group(0) @binding(3) var<storage, read_write> kept: array<u32>;
// Fragments that were not their leaf's nearest in the pixel.
@group(0) @binding(4) var<storage, read_write> dropped: atomic<u32>;

// Depth of a fragment that is to go; real ones are below 2^31.
const DROPPED: u32 = 0xFFFFFFFFu;

fn is_before(a: vec2<u32>, b: vec2<u32>) -> bool {
    return a.y < b.y || (a.y == b.y && a.x < b.x);
}

// Sorts by leaf first, where `by_leaf`.
fn is_before_by(by_leaf: bool, a: vec2<u32>, b: vec2<u32>) -> bool {
    if by_leaf {
        return is_before(a.yx, b.yx);
    }
    return is_before(a, b);
}

// Takes fragments one by one into the ordered run at `first`; returns its size.
fn insert_all(first: u32, size: u32) -> u32 {
    var left = 0u;
    for (var k = 0u; k < size; k++) {
        let fragment = lists[first + k];
        // The place of the leaf, or `left`.
        var same = 0u;
        while same < left && lists[first + same].x != fragment.x {
            same++;
        }
        if same < left && lists[first + same].y <= fragment.y {
            continue;
        }
        // The hole moves forward from the leaf's farther fragment, or from the end.
        var hole = same;
        while hole > 0u && is_before(fragment, lists[first + hole - 1u]) {
            lists[first + hole] = lists[first + hole - 1u];
            hole--;
        }
        lists[first + hole] = fragment;
        left += u32(same == left);
    }
    return left;
}

fn sift_down(by_leaf: bool, first: u32, size: u32, place: u32, fragment: vec2<u32>) {
    var hole = place;
    loop {
        var child = 2u * hole + 1u;
        if child >= size {
            break;
        }
        var larger = lists[first + child];
        if child + 1u < size {
            let other = lists[first + child + 1u];
            if is_before_by(by_leaf, larger, other) {
                child++;
                larger = other;
            }
        }
        if !is_before_by(by_leaf, fragment, larger) {
            break;
        }
        lists[first + hole] = larger;
        hole = child;
    }
    lists[first + hole] = fragment;
}

fn heap_sort(by_leaf: bool, first: u32, size: u32) {
    for (var k = size / 2u; k > 0u; k--) {
        sift_down(by_leaf, first, size, k - 1u, lists[first + k - 1u]);
    }
    for (var k = size - 1u; k > 0u; k--) {
        let fragment = lists[first + k];
        lists[first + k] = lists[first];
        sift_down(by_leaf, first, k, 0u, fragment);
    }
}

// Sorted by leaf, all but each leaf's first are marked and end up behind.
fn heap_all(first: u32, size: u32) -> u32 {
    heap_sort(true, first, size);
    var left = 1u;
    for (var k = 1u; k < size; k++) {
        if lists[first + k].x == lists[first + k - 1u].x {
            lists[first + k].y = DROPPED;
        } else {
            left++;
        }
    }
    heap_sort(false, first, size);
    return left;
}

@compute @workgroup_size(WORKGROUP)
fn sort_lists(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= window.pixel_count {
        return;
    }
    let pixel = window.first_pixel + id.x;
    let size = starts[pixel + 1u] - starts[pixel];
    let first = starts[pixel] - window.first_fragment;
    var left = size;
    if size > 1u && size <= INSERTION_MAX {
        left = insert_all(first, size);
    } else if size > INSERTION_MAX && size <= HEAP_MAX {
        left = heap_all(first, size);
    }
    kept[pixel] = left;
    if left != size {
        atomicAdd(&dropped, size - left);
    }
}
