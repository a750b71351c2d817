//! States of equilibrium in SI units, read off a solution.

use crate::design::Membrane as Dimensions;
use crate::material::Hyperelastic;
use crate::membrane::equations::{CONTACT_PARAMETER, POLE, TensionField, Zone};
use crate::membrane::equilibrium::Equilibrium;
use crate::membrane::solution::{Pole, Solution};
use crate::solver::collocation::STATES;
use core::f64::consts::{FRAC_PI_2, PI};

/// Units of the dimensionless equations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitScale {
    /// Length: the radial semi-axis, metres.
    pub length: f64,
    /// Stress: the shear modulus, pascals.
    pub stress: f64,
    /// Tension per deformed length: modulus times wall, newtons per metre.
    pub tension: f64,
    /// Pressure: `mu h0 / a0`, pascals.
    pub pressure: f64,
}

impl UnitScale {
    /// Units to be set.
    pub(crate) const BLANK: Self = Self {
        length: 1.0,
        stress: 1.0,
        tension: 1.0,
        pressure: 1.0,
    };

    /// The units of a membrane whose law has the shear modulus `stress`, pascals.
    pub fn new(dimensions: &Dimensions, stress: f64) -> Self {
        Self {
            length: dimensions.radial_semi_axis,
            stress,
            tension: stress * dimensions.thickness,
            pressure: stress * dimensions.thickness / dimensions.radial_semi_axis,
        }
    }

    /// Unit of volume, cubic metres.
    pub fn volume(&self) -> f64 {
        self.length * self.length * self.length
    }

    /// Unit of energy, joules.
    pub fn energy(&self) -> f64 {
        self.tension * self.length * self.length
    }
}

/// The worst zone of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Wrinkling {
    /// Taut both ways everywhere. `no` in tables.
    Taut,
    /// Hoop wrinkles somewhere; of a plain membrane: compression somewhere. `wrinkled` in tables.
    Wrinkled,
    /// A slack core under the plate. `slack` in tables.
    Slack,
}

impl Wrinkling {
    /// The word used in tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Taut => "no",
            Self::Wrinkled => "wrinkled",
            Self::Slack => "slack",
        }
    }
}

/// Quantities of every state of equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressShape {
    /// Gauge pressure of the fluid, pascals.
    pub pressure: f64,
    /// Stretch of the pole; 1 in a slack core.
    pub pole_stretch: f64,
    /// Edge of the slack core in the meridian's parameter, radians, 0 if there is none.
    pub slack_edge: f64,
    /// Height of the dome over its base, metres.
    pub height: f64,
    /// Volume of the dome above its base, cubic metres.
    pub volume: f64,
    /// Strain energy of the dome, joules.
    pub energy: f64,
    /// Angle of the meridian at the clamped edge, radians: pi/2 is vertical, pi touches the base plane.
    pub edge_angle: f64,
    /// Radius of the clamped edge, metres.
    pub edge_radius: f64,
    /// Largest radius, metres.
    pub largest_radius: f64,
    /// Smallest meridional tension, newtons per metre of deformed length.
    pub least_meridional_tension: f64,
    /// Smallest hoop tension, newtons per metre of deformed length.
    pub least_hoop_tension: f64,
    /// The worst zone.
    pub wrinkling: Wrinkling,
}

impl PressShape {
    /// Room for a shape.
    pub(crate) const BLANK: Self = Self {
        pressure: 0.0,
        pole_stretch: 1.0,
        slack_edge: 0.0,
        height: 0.0,
        volume: 0.0,
        energy: 0.0,
        edge_angle: 0.0,
        edge_radius: 0.0,
        largest_radius: 0.0,
        least_meridional_tension: 0.0,
        least_hoop_tension: 0.0,
        wrinkling: Wrinkling::Taut,
    };

    /// The smaller of the two smallest tensions, newtons per metre of deformed length.
    pub fn least_tension(&self) -> f64 {
        self.least_meridional_tension.min(self.least_hoop_tension)
    }
}

/// A pressed state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressedState {
    /// How far the plate went down from first touch, metres.
    pub indentation: f64,
    /// Pressure over that of the rest state, pascals.
    pub pressure_rise: f64,
    /// Force on the object, newtons; on a plate, total pressure times contact area.
    pub force: f64,
    /// Deformed radius of the contact, metres.
    pub contact_radius: f64,
    /// The contact edge in the meridian's parameter, radians.
    pub contact_parameter: f64,
    /// The rest.
    pub shape: PressShape,
}

impl PressedState {
    /// Area of the contact, square metres.
    pub fn contact_area(&self) -> f64 {
        PI * self.contact_radius * self.contact_radius
    }
}

/// One point of the meridian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeridianPoint {
    /// Meridian's parameter, radians: 0 at the pole, pi/2 at the equator.
    pub parameter: f64,
    /// Deformed radius, metres.
    pub radius: f64,
    /// Height over the base, metres.
    pub height: f64,
    /// Meridional stretch.
    pub meridional_stretch: f64,
    /// Hoop stretch.
    pub hoop_stretch: f64,
    /// Meridional tension, newtons per metre of deformed length.
    pub meridional_tension: f64,
    /// Hoop tension, newtons per metre of deformed length.
    pub hoop_tension: f64,
    /// Angle of the tangent, radians: 0 is horizontal, pi/2 vertical.
    pub angle: f64,
    /// Under the plate, its edge included, or free.
    pub zone: Zone,
    /// Hoop wrinkles stand here (of a plain membrane: it is compressed here), or the membrane is slack.
    pub wrinkling: Wrinkling,
}

/// The zone at `t`; the contact edge counts as contact.
fn zone_at<const S: usize>(solution: &Solution<S>, t: f64) -> Zone {
    if solution.contact_elements > 0 && t <= solution.parameters[CONTACT_PARAMETER] {
        Zone::Contact
    } else {
        Zone::Free
    }
}

/// Stretches and tensions at `t`, dimensionless: `[l1, l2, T1, T2, phi]`, and whether wrinkled.
fn local<L: Hyperelastic, const S: usize>(
    equilibrium: &Equilibrium<L, S>,
    solution: &Solution<S>,
    t: f64,
) -> Option<([f64; 5], bool)> {
    if t < solution.start() {
        return Some(([1.0, 1.0, 0.0, 0.0, 0.0], false));
    }
    let ([u, w], guess) = solution.at(&equilibrium.gauss, t);
    let [_, pressure, contact_radius, _] = solution.parameters;
    let membrane = &equilibrium.membrane;
    // At the pole of a rest state the tangent is horizontal as it is under a plate.
    let zone = if t == 0.0 {
        Zone::Contact
    } else {
        zone_at(solution, t)
    };
    let n = membrane.tension_measure(zone, t, [u, w], pressure, contact_radius);
    let response = membrane.respond(n, u, guess)?;
    let angle = match zone {
        Zone::Contact => libm::asin((-membrane.curvature * u * libm::sin(t)).clamp(-1.0, 1.0)),
        Zone::Free => {
            let x = libm::sin(t);
            let k = 0.5 * pressure * (u * u * x - contact_radius * contact_radius / x);
            // Under a plate only rounding falls below 0.
            let k = if membrane.curvature > 0.0 { k } else { k.max(0.0) };
            libm::atan2(k, w)
        }
    };
    Some((
        [response.l1, u, n / u, response.w2 / response.l1, angle],
        response.wrinkled,
    ))
}

/// The meridian at `t` with its height left open.
pub(crate) fn meridian_point<L: Hyperelastic, const S: usize>(
    equilibrium: &Equilibrium<L, S>,
    scale: &UnitScale,
    solution: &Solution<S>,
    t: f64,
    height: f64,
) -> Option<MeridianPoint> {
    let ([l1, l2, t1, t2, angle], wrinkled) = local(equilibrium, solution, t)?;
    let compressed = equilibrium.membrane.tension_field == TensionField::Plain && t1.min(t2) < 0.0;
    Some(MeridianPoint {
        parameter: t,
        radius: l2 * libm::sin(t) * scale.length,
        height: height * scale.length,
        meridional_stretch: l1,
        hoop_stretch: l2,
        meridional_tension: t1 * scale.tension,
        hoop_tension: t2 * scale.tension,
        angle,
        zone: zone_at(solution, t),
        wrinkling: if t < solution.start() {
            Wrinkling::Slack
        } else if wrinkled || compressed {
            Wrinkling::Wrinkled
        } else {
            Wrinkling::Taut
        },
    })
}

/// The golden section.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// Samples an element gets when an extreme is looked for.
const SAMPLES: usize = 6;

/// Smallest value of `of` on the meridian, refined between samples by golden section.
fn least<const S: usize>(solution: &Solution<S>, of: impl Fn(f64) -> f64) -> f64 {
    let (mut best, mut left, mut right) = (f64::INFINITY, 0.0, 0.0);
    for e in 0..solution.elements() {
        let span = solution.span(e);
        let step = span.length / SAMPLES as f64;
        for j in 0..=SAMPLES {
            let t = if j == SAMPLES {
                span.start + span.length
            } else {
                span.start + step * j as f64
            };
            let value = of(t);
            if value < best {
                best = value;
                (left, right) = ((t - step).max(solution.start()), (t + step).min(FRAC_PI_2));
            }
        }
    }
    let (mut a, mut b) = (right - GOLDEN * (right - left), left + GOLDEN * (right - left));
    let (mut of_a, mut of_b) = (of(a), of(b));
    for _ in 0..30 {
        if of_a < of_b {
            (right, b, of_b) = (b, a, of_a);
            a = right - GOLDEN * (right - left);
            of_a = of(a);
        } else {
            (left, a, of_a) = (a, b, of_b);
            b = left + GOLDEN * (right - left);
            of_b = of(b);
        }
    }
    best.min(of_a).min(of_b)
}

/// Everything but the press itself.
pub(crate) fn shape<L: Hyperelastic, const S: usize>(
    equilibrium: &Equilibrium<L, S>,
    scale: &UnitScale,
    solution: &Solution<S>,
) -> PressShape {
    let membrane = &equilibrium.membrane;
    let mut energy = 0.0;
    let mut any_wrinkled = false;
    equilibrium.for_each_point(solution, |e, j, span, _, response| {
        let meridian = membrane.meridian(span.start + equilibrium.gauss.nodes[j] * span.length);
        let u = if response.wrinkled {
            1.0 / libm::sqrt(response.l1)
        } else {
            solution.stages[e][j][0]
        };
        let weight = equilibrium.gauss.weights[j] * span.length;
        energy += weight * 2.0 * PI * meridian.x * meridian.arc_rate * membrane.law.energy(response.l1, u);
        any_wrinkled |= response.wrinkled;
    });
    let slack = solution.pole == Pole::Slack;
    let tension = |index: usize| {
        let sampled = least(solution, |t| {
            local(equilibrium, solution, t).map_or(f64::INFINITY, |l| l.0[index])
        });
        if slack { sampled.min(0.0) } else { sampled }
    };
    let (meridional, hoop) = (tension(2), tension(3));
    let largest_radius = -least(solution, |t| {
        -(solution.at(&equilibrium.gauss, t).0[0] * libm::sin(t))
    });
    let [u, w]: [f64; STATES] = solution.nodes[solution.elements()];
    let [pole, pressure, contact_radius, _] = solution.parameters;
    let k = 0.5 * pressure * (u * u - contact_radius * contact_radius);
    let compressed = membrane.tension_field == TensionField::Plain && meridional.min(hoop) < 0.0;
    PressShape {
        pressure: pressure * scale.pressure,
        pole_stretch: if slack { 1.0 } else { pole },
        slack_edge: if slack { solution.parameters[POLE] } else { 0.0 },
        height: solution.height * scale.length,
        volume: solution.volume * scale.volume(),
        energy: energy * scale.energy(),
        edge_angle: libm::atan2(k.max(0.0), w),
        edge_radius: u * scale.length,
        largest_radius: largest_radius * scale.length,
        least_meridional_tension: meridional * scale.tension,
        least_hoop_tension: hoop * scale.tension,
        wrinkling: if slack {
            Wrinkling::Slack
        } else if any_wrinkled || compressed {
            Wrinkling::Wrinkled
        } else {
            Wrinkling::Taut
        },
    }
}
