//! The chart of time against one metric, as SVG.

use std::fmt::Write as _;

use super::{Column, Point, pareto};
use secateur_eval::measure::Direction;

const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 440.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 200.0;
const TOP: f64 = 44.0;
const BOTTOM: f64 = 56.0;
const LEGEND_LINE: f64 = 16.0;
/// The longest line of the legend, in characters: what fits to the right of the frame.
const LEGEND_CHARACTERS: usize = 27;

/// Okabe and Ito's colours, which colour-blind readers can tell apart; marks
/// differ in shape too.
const COLORS: [&str; 7] = [
    "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000",
];

/// A chart of one metric at one level: time across (logarithmic), the metric
/// upwards, a mark for each point, the Pareto frontier joined by a line.
/// A metric that is best near 1 is drawn as its distance from 1. A line leads from each mark to
/// the mean of the worst sets of views. Points that are not finite are left out.
pub fn chart(points: &[Point], column: &Column, title: &str) -> String {
    let height_of = |value: f64| match column.direction {
        Direction::NearerToOne => (value - 1.0).abs(),
        _ => value,
    };
    let heights = |p: &Point| {
        let worst = Some(height_of(p.mean_of_worst)).filter(|height| height.is_finite());
        [Some(height_of(p.mean)), worst].into_iter().flatten()
    };
    let drawn: Vec<&Point> = points.iter().filter(|p| p.mean.is_finite()).collect();
    let (x, y) = (
        LogAxis::of(drawn.iter().map(|p| p.seconds)),
        Axis::of(drawn.iter().flat_map(|p| heights(p))),
    );
    let place = |p: &Point| (x.px(p.seconds), y.px(height_of(p.mean)));
    let lines: usize = drawn.iter().map(|p| wrapped(&p.shown()).len()).sum();
    let height = HEIGHT.max(TOP + 14.0 + LEGEND_LINE * lines as f64);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" font-family=\"sans-serif\" font-size=\"12\" role=\"img\">\n<title>{0}</title>\n<rect width=\"{WIDTH}\" height=\"{height}\" fill=\"#fff\"/>\n<text x=\"{LEFT}\" y=\"24\" font-size=\"15\" font-weight=\"bold\">{0}</text>\n",
        escaped(title)
    );
    x.draw(&mut svg);
    y.draw(&mut svg);
    let what = match (column.direction, column.unit) {
        (Direction::NearerToOne, _) => format!("{}: distance from 1", column.title),
        (_, "") => format!("{} ({})", column.title, column.better()),
        (_, unit) => format!("{} in {unit} ({})", column.title, column.better()),
    };
    let _ = writeln!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">time of the method in seconds</text>\n<text transform=\"translate(18 {:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        0.5 * (LEFT + WIDTH - RIGHT),
        HEIGHT - 14.0,
        0.5 * (TOP + HEIGHT - BOTTOM),
        escaped(&what)
    );
    let frontier: Vec<String> = pareto(points, column)
        .into_iter()
        .map(|p| format!("{:.1},{:.1}", place(p).0, place(p).1))
        .collect();
    let _ = writeln!(
        svg,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"#777\" stroke-width=\"1.5\" stroke-dasharray=\"5 3\"/>",
        frontier.join(" ")
    );
    let mut legend_lines = 0;
    for (number, point) in drawn.iter().enumerate() {
        let (at_x, at_y) = place(point);
        let _ = writeln!(
            svg,
            "<g><title>{}: {:.4}, worst set of views {:.4}, after {:.3} s</title>{}{}</g>",
            escaped(&point.shown()),
            point.mean,
            point.mean_of_worst,
            point.seconds,
            whisker(number, at_x, at_y, y.px(height_of(point.mean_of_worst))),
            mark(number, at_x, at_y)
        );
        let legend_y = TOP + 14.0 + LEGEND_LINE * legend_lines as f64;
        let lines = wrapped(&point.shown());
        let _ = writeln!(
            svg,
            "{}",
            mark(number, WIDTH - RIGHT + 20.0, legend_y - 4.0)
        );
        for (line, k) in lines.iter().zip(0..) {
            let _ = writeln!(
                svg,
                "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"11\">{}</text>",
                WIDTH - RIGHT + 34.0,
                legend_y + LEGEND_LINE * f64::from(k),
                escaped(line)
            );
        }
        legend_lines += lines.len();
    }
    svg + "</svg>\n"
}

/// From a mark to its worst.
fn whisker(number: usize, x: f64, from: f64, to: f64) -> String {
    if !to.is_finite() || (from - to).abs() < 0.1 {
        return String::new();
    }
    let color = COLORS[number % 7];
    format!("<path d=\"M{x:.1} {from:.1}V{to:.1}\" stroke=\"{color}\" opacity=\"0.5\"/>")
}

/// A name in lines that fit, broken between words.
fn wrapped(label: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in label.split(' ') {
        let last = lines.len() - 1;
        let line = &mut lines[last];
        if line.is_empty() || line.len() + 1 + word.len() <= LEGEND_CHARACTERS {
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}

/// One of 7 shapes in one of 7 colours, every pair once before any comes again;
/// hollow in every other round of colours.
fn mark(number: usize, x: f64, y: f64) -> String {
    let (color, round) = (COLORS[number % 7], number / 7);
    let fill = if round.is_multiple_of(2) {
        color
    } else {
        "#fff"
    };
    let style = format!("fill=\"{fill}\" stroke=\"{color}\" stroke-width=\"2\"");
    let polygon = |corners: &[(f64, f64)]| {
        let points: Vec<String> = corners
            .iter()
            .map(|(dx, dy)| format!("{:.1},{:.1}", x + dx, y + dy))
            .collect();
        format!("<polygon points=\"{}\" {style}/>", points.join(" "))
    };
    match (number + 3 * round) % 7 {
        0 => format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5\" {style}/>"),
        1 => polygon(&[(-5.0, -5.0), (5.0, -5.0), (5.0, 5.0), (-5.0, 5.0)]),
        2 => polygon(&[(0.0, -6.0), (6.0, 5.0), (-6.0, 5.0)]),
        3 => polygon(&[(0.0, -7.0), (7.0, 0.0), (0.0, 7.0), (-7.0, 0.0)]),
        4 => polygon(&[(0.0, 6.0), (6.0, -5.0), (-6.0, -5.0)]),
        5 => format!(
            "<path d=\"M{:.1} {y:.1}h12M{x:.1} {:.1}v12\" {style}/>",
            x - 6.0,
            y - 6.0
        ),
        _ => format!(
            "<path d=\"M{:.1} {:.1}l10 10m0 -10l-10 10\" {style}/>",
            x - 5.0,
            y - 5.0
        ),
    }
}

/// The vertical axis. It begins at 0, or a little below the least value where 0 is far.
struct Axis {
    low: f64,
    high: f64,
    step: f64,
}

impl Axis {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = range(values);
        let low = if low > 0.0 && low < 0.6 * high {
            0.0
        } else {
            low
        };
        let spread = if high > low {
            high - low
        } else {
            high.abs().max(1.0)
        };
        let step = round_step(spread / 5.0);
        let low = (low / step).floor() * step;
        let high = ((high / step).ceil() * step).max(low + step);
        Self { low, high, step }
    }

    fn px(&self, value: f64) -> f64 {
        let bottom = HEIGHT - BOTTOM;
        bottom - (value - self.low) / (self.high - self.low) * (bottom - TOP)
    }

    fn draw(&self, svg: &mut String) {
        let count = ((self.high - self.low) / self.step).round() as usize;
        let decimals = (-self.step.log10().floor()).max(0.0) as usize;
        for k in 0..=count {
            let value = self.low + k as f64 * self.step;
            let y = self.px(value);
            let _ = writeln!(
                svg,
                "<path d=\"M{LEFT} {y:.1}H{:.1}\" stroke=\"#ddd\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{value:.decimals$}</text>",
                WIDTH - RIGHT,
                LEFT - 8.0,
                y + 4.0
            );
        }
    }
}

/// The horizontal axis, between two powers of ten.
struct LogAxis {
    low: i32,
    high: i32,
}

impl LogAxis {
    fn of(seconds: impl Iterator<Item = f64>) -> Self {
        let (low, high) = range(seconds.map(|s| s.max(1e-6).log10()));
        let low = low.floor() as i32;
        Self {
            low,
            high: (high.ceil() as i32).max(low + 1),
        }
    }

    fn px(&self, seconds: f64) -> f64 {
        let part =
            (seconds.max(1e-6).log10() - f64::from(self.low)) / f64::from(self.high - self.low);
        LEFT + part * (WIDTH - RIGHT - LEFT)
    }

    fn draw(&self, svg: &mut String) {
        for power in self.low..=self.high {
            let seconds = 10f64.powi(power);
            let x = self.px(seconds);
            let decimals = (-power).max(0) as usize;
            let _ = writeln!(
                svg,
                "<path d=\"M{x:.1} {TOP}V{:.1}\" stroke=\"#ddd\"/><text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{seconds:.decimals$}</text>",
                HEIGHT - BOTTOM,
                HEIGHT - BOTTOM + 18.0
            );
        }
    }
}

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| {
        (lo.min(v), hi.max(v))
    });
    if low <= high { (low, high) } else { (0.0, 1.0) }
}

/// The least step not below `least` that is 1, 2 or 5 times a power of ten.
fn round_step(least: f64) -> f64 {
    let power = 10f64.powf(least.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|s| s * power);
    steps
        .into_iter()
        .find(|s| *s >= least * (1.0 - 1e-9))
        .unwrap_or(steps[3])
}

/// A text with the characters escaped that XML gives a meaning.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::super::{COLUMNS, Row, summarise};
    use super::*;
    use crate::rows::tests::row;

    #[test]
    fn steps_are_1_2_or_5() {
        let found = [0.3, 1.0, 1.1, 4.0, 7.0].map(round_step);
        for (found, expected) in found.into_iter().zip([0.5, 1.0, 2.0, 5.0, 10.0]) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    #[test]
    fn every_point_has_a_mark_within_the_frame_and_a_name() {
        let rows: Vec<Row> = (0..9)
            .map(|k| row(&format!("m<{k}>"), 0.5, 10f64.powi(k - 4), f64::from(k)))
            .collect();
        let rows: Vec<&Row> = rows.iter().collect();
        let svg = chart(&summarise(&rows, &COLUMNS[0]), &COLUMNS[0], "a & b");
        assert_eq!(svg.matches("<g><title>").count(), 9);
        assert!(svg.contains("m&lt;8&gt;") && svg.contains("a &amp; b"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    /// By shape and colour, not by what is hollow: crosses are not.
    #[test]
    fn forty_nine_points_can_be_told_apart() {
        let mut marks: Vec<String> = (0..49)
            .map(|number| mark(number, 0.0, 0.0).replace("fill=\"#fff\" ", ""))
            .map(|mark| mark.replace("fill=\"#", "\""))
            .collect();
        marks.sort();
        marks.dedup();
        assert_eq!(marks.len(), 49);
    }

    #[test]
    fn no_points_and_endless_ones_still_make_a_chart() {
        let endless = row("a", 0.5, 1.0, f64::INFINITY);
        for points in [vec![], summarise(&[&endless], &COLUMNS[0])] {
            let svg = chart(&points, &COLUMNS[0], "t");
            assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN"));
        }
    }
}
