//! Which images go along to the folder of the output.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::encodings;
use super::every_encoding::one_gone_one_grown;
use super::fixture::Fixture;
use crate::{Document, GltfError, Problem, Selector, WriteProblem, Written};

const KTX2: &[u8] = b"\xabKTX 20\xbb\r\n\x1a\n and so on";
const WEBP: &[u8] = b"RIFF\x10\0\0\0WEBPVP8L and so on";

/// A folder with a tree in `in`, and an empty folder `out`.
struct Case {
    folder: tempfile::TempDir,
    root: Value,
}

impl Case {
    fn new() -> Self {
        let Fixture { mut root, bin } = encodings::textured();
        root["buffers"] = json!([{"uri": "tree.bin", "byteLength": bin.len()}]);
        root["images"] = json!([{"uri": "leaf.png"}]);
        let case = Self {
            folder: tempfile::tempdir().unwrap(),
            root,
        };
        fs::create_dir(case.path("out")).unwrap();
        case.put("in/tree.bin", &bin);
        case.put("in/leaf.png", &encodings::one_texel_png());
        case
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn put(&self, name: &str, bytes: &[u8]) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }

    /// Adds a file, an image that names it, and, if so wished, a texture.
    fn image(&mut self, uri: &str, bytes: &[u8], texture: Option<fn(usize) -> Value>) {
        self.put(&format!("in/{uri}"), bytes);
        let images = self.root["images"].as_array_mut().unwrap();
        images.push(json!({"uri": uri}));
        let number = images.len() - 1;
        if let Some(texture) = texture {
            let textures = self.root["textures"].as_array_mut().unwrap();
            textures.push(texture(number));
        }
    }

    fn write(&self) -> Result<Written, GltfError> {
        self.put("in/tree.gltf", self.root.to_string().as_bytes());
        let leaves = [Selector::Material("leaf".to_owned())];
        let tree = Document::open(&self.path("in/tree.gltf"))?.into_tree(&leaves)?;
        tree.write_lod(&one_gone_one_grown(&tree), &self.path("out/lod.glb"))
    }

    /// Everything below `out`, sorted.
    fn out(&self) -> Vec<String> {
        let mut names = Vec::new();
        add_files(&self.path("out"), "", &mut names);
        names.sort();
        names
    }
}

fn add_files(folder: &Path, prefix: &str, names: &mut Vec<String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let name = format!("{prefix}{}", entry.file_name().to_str().unwrap());
        if entry.file_type().unwrap().is_dir() {
            add_files(&entry.path(), &format!("{name}/"), names);
        } else {
            names.push(name);
        }
    }
}

#[track_caller]
fn assert_note(written: &Written, parts: &[&str]) {
    let says = |note: &&String| parts.iter().all(|part| note.contains(part));
    let count = written.notes.iter().filter(says).count();
    assert_eq!(count, 1, "{parts:?} in {:?}", written.notes);
}

fn source(image: usize) -> Value {
    json!({ "source": image })
}

#[test]
fn what_a_texture_needs_goes_along() {
    let mut case = Case::new();
    let png = encodings::one_texel_png();
    case.image("./maps/bark.PNG", &png, Some(source));
    case.image("photo.jpg", b"\xff\xd8\xff\xe0 and so on", Some(source));
    case.image(
        "a.webp",
        WEBP,
        Some(|image| json!({"source": 0, "extensions": {"EXT_texture_webp": {"source": image}}})),
    );
    case.image(
        "a.ktx2",
        KTX2,
        Some(|image| json!({"extensions": {"KHR_texture_basisu": {"source": image}}})),
    );
    let written = case.write().unwrap();
    let names = ["a.ktx2", "a.webp", "leaf.png", "maps/bark.PNG", "photo.jpg"];
    for name in names {
        assert_note(&written, &[&format!("`{name}` was copied to"), "out"]);
        let [from, to] = ["in", "out"].map(|folder| case.path(folder).join(name));
        assert_eq!(fs::read(from).unwrap(), fs::read(to).unwrap());
    }
    assert_eq!(written.files.len(), 1 + names.len());

    // The second time all is there; only the tree is written.
    let written = case.write().unwrap();
    assert_eq!(written.files.len(), 1);
    assert_note(&written, &["`leaf.png`", "not copied: it is there already"]);
}

#[test]
fn what_no_texture_needs_stays() {
    let mut case = Case::new();
    case.image("other.png", &encodings::one_texel_png(), None);
    case.image(".cargo/config.toml", b"[build]", None);
    let written = case.write().unwrap();
    assert_eq!(case.out(), ["leaf.png", "lod.glb"]);
    for name in ["other.png", ".cargo/config.toml"] {
        let name = format!("`{name}`");
        assert_note(&written, &[&name, "was not copied: no texture uses it"]);
    }
    // The JSON stays as it was.
    let after = Document::open(&case.path("out/lod.glb")).unwrap();
    assert_eq!(after.root["images"], case.root["images"]);
}

#[test]
fn what_is_hidden_or_no_image_stays() {
    let png = encodings::one_texel_png();
    let script = b"RIFF=1; WEBP=2\nprint()";
    for (uri, bytes, why) in [
        (".envrc", &png[..], "begins with a dot"),
        (".git/hooks/x.png", &png, "begins with a dot"),
        ("maps/.cargo/x.png", &png, "begins with a dot"),
        ("maps/..png", &png, "begins with a dot"),
        ("Makefile", &png, "does not end in .png"),
        ("conftest.py", script, "does not end in .png"),
        ("a.png", b"all: evil", "does not begin as a PNG"),
        ("b.png", b"", "does not begin as a PNG"),
        ("b.webp", b"RIFF\x10\0\0\0WAVE", "does not begin as a PNG"),
    ] {
        let mut case = Case::new();
        case.image(uri, bytes, Some(source));
        let written = case.write().unwrap();
        assert_eq!(case.out(), ["leaf.png", "lod.glb"], "{uri}");
        assert_note(&written, &[&format!("`{uri}` was not copied: "), why]);
    }
    // The dot may be written as an escape.
    let mut case = Case::new();
    case.image(".envrc.png", &png, None);
    case.root["images"][1]["uri"] = json!("%2eenvrc.png");
    case.root["textures"][0]["source"] = json!(1);
    let written = case.write().unwrap();
    assert_note(&written, &["`.envrc.png`", "begins with a dot"]);
}

#[test]
fn an_image_that_is_not_there_is_noted() {
    let mut case = Case::new();
    case.root["images"] = json!([{"uri": "gone.png"}]);
    let written = case.write().unwrap();
    assert_note(&written, &["`gone.png` was not copied: it is not there"]);
    case.root["images"] = json!([{"uri": "folder.png"}]);
    fs::create_dir(case.path("in/folder.png")).unwrap();
    let written = case.write().unwrap();
    assert_note(&written, &["`folder.png` was not copied: it is not there"]);
}

#[test]
fn a_folder_in_the_place_of_an_image_is_in_the_way() {
    let case = Case::new();
    fs::create_dir(case.path("out/leaf.png")).unwrap();
    let error = case.write().unwrap_err();
    assert!(
        matches!(error.problem(), Problem::Write(WriteProblem::Occupied(_))),
        "{error}"
    );
    assert_eq!(case.out(), [] as [&str; 0]);
}

#[cfg(unix)]
#[test]
fn nothing_is_written_through_links() {
    use std::os::unix::fs::symlink;

    let png = encodings::one_texel_png();
    let mut case = Case::new();
    case.image("maps/bark.png", &png, Some(source));
    fs::create_dir(case.path("elsewhere")).unwrap();
    symlink(case.path("elsewhere"), case.path("out/maps")).unwrap();
    // One that leads nowhere yet: a copy would make the file.
    symlink(case.path("elsewhere/new.png"), case.path("out/leaf.png")).unwrap();
    let written = case.write().unwrap();
    assert_note(
        &written,
        &["`maps/bark.png` was not copied", "symbolic link"],
    );
    assert_note(&written, &["`leaf.png` was not copied", "symbolic link"]);
    assert_eq!(fs::read_dir(case.path("elsewhere")).unwrap().count(), 0);
    assert!(
        fs::symlink_metadata(case.path("out/leaf.png"))
            .unwrap()
            .is_symlink()
    );
    assert_eq!(written.files, [case.path("out/lod.glb")]);

    // The folder of the output itself may be one: it was asked for.
    let case = Case::new();
    fs::remove_dir(case.path("out")).unwrap();
    fs::create_dir(case.path("real")).unwrap();
    symlink(case.path("real"), case.path("out")).unwrap();
    case.write().unwrap();
    assert_eq!(case.out(), ["leaf.png", "lod.glb"]);
}
