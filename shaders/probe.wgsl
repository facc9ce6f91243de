// Counts to a bound that some drivers never reach: one invocation. A sound
// driver writes `iterations`.

struct Probe {
    iterations: u32,
}

@group(0) @binding(0) var<uniform> probe: Probe;
@group(0) @binding(1) var<storage, read_write> counted: u32;

@compute @workgroup_size(1)
fn count_up() {
    // Read from memory at every turn, so that the loop is not folded away.
    counted = 0u;
    while counted < probe.iterations {
        counted++;
    }
}
