//! A tab of a browser without a window, driven from outside as a person would:
//! by mouse, fingers and keys. Speaks the DevTools protocol through pipes.

use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use image::RgbaImage;
use serde_json::{Value, json};

use crate::browser::find;

/// The longest that anything may take: the machine may be busy with other tests.
const PATIENCE: Duration = Duration::from_secs(120);

/// The screen that a tab is on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Device {
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// Pixels of the screen for each of the page's.
    pub(crate) ratio: u32,
    pub(crate) has_touch: bool,
}

pub(crate) const DESKTOP: Device = Device {
    width: 1440,
    height: 900,
    ratio: 1,
    has_touch: false,
};

pub(crate) const PHONE: Device = Device {
    width: 390,
    height: 844,
    ratio: 2,
    has_touch: true,
};

pub(crate) struct Tab {
    browser: Child,
    commands: File,
    answers: Receiver<Value>,
    session: Option<String>,
    last_id: u64,
    /// What happened without being asked for.
    events: Vec<Value>,
    device: Device,
    _folder: tempfile::TempDir,
}

impl Drop for Tab {
    fn drop(&mut self) {
        let _ = self.browser.kill();
        let _ = self.browser.wait();
    }
}

impl Tab {
    /// Nothing where there is no browser, unless the environment has
    /// `SECATEUR_REQUIRE_BROWSER=1`: then it panics.
    pub(crate) fn open(device: Device) -> Option<Self> {
        let browser = find()?;
        let folder = tempfile::tempdir().unwrap();
        let [commands, answers] = ["commands", "answers"].map(|name| folder.path().join(name));
        let made = Command::new("mkfifo").args([&commands, &answers]).status();
        assert!(made.unwrap().success());
        // Both ways, since a pipe opened one way waits for its other end.
        let open = |path| OpenOptions::new().read(true).write(true).open(path);
        let from_browser = open(&answers).unwrap();
        let to_browser = open(&commands).unwrap();
        let browser = Command::new("sh")
            .args(["-c", "exec \"$0\" \"$@\" 3<\"$COMMANDS\" 4>\"$ANSWERS\""])
            .arg(browser)
            .args(["--headless", "--no-sandbox", "--disable-dev-shm-usage"])
            .args(["--remote-debugging-pipe", "--no-first-run"])
            .args(["--disable-extensions", "--disable-background-networking"])
            // Draws on the CPU, wherever the tests run.
            .args(["--use-angle=swiftshader", "--enable-unsafe-swiftshader"])
            // For the modules of three.js.
            .arg("--allow-file-access-from-files")
            .arg(format!(
                "--user-data-dir={}",
                folder.path().join("profile").display()
            ))
            .env("COMMANDS", &commands)
            .env("ANSWERS", &answers)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let (sender, answers) = channel();
        std::thread::spawn(move || {
            for message in BufReader::new(from_browser).split(0) {
                let Ok(message) = message else { return };
                let message = serde_json::from_slice(&message).unwrap();
                if sender.send(message).is_err() {
                    return;
                }
            }
        });
        let mut tab = Self {
            browser,
            commands: to_browser,
            answers,
            session: None,
            last_id: 0,
            events: Vec::new(),
            device,
            _folder: folder,
        };
        tab.set_up();
        Some(tab)
    }

    fn set_up(&mut self) {
        let target = self.call("Target.createTarget", json!({"url": "about:blank"}));
        let attached = self.call(
            "Target.attachToTarget",
            json!({"targetId": target["targetId"], "flatten": true}),
        );
        self.session = Some(attached["sessionId"].as_str().unwrap().to_owned());
        for domain in ["Page", "Runtime", "Log", "Network", "Accessibility"] {
            self.call(&format!("{domain}.enable"), json!({}));
        }
        let device = self.device;
        let screen = json!({
            "width": device.width, "height": device.height,
            "deviceScaleFactor": device.ratio, "mobile": device.has_touch,
        });
        self.call("Emulation.setDeviceMetricsOverride", screen);
        if device.has_touch {
            let touch = json!({"enabled": true, "maxTouchPoints": 2});
            self.call("Emulation.setTouchEmulationEnabled", touch);
        }
    }

    fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.last_id += 1;
        let mut command = json!({"id": self.last_id, "method": method, "params": parameters});
        if let Some(session) = &self.session {
            command["sessionId"] = json!(session);
        }
        let mut bytes = serde_json::to_vec(&command).unwrap();
        bytes.push(0);
        self.commands.write_all(&bytes).unwrap();
        loop {
            let message = self.answers.recv_timeout(PATIENCE).expect(method);
            if message["id"] == json!(self.last_id) {
                assert!(message.get("error").is_none(), "{method}: {message}");
                return message["result"].clone();
            }
            self.events.push(message);
        }
    }

    /// What an expression (or what it promises) is in the page.
    #[track_caller]
    pub(crate) fn ask(&mut self, expression: &str) -> Value {
        let question =
            json!({"expression": expression, "awaitPromise": true, "returnByValue": true});
        let answer = self.call("Runtime.evaluate", question);
        let problem = answer.get("exceptionDetails");
        assert!(problem.is_none(), "{expression:.200}: {problem:?}");
        answer["result"]["value"].clone()
    }

    /// Opens a page and waits until it says that it is ready.
    pub(crate) fn visit(&mut self, page: &Path) {
        self.visit_address(&format!(
            "file://{}",
            page.canonicalize().unwrap().display()
        ));
    }

    /// Opens a page of a server.
    pub(crate) fn visit_address(&mut self, address: &str) {
        self.call("Page.navigate", json!({"url": address}));
        let start = Instant::now();
        while self.ask("document.documentElement?.dataset.ready ?? null") == Value::Null {
            let text = "document.body?.innerText";
            assert!(
                start.elapsed() < PATIENCE,
                "{address} does not get ready: {} {:?}",
                self.ask(text),
                self.complaints()
            );
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// The window as it is seen, once what was asked for is drawn.
    pub(crate) fn picture(&mut self) -> RgbaImage {
        self.ask("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))");
        let shot = self.call("Page.captureScreenshot", json!({"format": "png"}));
        decoded(shot["data"].as_str().unwrap())
    }

    /// The part of a picture of the window that an element covers.
    pub(crate) fn part(&mut self, picture: &RgbaImage, selector: &str) -> RgbaImage {
        // Without the rim, which pixels of neighbours may share.
        const RIM: f64 = 3.0;
        let [x, y, width, height] = self.place(selector);
        let inner = [x + RIM, y + RIM, width - 2.0 * RIM, height - 2.0 * RIM];
        let [x, y, width, height] =
            inner.map(|v| (v * f64::from(self.device.ratio)).round() as u32);
        let width = width.min(picture.width().saturating_sub(x));
        let height = height.min(picture.height().saturating_sub(y));
        assert!(width > 8 && height > 8, "{selector} is in the window");
        image::imageops::crop_imm(picture, x, y, width, height).to_image()
    }

    fn place(&mut self, selector: &str) -> [f64; 4] {
        let rect = self.ask(&format!(
            "(() => {{ const r = document.querySelector('{selector}').getBoundingClientRect(); return [r.x, r.y, r.width, r.height]; }})()"
        ));
        [0, 1, 2, 3].map(|k| rect[k].as_f64().unwrap())
    }

    fn middle(&mut self, selector: &str) -> [f64; 2] {
        self.ask(&format!(
            "document.querySelector('{selector}').scrollIntoView({{ block: 'nearest' }})"
        ));
        let [x, y, width, height] = self.place(selector);
        [x + width / 2.0, y + height / 2.0]
    }

    /// Clicks, or taps where there is a touch screen, and waits until the page has heard of it:
    /// a browser tells of a tap some time after the finger has left.
    ///
    /// A busy machine may lift the finger so late that the browser takes the tap for a long press,
    /// of which a page hears no click. Then it is tapped again.
    pub(crate) fn click(&mut self, selector: &str) {
        let at = self.middle(selector);
        self.click_at(at);
    }

    /// As [`click`](Self::click), at a place of the window.
    pub(crate) fn click_at(&mut self, at: [f64; 2]) {
        const MOST_TAPS: usize = 5;
        let heard = "Promise.race([clicked, new Promise((done) => setTimeout(done, 4000, false))])";
        for _ in 0..MOST_TAPS {
            self.ask("void (window.clicked = new Promise((done) => addEventListener('click', () => done(true), { once: true, capture: true })))");
            self.drag(at, [0.0, 0.0]);
            if self.ask(heard) == json!(true) {
                return;
            }
        }
        panic!("nothing is clicked at {at:?}");
    }

    /// Drags from the middle of an element.
    pub(crate) fn drag_from(&mut self, selector: &str, by: [f64; 2]) {
        let at = self.middle(selector);
        self.drag(at, by);
    }

    fn drag(&mut self, [x, y]: [f64; 2], by: [f64; 2]) {
        const STEPS: u32 = 4;
        let is_drag = by != [0.0, 0.0];
        let steps = if is_drag { STEPS } else { 0 };
        let at = |step: u32| {
            let share = f64::from(step) / f64::from(STEPS);
            [x + share * by[0], y + share * by[1]]
        };
        self.drag_along(&(0..=steps).map(at).collect::<Vec<_>>());
    }

    /// Drags through these places of the window.
    pub(crate) fn drag_along(&mut self, places: &[[f64; 2]]) {
        let [first, rest @ ..] = places else {
            return;
        };
        if self.device.has_touch {
            self.touch("touchStart", &[*first]);
            for place in rest {
                self.touch("touchMove", &[*place]);
            }
            self.touch("touchEnd", &[]);
            return;
        }
        let pressed = json!({"button": "left", "buttons": 1, "clickCount": 1});
        self.mouse("mousePressed", (*first).into(), pressed);
        for place in rest {
            let moved = json!({"button": "left", "buttons": 1});
            self.mouse("mouseMoved", (*place).into(), moved);
        }
        let last = places.last().unwrap_or(first);
        let released = json!({"button": "left", "clickCount": 1});
        self.mouse("mouseReleased", (*last).into(), released);
    }

    fn mouse(&mut self, kind: &str, (x, y): (f64, f64), mut more: Value) {
        more["type"] = json!(kind);
        more["x"] = json!(x);
        more["y"] = json!(y);
        self.call("Input.dispatchMouseEvent", more);
    }

    fn touch(&mut self, kind: &str, fingers: &[[f64; 2]]) {
        let fingers = fingers.iter().enumerate();
        let points: Vec<Value> = fingers
            .map(|(id, [x, y])| json!({"x": x, "y": y, "id": id}))
            .collect();
        self.call(
            "Input.dispatchTouchEvent",
            json!({"type": kind, "touchPoints": points}),
        );
    }

    /// Turns the wheel, or spreads two fingers, over the middle of an element so
    /// as to come nearer.
    pub(crate) fn zoom_in(&mut self, selector: &str) {
        let [x, y] = self.middle(selector);
        if !self.device.has_touch {
            self.mouse("mouseWheel", (x, y), json!({"deltaX": 0, "deltaY": -300}));
            return;
        }
        let fingers = |apart: f64| [[x - apart, y], [x + apart, y]];
        self.touch("touchStart", &fingers(20.0));
        for apart in [25.0, 30.0, 35.0, 40.0] {
            self.touch("touchMove", &fingers(apart));
        }
        self.touch("touchEnd", &[]);
    }

    /// Chooses files in an input element.
    pub(crate) fn choose_files(&mut self, selector: &str, files: &[PathBuf]) {
        let document = self.call("DOM.getDocument", json!({}));
        let root = &document["root"]["nodeId"];
        let question = json!({"nodeId": root, "selector": selector});
        let input = self.call("DOM.querySelector", question);
        let chosen = json!({"nodeId": input["nodeId"], "files": files});
        self.call("DOM.setFileInputFiles", chosen);
    }

    /// Presses Control and a letter, wherever the keyboard is.
    pub(crate) fn press_with_control(&mut self, letter: &str) {
        const CONTROL: u32 = 2;
        for kind in ["rawKeyDown", "keyUp"] {
            let stroke = json!({"type": kind, "key": letter, "modifiers": CONTROL});
            self.call("Input.dispatchKeyEvent", stroke);
        }
    }

    /// Presses a key in the element (`ArrowLeft`, `a`).
    pub(crate) fn press(&mut self, selector: &str, key: &str) {
        self.ask(&format!("document.querySelector('{selector}').focus()"));
        let code = match key {
            "Enter" => 13,
            "End" => 35,
            "Home" => 36,
            "ArrowLeft" => 37,
            "ArrowUp" => 38,
            "ArrowRight" => 39,
            "ArrowDown" => 40,
            _ => 0,
        };
        let mut stroke = json!({"type": "keyDown", "key": key, "windowsVirtualKeyCode": code});
        if key.chars().count() == 1 {
            stroke["text"] = json!(key);
        } else if key == "Enter" {
            stroke["text"] = json!("\r");
        }
        self.call("Input.dispatchKeyEvent", stroke);
        self.call(
            "Input.dispatchKeyEvent",
            json!({"type": "keyUp", "key": key, "windowsVirtualKeyCode": code}),
        );
    }

    /// Names of all that can be operated, as a screen reader says them, by role.
    pub(crate) fn controls(&mut self) -> Vec<(String, String)> {
        let tree = self.call("Accessibility.getFullAXTree", json!({}));
        let text = |node: &Value, key: &str| node[key]["value"].as_str().unwrap_or("").to_owned();
        let nodes = tree["nodes"].as_array().unwrap().iter();
        nodes
            .map(|node| (text(node, "role"), text(node, "name")))
            .filter(|(role, _)| ["button", "slider", "application"].contains(&role.as_str()))
            .collect()
    }

    /// Errors and whatever else reached the console.
    pub(crate) fn complaints(&self) -> Vec<String> {
        let is_complaint = |event: &&Value| {
            let method = event["method"].as_str().unwrap_or("");
            [
                "Runtime.exceptionThrown",
                "Runtime.consoleAPICalled",
                "Log.entryAdded",
            ]
            .contains(&method)
        };
        let complaints = self.events.iter().filter(is_complaint);
        complaints
            .map(|event| event["params"].to_string())
            .collect()
    }

    /// Addresses that were asked for, but for what the page itself holds.
    pub(crate) fn asked_for(&self) -> Vec<String> {
        let requests = self.events.iter();
        requests
            .filter(|event| event["method"] == "Network.requestWillBeSent")
            .filter_map(|event| event["params"]["request"]["url"].as_str())
            .filter(|url| !url.starts_with("data:") && !url.starts_with("blob:"))
            .map(str::to_owned)
            .collect()
    }
}

/// A picture from base64, with or without the head of a data address.
pub(crate) fn decoded(base64: &str) -> RgbaImage {
    let base64 = base64.rsplit(',').next().unwrap();
    let bytes = STANDARD.decode(base64).unwrap();
    image::load_from_memory(&bytes).unwrap().into_rgba8()
}
