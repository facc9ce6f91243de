// What pruning each leaf of the original foliage costs (VDS, Eq. 4), in units
// of 2^-27 bits times pixels:
//
//   changes    one invocation per leaf (x) and view (y): how far the view's
//              VMI moves
//   sum_views  one invocation per leaf adds up its views
//
// A leaf of area a in a view and S over all views lowers the view's VMI by
// h(a, S) = a (lg S - lg a), which is never negative. Taking leaf l away moves
// P * I(v) by
//
//   h(a_l, S_l) + sum over revealed o of [h(a_o, S_o) - h(a_o + r_o, S_o + s_o)]
//
// in integers of 64 bits, here pairs (low, high). The twin is
// `first_costs::on_cpu`.

override WORKGROUP: u32;
override LG_FRACTION_BITS: u32;

struct Shape {
    leaf_count: u32,
    view_count: u32,
    // Number of this run's first leaf.
    first_leaf: u32,
    // Areas of a view: leaves of the foliage and the background.
    row: u32,
}

// What one leaf hands to another, over all views.
struct Reveal {
    to: u32,
    total_px: u32,
    // Its edges end where those of the next begin.
    first_edge: u32,
}

struct Edge {
    view: u32,
    pixels: u32,
}

@group(0) @binding(0) var<uniform> shape: Shape;
// Where the reveals of each leaf of this run start, and their end.
@group(0) @binding(1) var<storage, read> first_reveal: array<u32>;
@group(0) @binding(2) var<storage, read> reveals: array<Reveal>;
@group(0) @binding(3) var<storage, read> edges: array<Edge>;
@group(0) @binding(4) var<storage, read> area_px: array<u32>;
@group(0) @binding(5) var<storage, read> total_px: array<u32>;
// Logarithms of small counts; [0] is unused.
@group(0) @binding(6) var<storage, read> lg_table: array<u32>;
@group(0) @binding(7) var<storage, read_write> moved: array<vec2<u32>>;
@group(0) @binding(8) var<storage, read_write> costs: array<vec2<u32>>;

fn add64(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    let low = a.x + b.x;
    return vec2(low, a.y + b.y + u32(low < a.x));
}

fn negate64(a: vec2<u32>) -> vec2<u32> {
    return add64(~a, vec2(1u, 0u));
}

fn multiply(a: u32, b: u32) -> vec2<u32> {
    let al = a & 0xFFFFu;
    let ah = a >> 16u;
    let bl = b & 0xFFFFu;
    let bh = b >> 16u;
    let low = al * bl;
    let m = al * bh;
    let n = ah * bl;
    let middle = (low >> 16u) + (m & 0xFFFFu) + (n & 0xFFFFu);
    return vec2(
        (low & 0xFFFFu) | (middle << 16u),
        ah * bh + (m >> 16u) + (n >> 16u) + (middle >> 16u),
    );
}

// `lg::lg`.
fn lg(n: u32) -> u32 {
    if n < arrayLength(&lg_table) {
        return lg_table[n];
    }
    let exponent = firstLeadingBit(n);
    var mantissa = n << (31u - exponent);
    var bits = exponent;
    for (var k = 0u; k < LG_FRACTION_BITS; k++) {
        let square = multiply(mantissa, mantissa);
        let carry = square.y >> 31u;
        mantissa = select((square.y << 1u) | (square.x >> 31u), square.y, carry == 1u);
        bits = (bits << 1u) | carry;
    }
    return bits;
}

// lg is monotonic and a view's area is at most that of all views.
fn lowers(area: u32, total: u32) -> vec2<u32> {
    if area == 0u {
        return vec2(0u, 0u);
    }
    return multiply(area, lg(total) - lg(area));
}

@compute @workgroup_size(WORKGROUP)
fn changes(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= shape.leaf_count {
        return;
    }
    let leaf = shape.first_leaf + id.x;
    let view = id.y;
    let row = view * shape.row;
    var change = lowers(area_px[row + leaf], total_px[leaf]);
    for (var k = first_reveal[id.x]; k < first_reveal[id.x + 1u]; k++) {
        let reveal = reveals[k];
        var pixels = 0u;
        for (var e = reveal.first_edge; e < reveals[k + 1u].first_edge; e++) {
            if edges[e].view == view {
                pixels = edges[e].pixels;
            }
        }
        let area = area_px[row + reveal.to];
        let total = total_px[reveal.to];
        let after = lowers(area + pixels, total + reveal.total_px);
        change = add64(change, lowers(area, total));
        change = add64(change, negate64(after));
    }
    if (change.y >> 31u) == 1u {
        change = negate64(change);
    }
    moved[id.x * shape.view_count + view] = change;
}

@compute @workgroup_size(WORKGROUP)
fn sum_views(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= shape.leaf_count {
        return;
    }
    var cost = vec2(0u, 0u);
    for (var view = 0u; view < shape.view_count; view++) {
        cost = add64(cost, moved[id.x * shape.view_count + view]);
    }
    costs[id.x] = cost;
}
