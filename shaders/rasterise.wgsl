// Snapped triangles to pixels, in integers. The twin is `cpu::rasterise`.
//
// One invocation per triangle; its box is at most a tile (`gpu::tiles`), so no
// invocation walks far. Entry points differ in what they do with a pixel:
//
//   count          fragments of each pixel
//   emit           (leaf, depth) into the pixel's slots
//   nearest_depth  the least depth of each pixel
//   nearest_leaf   the lowest leaf at that depth
//   uncover        one invocation per pixel: what `nearest_leaf` found to a leaf ID
//
// Additions and multiplications wrap, as the twin's do.

override WORKGROUP: u32;

struct Triangle {
    leaf: u32,
    cutout: u32,
    first_pixel: u32,
    size: u32,
    edges: array<array<i32, 3>, 3>,
    depth: array<i32, 3>,
    u: array<i32, 3>,
    v: array<i32, 3>,
}

// Triangles of one view.
struct Piece {
    triangle_count: u32,
    // Number of the view's pixel 0 among the pixels of the chunk.
    view_pixel: u32,
    triangles: array<Triangle>,
}

// A run of the chunk's pixels; pixels outside are passed over.
struct Window {
    resolution: u32,
    first_pixel: u32,
    pixel_count: u32,
    // Number of the window's fragment 0 among the fragments of the chunk.
    first_fragment: u32,
}

@group(0) @binding(0) var<uniform> window: Window;
@group(0) @binding(1) var<storage, read> piece: Piece;
// Three words for each cut-out: where its bits start; width and height times
// 65536; wraps of u and v times 65536. Then the bits.
@group(0) @binding(2) var<storage, read> cutouts: array<u32>;
// A word for each pixel of the chunk: fragments (count), the next free slot
// (emit), the complement of the least depth (nearest_depth).
@group(0) @binding(3) var<storage, read_write> per_pixel: array<atomic<u32>>;
// x is the leaf, y the depth: `Fragment` as two words.
@group(0) @binding(4) var<storage, read_write> lists: array<vec2<u32>>;
// The complement of the lowest leaf; 0 where none is.
@group(0) @binding(5) var<storage, read_write> nearest: array<atomic<u32>>;

const REPEAT: i32 = 0;
const CLAMP_TO_EDGE: i32 = 1;

// `Wrap::texel`.
fn wrap_texel(wrap: i32, coordinate: i32, size: i32) -> i32 {
    let last = size - 1;
    if wrap == REPEAT {
        return coordinate & last;
    }
    if wrap == CLAMP_TO_EDGE {
        return clamp(coordinate, 0, last);
    }
    let t = coordinate & (2 * last + 1);
    return select(t, 2 * last + 1 - t, t > last);
}

// `Cutout::is_opaque`; `cutout` from 1.
fn is_opaque(cutout: u32, u_texel: i32, v_texel: i32) -> bool {
    let entry = 3u * (cutout - 1u);
    let size = cutouts[entry + 1u];
    let wraps = cutouts[entry + 2u];
    let width = size & 0xFFFFu;
    let x = u32(wrap_texel(i32(wraps & 0xFFFFu), u_texel, i32(width)));
    let y = u32(wrap_texel(i32(wraps >> 16u), v_texel, i32(size >> 16u)));
    let texel = y * width + x;
    return ((cutouts[cutouts[entry] + texel / 32u] >> (texel % 32u)) & 1u) == 1u;
}

// Where the walk through a triangle's box stands.
struct Walk {
    index: u32,
    width: u32,
    x: u32,
    y: u32,
    rows_left: u32,
    was_inside: bool,
    // Edge functions here, at the start of the row, and their steps.
    at: vec3<i32>,
    row: vec3<i32>,
    right: vec3<i32>,
    down: vec3<i32>,
    // Pixel (0, 0) of the box, from the window's first.
    corner: u32,
}

fn begin(index: u32) -> Walk {
    let e = piece.triangles[index].edges;
    let first = piece.triangles[index].first_pixel;
    let size = piece.triangles[index].size;
    let start = vec3(e[0][0], e[1][0], e[2][0]);
    return Walk(
        index,
        size & 0xFFFFu,
        0u,
        0u,
        size >> 16u,
        false,
        start,
        start,
        vec3(e[0][1], e[1][1], e[2][1]),
        vec3(e[0][2], e[1][2], e[2][2]),
        piece.view_pixel + (first >> 16u) * window.resolution + (first & 0xFFFFu)
            - window.first_pixel,
    );
}

struct Pixel {
    is_covered: bool,
    // From the window's first.
    index: u32,
    x: u32,
    y: u32,
}

// Looks at one pixel and goes on to the next: to the right, or to the next row
// when this one ends or the triangle was left.
fn step(walk: ptr<function, Walk>) -> Pixel {
    let at = (*walk).at;
    let x = (*walk).x;
    let y = (*walk).y;
    let is_inside = (at.x | at.y | at.z) >= 0;
    let index = (*walk).corner + y * window.resolution + x;
    let is_left = !is_inside && (*walk).was_inside;
    if is_left || x + 1u == (*walk).width {
        let row = (*walk).row + (*walk).down;
        (*walk).row = row;
        (*walk).at = row;
        (*walk).x = 0u;
        (*walk).y = y + 1u;
        (*walk).rows_left -= 1u;
        (*walk).was_inside = false;
    } else {
        (*walk).at = at + (*walk).right;
        (*walk).x = x + 1u;
        (*walk).was_inside = is_inside;
    }
    var is_covered = is_inside && index < window.pixel_count;
    if is_covered {
        let cutout = piece.triangles[(*walk).index].cutout;
        if cutout != 0u {
            let u = plane(piece.triangles[(*walk).index].u, x, y) >> 16u;
            let v = plane(piece.triangles[(*walk).index].v, x, y) >> 16u;
            is_covered = is_opaque(cutout, u, v);
        }
    }
    return Pixel(is_covered, index, x, y);
}

fn plane(p: array<i32, 3>, x: u32, y: u32) -> i32 {
    return p[0] + p[1] * i32(x) + p[2] * i32(y);
}

fn depth_at(index: u32, pixel: Pixel) -> u32 {
    return u32(plane(piece.triangles[index].depth, pixel.x, pixel.y));
}

@compute @workgroup_size(WORKGROUP)
fn count(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= piece.triangle_count {
        return;
    }
    var walk = begin(id.x);
    while walk.rows_left != 0u {
        let pixel = step(&walk);
        if pixel.is_covered {
            atomicAdd(&per_pixel[window.first_pixel + pixel.index], 1u);
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn emit(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= piece.triangle_count {
        return;
    }
    let leaf = piece.triangles[id.x].leaf;
    var walk = begin(id.x);
    while walk.rows_left != 0u {
        let pixel = step(&walk);
        if pixel.is_covered {
            let slot = atomicAdd(&per_pixel[window.first_pixel + pixel.index], 1u);
            lists[slot - window.first_fragment] = vec2(leaf, depth_at(id.x, pixel));
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn nearest_depth(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= piece.triangle_count {
        return;
    }
    var walk = begin(id.x);
    while walk.rows_left != 0u {
        let pixel = step(&walk);
        if pixel.is_covered {
            atomicMax(&per_pixel[window.first_pixel + pixel.index], ~depth_at(id.x, pixel));
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn nearest_leaf(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= piece.triangle_count {
        return;
    }
    let leaf = piece.triangles[id.x].leaf;
    var walk = begin(id.x);
    while walk.rows_left != 0u {
        let pixel = step(&walk);
        if pixel.is_covered {
            let at = window.first_pixel + pixel.index;
            if atomicLoad(&per_pixel[at]) == ~depth_at(id.x, pixel) {
                atomicMax(&nearest[at], ~leaf);
            }
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn uncover(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < window.pixel_count {
        let found = atomicLoad(&nearest[id.x]);
        if found != 0u {
            atomicStore(&nearest[id.x], ~found);
        }
    }
}
