//! A page that shows a stream as it arrives.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::Stream;
use crate::preview::{escaped, filled, vertex_shader};

const TEMPLATE: &str = include_str!("page/page.html");

/// In the order in which they build on each other.
const SCRIPTS: [&str; 9] = [
    include_str!("../preview/page/matrices.js"),
    include_str!("../preview/page/unpack.js"),
    include_str!("../preview/page/continuous.js"),
    include_str!("../preview/page/wind.js"),
    include_str!("../preview/page/renderer.js"),
    include_str!("../preview/page/orbit.js"),
    include_str!("../preview/page/levels.js"),
    include_str!("page/reader.js"),
    include_str!("page/page.js"),
];

/// The page of a stream, as HTML; `beside` is the name of a file with the same stream in the page's
/// own folder. From a server the page asks for that file and draws what arrives of it. Opened as a
/// file, where browsers do not let a page read others, it takes the stream that is in it, a chunk of
/// 64 KiB after the other.
pub fn stream_page(title: &str, stream: &Stream, beside: Option<&str>) -> String {
    filled(TEMPLATE, |mark| match mark {
        "title" => escaped(title),
        "style" => include_str!("../preview/page/page.css").to_owned(),
        "vertex shader" => vertex_shader(),
        "fragment shader" => include_str!("../preview/page/tree.frag").to_owned(),
        "facts" => facts(stream, beside),
        "stream" => STANDARD.encode(&stream.bytes),
        "script" => SCRIPTS.concat(),
        _ => unreachable!("the template has no other mark than these: {mark}"),
    })
}

fn facts(stream: &Stream, beside: Option<&str>) -> String {
    let facts = serde_json::json!({
        "bytes": stream.bytes.len(),
        "beside": beside,
        "pieces": stream.pieces,
    });
    // Within a script element only this sign could end it.
    facts.to_string().replace('<', "\\u003c")
}
