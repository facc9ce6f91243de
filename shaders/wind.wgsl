// How a plant sways: what hangs on the wood moves as the wood does where it hangs, and a leaf turns
// about that point besides. Waves are integers, and the way of the wood is products only, so that all
// devices agree on them bit for bit; only the last sum may round otherwise. Invocation k takes the k-th
// vertex; a vertex shader calls `swayed` itself. The twin is `secateur_runtime::wind`.

override WORKGROUP: u32;

struct Wind {
    // Where it blows to, x and z, a unit vector in 1/256.
    toward: vec2<i32>,
    // What leaves turn about, x and z, a unit vector.
    axis: vec2<f32>,
    // The time in 1/65536 turns of the slow wave.
    turns: u32,
    // How far wood moves, in metres for each square metre along it, by UNIT and by 256.
    bend: f32,
    // The tangent of half the angle by which a leaf turns at most, by UNIT; 0 for wood.
    flutter: f32,
    // How many vertices there are.
    vertices: u32,
}

struct Vertex {
    position: vec3<f32>,
    // From the ground to the pivot along the wood, in metres.
    along: f32,
    // The point of the wood's axis that the vertex hangs on.
    pivot: vec3<f32>,
    // 1 + the place of the piece of wood, 0 for none.
    segment: u32,
}

struct Swayed {
    position: vec3<f32>,
    // The tangent of half the angle by which its leaf has turned.
    half_turn: f32,
    // How far its pivot has moved.
    bend: vec3<f32>,
    nothing: f32,
}

// The height of a wave.
const UNIT: i32 = 16384;

@group(0) @binding(0) var<uniform> wind: Wind;
@group(0) @binding(1) var<storage, read> vertices: array<Vertex>;
@group(0) @binding(2) var<storage, read_write> found: array<Swayed>;

// From -UNIT to UNIT in 65536 steps a turn: two parabolas that follow a sine to 6 % of its height.
fn wave(turns: u32) -> i32 {
    let half = i32(turns & 0x7fffu);
    let height = (half * (32768 - half)) >> 14u;
    return select(height, -height, (turns & 0x8000u) != 0u);
}

// A point in 1/1024 m.
fn cells(point: vec3<f32>) -> vec3<i32> {
    return vec3<i32>(floor(clamp(point, vec3<f32>(-1000.0), vec3<f32>(1000.0)) * 1024.0));
}

// How far downwind a point is, in 1/65536 of the slow wave's 64 m.
fn downwind(at: vec3<i32>) -> u32 {
    return u32((wind.toward.x * at.x + wind.toward.y * at.z) >> 8u);
}

// How far a point of the wood moves: it leans, gusts of 64 m pass, and waves of 8 m, three times as fast.
fn bend(pivot: vec3<f32>, along: f32) -> vec3<f32> {
    let at = downwind(cells(pivot));
    let gust = wave(wind.turns - at);
    let shiver = wave(3u * wind.turns - 8u * at);
    let amount = f32(2 * UNIT + 2 * gust + shiver) * (wind.bend * (along * along));
    return vec3<f32>(amount * f32(wind.toward.x), 0.0, amount * f32(wind.toward.y));
}

// The tangent of half the angle by which a leaf turns: each by its own wave.
fn half_turn(pivot: vec3<f32>, segment: u32) -> f32 {
    let at = cells(pivot);
    let own = segment * 0x9e3779b1u + bitcast<u32>(at.x) * 0x85ebca77u
        + bitcast<u32>(at.y) * 0xc2b2ae3du + bitcast<u32>(at.z) * 0x27d4eb2fu;
    return f32(wave(7u * wind.turns + (own >> 16u))) * wind.flutter;
}

// Where a vertex is that hangs on a pivot.
fn swayed(position: vec3<f32>, pivot: vec3<f32>, along: f32, segment: u32) -> vec3<f32> {
    let arm = position - pivot;
    let h = half_turn(pivot, segment);
    let axis = vec3<f32>(wind.axis.x, 0.0, wind.axis.y);
    let across = cross(axis, arm);
    let turn = (2.0 / (1.0 + h * h)) * (h * across + h * h * cross(axis, across));
    return pivot + bend(pivot, along) + (arm + turn);
}

@compute @workgroup_size(WORKGROUP)
fn sway(@builtin(global_invocation_id) invocation: vec3<u32>) {
    let k = invocation.x;
    if k >= wind.vertices {
        return;
    }
    let vertex = vertices[k];
    found[k] = Swayed(
        swayed(vertex.position, vertex.pivot, vertex.along, vertex.segment),
        half_turn(vertex.pivot, vertex.segment),
        bend(vertex.pivot, vertex.along),
        0.0,
    );
}
