//! Whatever the text, rules end in a plant or in an error.

#![no_main]

use libfuzzer_sys::fuzz_target;
use secateur_plant::{Random, Rules, draw};

fuzz_target!(|text: &str| {
    let limited = format!("modules = 2000;\n{text}");
    let Ok(rules) = Rules::parse(&limited) else {
        let _ = Rules::parse(text);
        return;
    };
    if let Ok(word) = rules.derive(1.0, &mut Random::new(0)) {
        let _ = draw(&rules, &word);
    }
});
