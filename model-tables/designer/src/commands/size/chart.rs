//! The chart of a sizing: the target beside the best designs, and what they cost.

use crate::size::Sized;
use crate::size::target::Target;
use model_tables::membrane::TensionField;
use model_tables::membrane::press::Press;
use output::drawing::{Anchor, BLACK, BLUE, Drawing, GREEN, GREY, Marker, ORANGE, PURPLE, VERMILION};
use output::linear::{LinearAxis, LinearPanel};

const WIDTH: f64 = 1000.0;
const HEIGHT: f64 = 470.0;
/// Designs whose curve is drawn.
const DRAWN: usize = 5;
const COLORS: [&str; DRAWN] = [BLUE, VERMILION, GREEN, PURPLE, ORANGE];
const MARKERS: [Marker; DRAWN] = [
    Marker::Circle,
    Marker::Square,
    Marker::Diamond,
    Marker::Triangle,
    Marker::Wedge,
];

/// The whole chart; designs ranked.
pub(super) fn draw(target: &Target, designs: &[Sized]) -> String {
    let mut drawing = Drawing::new(WIDTH, HEIGHT);
    let title = format!("membranes for `{}`", target.name);
    drawing.text([20.0, 26.0], Anchor::Start, 16.0, BLACK, &title);
    curves(&mut drawing, target, designs);
    costs(&mut drawing, designs);
    drawing.finish()
}

/// Force over the indentation.
fn curves(drawing: &mut Drawing, target: &Target, designs: &[Sized]) {
    let largest = target.forces.iter().copied().fold(0.0, f64::max);
    let panel = LinearPanel {
        x: LinearAxis::from_zero(1e3 * target.deepest(), [75.0, 455.0]),
        y: LinearAxis::from_zero(1.15 * largest, [HEIGHT - 60.0, 55.0]),
    };
    panel.draw(drawing);
    drawing.text(
        [265.0, HEIGHT - 22.0],
        Anchor::Middle,
        13.0,
        BLACK,
        "indentation / mm",
    );
    drawing.upward([24.0, 0.5 * HEIGHT], 13.0, "force / N");
    for (k, sized) in designs.iter().take(DRAWN).enumerate() {
        let Ok(mut press) = Press::new(&sized.design, TensionField::Relaxed) else {
            continue;
        };
        let points: Vec<[f64; 2]> = (0..=40)
            .map(|i| target.deepest() * f64::from(i) / 40.0)
            .filter_map(|depth| press.contact_at(depth).ok())
            .map(|contact| panel.at([1e3 * contact.indentation, contact.force]))
            .collect();
        drawing.path(&points, COLORS[k], 2.0);
        let y = 78.0 + 19.0 * k as f64;
        drawing.line([88.0, y - 4.0], [112.0, y - 4.0], COLORS[k], 2.2);
        let words = format!(
            "{}. {}, {:.2} %",
            k + 1,
            sized.material.title,
            100.0 * sized.misfit
        );
        drawing.text([120.0, y], Anchor::Start, 12.5, BLACK, &words);
    }
    for (depth, force) in target.indentations.iter().zip(&target.forces) {
        drawing.marker(Marker::Cross, panel.at([1e3 * depth, *force]), BLACK, false);
    }
    let y = 78.0 + 19.0 * designs.len().min(DRAWN) as f64;
    drawing.marker(Marker::Cross, [100.0, y - 4.0], BLACK, false);
    drawing.text([120.0, y], Anchor::Start, 12.5, BLACK, "wanted");
}

/// What making does to the force over the peak pressure; what nothing beats is filled.
fn costs(drawing: &mut Drawing, designs: &[Sized]) {
    let largest = |of: fn(&Sized) -> f64| designs.iter().map(of).fold(0.0, f64::max);
    let panel = LinearPanel {
        x: LinearAxis::from_zero(1e-3 * largest(|sized| sized.peak_pressure), [575.0, 965.0]),
        y: LinearAxis::from_zero(100.0 * largest(Sized::making), [HEIGHT - 60.0, 55.0]),
    };
    panel.draw(drawing);
    drawing.text(
        [770.0, HEIGHT - 22.0],
        Anchor::Middle,
        13.0,
        BLACK,
        "peak pressure / kPa (filled: nothing beats it)",
    );
    drawing.upward(
        [524.0, 0.5 * HEIGHT],
        13.0,
        "change of force by the tolerance / %",
    );
    // The ranked ones last, so that they lie on top.
    for (rank, sized) in designs.iter().enumerate().rev() {
        let at = panel.at([1e-3 * sized.peak_pressure, 100.0 * sized.making()]);
        let beaten = designs.iter().any(|other| other.dominates(sized));
        if rank < DRAWN {
            drawing.marker(MARKERS[rank], at, COLORS[rank], beaten);
            let words = format!("{}", rank + 1);
            drawing.text([at[0] + 8.0, at[1] + 4.0], Anchor::Start, 12.0, BLACK, &words);
        } else {
            drawing.marker(Marker::Circle, at, GREY, beaten);
        }
    }
}
