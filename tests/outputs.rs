//! Where outputs may go: what cannot be written, or would take the place of something else, is
//! said in one sentence before the work, and nothing is left of a run that is stopped.

use crate::bad_input::{refused, refused_with};
use crate::program::{Bench, Ran};

#[test]
fn outputs_that_cannot_be_written() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("folder.glb")).unwrap();
    // The input is broken: outputs are looked at before the work.
    bench.put("broken.glb", b"");
    for (more, sentence) in [
        (
            &["-o", "gone/out.glb"][..],
            "its folder `gone` does not exist",
        ),
        (&["-o", "out.obj"], "its name must end in .glb or .gltf"),
        (&["-o", "broken.glb"], "broken.glb: is the input"),
        (&["-o", "folder.glb"], "it is a folder"),
        (
            &["-o", "o.glb", "--report", "gone/r.json"],
            "its folder `gone` does not exist",
        ),
        (&["-o", "o.glb", "--report", "./broken.glb"], "is the input"),
        (
            &["-o", "o.glb", "--report", "o.glb"],
            "two outputs are this file",
        ),
        (
            &["-o", "o.glb", "--picture", "o.jpg"],
            "its name must end in .png",
        ),
        (
            &["-o", "o.glb", "--debug-images", "broken.glb/x"],
            "`broken.glb` is no folder",
        ),
    ] {
        let arguments = [&["broken.glb", "--leaves", "1"], more].concat();
        refused(&bench, || bench.simplify(&arguments), &[sentence]);
    }
    if cfg!(target_os = "linux") {
        // Not even root can make files there.
        let arguments = ["broken.glb", "--leaves", "1", "-o", "/proc/out.glb"];
        let run = || bench.simplify(&arguments);
        refused(&bench, run, &["/proc/out.glb: cannot be written"]);
    }
}

#[cfg(unix)]
#[test]
fn a_full_disk_leaves_nothing_behind() {
    use std::process::Command;
    let bench = Bench::new();
    // A limit on the size of files stands for a disk without room. No audit: software
    // GPU drivers put their memory into files.
    let script = "trap '' XFSZ; ulimit -f 8; exec \"$0\" \"$@\"";
    let arguments = [
        "simplify",
        "oak.glb",
        "-o",
        "out.glb",
        "--leaves",
        "200",
        "--views",
        "6",
        "--resolution",
        "32",
        "--no-audit",
        "--report",
        "r.json",
    ];
    let run = || {
        let mut command = Command::new("sh");
        command.args(["-c", script, env!("CARGO_BIN_EXE_secateur")]);
        command.args(arguments).current_dir(bench.path("."));
        Ran::of(&arguments, command.output().unwrap())
    };
    refused_with(4, &bench, run, &["out.glb: cannot be written: "]);
}

#[cfg(unix)]
#[test]
fn signals_stop_and_leave_nothing() {
    for signal in ["-INT", "-TERM", "-HUP"] {
        stops_at(signal);
    }
}

#[cfg(unix)]
fn stops_at(signal: &str) {
    use std::io::{BufRead, BufReader, Read};
    use std::process::{Command, Stdio};
    let bench = Bench::new();
    // A run of minutes.
    let mut child = Command::new(env!("CARGO_BIN_EXE_secateur"))
        .args([
            "simplify", "oak.glb", "-o", "out.glb", "--leaves", "1", "-v",
        ])
        .args([
            "--method",
            "vds-reference",
            "--resolution",
            "256",
            "--report",
            "r.json",
        ])
        .current_dir(bench.path("."))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    // From here on it listens.
    stderr.read_line(&mut line).unwrap();
    assert_eq!(line, "secateur: reading oak.glb\n");
    let pid = child.id().to_string();
    assert!(
        Command::new("kill")
            .args([signal, &pid])
            .status()
            .unwrap()
            .success()
    );
    let mut rest = String::new();
    stderr.read_to_string(&mut rest).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let last = "secateur: error: stopped; nothing was written\n";
    assert!(rest.ends_with(last), "{rest}");
    assert_eq!(bench.names(), ["oak.glb"]);
}

#[test]
fn outputs_do_not_overwrite_each_other() {
    let bench = Bench::new();
    for (out, report) in [("o.glb", "./o.glb"), ("o.gltf", "o.bin")] {
        let arguments = ["oak.glb", "-o", out, "--leaves", "9", "--report", report];
        let says = "two outputs are this file";
        refused(&bench, || bench.simplify(&arguments), &[says]);
    }
}

#[cfg(unix)]
#[test]
fn only_files_are_replaced_and_links_and_permissions_stay() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let bench = Bench::new();
    let few = ["oak.glb", "-o", "out.glb", "--leaves", "9", "--report"];
    let device = [&few[..], &["/dev/null"]].concat();
    bench
        .simplify(&device)
        .failed_saying(&["it is a device, a pipe or a socket"]);
    symlink("nowhere.json", bench.path("dangling.json")).unwrap();
    let dangling = [&few[..], &["dangling.json"]].concat();
    bench
        .simplify(&dangling)
        .failed_saying(&["link to a file that does not exist"]);

    bench.put("real.json", b"{}");
    let private = std::fs::Permissions::from_mode(0o600);
    std::fs::set_permissions(bench.path("real.json"), private).unwrap();
    symlink("real.json", bench.path("link.json")).unwrap();
    bench
        .simplify(&[&few[..], &["link.json"]].concat())
        .succeeded();
    assert!(bench.path("link.json").is_symlink());
    assert!(bench.json("real.json")["leaves"]["final"] == 9);
    let mode = std::fs::metadata(bench.path("real.json"))
        .unwrap()
        .permissions()
        .mode();
    assert_eq!(mode & 0o777, 0o600);
}

/// A .gltf with its buffer beside it: no output takes the place of that buffer.
#[test]
fn outputs_spare_what_the_input_names() {
    let bench = Bench::new();
    let few = ["--leaves", "200"];
    let gltf = [&["oak.glb", "-o", "tree.gltf"][..], &few].concat();
    bench.simplify(&gltf).succeeded();
    let before = bench.read("tree.bin");
    for arguments in [
        &[
            "simplify",
            "tree.gltf",
            "-o",
            "o.glb",
            "--leaves",
            "9",
            "--report",
            "./tree.bin",
        ][..],
        &["inspect", "tree.gltf", "--report", "tree.bin"],
        &["measure", "oak.glb", "tree.gltf", "--report", "tree.bin"],
    ] {
        let says = "it is a buffer or an image of the input";
        bench.run(arguments).failed_saying(&["tree.bin", says]);
    }
    assert_eq!(bench.read("tree.bin"), before);
}
