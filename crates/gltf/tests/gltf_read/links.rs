//! Links in the folder of a glTF: followed where they stay in it.

#![cfg(unix)]

use std::fs;
use std::os::unix::fs::symlink;
use std::path::PathBuf;

use secateur_gltf::{Document, GltfError, Tree};
use serde_json::json;

use crate::small_tree::SmallTree;

/// `tree/small.gltf` with its buffer and its image, to be moved about.
struct CopiedTree {
    folder: tempfile::TempDir,
}

impl CopiedTree {
    fn new() -> Self {
        let mut tree = SmallTree::squares();
        tree.append("images", json!({"uri": "maps/leaf.png"}));
        tree.append("textures", json!({"source": 0}));
        let tree = tree.set("/buffers", json!([{"uri": "small.bin", "byteLength": 120}]));
        assert_eq!(tree.bytes.len(), 120);
        let place = Self {
            folder: tempfile::tempdir().unwrap(),
        };
        fs::create_dir_all(place.path("tree/maps")).unwrap();
        fs::create_dir(place.path("outside")).unwrap();
        fs::write(place.path("tree/small.gltf"), tree.root.to_string()).unwrap();
        fs::write(place.path("tree/small.bin"), &tree.bytes).unwrap();
        let png = image::RgbaImage::new(1, 1);
        png.save(place.path("tree/maps/leaf.png")).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Moves a file or folder and leaves a link to it.
    fn replace_by_link(&self, from: &str, to: &str) {
        fs::rename(self.path(from), self.path(to)).unwrap();
        symlink(self.path(to), self.path(from)).unwrap();
    }

    fn open(&self, name: &str) -> Result<Tree, GltfError> {
        Document::open(&self.path(name))?.into_tree(&["material:leaf".parse().unwrap()])
    }

    #[track_caller]
    fn assert_leads_out(&self, at: &str, uri: &str) {
        let path = self.path("tree/small.gltf");
        assert_eq!(
            self.open("tree/small.gltf").unwrap_err().to_string(),
            format!(
                "{}: {at}: the file `{uri}` is reached through a symbolic link that leads out of \
                 the glTF's own folder; put the file itself there in place of the link",
                path.display()
            )
        );
    }
}

#[test]
fn a_buffer_outside() {
    let place = CopiedTree::new();
    place.open("tree/small.gltf").unwrap();
    place.replace_by_link("tree/small.bin", "outside/small.bin");
    place.assert_leads_out("buffers[0]", "small.bin");
}

#[test]
fn an_image_outside() {
    let place = CopiedTree::new();
    place.replace_by_link("tree/maps/leaf.png", "outside/leaf.png");
    place.assert_leads_out("images[0]", "maps/leaf.png");
}

#[test]
fn a_linked_folder() {
    let place = CopiedTree::new();
    place.replace_by_link("tree/maps", "outside/maps");
    place.assert_leads_out("images[0]", "maps/leaf.png");
}

#[test]
fn a_folder_of_which_ours_is_the_beginning_is_outside() {
    let place = CopiedTree::new();
    fs::create_dir(place.path("tree-2")).unwrap();
    place.replace_by_link("tree/small.bin", "tree-2/small.bin");
    place.assert_leads_out("buffers[0]", "small.bin");
}

#[test]
fn something_outside_that_is_no_file() {
    // A device must not be opened: it could give bytes without end.
    let place = CopiedTree::new();
    fs::remove_file(place.path("tree/small.bin")).unwrap();
    symlink("/dev/zero", place.path("tree/small.bin")).unwrap();
    place.assert_leads_out("buffers[0]", "small.bin");
}

#[test]
fn links_that_stay_in_the_folder_are_followed() {
    let place = CopiedTree::new();
    place.replace_by_link("tree/small.bin", "tree/maps/small.bin");
    place.replace_by_link("tree/maps", "tree/textures");
    place.open("tree/small.gltf").unwrap();
}

#[test]
fn a_link_to_the_gltf_itself_is_followed() {
    // The user named it; what belongs to the file is where the file is.
    let place = CopiedTree::new();
    symlink(place.path("tree/small.gltf"), place.path("outside/a.gltf")).unwrap();
    place.open("outside/a.gltf").unwrap();
    // So is one on the way to it.
    symlink(place.path("tree"), place.path("link")).unwrap();
    place.open("link/small.gltf").unwrap();
}
