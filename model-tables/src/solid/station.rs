//! States on the path of a press, and what is between them.

use super::equilibrium::Tangent;
use super::section::ContactEdge;
use super::state::{Balance, Fluid, State};

/// A state of the press.
#[derive(Clone, Debug)]
pub struct Kept {
    /// Its indentation, over the radial semi-axis.
    pub indentation: f64,
    /// Its unknowns.
    pub state: State,
    /// What it came with.
    pub balance: Balance,
    /// Where the outer surface leaves what touches it.
    pub contact: ContactEdge,
    /// Where its points are anchored on what touches, over the radial semi-axis; empty without friction.
    pub anchors: Vec<f64>,
    /// Energy of the wall and of the contact, dimensionless.
    pub energy: f64,
    /// Work of plate and fluid since the rest state, plus the energy of that, less the dissipation of friction,
    /// dimensionless.
    pub work: f64,
}

impl Kept {
    /// From the rest state towards another one next to it, at a part of its indentation: by Hertz's law, `F` and with it the pressure's rise go
    /// with the indentation to 3/2, the energy to 5/2, the contact's radius to 1/2.
    pub fn approach(&mut self, next: &Self, part: f64) {
        let root = libm::sqrt(part);
        let force = part * root;
        self.indentation = part * next.indentation;
        let rest = self.state.clone();
        self.state.add(force, &next.state);
        self.state.add(-force, &rest);
        self.balance = Balance {
            volume: self.balance.volume + force * (next.balance.volume - self.balance.volume),
            force: force * next.balance.force,
            contact_energy: force * part * next.balance.contact_energy,
            residual: next.balance.residual,
        };
        self.contact = ContactEdge {
            radius: root * next.contact.radius,
            parameter: root * next.contact.parameter,
        };
        self.energy += force * part * (next.energy - self.energy);
        self.work += force * part * (next.work - self.work);
    }
}

/// A state of the path, and how it goes on.
#[derive(Clone, Debug)]
pub(super) struct WallPoint {
    pub(super) kept: Kept,
    pub(super) tangent: Tangent,
}

/// Cubic of Hermite at `x` in `[0, 1]`: weights of both values and, over the interval, both slopes.
pub(super) fn hermite(x: f64) -> [f64; 4] {
    let y = 1.0 - x;
    [
        y * y * (1.0 + 2.0 * x),
        x * x * (1.0 + 2.0 * y),
        x * y * y,
        -x * x * y,
    ]
}

/// Work of plate and fluid from a state of the path to one with this derivative of its force.
pub(super) fn work(from: &WallPoint, to: &Kept, stiffness: f64, fluid: &Fluid) -> f64 {
    let WallPoint { kept: from, tangent } = from;
    let step = to.indentation - from.indentation;
    let (first, last) = (from.balance.force, to.balance.force);
    let plate = if from.indentation > 0.0 {
        // Trapezium with the slopes of both ends: of fourth order.
        step * (0.5 * (first + last) + step / 12.0 * (tangent.force - stiffness))
    } else {
        // The force begins as a power of the indentation.
        last * step / (1.0 + stiffness * step / last)
    };
    // dV = -c dP.
    let (before, after) = (from.state.fluid, to.state.fluid);
    plate - 0.5 * fluid.by_pressure * (after - before) * (after + before)
}

/// Value and slope of the cubic through two states of the path, from their values and slopes.
pub(super) fn between(
    below: &WallPoint,
    above: &WallPoint,
    indentation: f64,
    of: impl Fn(&WallPoint) -> [f64; 2],
) -> [f64; 2] {
    let from = below.kept.indentation;
    let step = above.kept.indentation - from;
    let x = (indentation - from) / step;
    let ([y0, s0], [y1, s1]) = (of(below), of(above));
    let w = hermite(x);
    let value = w[0] * y0 + w[1] * y1 + step * (w[2] * s0 + w[3] * s1);
    let slope =
        6.0 * x * (1.0 - x) * (y1 - y0) / step + (1.0 - x) * (1.0 - 3.0 * x) * s0 + x * (3.0 * x - 2.0) * s1;
    [value, slope]
}

/// Force and its derivative.
pub(super) fn force(station: &WallPoint) -> [f64; 2] {
    [station.kept.balance.force, station.tangent.force]
}
