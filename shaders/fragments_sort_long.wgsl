// `fragments_sort.wgsl` for long lists: a bitonic network over each, one
// dispatch per step, x the pair of fragments, y the list. All comparisons put
// the smaller fragment first, so that a list of any length is sorted as if
// larger fragments filled it up to a power of two.
//
//   exchange     one step of the network
//   mark         sorted by leaf: all but each leaf's first are to go

override WORKGROUP: u32;

struct Step {
    // Pairs lie in blocks of this many fragments, a power of two.
    block: u32,
    // 1: the block's ends pair and so on inwards; 0: halves pair in order.
    is_flip: u32,
    // 1: leaf before depth.
    by_leaf: u32,
    first_list: u32,
}

struct List {
    // Of its first fragment in the window.
    first: u32,
    size: u32,
    pixel: u32,
}

@group(0) @binding(0) var<uniform> step: Step;
@group(0) @binding(1) var<storage, read> long_lists: array<List>;
@group(0) @binding(2) var<storage, read_write> lists: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read_write> kept: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> dropped: atomic<u32>;

const DROPPED: u32 = 0xFFFFFFFFu;

fn is_before(a: vec2<u32>, b: vec2<u32>) -> bool {
    return a.y < b.y || (a.y == b.y && a.x < b.x);
}

@compute @workgroup_size(WORKGROUP)
fn exchange(@builtin(global_invocation_id) id: vec3<u32>) {
    let list = long_lists[step.first_list + id.y];
    let half = step.block / 2u;
    let base = id.x / half * step.block;
    let offset = id.x % half;
    let low = base + offset;
    var high = low + half;
    if step.is_flip == 1u {
        high = base + step.block - 1u - offset;
    }
    if high >= list.size {
        return;
    }
    let a = lists[list.first + low];
    let b = lists[list.first + high];
    var is_swapped = is_before(b, a);
    if step.by_leaf == 1u {
        is_swapped = is_before(b.yx, a.yx);
    }
    if is_swapped {
        lists[list.first + low] = b;
        lists[list.first + high] = a;
    }
}

// Only depths are overwritten and only leaves compared, so that invocations do
// not disturb each other.
@compute @workgroup_size(WORKGROUP)
fn mark(@builtin(global_invocation_id) id: vec3<u32>) {
    let list = long_lists[step.first_list + id.y];
    let k = id.x + 1u;
    if k >= list.size {
        return;
    }
    if lists[list.first + k].x == lists[list.first + k - 1u].x {
        lists[list.first + k].y = DROPPED;
        atomicSub(&kept[list.pixel], 1u);
        atomicAdd(&dropped, 1u);
    }
}
