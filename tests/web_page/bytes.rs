//! The bytes that the page hands out are those of the program.

use std::iter;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use secateur_plant::{GrowOptions, Species, grow};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use super::opened;
use crate::program::Bench;
use crate::tab::{DESKTOP, Tab};

const PLANTS: [(Species, u32); 5] = [
    (Species::Birch, 40),
    (Species::Bush, 30),
    (Species::Carya, 12),
    (Species::Palmetto, 60),
    (Species::Rowan, 12),
];

/// What is decided in the page, and the words after `secateur simplify|lods plant.glb -o OUTPUT`.
fn settings([of_share, of_count]: [&str; 2]) -> [(Value, Vec<&str>); 3] {
    [
        (
            json!({"kind": "level", "level": {"amount": "share", "value": 0.3}, "effort": of_share}),
            vec!["simplify", "--triangles", "0.3", "--effort", of_share],
        ),
        (
            json!({"kind": "level", "level": {"amount": "triangles", "value": 1500}, "effort": of_count}),
            vec!["simplify", "--triangles", "1500", "--effort", of_count],
        ),
        (
            json!({"kind": "chain", "levels": "shares", "shares": [0.3, 0.1], "effort": "fast"}),
            vec!["lods", "--levels", "0.3,0.1", "--effort", "fast"],
        ),
    ]
}

/// The SHA-256 of each file that the page hands out.
pub(super) fn of_page(tab: &mut Tab, decided: &Value) -> Vec<String> {
    let question = format!(
        "(async () => {{
            page.decisions.decide({decided});
            await page.make();
            const hex = async (bytes) => [...new Uint8Array(await crypto.subtle.digest('SHA-256', bytes))].map((b) => b.toString(16).padStart(2, '0')).join('');
            const result = page.state.results.get(page.decisions.key);
            if (!result) return [document.querySelector('#error').innerText];
            if (result.kind === 'level') return [await hex(await page.take({{ what: 'level' }}))];
            const files = [];
            for (const k of result.levels.keys()) files.push(await hex(await page.take({{ what: 'file', layout: 'files', number: k }})));
            return files;
        }})()"
    );
    let answer = tab.ask(&question);
    let all = answer.as_array().unwrap().iter();
    all.map(|text| text.as_str().unwrap().to_owned()).collect()
}

/// The SHA-256 of each file that the program writes.
pub(super) fn of_program(bench: &Bench, words: &[&str]) -> Vec<String> {
    let [command, options @ ..] = words else {
        panic!("a command");
    };
    let hex = |bytes: Vec<u8>| {
        let digest = Sha256::digest(bytes);
        digest.iter().map(|byte| format!("{byte:02x}")).collect()
    };
    let output = if *command == "lods" {
        "levels"
    } else {
        "out.glb"
    };
    let call = [
        &[*command, "plant.glb", "-o", output, "--engine", "cpu"],
        options,
    ]
    .concat();
    bench.run(&call).succeeded();
    if *command == "simplify" {
        return vec![hex(bench.read("out.glb"))];
    }
    let names = (0..).map(|k| format!("levels/plant_LOD{k}.glb"));
    let files = names.take_while(|name| bench.path(name).is_file());
    files.map(|name| hex(bench.read(&name))).collect()
}

#[test]
fn the_bytes_of_the_page_are_those_of_the_program() {
    let Some(mut tab) = opened(DESKTOP) else {
        return;
    };
    let mut equal = 0;
    // What is not fast takes a browser long: each effort is of one plant.
    let efforts = [["fast", "best"], ["normal", "fast"]].into_iter();
    let efforts = efforts.chain(iter::repeat(["fast", "fast"]));
    for ((species, leaves), effort) in PLANTS.into_iter().zip(efforts) {
        let plant = grow(species, &GrowOptions { leaves, seed: 7 }).unwrap();
        let glb = secateur::plant_into_glb(plant);
        let text = STANDARD.encode(&glb);
        tab.ask(&format!(
            "page.open({{ files: [new File([Uint8Array.from(atob('{text}'), (c) => c.charCodeAt(0))], 'plant.glb')] }})"
        ));
        for (decided, words) in settings(effort) {
            let bench = Bench::new();
            bench.put("plant.glb", &glb);
            let page = of_page(&mut tab, &decided);
            assert_eq!(
                page,
                of_program(&bench, &words),
                "{} {words:?}",
                species.name()
            );
            equal += 1;
        }
        // Grown in the page it is the same plant, too.
        let name = species.name();
        let grown = tab.ask(&format!(
            "(async () => {{ await page.open({{ grown: {{ species: '{name}', leaves: {leaves}, seed: 7 }} }}); page.decisions.decide({{ kind: 'level', level: {{ amount: 'share', value: 0.3 }} }}); await page.make(); const bytes = await page.take({{ what: 'level' }}); return bytes.length; }})()"
        ));
        assert!(grown.as_u64().unwrap() > 1000, "{name}: {grown}");
    }
    eprintln!("equal to the program's: {equal} files or chains");
}
