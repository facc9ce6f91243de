//! Opens a page in a real browser without a window: Chromium, from the system's
//! packages.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

/// What a page said at one width.
#[derive(Debug)]
pub(crate) struct Visit {
    /// Of the window, in CSS pixels.
    pub(crate) width_px: u64,
    /// What `probe.js` found on the page, as it returned it.
    pub(crate) found: Value,
}

/// Opens the page once for each width, lets `probe.js` use it and tells what it
/// found; and everything that reached the browser's console.
///
/// Nothing where there is no browser, unless the environment has
/// `SECATEUR_REQUIRE_BROWSER=1`: then it panics.
pub(crate) fn visit(page: &Path, widths_px: &[u64]) -> Option<(Vec<Visit>, Vec<String>)> {
    let browser = find()?;
    let folder = tempfile::tempdir().unwrap();
    let html = std::fs::read_to_string(page).unwrap();
    let probe = format!("<script>\n{}</script>\n", include_str!("probe.js"));
    let probed = html.replacen("<head>", &format!("<head>{probe}"), 1);
    assert_ne!(probed, html, "the page has a head");
    std::fs::write(folder.path().join("page.html"), probed).unwrap();
    // A browser's window is never narrower than 500 pixels; a frame is.
    let frames: String = widths_px
        .iter()
        .map(|w| format!("<iframe name=\"{w}\" src=\"page.html\" style=\"width:{w}px;height:900px;border:0\"></iframe>\n"))
        .collect();
    let harness = folder.path().join("harness.html");
    let collect = "<pre></pre><script>addEventListener('message', (e) => { document.querySelector('pre').textContent += e.data + '\\n'; });</script>";
    std::fs::write(
        &harness,
        format!("<!DOCTYPE html><meta charset=\"utf-8\">{collect}{frames}"),
    )
    .unwrap();

    let output = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-dev-shm-usage",
        ])
        .args([
            "--no-first-run",
            "--disable-extensions",
            "--disable-background-networking",
        ])
        .args([
            "--enable-logging=stderr",
            "--virtual-time-budget=20000",
            "--dump-dom",
        ])
        .arg("--window-size=1600,1000")
        .arg(format!(
            "--user-data-dir={}",
            folder.path().join("profile").display()
        ))
        .arg(format!(
            "file://{}",
            harness.canonicalize().unwrap().display()
        ))
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let dom = String::from_utf8_lossy(&output.stdout);
    let log = String::from_utf8_lossy(&output.stderr);
    let start = dom.find("<pre>").map(|at| at + 5);
    let end = dom.find("</pre>");
    let (Some(start), Some(end)) = (start, end) else {
        panic!("the browser gave no page: {dom}\n{log}");
    };
    let text = dom[start..end]
        .replace("&lt;", "<")
        .replace("&gt;", ">")
        .replace("&amp;", "&");
    let visits: Vec<Visit> = text
        .lines()
        .map(|line| {
            let found: Value = serde_json::from_str(line).unwrap();
            let width_px = found["width"].as_u64().unwrap();
            Visit { width_px, found }
        })
        .collect();
    assert_eq!(
        visits.len(),
        widths_px.len(),
        "an answer from every frame: {text}\n{log}"
    );
    let console = log.lines().filter(|line| line.contains("CONSOLE"));
    Some((visits, console.map(str::to_owned).collect()))
}

/// The browser, or nothing where there is none, unless the environment has
/// `SECATEUR_REQUIRE_BROWSER=1`: then it panics.
pub(crate) fn find() -> Option<PathBuf> {
    let found = installed();
    if found.is_none() {
        let is_required = std::env::var("SECATEUR_REQUIRE_BROWSER").is_ok_and(|v| v == "1");
        assert!(!is_required, "there is no Chromium");
        eprintln!("SKIPPED: there is no Chromium; bash tests/run.sh installs it");
    }
    found
}

fn installed() -> Option<PathBuf> {
    let own = std::env::var_os("SECATEUR_BROWSER").map(PathBuf::from);
    let names = [
        "chromium",
        "chromium-browser",
        "google-chrome",
        "google-chrome-stable",
    ];
    own.into_iter()
        .chain(names.map(PathBuf::from))
        .find(|name| {
            let version = Command::new(name)
                .arg("--version")
                .stdin(Stdio::null())
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .status();
            version.is_ok_and(|status| status.success())
        })
}
