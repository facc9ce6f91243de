//! A chart of lines over a logarithmic distance, as SVG.

use std::fmt::Write as _;

use crate::chart::escaped;

/// A line: what it is called, and its points from left to right.
pub(crate) struct Line {
    pub(crate) name: String,
    pub(crate) points: Vec<(f64, f64)>,
}

const SIZE: [f64; 2] = [720.0, 400.0];
/// Room to the left of, right of, above and below the frame.
const ROOM: [f64; 4] = [80.0, 210.0, 44.0, 52.0];
/// Okabe and Ito's colours, which colour-blind readers can tell apart.
const COLORS: [&str; 5] = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00"];

/// The chart, from zero upwards. A line without points is left out.
pub(crate) fn line_chart(title: &str, across: &str, upward: &str, lines: &[Line]) -> String {
    let lines = || lines.iter().filter(|line| !line.points.is_empty());
    let [title, across, upward] = [title, across, upward].map(escaped);
    let points = || lines().flat_map(|line| &line.points);
    let xs = || points().map(|point| point.0.log2());
    let (left, right) = (xs().fold(f64::MAX, f64::min), xs().fold(f64::MIN, f64::max));
    let top = points()
        .map(|point| point.1)
        .fold(f64::MIN_POSITIVE, f64::max);
    let [width, height] = [SIZE[0] - ROOM[0] - ROOM[1], SIZE[1] - ROOM[2] - ROOM[3]];
    let x = |value: f64| ROOM[0] + width * (value.log2() - left) / (right - left).max(1e-9);
    let y = |value: f64| ROOM[2] + height * (1.0 - value / top);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" font-size=\"12\" role=\"img\">\n<title>{title}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n<text x=\"{}\" y=\"24\" font-size=\"15\" font-weight=\"bold\">{title}</text>\n",
        SIZE[0], SIZE[1], ROOM[0]
    );
    for k in 0..=4 {
        let value = top * f64::from(k) / 4.0;
        let text = if top < 2.0 {
            format!("{value:.3}")
        } else {
            format!("{value:.0}")
        };
        let at = y(value);
        let _ = writeln!(
            svg,
            "<line x1=\"{:.1}\" x2=\"{:.1}\" y1=\"{at:.1}\" y2=\"{at:.1}\" stroke=\"#ddd\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>",
            ROOM[0],
            ROOM[0] + width,
            ROOM[0] - 6.0,
            at + 4.0
        );
    }
    let mut marks: Vec<f64> = points().map(|point| point.0).collect();
    marks.sort_by(f64::total_cmp);
    marks.dedup();
    for mark in marks {
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{mark:.0}</text>",
            x(mark),
            ROOM[2] + height + 18.0
        );
    }
    let _ = writeln!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{across}</text>\n<text transform=\"translate(18 {:.1}) rotate(-90)\" text-anchor=\"middle\">{upward}</text>",
        ROOM[0] + 0.5 * width,
        SIZE[1] - 10.0,
        ROOM[2] + 0.5 * height
    );
    for (number, line) in lines().enumerate() {
        let color = COLORS[number % COLORS.len()];
        let places: Vec<String> = line
            .points
            .iter()
            .map(|(a, b)| format!("{:.1},{:.1}", x(*a), y(*b)))
            .collect();
        let at = ROOM[2] + 14.0 + 18.0 * number as f64;
        let legend = SIZE[0] - ROOM[1] + 16.0;
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"/><line x1=\"{legend:.1}\" x2=\"{:.1}\" y1=\"{at:.1}\" y2=\"{at:.1}\" stroke=\"{color}\" stroke-width=\"2\"/><text x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            places.join(" "),
            legend + 18.0,
            legend + 24.0,
            at + 4.0,
            escaped(&line.name)
        );
    }
    svg + "</svg>\n"
}
