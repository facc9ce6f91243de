//! `secateur stream`: a plant that is drawn while it arrives, as a program and as a page.

use image::RgbaImage;
use secateur::Document;
use serde_json::Value;

use crate::program::{Bench, shared_tree};
use crate::tab::{DESKTOP, Tab};

#[test]
fn every_prefix_of_a_stream_is_a_plant_and_all_of_it_the_tree() {
    let bench = Bench::new();
    let write = [
        "stream",
        "oak.glb",
        "-o",
        "oak.stream",
        "--report",
        "w.json",
    ];
    let ran = bench
        .run(&[&write[..], &["--leaves", "12"]].concat())
        .succeeded();
    assert!(
        ran.stdout
            .contains("every prefix from the first one on is a plant")
    );
    let record = bench.json("w.json");
    let pieces = record["pieces"].as_array().unwrap();
    assert!(pieces.len() > 5, "{record}");
    assert_eq!(pieces[0]["leaves"], 12);
    let read = |bytes: &str| {
        let read = [
            "stream",
            "--read",
            "oak.stream",
            "-o",
            "level.glb",
            "--report",
            "r.json",
        ];
        bench
            .run(&[&read[..], &["--bytes", bytes]].concat())
            .succeeded();
        bench
            .run(&["inspect", "level.glb", "--report", "i.json"])
            .succeeded();
        (bench.json("r.json"), bench.json("i.json"))
    };
    for piece in [&pieces[0], &pieces[3], &pieces[pieces.len() - 1]] {
        // Some bytes more change nothing.
        let bytes = piece["bytes"].as_u64().unwrap() + 5;
        let (record, inspected) = read(&bytes.to_string());
        assert_eq!(record["leaves"]["final"], piece["leaves"]);
        assert_eq!(record["triangles"]["final"], piece["triangles"]);
        let drawn = inspected["primitives"].as_array().unwrap().iter();
        let drawn: u64 = drawn.map(|p| p["triangles"].as_u64().unwrap()).sum();
        assert_eq!(drawn, piece["triangles"].as_u64().unwrap(), "{inspected}");
    }
    assert_eq!(bench.json("r.json")["is_whole"], true);
    assert_eq!(soup(&bench.read("level.glb")), soup(&bench.read("oak.glb")));
}

/// Positions and texture coordinates of all triangles, bit for bit, in an order of their own.
fn soup(glb: &[u8]) -> Vec<Vec<u32>> {
    let document = Document::from_bytes("tree.glb", glb.to_vec(), None).unwrap();
    let mut soup = Vec::new();
    for (surface, is_foliage) in document.surfaces(&[]).unwrap() {
        for triangle in &surface.triangles {
            let corner = |corner: &u32| {
                let position = surface.positions[*corner as usize].as_vec3();
                let uv = surface.uvs[*corner as usize];
                [&position.to_array()[..], &uv.to_array()].concat()
            };
            let corners = triangle.iter().flat_map(corner).map(f32::to_bits);
            soup.push([u32::from(is_foliage)].into_iter().chain(corners).collect());
        }
    }
    soup.sort_unstable();
    soup
}

#[test]
fn a_stream_follows_the_order_it_is_given_or_the_branches() {
    let bench = Bench::new();
    bench
        .simplify(&[
            "oak.glb",
            "-o",
            "out.glb",
            "--leaves",
            "24",
            "--order",
            "oak.order",
        ])
        .succeeded();
    let with = |more: &[&str]| {
        let write = [
            "stream",
            "oak.glb",
            "-o",
            "oak.stream",
            "--report",
            "w.json",
        ];
        bench.run(&[&write[..], more].concat()).succeeded();
        let read = [
            "stream",
            "--read",
            "oak.stream",
            "-o",
            "level.glb",
            "--bytes",
        ];
        let first = bench.json("w.json")["pieces"][0]["bytes"].to_string();
        bench.run(&[&read[..], &[&first]].concat()).succeeded();
        bench.json("w.json")
    };
    let ordered = with(&["--order", "oak.order"]);
    assert_eq!(ordered["leaves"]["first"], 24);
    let chained = with(&["--chain", "--leaves", "24"]);
    assert_eq!(chained["leaves"]["first"], 24);
    assert_ne!(chained["order_sha256"], ordered["order_sha256"]);
}

#[test]
fn what_is_no_stream_or_no_whole_piece_of_one_is_refused() {
    let bench = Bench::new();
    bench
        .run(&[
            "stream",
            "oak.glb",
            "-o",
            "oak.stream",
            "--chain",
            "--leaves",
            "20",
        ])
        .succeeded();
    let read = |name: &str, more: &[&str], parts: &[&str]| {
        let read = ["stream", "--read", name, "-o", "level.glb"];
        bench.run(&[&read[..], more].concat()).failed_saying(parts);
        assert!(!bench.names().contains(&"level.glb".to_owned()));
    };
    read("oak.glb", &[], &["oak.glb", "this is no stream of a plant"]);
    read(
        "oak.stream",
        &["--bytes", "500"],
        &["cut short within its first piece", "500 bytes"],
    );
    read(
        "oak.stream",
        &["--bytes", "0"],
        &["cut short within its first piece", "0 bytes"],
    );
    read("none.stream", &[], &["none.stream: cannot be read"]);
    let mut later = bench.read("oak.stream");
    later[16] = 3;
    bench.put("later.stream", &later);
    read(
        "later.stream",
        &[],
        &["of version 3; this program reads version 2"],
    );
    // The removal order of another tree.
    let other = ["grow", "birch", "-o", "birch.glb", "--leaves", "200"];
    bench.run(&other).succeeded();
    bench
        .simplify(&[
            "birch.glb",
            "-o",
            "b.glb",
            "--ratio",
            "0.5",
            "--order",
            "b.order",
        ])
        .succeeded();
    let wrong = ["stream", "oak.glb", "-o", "x.stream", "--order", "b.order"];
    bench
        .run(&wrong)
        .failed_saying(&["b.order: the removal order is of another tree"]);
    assert!(!bench.names().contains(&"x.stream".to_owned()));
    for (arguments, parts) in [
        (
            &["--read", "--ratio", "0.5"][..],
            &["--read", "--ratio"][..],
        ),
        (&["--bytes", "5"], &["--read"]),
        (
            &["--order", "b.order", "--leaves", "5"],
            &["--order", "--leaves"],
        ),
    ] {
        let all = [&["stream", "oak.glb", "-o", "x.stream"], arguments].concat();
        bench.run(&all).misused_saying(parts);
    }
}

/// Of all pixels, those that differ.
fn differing(a: &RgbaImage, b: &RgbaImage) -> f64 {
    assert_eq!(a.dimensions(), b.dimensions());
    let pairs = a.pixels().zip(b.pixels());
    let other = pairs.filter(|(a, b)| a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > 8));
    other.count() as f64 / (f64::from(a.width()) * f64::from(a.height()))
}

/// The picture of the first `bytes` bytes.
fn shown(tab: &mut Tab, bytes: &Value) -> RgbaImage {
    tab.ask(&format!(
        "streaming.showBytes({bytes}).then(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(0)))))"
    ));
    let picture = tab.picture();
    tab.part(&picture, "#canvas")
}

#[test]
fn a_page_draws_what_has_arrived() {
    let bench = Bench::new();
    let write = [
        "stream",
        "oak.glb",
        "-o",
        "oak.stream",
        "--preview",
        "oak.html",
        "--leaves",
        "12",
    ];
    bench.run(&write).succeeded();
    let Some(mut tab) = Tab::open(DESKTOP) else {
        return;
    };
    tab.visit(&bench.path("oak.html"));
    assert_eq!(tab.ask("streaming.state.source"), "in this page");
    assert_eq!(tab.ask("streaming.reader().isWhole"), true);
    tab.ask("(streaming.state.isReceiving = false, 0)");
    let bytes = tab.ask("streaming.facts.pieces.map((piece) => piece.bytes)");
    let bytes = bytes.as_array().unwrap().clone();
    let last = bytes.len() - 1;
    let empty = {
        tab.click("#leaves");
        tab.click("#wood");
        shown(&mut tab, &bytes[last])
    };
    tab.click("#leaves");
    tab.click("#wood");
    let pictures = [0, last / 2, last].map(|k| shown(&mut tab, &bytes[k]));
    let drawn = pictures
        .each_ref()
        .map(|picture| differing(picture, &empty));
    assert!(drawn[0] > 0.03 && drawn[2] < 0.9, "{drawn:?}");
    // Ever nearer to the original.
    let [coarse, middle] = [0, 1].map(|k| differing(&pictures[k], &pictures[2]));
    assert!(coarse > middle && middle > 0.0, "{coarse} {middle}");
    // Within a piece it is the plant of the one before.
    let between = bytes[last / 2].as_u64().unwrap() + 7;
    let cut = shown(&mut tab, &between.into());
    assert_eq!(differing(&cut, &pictures[1]), 0.0);
    let text = tab.ask("document.body.innerText");
    assert!(text.as_str().unwrap().contains("leaves"), "{text}");
    // What has arrived sways, once it is asked to.
    assert_eq!(tab.ask("streaming.state.isWindy"), false);
    let still = shown(&mut tab, &bytes[0]);
    tab.ask("(streaming.state.windSeconds = 3.3, 0)");
    tab.click("#wind");
    let swaying = shown(&mut tab, &bytes[0]);
    assert!(differing(&swaying, &still) > 0.01);
    tab.click("#wind");
    assert_eq!(differing(&shown(&mut tab, &bytes[0]), &still), 0.0);
    // Before the first piece there is no plant, and that is no error.
    shown(&mut tab, &Value::from(100));
    assert_eq!(tab.ask("streaming.reader().pieces"), 0);
    assert_eq!(tab.complaints(), [""; 0], "nothing reaches the console");
    for (role, name) in tab.controls() {
        assert!(!name.is_empty(), "a {role} has a name");
    }
}

/// From a server the page takes the file beside it, as the network brings it.
#[test]
fn a_page_takes_the_file_beside_it() {
    let bench = Bench::new();
    let write = [
        "stream",
        "oak.glb",
        "-o",
        "oak.stream",
        "--preview",
        "oak.html",
        "--chain",
    ];
    bench.run(&write).succeeded();
    let Some(mut tab) = Tab::open(DESKTOP) else {
        return;
    };
    let server = Server::start(bench.read("oak.html"), bench.read("oak.stream"));
    tab.visit_address(&server.address);
    assert_eq!(tab.ask("streaming.state.source"), "oak.stream");
    assert_eq!(tab.ask("streaming.reader().isWhole"), true);
    assert_eq!(tab.complaints(), [""; 0], "nothing reaches the console");
}

/// A server of two files, each connection one answer.
struct Server {
    address: String,
}

impl Server {
    fn start(page: Vec<u8>, stream: Vec<u8>) -> Self {
        use std::io::{BufRead as _, BufReader, Write as _};
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let address = format!("http://{}/oak.html", listener.local_addr().unwrap());
        std::thread::spawn(move || {
            for connection in listener.incoming() {
                let mut connection = connection.unwrap();
                let mut lines = BufReader::new(connection.try_clone().unwrap()).lines();
                let Some(Ok(first)) = lines.next() else {
                    continue;
                };
                while lines
                    .next()
                    .is_some_and(|line| line.is_ok_and(|l| !l.is_empty()))
                {}
                let (kind, body) = match first.contains("oak.stream") {
                    true => ("application/octet-stream", &stream),
                    false => ("text/html", &page),
                };
                let head = format!(
                    "HTTP/1.1 200 OK\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n",
                    body.len()
                );
                let _ = connection.write_all(head.as_bytes());
                // In pieces, as a network does.
                for chunk in body.chunks(5000) {
                    let _ = connection.write_all(chunk);
                    let _ = connection.flush();
                }
            }
        });
        Self { address }
    }
}

#[test]
fn real_trees_stream() {
    let Some(tree) = shared_tree("quat_commontree_1.glb") else {
        return;
    };
    let bench = Bench::new();
    let original = std::fs::read(&tree).unwrap();
    bench.put("tree.glb", &original);
    let order = [
        "tree.glb",
        "-o",
        "out.glb",
        "--method",
        "stochastic",
        "--ratio",
        "0.1",
    ];
    bench
        .simplify(&[&order[..], &["--order", "tree.order"]].concat())
        .succeeded();
    bench
        .run(&[
            "stream",
            "tree.glb",
            "-o",
            "t.stream",
            "--order",
            "tree.order",
        ])
        .succeeded();
    bench
        .run(&["stream", "--read", "t.stream", "-o", "all.glb"])
        .succeeded();
    assert_eq!(soup(&bench.read("all.glb")), soup(&original));
}
