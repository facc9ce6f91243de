//! The fuzzer's skeletons and thousands of fixed mutations of them: whatever the
//! bytes, the methods that follow branches end in an order or are not begun.

use std::path::Path;

use glam::DVec3;
use secateur_gltf::Document;
use secateur_plant::{
    ClusterSize, MAX_DEPTH, Metric, Random, Segment, SegmentIndex, chain_order, check_depth,
    merge_order,
};

/// What the fuzz target does with a file, too. Whether there were orders.
fn ends(bytes: &[u8]) -> bool {
    let document = Document::from_bytes("fuzz.glb", bytes.to_vec(), None);
    let tree = document.and_then(|d| d.into_tree(&["material:*".parse().unwrap()]));
    let Ok(tree) = tree else {
        return false;
    };
    let Ok(Some(skeleton)) = tree.skeleton() else {
        return false;
    };
    if check_depth(&skeleton.segments).is_err() {
        return false;
    }
    let foliage = tree.foliage();
    let leaves = foliage.leaves().len();
    let chain = chain_order(foliage, &skeleton, Metric::BranchingLength, 0);
    let merge = merge_order(foliage, &skeleton, ClusterSize::Area, 0);
    assert_eq!([chain.len(), merge.len()], [leaves; 2]);
    true
}

fn seeds_of(target: &str) -> Vec<(String, Vec<u8>)> {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus");
    let folder = corpus.join(target);
    let entries = std::fs::read_dir(folder).unwrap();
    let mut paths: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let file = |path: &std::path::PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        (name, std::fs::read(path).unwrap())
    };
    paths.iter().map(file).collect()
}

#[test]
fn skeletons_that_can_be_have_orders() {
    let seeds = seeds_of("skeleton");
    assert!(seeds.len() >= 20, "{} seeds", seeds.len());
    for (name, bytes) in seeds {
        assert_eq!(ends(&bytes), !name.starts_with("broken"), "{name}");
    }
}

/// Bits of the numbers, and digits of the JSON that says which are whose.
#[test]
fn mutations_of_skeletons_end() {
    let mut random = Random::new(2026);
    let below = |random: &mut Random, end: usize| (random.bits() % end as u64) as usize;
    let mut orders = 0;
    for (_, seed) in seeds_of("skeleton") {
        let json_end = 20 + u32::from_le_bytes(seed[12..16].try_into().unwrap()) as usize;
        let of_json = 20..json_end;
        let digits: Vec<usize> = of_json.filter(|&k| seed[k].is_ascii_digit()).collect();
        for _ in 0..200 {
            let mut bytes = seed.clone();
            for _ in 0..=below(&mut random, 3) {
                match below(&mut random, 3) {
                    0 => {
                        let at = digits[below(&mut random, digits.len())];
                        bytes[at] = b'0' + below(&mut random, 10) as u8;
                    }
                    1 => {
                        let at = json_end + 8 + below(&mut random, seed.len() - json_end - 8);
                        bytes[at] = random.bits() as u8;
                    }
                    _ => {
                        let at = 20 + below(&mut random, seed.len() - 20);
                        bytes[at] ^= 1 << below(&mut random, 8);
                    }
                }
            }
            orders += usize::from(ends(&bytes));
        }
    }
    assert!(orders > 50, "only {orders} mutations were still skeletons");
}

#[test]
fn a_way_from_the_root_may_only_be_so_long() {
    let segment = |k: usize| Segment {
        parent: k.checked_sub(1).map(SegmentIndex::from_index),
        continues_parent: k > 0,
        start: DVec3::Y * k as f64,
        end: DVec3::Y * (k + 1) as f64,
        start_radius_m: 0.1,
        end_radius_m: 0.1,
        sides: 3,
    };
    let most = MAX_DEPTH as usize;
    let mut segments: Vec<Segment> = (0..most).map(segment).collect();
    assert_eq!(check_depth(&segments), Ok(()));
    // Beside the others, not on them.
    segments.push(segment(0));
    assert_eq!(check_depth(&segments), Ok(()));
    segments.push(segment(most));
    let said = check_depth(&segments).unwrap_err().to_string();
    assert!(
        said.starts_with("segment 10001 of the skeleton grows 10001 segments above its root"),
        "{said}"
    );
}
