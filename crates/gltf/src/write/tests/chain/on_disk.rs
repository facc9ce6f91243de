//! A chain in a folder: refused, whole, or not there at all.

use super::*;

#[test]
fn levels_that_are_no_chain_are_refused() {
    let tree = encodings::textured().tree();
    let lods = lods(&tree);
    let refused = |change: &dyn Fn(&mut Vec<Level>), layout: Layout| -> ChainProblem {
        let mut levels = levels(&lods);
        change(&mut levels);
        let error = tree.chain_to_bytes("oak", &levels, layout).unwrap_err();
        match error.problem() {
            Problem::Chain(problem) => problem.clone(),
            other => panic!("{other}"),
        }
    };
    let files = Layout::Files;
    assert_eq!(
        refused(&|levels| levels.clear(), files),
        ChainProblem::Levels(0)
    );
    let many = |levels: &mut Vec<Level>| *levels = vec![levels[0].clone(); 9];
    assert_eq!(refused(&many, files), ChainProblem::Levels(9));
    for name in ["", "../oak", "a\\b", "a\n", ".hidden"] {
        let rename = |levels: &mut Vec<Level>| levels[1].name = name.to_owned();
        assert_eq!(refused(&rename, files), ChainProblem::Name(name.to_owned()));
    }
    let same = |levels: &mut Vec<Level>| levels[1].name = "oak_LOD0".to_owned();
    assert_eq!(
        refused(&same, files),
        ChainProblem::SameName("oak_LOD0".to_owned())
    );
    for wrong in [
        json!(0.5),
        json!(0.7),
        json!(-1),
        json!("a lot"),
        Value::Null,
    ] {
        let cover = |levels: &mut Vec<Level>| {
            levels[1]
                .facts
                .insert("screen_coverage".to_owned(), wrong.clone());
        };
        let problem = refused(&cover, Layout::Msft);
        assert_eq!(problem, ChainProblem::Coverage("oak_LOD1".to_owned()));
    }
}

#[test]
fn a_chain_goes_to_disk_with_its_images() {
    let folder = tempfile::tempdir().unwrap();
    let (from, to) = (folder.path().join("from"), folder.path().join("to"));
    std::fs::create_dir(&from).unwrap();
    std::fs::create_dir(&to).unwrap();
    let mut fixture = encodings::textured();
    fixture.root["images"] = json!([{"uri": "leaf.png"}]);
    let input = from.join("oak.glb");
    std::fs::write(&input, fixture.glb()).unwrap();
    std::fs::write(from.join("leaf.png"), encodings::one_texel_png()).unwrap();
    let tree = Tree::open(&input, &["material:leaf".parse().unwrap()]).unwrap();
    let lods = lods(&tree);

    let written = tree
        .write_chain("oak", &levels(&lods), Layout::Files, &to)
        .unwrap();
    let names = ["oak_LOD0.glb", "oak_LOD1.glb", "oak_LOD2.glb", "leaf.png"];
    assert_eq!(written.files, names.map(|name| to.join(name)));
    assert_eq!(written.triangles, chain(&tree, Layout::Files).triangles);
    let bytes: u64 = written
        .files
        .iter()
        .map(|f| f.metadata().unwrap().len())
        .sum();
    assert_eq!(written.bytes, bytes);

    for (name, layout) in [("s.glb", Layout::Siblings), ("m.gltf", Layout::Msft)] {
        let path = to.join(name);
        let written = tree
            .write_chain("oak", &levels(&lods), layout, &path)
            .unwrap();
        assert_eq!(written.files[0], path);
        let read = Document::open(&path).unwrap();
        let level = node_named(&read.root, "oak_LOD2");
        assert_eq!(triangles_below(&read, level), written.triangles[2]);
    }
    let glb = std::fs::read(to.join("s.glb")).unwrap();
    assert_eq!(glb, chain(&tree, Layout::Siblings).files[0].bytes);
    assert_valid(&[to.join("oak_LOD0.glb"), to.join("s.glb"), to.join("m.gltf")]);

    let over_input = tree.write_chain("oak", &levels(&lods), Layout::Msft, &input);
    assert!(
        over_input
            .unwrap_err()
            .to_string()
            .contains("the input is made of")
    );
}

/// A folder is where the third level should go: no other level appears, nor the
/// folder of the chain if it was made for it.
#[test]
fn a_chain_of_files_is_all_there_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("in.glb");
    std::fs::write(&input, encodings::textured().glb()).unwrap();
    let tree = Tree::open(&input, &["material:leaf".parse().unwrap()]).unwrap();
    let lods = lods(&tree);
    let levels = levels(&lods);
    let names = |folder: &Path| {
        let files = std::fs::read_dir(folder).unwrap();
        let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    };
    let to = folder.path().join("chain");
    let third = to.join("oak_LOD2.glb");
    let overwrite = WriteOptions::default().overwrite(true);
    let prepare = |options| tree.prepare_chain("oak", &levels, Layout::Files, &to, options);

    std::fs::create_dir_all(&third).unwrap();
    assert!(prepare(overwrite).is_err());
    assert_eq!(names(&to), ["oak_LOD2.glb"]);
    std::fs::remove_dir(&third).unwrap();

    std::fs::write(&third, "mine").unwrap();
    let error = prepare(WriteOptions::default()).unwrap_err().to_string();
    assert!(
        error.contains("LOD2") && error.contains("already"),
        "{error}"
    );
    assert_eq!(names(&to), ["oak_LOD2.glb"]);
    assert_eq!(std::fs::read(&third).unwrap(), b"mine");
    prepare(overwrite).unwrap().commit().unwrap();
    assert_eq!(names(&to), ["oak_LOD0.glb", "oak_LOD1.glb", "oak_LOD2.glb"]);

    std::fs::remove_dir_all(&to).unwrap();
    drop(prepare(overwrite).unwrap());
    assert_eq!(names(folder.path()), ["in.glb"]);
}
