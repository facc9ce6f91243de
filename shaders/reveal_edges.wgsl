// Which leaf each leaf's pixels would show if it went: pixels counted by
// (front leaf, second leaf, view) in a hash table.
//
//   insert  one invocation per pixel finds the slot of its key, and counts
//   gather  one invocation per slot appends the used ones
//
// A slot names some pixel, and so that pixel's key: a key of three words is
// claimed with one atomic. Keys never move, so each has one slot, whoever comes
// first; only the order of slots varies, and the runner sorts. The twin is
// `cpu::reveal_edges`.

override WORKGROUP: u32;

struct Table {
    pixel_count: u32,
    pixels_per_view: u32,
    // Slots, a power of two, at least twice the pixels: there is always a free one.
    slot_count: u32,
    // Number of pixel 0 among those of all views.
    first_pixel: u32,
}

struct Slot {
    // One more than a pixel with the slot's key; 0 where the slot is free.
    pixel: atomic<u32>,
    count: atomic<u32>,
}

struct Edge {
    front: u32,
    second: u32,
    view: u32,
    pixels: u32,
}

@group(0) @binding(0) var<uniform> table: Table;
// Front and second leaf of each pixel, 0 where there is none.
@group(0) @binding(1) var<storage, read> leaves: array<vec2<u32>>;
@group(0) @binding(2) var<storage, read_write> slots: array<Slot>;
@group(0) @binding(3) var<storage, read_write> edges: array<Edge>;
@group(0) @binding(4) var<storage, read_write> edge_count: atomic<u32>;

fn mix(word: u32) -> u32 {
    var m = word;
    m = (m ^ (m >> 16u)) * 0x7FEB352Du;
    m = (m ^ (m >> 15u)) * 0x846CA68Bu;
    return m ^ (m >> 16u);
}

fn view_of(pixel: u32) -> u32 {
    return (table.first_pixel + pixel) / table.pixels_per_view;
}

@compute @workgroup_size(WORKGROUP)
fn insert(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= table.pixel_count || leaves[id.x].x == 0u {
        return;
    }
    let own = leaves[id.x];
    let view = view_of(id.x);
    var at = mix(own.x ^ mix(own.y ^ mix(view)));
    for (var tries = 0u; tries < table.slot_count; tries++) {
        at &= table.slot_count - 1u;
        var found = atomicLoad(&slots[at].pixel);
        if found == 0u {
            // May fail for no reason; then the slot is looked at again.
            let claim = atomicCompareExchangeWeak(&slots[at].pixel, 0u, id.x + 1u);
            if claim.exchanged {
                found = id.x + 1u;
            } else {
                found = claim.old_value;
            }
        }
        if found == 0u {
            continue;
        }
        let other = found - 1u;
        if all(leaves[other] == own) && view_of(other) == view {
            atomicAdd(&slots[at].count, 1u);
            return;
        }
        at++;
    }
}

@compute @workgroup_size(WORKGROUP)
fn gather(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= table.slot_count {
        return;
    }
    let found = atomicLoad(&slots[id.x].pixel);
    if found == 0u {
        return;
    }
    let pixel = found - 1u;
    let place = atomicAdd(&edge_count, 1u);
    edges[place] = Edge(
        leaves[pixel].x,
        leaves[pixel].y,
        view_of(pixel),
        atomicLoad(&slots[id.x].count),
    );
}
