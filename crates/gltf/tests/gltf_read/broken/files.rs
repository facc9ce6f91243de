//! Containers, buffers and URIs.

use super::*;

#[test]
fn files_that_are_no_gltf() {
    assert_eq!(refused(b""), "small.glb: is not glTF: it is empty");
    assert_eq!(
        refused(b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 7\n"),
        "small.glb: is not glTF: it is a pointer of Git LFS, not the file itself: `git lfs pull` fetches that"
    );
    assert!(
        refused(b"\x89PNG\r\n").starts_with("small.glb: is not glTF: its JSON cannot be parsed")
    );
    assert_eq!(
        refused(b"{}"),
        "small.glb: is not glTF: its JSON has no `asset`"
    );
    assert_eq!(
        refused(b"[1]"),
        "small.glb: is not glTF: its JSON has no `asset`"
    );
    let deep = "[".repeat(100_000);
    assert!(refused(deep.as_bytes()).contains("recursion limit"));
    let huge = br#"{"asset": {"version": "2.0"}, "scene": 1e999}"#;
    assert!(refused(huge).contains("number out of range"));
}

#[test]
fn damaged_containers() {
    let glb = SmallTree::squares().glb();
    let total = glb.len();
    assert_eq!(
        refused(&glb[..total - 1]),
        format!(
            "small.glb: is truncated: its header speaks of {total} bytes, it has {}",
            total - 1
        )
    );
    assert_eq!(
        refused(&glb[..7]),
        "small.glb: is truncated: its header speaks of 12 bytes, it has 7"
    );
    let with_word = |at: usize, word: u32| {
        let mut glb = glb.clone();
        glb[at..at + 4].copy_from_slice(&word.to_le_bytes());
        refused(&glb)
    };
    assert_eq!(
        with_word(4, 1),
        "small.glb: is glTF 1; only version 2.0 can be read"
    );
    assert_eq!(
        with_word(8, 3),
        "small.glb: is a damaged GLB: its header gives a length of 3 bytes"
    );
    assert!(with_word(12, u32::MAX).starts_with("small.glb: is a damaged GLB: "));
    assert!(with_word(16, 0).starts_with("small.glb: is a damaged GLB: "));
}

#[test]
fn versions_and_extensions() {
    assert_error(
        &with("/asset/version", json!("1.0")),
        "is glTF 1.0; only version 2.0 can be read",
    );
    assert_error(
        &with("/asset/minVersion", json!("2.1")),
        "is glTF 2.1; only version 2.0 can be read",
    );
    assert_error(
        &with("/asset/version", json!(2)),
        "`version` is 2, not a string",
    );
    assert_error(
        &with(
            "/extensionsRequired",
            json!(["KHR_materials_unlit", "ACME_leaves"]),
        ),
        "needs the extension ACME_leaves, which is not supported",
    );
}

#[test]
fn buffers_that_are_not_there() {
    let buffer = |json: Value| with("/buffers", json!([json]));
    assert_error(
        &buffer(json!({"byteLength": 9, "uri": "leaves.bin"})),
        "buffers[0]: the file `leaves.bin` cannot be read: the glTF itself is in no folder",
    );
    assert_error(
        &buffer(json!({"byteLength": 4096})),
        "buffers[0]: says it has 4096 bytes; only 120 are there",
    );
    assert_error(&buffer(json!({})), "buffers[0]: has no `byteLength`");
    assert_error(
        &with(
            "/buffers",
            json!([{"byteLength": 120}, {"byteLength": 200}]),
        )
        .set("/bufferViews/0/buffer", json!(1)),
        "bufferViews[0]: has neither a URI nor a GLB chunk to take its bytes from",
    );
    assert_error(
        &with("/bufferViews/0/buffer", json!(7)),
        "bufferViews[0]: `buffers[7]` does not exist: there are 1",
    );
}

#[test]
fn uris_that_leave_the_folder() {
    for uri in [
        "../leaves.bin",
        "a/../../leaves.bin",
        "%2e%2e/leaves.bin",
        "..%5cleaves.bin",
        "a\\..\\..\\leaves.bin",
        "/etc/passwd",
        "%2Fetc/passwd",
        "\\\\server\\leaves.bin",
        "file:///etc/passwd",
        "FILE:leaves.bin",
        "https://example.com/leaves.bin",
        "C:/leaves.bin",
        "c%3A/leaves.bin",
    ] {
        let tree = with("/buffers", json!([{"byteLength": 120, "uri": uri}]));
        assert_error(
            &tree,
            &format!(
                "buffers[0]: the URI `{uri}` is not a file in the glTF's own folder; put the \
                 file there and name it without a path outside"
            ),
        );
    }
}

#[test]
fn uris_that_are_none() {
    for (uri, why) in [
        (
            "leaves%2",
            "a `%` is not followed by two hexadecimal digits",
        ),
        (
            "%zzleaves",
            "a `%` is not followed by two hexadecimal digits",
        ),
        ("%ff%fe", "it is not UTF-8"),
        ("a%00b", "it has a control character"),
        ("", "it is empty"),
        (
            "data:application/octet-stream;base64",
            "a data URI has a comma before its data",
        ),
    ] {
        let tree = with("/buffers", json!([{"byteLength": 120, "uri": uri}]));
        assert_error(
            &tree,
            &format!("buffers[0]: the URI `{uri}` is malformed: {why}"),
        );
    }
    let bad = with(
        "/buffers",
        json!([{"byteLength": 120, "uri": "data:;base64,A*B="}]),
    );
    assert!(bad.error().contains("its base64 is damaged"));
}
