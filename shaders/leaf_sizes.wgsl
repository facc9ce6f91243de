// The sizes of leaves at a level of a removal order: a level is a prefix of the leaves by removal,
// and each leaf's size there the last one that a step up to the level's gave it. Invocation k takes
// the k-th leaf; a vertex shader calls `scale_bits` and `shown` itself. The twin is
// `secateur_runtime::prefix_buffers`.

override WORKGROUP: u32;

struct Level {
    // Steps of the order that are made.
    steps: u32,
    // Steps before its removal over which a leaf fades; 0 for none.
    fade_steps: u32,
    // Leaves of the prefix.
    leaves: u32,
}

struct SizeAt {
    step: u32,
    // Bits of the linear scale as f32.
    scale_bits: u32,
}

// A leaf that is shown whole.
const WHOLE: u32 = 65536u;

@group(0) @binding(0) var<uniform> level: Level;
// For each leaf where its sizes begin, and one more.
@group(0) @binding(1) var<storage, read> first_size: array<u32>;
@group(0) @binding(2) var<storage, read> sizes: array<SizeAt>;
// For each leaf the number of steps after which it is gone.
@group(0) @binding(3) var<storage, read> gone_after: array<u32>;
// For each leaf its scale and how much of it is shown.
@group(0) @binding(4) var<storage, read_write> found: array<vec2<u32>>;

// The linear scale of a leaf as the bits of an f32; 0 where it is not made yet.
fn scale_bits(leaf: u32, steps: u32) -> u32 {
    let first = first_size[leaf];
    var low = first;
    var high = first_size[leaf + 1u];
    while low < high {
        let middle = low + (high - low) / 2u;
        if sizes[middle].step <= steps {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    if low == first {
        return 0u;
    }
    return sizes[low - 1u].scale_bits;
}

// How much of a leaf is shown, of WHOLE: less and less over the last steps before it goes.
fn shown(leaf: u32, steps: u32, fade_steps: u32) -> u32 {
    let gone = gone_after[leaf];
    if gone <= steps {
        return 0u;
    }
    let left = gone - steps;
    if left >= fade_steps {
        return WHOLE;
    }
    return left * (WHOLE / fade_steps);
}

@compute @workgroup_size(WORKGROUP)
fn leaf_sizes(@builtin(global_invocation_id) invocation: vec3<u32>) {
    let leaf = invocation.x;
    if leaf >= level.leaves {
        return;
    }
    found[leaf] = vec2<u32>(
        scale_bits(leaf, level.steps),
        shown(leaf, level.steps, level.fade_steps),
    );
}
