//! Lists that are too long for one invocation.

use super::Device;
use super::chunk::Window;
use super::stages::{HEAP_MAX, PIXEL_WORKGROUP};

/// Lists of one dispatch: its workgroups in one direction.
const MAX_LISTS: usize = 65_535;

/// A list in words: where it starts in the window, its size, its pixel.
type List = [u32; 3];

/// Records the sorting of the window's lists over [`HEAP_MAX`]: by leaf, to
/// mark all but each leaf's nearest, then by depth. `starts` are those of the
/// chunk; `buffers` are lists, what is kept of each pixel, and the number of
/// dropped fragments.
pub(super) fn sort(
    device: &Device,
    pass: &mut wgpu::ComputePass<'_>,
    window: &Window,
    starts: &[u32],
    buffers: [&wgpu::Buffer; 3],
) {
    let mut long: Vec<List> = (window.first_pixel..window.first_pixel + window.pixel_count)
        .map(|pixel| {
            let start = starts[pixel as usize];
            let size = starts[pixel as usize + 1] - start;
            [start - window.first_fragment, size, pixel]
        })
        .filter(|list| list[1] > HEAP_MAX)
        .collect();
    if long.is_empty() {
        return;
    }
    long.sort_by_key(|list| list[1]);
    let table = device.storage_of("long lists", long.as_flattened());
    let mut recorder = Recorder {
        device,
        pass,
        table,
        buffers,
    };
    let mut first = 0;
    // Lists that fill up to the same power of two go together.
    for group in long.chunk_by(|a, b| a[1].next_power_of_two() == b[1].next_power_of_two()) {
        for lists in group.chunks(MAX_LISTS) {
            let class = Class {
                first,
                count: lists.len() as u32,
                filled: lists[0][1].next_power_of_two(),
            };
            recorder.network(&class, true);
            recorder.mark(&class);
            recorder.network(&class, false);
            first += class.count;
        }
    }
}

/// Lists of like size.
struct Class {
    first: u32,
    count: u32,
    /// Size that they are filled up to, a power of two.
    filled: u32,
}

struct Recorder<'r, 'p> {
    device: &'r Device,
    pass: &'r mut wgpu::ComputePass<'p>,
    table: wgpu::Buffer,
    buffers: [&'r wgpu::Buffer; 3],
}

impl Recorder<'_, '_> {
    fn network(&mut self, class: &Class, by_leaf: bool) {
        let mut sorted = 2;
        while sorted <= class.filled {
            self.exchange(class, sorted, true, by_leaf);
            let mut block = sorted / 2;
            while block >= 2 {
                self.exchange(class, block, false, by_leaf);
                block /= 2;
            }
            sorted *= 2;
        }
    }

    fn exchange(&mut self, class: &Class, block: u32, is_flip: bool, by_leaf: bool) {
        let words = [block, u32::from(is_flip), u32::from(by_leaf), class.first];
        let step = self.device.uniform(&words);
        let bindings = [(0, &step), (1, &self.table), (2, self.buffers[0])];
        let workgroups = [(class.filled / 2).div_ceil(PIXEL_WORKGROUP), class.count, 1];
        let exchange = &self.device.stages.exchange;
        exchange.run(self.device, self.pass, &bindings, workgroups);
    }

    fn mark(&mut self, class: &Class) {
        let step = self.device.uniform(&[0, 0, 0, class.first]);
        let [lists, kept, dropped] = self.buffers;
        let bindings = [
            (0, &step),
            (1, &self.table),
            (2, lists),
            (3, kept),
            (4, dropped),
        ];
        let workgroups = [class.filled.div_ceil(PIXEL_WORKGROUP), class.count, 1];
        let mark = &self.device.stages.mark;
        mark.run(self.device, self.pass, &bindings, workgroups);
    }
}
