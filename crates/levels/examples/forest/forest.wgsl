// Draws a stand of trees. Behind `leaf_sizes.wgsl`, whose `scale_bits` and `shown` it calls.

struct Frame {
    view_projection: mat4x4<f32>,
    eye: vec4<f32>,
    // Of the picture: its middle, and from there to its right and upper side, at distance 1.
    forward: vec4<f32>,
    right: vec4<f32>,
    up: vec4<f32>,
    // Towards the sun.
    sun: vec4<f32>,
}

struct Item {
    position: vec3<f32>,
    scale: f32,
    // Cosine and sine.
    turn: vec2<f32>,
    steps: u32,
    fade_steps: u32,
    // What survivors share.
    common_scale: f32,
    // How much of it is shown, 0 to 1.
    shown: f32,
    seed: u32,
    padding: u32,
}

// A leaf of a list.
struct Listed {
    item: u32,
    place: u32,
    scale: f32,
    first_index: u32,
    // How many it has.
    indices: u32,
}

// A plane of a box in the plant's own space.
struct BoxPlane {
    centre: vec4<f32>,
    right: vec4<f32>,
    up: vec4<f32>,
    toward: vec4<f32>,
    // Of its picture.
    extent: vec4<f32>,
}

@group(0) @binding(5) var<storage, read> centres: array<vec4<f32>>;
// Eight words a vertex, for leaves of lists.
@group(0) @binding(6) var<storage, read> pulled_vertices: array<u32>;
@group(0) @binding(7) var<storage, read> pulled_indices: array<u32>;

@group(1) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(1) var<storage, read> items: array<Item>;
@group(1) @binding(2) var<storage, read> listed: array<Listed>;
@group(1) @binding(3) var smooth_sampler: sampler;

@group(2) @binding(0) var picture: texture_2d<f32>;

@group(3) @binding(0) var box_colors: texture_2d_array<f32>;
@group(3) @binding(1) var box_normals: texture_2d_array<f32>;
@group(3) @binding(2) var<storage, read> box_planes: array<BoxPlane>;

// Indices of the largest leaf.
override LEAF_INDICES: u32 = 6u;

struct Corner {
    @location(0) position: vec3<f32>,
    @location(1) normal: vec4<f32>,
    @location(2) color: vec4<f32>,
    @location(3) uv: vec2<f32>,
    @location(4) place: u32,
}

struct Shaded {
    @builtin(position) clip: vec4<f32>,
    @location(0) normal: vec3<f32>,
    @location(1) color: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) @interpolate(flat) shown: f32,
    @location(4) @interpolate(flat) seed: u32,
}

fn turned(item: Item, v: vec3<f32>) -> vec3<f32> {
    let c = item.turn.x;
    let s = item.turn.y;
    return vec3<f32>(c * v.x + s * v.z, v.y, c * v.z - s * v.x);
}

fn shaded(item: Item, corner: Corner, own: vec3<f32>, shown: f32) -> Shaded {
    var out: Shaded;
    let world = item.position + item.scale * turned(item, own);
    out.clip = frame.view_projection * vec4<f32>(world, 1.0);
    out.normal = turned(item, corner.normal.xyz);
    out.color = corner.color.rgb;
    out.uv = corner.uv;
    out.shown = shown;
    // All leaves of a tree alike: so pictures of two of its levels differ no more than they must.
    out.seed = item.seed;
    return out;
}

// A mesh as it is.
@vertex
fn vs_plain(corner: Corner, @builtin(instance_index) index: u32) -> Shaded {
    let item = items[index];
    return shaded(item, corner, corner.position, item.shown);
}

// A prefix of a model's index buffer: the size of a leaf is looked up.
@vertex
fn vs_prefix(corner: Corner, @builtin(instance_index) index: u32) -> Shaded {
    let item = items[index];
    let scale = bitcast<f32>(scale_bits(corner.place, item.steps)) * item.common_scale;
    let centre = centres[corner.place].xyz;
    let own = centre + (corner.position - centre) * scale;
    let share = f32(shown(corner.place, item.steps, item.fade_steps)) / f32(WHOLE);
    return shaded(item, corner, own, item.shown * share);
}

// Leaves of a list, each of its own size.
@vertex
fn vs_listed(@builtin(vertex_index) index: u32) -> Shaded {
    let leaf = listed[index / LEAF_INDICES];
    let item = items[leaf.item];
    // What a leaf has fewer of is a triangle without area.
    let k = min(index % LEAF_INDICES, leaf.indices - 1u);
    let at = pulled_indices[leaf.first_index + k] * 8u;
    var corner: Corner;
    corner.position = vec3<f32>(
        bitcast<f32>(pulled_vertices[at]),
        bitcast<f32>(pulled_vertices[at + 1u]),
        bitcast<f32>(pulled_vertices[at + 2u]),
    );
    corner.normal = unpack4x8snorm(pulled_vertices[at + 3u]);
    corner.color = unpack4x8unorm(pulled_vertices[at + 4u]);
    corner.uv = vec2<f32>(
        bitcast<f32>(pulled_vertices[at + 5u]),
        bitcast<f32>(pulled_vertices[at + 6u]),
    );
    corner.place = leaf.place;
    let centre = centres[leaf.place].xyz;
    return shaded(item, corner, centre + (corner.position - centre) * leaf.scale, item.shown);
}

fn hash(x: u32) -> u32 {
    // PCG (O'Neill 2014), as an integer hash.
    let state = x * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// So many of four samples as alpha says, others for each pixel and thing: what covers a share of a
// pixel covers it wherever something else stands before or behind (stochastic transparency;
// Enderton et al. 2010).
fn samples(alpha: f32, clip: vec4<f32>, seed: u32) -> u32 {
    let pixel = vec2<u32>(clip.xy);
    let h = hash(pixel.x + hash(pixel.y + hash(seed)));
    let count = u32(alpha * 4.0 + f32(h & 0xffffu) / 65536.0);
    let mask = (1u << min(count, 4u)) - 1u;
    let turn = (h >> 16u) & 3u;
    return ((mask << turn) | (mask >> (4u - turn))) & 15u;
}

fn lit(base: vec3<f32>, normal: vec3<f32>) -> vec3<f32> {
    let n = normalize(normal);
    let sky = mix(vec3<f32>(0.22, 0.20, 0.15), vec3<f32>(0.48, 0.55, 0.66), 0.5 + 0.5 * n.y);
    let sun = vec3<f32>(1.15, 1.05, 0.88) * max(dot(n, frame.sun.xyz), 0.0);
    return base * (sky + sun);
}

struct Masked {
    @location(0) color: vec4<f32>,
    @builtin(sample_mask) mask: u32,
}

@fragment
fn fs_leaf(in: Shaded, @builtin(front_facing) is_front: bool) -> Masked {
    let texel = textureSample(picture, smooth_sampler, in.uv);
    var out: Masked;
    let normal = select(-in.normal, in.normal, is_front);
    out.color = vec4<f32>(lit(in.color * texel.rgb, normal), 1.0);
    out.mask = samples(texel.a * in.shown, in.clip, in.seed);
    return out;
}

@fragment
fn fs_wood(in: Shaded) -> Masked {
    let texel = textureSample(picture, smooth_sampler, in.uv);
    var out: Masked;
    out.color = vec4<f32>(lit(in.color * texel.rgb, in.normal), 1.0);
    out.mask = samples(in.shown, in.clip, in.seed);
    return out;
}

struct OnPlane {
    @builtin(position) clip: vec4<f32>,
    @location(0) uv: vec2<f32>,
    @location(1) @interpolate(flat) layer: u32,
    // How much the plane counts.
    @location(2) @interpolate(flat) weight: f32,
    // Cosine and sine of the turn, and 1 where the plane is seen from its front, else -1.
    @location(3) @interpolate(flat) turn: vec3<f32>,
    @location(4) @interpolate(flat) seed: u32,
}

const LEAST_COSINE: f32 = 0.35;

// Six corners for each of the six planes of the box whose first plane `first_vertex / 6` is.
@vertex
fn vs_box(@builtin(vertex_index) vertex: u32, @builtin(instance_index) index: u32) -> OnPlane {
    let item = items[index];
    let number = vertex / 6u;
    let first = number - number % 6u;
    let plane = box_planes[number];
    let centre = item.position + item.scale * turned(item, plane.centre.xyz);
    let to_eye = normalize(frame.eye.xyz - centre);
    var sum = 0.0;
    var own = 0.0;
    for (var k = 0u; k < 6u; k++) {
        let cosine = abs(dot(turned(item, box_planes[first + k].toward.xyz), to_eye));
        let squarely = max(cosine - LEAST_COSINE, 0.0);
        sum += squarely * squarely;
        if first + k == number {
            own = squarely * squarely;
        }
    }
    let corner = array<vec2<f32>, 6>(
        vec2<f32>(-1.0, -1.0), vec2<f32>(1.0, -1.0), vec2<f32>(1.0, 1.0),
        vec2<f32>(-1.0, -1.0), vec2<f32>(1.0, 1.0), vec2<f32>(-1.0, 1.0),
    )[vertex % 6u];
    let at = plane.centre.xyz + corner.x * plane.right.xyz + corner.y * plane.up.xyz;
    let world = item.position + item.scale * turned(item, at);
    var out: OnPlane;
    out.clip = frame.view_projection * vec4<f32>(world, 1.0);
    out.uv = 0.5 + 0.5 * vec2<f32>(corner.x, -corner.y) * plane.extent.xy;
    out.layer = number;
    out.weight = own / max(sum, 1e-6) * item.shown;
    let is_front = dot(turned(item, plane.toward.xyz), to_eye) > 0.0;
    out.turn = vec3<f32>(item.turn, select(-1.0, 1.0, is_front));
    out.seed = item.seed + number * 2891336453u;
    // What does not count is nowhere.
    if out.weight <= 0.0 {
        out.clip = vec4<f32>(0.0, 0.0, -2.0, 1.0);
    }
    return out;
}

@fragment
fn fs_box(in: OnPlane) -> Masked {
    let texel = textureSample(box_colors, smooth_sampler, in.uv, in.layer);
    let own = textureSample(box_normals, smooth_sampler, in.uv, in.layer).xyz * 2.0 - 1.0;
    let c = in.turn.x;
    let s = in.turn.y;
    var normal = vec3<f32>(c * own.x + s * own.z, own.y, c * own.z - s * own.x);
    let toward_own = box_planes[in.layer].toward.xyz;
    let toward = vec3<f32>(c * toward_own.x + s * toward_own.z, toward_own.y, c * toward_own.z - s * toward_own.x);
    // From behind, leaves are seen from their other side.
    if in.turn.z < 0.0 {
        normal -= 2.0 * dot(normal, toward) * toward;
    }
    var out: Masked;
    out.color = vec4<f32>(lit(texel.rgb, normal), 1.0);
    // All planes together cover as much as each does alone.
    let covered = 1.0 - pow(max(1.0 - texel.a, 0.0), in.weight);
    out.mask = samples(covered, in.clip, in.seed);
    return out;
}

struct OnSky {
    @builtin(position) clip: vec4<f32>,
    @location(0) ray: vec3<f32>,
}

@vertex
fn vs_sky(@builtin(vertex_index) vertex: u32) -> OnSky {
    let at = vec2<f32>(f32(vertex & 1u), f32(vertex >> 1u)) * 4.0 - 1.0;
    var out: OnSky;
    out.clip = vec4<f32>(at, 0.5, 1.0);
    out.ray = frame.forward.xyz + at.x * frame.right.xyz + at.y * frame.up.xyz;
    return out;
}

@fragment
fn fs_sky(in: OnSky) -> @location(0) vec4<f32> {
    let ray = normalize(in.ray);
    let horizon = vec3<f32>(0.70, 0.78, 0.84);
    let sky = mix(horizon, vec3<f32>(0.20, 0.42, 0.78), pow(max(ray.y, 0.0), 0.6));
    let meadow = vec3<f32>(0.10, 0.14, 0.045);
    let ground = mix(horizon, meadow, smoothstep(0.0, 0.06, -ray.y));
    return vec4<f32>(select(ground, sky, ray.y >= 0.0), 1.0);
}
