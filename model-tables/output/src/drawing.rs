//! Charts as SVG: panels with logarithmic axes, lines, markers, labels.

use std::fmt::Write as _;

// Colours that the colour-blind tell apart (Okabe and Ito 2008).
/// Blue.
pub const BLUE: &str = "#0072b2";
/// Vermilion.
pub const VERMILION: &str = "#d55e00";
/// Green.
pub const GREEN: &str = "#009e73";
/// Purple.
pub const PURPLE: &str = "#aa4499";
/// Orange.
pub const ORANGE: &str = "#e69f00";
/// For words and axes.
pub const BLACK: &str = "#222222";
/// For what stands back.
pub const GREY: &str = "#8a8a8a";
const GRID: &str = "#e4e4e4";

/// The shape of a marker.
#[derive(Clone, Copy, Debug)]
pub enum Marker {
    /// A circle.
    Circle,
    /// A square.
    Square,
    /// A square on its corner.
    Diamond,
    /// A triangle that points up.
    Triangle,
    /// A triangle that points down.
    Wedge,
    /// Two crossed lines.
    Cross,
}

/// Where a text stands relative to its point.
#[derive(Clone, Copy, Debug)]
pub enum Anchor {
    /// The text begins there.
    Start,
    /// Its middle is there.
    Middle,
    /// It ends there.
    End,
}

/// An SVG in the making.
#[derive(Debug)]
pub struct Drawing {
    text: String,
}

impl Drawing {
    /// An empty white drawing.
    pub fn new(width: f64, height: f64) -> Self {
        Self {
            text: format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
                 viewBox=\"0 0 {width} {height}\" font-family=\"Helvetica, Arial, sans-serif\">\n\
                 <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n"
            ),
        }
    }

    /// A drawing that stands in a page: as wide as its place, on the page's ground and in its type, with words for those who do
    /// not see it.
    pub fn inline([width, height]: [f64; 2], title: &str, description: &str) -> Self {
        Self {
            text: format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" role=\"img\">\n\
                 <title>{}</title>\n<desc>{}</desc>\n",
                escape(title),
                escape(description)
            ),
        }
    }

    /// The file.
    pub fn finish(self) -> String {
        self.text + "</svg>\n"
    }

    fn push(&mut self, element: &str) {
        self.text.push_str(element);
        self.text.push('\n');
    }

    /// A straight line.
    pub fn line(&mut self, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], color: &str, width: f64) {
        self.push(&format!(
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{color}\" \
             stroke-width=\"{width}\"/>"
        ));
    }

    /// A line through points.
    pub fn path(&mut self, points: &[[f64; 2]], color: &str, width: f64) {
        let mut list = String::new();
        for [x, y] in points {
            let _ = write!(list, "{x:.1},{y:.1} ");
        }
        self.push(&format!(
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\" \
             stroke-linejoin=\"round\"/>",
            list.trim_end()
        ));
    }

    /// A filled rectangle.
    pub fn area(&mut self, [x, y]: [f64; 2], [width, height]: [f64; 2], color: &str) {
        self.push(&format!(
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"{color}\"/>"
        ));
    }

    /// A filled polygon.
    pub fn polygon(&mut self, points: &[[f64; 2]], color: &str) {
        let list: Vec<String> = points.iter().map(|[x, y]| format!("{x:.2},{y:.2}")).collect();
        self.push(&format!(
            "<polygon points=\"{}\" fill=\"{color}\"/>",
            list.join(" ")
        ));
    }

    /// A marker, hollow for what is incomplete.
    pub fn marker(&mut self, marker: Marker, [x, y]: [f64; 2], color: &str, hollow: bool) {
        let fill = if hollow { "white" } else { color };
        let r = 4.2;
        let polygon = |points: &[[f64; 2]]| {
            let list: Vec<String> = points
                .iter()
                .map(|[a, b]| format!("{:.1},{:.1}", x + r * a, y + r * b))
                .collect();
            format!("<polygon points=\"{}\"", list.join(" "))
        };
        let shape = match marker {
            Marker::Circle => format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{r}\""),
            Marker::Square => polygon(&[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]]),
            Marker::Diamond => polygon(&[[0.0, -1.25], [1.25, 0.0], [0.0, 1.25], [-1.25, 0.0]]),
            Marker::Triangle => polygon(&[[0.0, -1.2], [1.15, 0.9], [-1.15, 0.9]]),
            Marker::Wedge => polygon(&[[0.0, 1.2], [1.15, -0.9], [-1.15, -0.9]]),
            Marker::Cross => polygon(&[
                [0.0, -0.4],
                [0.8, -1.2],
                [1.2, -0.8],
                [0.4, 0.0],
                [1.2, 0.8],
                [0.8, 1.2],
                [0.0, 0.4],
                [-0.8, 1.2],
                [-1.2, 0.8],
                [-0.4, 0.0],
                [-1.2, -0.8],
                [-0.8, -1.2],
            ]),
        };
        self.push(&format!(
            "{shape} fill=\"{fill}\" stroke=\"{color}\" stroke-width=\"1.4\"/>"
        ));
    }

    /// A text whose baseline starts, is centred or ends at a point; a white edge parts it from what lies below.
    pub fn text(&mut self, [x, y]: [f64; 2], anchor: Anchor, size: f64, color: &str, words: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let words = escape(words);
        self.push(&format!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" text-anchor=\"{anchor}\" \
             fill=\"{color}\" stroke=\"white\" stroke-width=\"3\" paint-order=\"stroke\">{words}</text>"
        ));
    }

    /// A text that reads upward, centred at a point.
    pub fn upward(&mut self, [x, y]: [f64; 2], size: f64, words: &str) {
        self.push(&format!(
            "<text transform=\"translate({x:.1} {y:.1}) rotate(-90)\" font-size=\"{size}\" \
             text-anchor=\"middle\" fill=\"{BLACK}\">{words}</text>"
        ));
    }
}

/// Words as text of an SVG.
fn escape(words: &str) -> String {
    words.replace('&', "&amp;").replace('<', "&lt;")
}

/// A logarithmic axis: decades, whole or not, over pixels.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// First and last decade, exponents of ten, dimensionless.
    pub decades: [f64; 2],
    /// Where they lie, pixels.
    pub pixels: [f64; 2],
}

impl Axis {
    /// Where a value lies; values beyond the ends lie at the ends.
    pub fn at(&self, value: f64) -> f64 {
        let [first, last] = self.decades;
        let part = ((libm::log10(value) - first) / (last - first)).clamp(0.0, 1.0);
        self.pixels[0] + part * (self.pixels[1] - self.pixels[0])
    }

    fn whole(&self) -> core::ops::RangeInclusive<i32> {
        let [first, last] = self.decades;
        first.ceil() as i32..=last.floor() as i32
    }
}

/// A frame with two logarithmic axes.
#[derive(Clone, Copy, Debug)]
pub struct Panel {
    /// To the right.
    pub x: Axis,
    /// Upward.
    pub y: Axis,
}

impl Panel {
    /// Where a point lies.
    pub fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.x.at(x), self.y.at(y)]
    }

    /// Grid, frame, and the labels of every `step`-th decade, in words.
    pub fn draw(&self, drawing: &mut Drawing, steps: [usize; 2], words: [&dyn Fn(i32) -> String; 2]) {
        let ([left, right], [bottom, top]) = (self.x.pixels, self.y.pixels);
        for decade in self.x.whole().step_by(steps[0]) {
            let x = self.x.at(libm::pow(10.0, f64::from(decade)));
            drawing.line([x, bottom], [x, top], GRID, 1.0);
            drawing.text([x, bottom + 17.0], Anchor::Middle, 12.0, BLACK, &words[0](decade));
        }
        for decade in self.y.whole().step_by(steps[1]) {
            let y = self.y.at(libm::pow(10.0, f64::from(decade)));
            drawing.line([left, y], [right, y], GRID, 1.0);
            drawing.text([left - 7.0, y + 4.0], Anchor::End, 12.0, BLACK, &words[1](decade));
        }
        let corners = [
            [left, bottom],
            [right, bottom],
            [right, top],
            [left, top],
            [left, bottom],
        ];
        drawing.path(&corners, GREY, 1.0);
    }
}

/// Moves heights apart that are closer than `gap`, as little as it takes; the order stays.
pub fn spread(heights: &mut [f64], gap: f64, [top, bottom]: [f64; 2]) {
    let mut order: Vec<usize> = (0..heights.len()).collect();
    order.sort_by(|&a, &b| heights[a].total_cmp(&heights[b]));
    let mut least = top;
    for &i in &order {
        heights[i] = heights[i].max(least);
        least = heights[i] + gap;
    }
    let mut most = bottom;
    for &i in order.iter().rev() {
        heights[i] = heights[i].min(most);
        most = heights[i] - gap;
    }
}

/// A decade as a power of ten.
pub fn power(decade: i32) -> String {
    match decade {
        0 => "1".to_owned(),
        1 => "10".to_owned(),
        _ => {
            let digits: String = decade
                .to_string()
                .chars()
                .map(|c| match c {
                    '-' => '\u{207b}',
                    '1' => '\u{b9}',
                    '2' => '\u{b2}',
                    '3' => '\u{b3}',
                    c => char::from_u32(0x2070 + c as u32 - '0' as u32).unwrap_or(c),
                })
                .collect();
            format!("10{digits}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_move_apart_and_stay_inside() {
        let mut heights = [10.0, 11.0, 50.0, 99.0, 98.0];
        spread(&mut heights, 12.0, [0.0, 100.0]);
        let mut sorted = heights;
        sorted.sort_by(f64::total_cmp);
        assert!(
            sorted.windows(2).all(|w| w[1] - w[0] >= 12.0 - 1e-9),
            "{heights:?}"
        );
        assert!(sorted[0] >= 0.0 && sorted[4] <= 100.0);
        assert!(heights[0] < heights[1] && heights[4] < heights[3]);
    }

    #[test]
    fn axes_are_logarithmic() {
        let axis = Axis {
            decades: [-2.0, 2.0],
            pixels: [0.0, 400.0],
        };
        assert!((axis.at(1.0) - 200.0).abs() < 1e-9 && (axis.at(10.0) - 300.0).abs() < 1e-9);
        assert!((axis.at(1e9) - 400.0).abs() < 1e-9 && axis.at(0.0).abs() < 1e-9);
    }

    #[test]
    fn powers_are_raised() {
        assert_eq!(power(-12), "10\u{207b}\u{b9}\u{b2}");
        assert_eq!(power(4), "10\u{2074}");
    }
}
