// Snapped triangles to pixels, in integers. The twin is `cpu::rasterise`.
//
// One invocation per triangle; its box is at most a tile (`gpu::tiles`), so no
// invocation goes far. It looks at a block of pixels at a time, without branches,
// and then only at those inside: neighbouring lanes stay together, whatever their
// triangles look like. Entry points differ in what they do with a pixel:
//
//   count          fragments of each pixel, and which pixels are covered
//   emit           (leaf, depth) into the slots of the pixels that `count` found
//   nearest_depth  the least depth of each pixel
//   nearest_leaf   the lowest leaf at that depth
//   uncover        one invocation per pixel: what `nearest_leaf` found to a leaf ID
//
// Additions and multiplications wrap, as the twin's do.

override WORKGROUP: u32;
override KNOWN_BLOCKS: u32;

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
// The pixels that each triangle covers in the first KNOWN_BLOCKS blocks of its
// box.
@group(0) @binding(6) var<storage, read_write> masks: array<vec2<u32>>;

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

// Pixels of a block across and down.
const BLOCK: u32 = 8u;

// A block of a triangle's box, and the pixels of it still to be looked at: bit
// 8 y + x, the upper four rows in x, the others in y.
struct Block {
    // First pixel, from the box's.
    x: u32,
    y: u32,
    number: u32,
    rest: vec2<u32>,
}

fn width_of(index: u32) -> u32 {
    return piece.triangles[index].size & 0xFFFFu;
}

fn height_of(index: u32) -> u32 {
    return piece.triangles[index].size >> 16u;
}

fn first_block() -> Block {
    return Block(0u, 0u, 0u, vec2(0u));
}

fn go_on(block: ptr<function, Block>, width: u32) {
    (*block).number += 1u;
    (*block).x += BLOCK;
    if (*block).x >= width {
        (*block).x = 0u;
        (*block).y += BLOCK;
    }
}

// The pixels of a block that are inside the edges.
fn pixels_inside(index: u32, block: Block) -> vec2<u32> {
    let e = piece.triangles[index].edges;
    let height = min(height_of(index) - block.y, BLOCK);
    let width_mask = (1u << min(width_of(index) - block.x, BLOCK)) - 1u;
    let columns = i32(block.x) + vec4(0, 1, 2, 3);
    let row = i32(block.y);
    var a = e[0][0] + e[0][1] * columns + e[0][2] * row;
    var b = e[1][0] + e[1][1] * columns + e[1][2] * row;
    var c = e[2][0] + e[2][1] * columns + e[2][2] * row;
    var mask = vec2(0u);
    for (var y = 0u; y < height; y++) {
        let outside = signs(a | b | c)
            | (signs((a + 4 * e[0][1]) | (b + 4 * e[1][1]) | (c + 4 * e[2][1])) << 4u);
        let bits = (~outside & width_mask) << (BLOCK * (y & 3u));
        mask |= select(vec2(0u, bits), vec2(bits, 0u), y < 4u);
        a += e[0][2];
        b += e[1][2];
        c += e[2][2];
    }
    return mask;
}

// A bit for each that is negative.
fn signs(v: vec4<i32>) -> u32 {
    let bits = (vec4<u32>(v) >> vec4(31u)) << vec4(0u, 1u, 2u, 3u);
    return bits.x | bits.y | bits.z | bits.w;
}

struct Pixel {
    // From the window's first.
    index: u32,
    // From the box's first.
    x: u32,
    y: u32,
    bit: vec2<u32>,
}

// Takes the next of the pixels that are left; there is one. `corner` as
// `corner_of`.
fn take_pixel(block: ptr<function, Block>, corner: u32) -> Pixel {
    let rest = (*block).rest;
    let in_upper = rest.x != 0u;
    let word = select(rest.y, rest.x, in_upper);
    let place = firstTrailingBit(word) + select(BLOCK * 4u, 0u, in_upper);
    let lowest = word & (~word + 1u);
    let bit = select(vec2(0u, lowest), vec2(lowest, 0u), in_upper);
    (*block).rest ^= bit;
    let x = (*block).x + place % BLOCK;
    let y = (*block).y + place / BLOCK;
    return Pixel(corner + y * window.resolution + x, x, y, bit);
}

fn has_pixels(block: Block) -> bool {
    return (block.rest.x | block.rest.y) != 0u;
}

// The box's first pixel, from the window's.
fn corner_of(index: u32) -> u32 {
    let first = piece.triangles[index].first_pixel;
    return piece.view_pixel + (first >> 16u) * window.resolution + (first & 0xFFFFu)
        - window.first_pixel;
}

// Whether a pixel inside the edges is in the window, and kept by the cut-out, from
// 1 or none.
fn is_covered(index: u32, cutout: u32, pixel: Pixel) -> bool {
    if pixel.index >= window.pixel_count {
        return false;
    }
    if cutout == 0u {
        return true;
    }
    let u = plane(piece.triangles[index].u, pixel) >> 16u;
    let v = plane(piece.triangles[index].v, pixel) >> 16u;
    return is_opaque(cutout, u, v);
}

fn plane(p: array<i32, 3>, pixel: Pixel) -> i32 {
    return p[0] + p[1] * i32(pixel.x) + p[2] * i32(pixel.y);
}

fn depth_at(index: u32, pixel: Pixel) -> u32 {
    return u32(plane(piece.triangles[index].depth, pixel));
}

@compute @workgroup_size(WORKGROUP)
fn count(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= piece.triangle_count {
        return;
    }
    let width = width_of(id.x);
    let height = height_of(id.x);
    let corner = corner_of(id.x);
    let cutout = piece.triangles[id.x].cutout;
    var block = first_block();
    while block.y < height {
        block.rest = pixels_inside(id.x, block);
        var covered = block.rest;
        while has_pixels(block) {
            let pixel = take_pixel(&block, corner);
            if is_covered(id.x, cutout, pixel) {
                atomicAdd(&per_pixel[window.first_pixel + pixel.index], 1u);
            } else {
                covered ^= pixel.bit;
            }
        }
        if block.number < KNOWN_BLOCKS {
            masks[KNOWN_BLOCKS * id.x + block.number] = covered;
        }
        go_on(&block, width);
    }
}

@compute @workgroup_size(WORKGROUP)
fn emit(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= piece.triangle_count {
        return;
    }
    let width = width_of(id.x);
    let height = height_of(id.x);
    let corner = corner_of(id.x);
    let leaf = piece.triangles[id.x].leaf;
    var block = first_block();
    while block.y < height {
        // What is known has been through the cut-out.
        var cutout = 0u;
        if block.number < KNOWN_BLOCKS {
            block.rest = masks[KNOWN_BLOCKS * id.x + block.number];
        } else {
            block.rest = pixels_inside(id.x, block);
            cutout = piece.triangles[id.x].cutout;
        }
        while has_pixels(block) {
            let pixel = take_pixel(&block, corner);
            if is_covered(id.x, cutout, pixel) {
                let slot = atomicAdd(&per_pixel[window.first_pixel + pixel.index], 1u);
                lists[slot - window.first_fragment] = vec2(leaf, depth_at(id.x, pixel));
            }
        }
        go_on(&block, width);
    }
}

@compute @workgroup_size(WORKGROUP)
fn nearest_depth(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= piece.triangle_count {
        return;
    }
    let width = width_of(id.x);
    let height = height_of(id.x);
    let corner = corner_of(id.x);
    let cutout = piece.triangles[id.x].cutout;
    var block = first_block();
    while block.y < height {
        block.rest = pixels_inside(id.x, block);
        while has_pixels(block) {
            let pixel = take_pixel(&block, corner);
            if is_covered(id.x, cutout, pixel) {
                atomicMax(&per_pixel[window.first_pixel + pixel.index], ~depth_at(id.x, pixel));
            }
        }
        go_on(&block, width);
    }
}

@compute @workgroup_size(WORKGROUP)
fn nearest_leaf(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= piece.triangle_count {
        return;
    }
    let width = width_of(id.x);
    let height = height_of(id.x);
    let corner = corner_of(id.x);
    let cutout = piece.triangles[id.x].cutout;
    let leaf = piece.triangles[id.x].leaf;
    var block = first_block();
    while block.y < height {
        block.rest = pixels_inside(id.x, block);
        while has_pixels(block) {
            let pixel = take_pixel(&block, corner);
            if is_covered(id.x, cutout, pixel) {
                let at = window.first_pixel + pixel.index;
                if atomicLoad(&per_pixel[at]) == ~depth_at(id.x, pixel) {
                    atomicMax(&nearest[at], ~leaf);
                }
            }
        }
        go_on(&block, width);
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
