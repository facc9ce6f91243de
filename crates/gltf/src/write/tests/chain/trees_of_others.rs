//! Chains of trees by other tools.

use super::*;

#[test]
fn real_trees_make_chains() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    for path in super::super::real_trees::trees() {
        let tree = Document::open(&path).unwrap().into_tree(&[]).unwrap();
        let count = tree.foliage.leaves().len();
        let mut lods = vec![Lod::original(count); 3];
        for index in 0..count {
            let leaf = LeafId::from_index(index);
            if index % 2 == 1 {
                lods[1].remove(leaf);
            }
            match index % 10 {
                0 => lods[2].resize(leaf, 4.0),
                _ => lods[2].remove(leaf),
            }
        }
        let name = path.file_stem().unwrap().to_str().unwrap();
        let mut sizes = Vec::new();
        for layout in LAYOUTS {
            let chain = tree.chain_to_bytes("oak", &levels(&lods), layout).unwrap();
            sizes.push(chain.files.iter().map(|f| f.bytes.len()).sum::<usize>());
            for (number, &triangles) in chain.triangles.iter().enumerate() {
                let file = if layout == Layout::Files { number } else { 0 };
                let level = document(&chain, file);
                let node = node_named(&level.root, &format!("oak_LOD{number}"));
                assert_eq!(triangles_below(&level, node), triangles, "{name}");
                if layout == Layout::Files && number == 0 {
                    let extents = |document: &Document| document.inspect(&[]).extents.unwrap();
                    let (old, new) = (extents(&tree.document), extents(&level));
                    for (old, new) in old.as_flattened().iter().zip(new.as_flattened()) {
                        assert!((old - new).abs() <= 1e-5 * (1.0 + old.abs()), "{name}");
                    }
                }
            }
            files.extend(written(
                &chain,
                folder.path(),
                &format!("{name}-{layout:?}"),
            ));
        }
        // One file has what the levels share once.
        assert!(
            sizes[1] < sizes[0] && sizes[2] < sizes[0],
            "{name}: {sizes:?}"
        );
        let input = path.metadata().unwrap().len();
        eprintln!("{name}: {input} bytes, files, siblings and msft: {sizes:?}");
    }
    assert_valid(&files);
    assert_eq!(warnings(&files), [""; 0]);
}
