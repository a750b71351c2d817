//! Random designs, each from its own number, so that any one can be looked at alone.

use model_tables::design::{Design, Membrane, RestBy};
use model_tables::material::{Hyperelastic as _, Law};
use model_tables::membrane::TensionField;
use model_tables::object::Object;
use model_tables::random::Random;

/// Indentations a design is judged at.
pub const INDENTATIONS: usize = 8;

/// A design and what is asked of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// Its number in the campaign.
    pub index: u64,
    /// The design; at rest by pole stretch.
    pub design: Design,
    /// Pole stretch.
    pub pole_stretch: f64,
    /// Compliance over `a0^4 / (mu h0)`.
    pub compliance: f64,
    /// Whether the membrane may push.
    pub tension_field: TensionField,
    /// Indentations over the limit, increasing.
    pub parts: [f64; INDENTATIONS],
}

/// Pole stretch: half of them crowd towards 1, where methods fail.
fn pole_stretch(random: &mut Random) -> f64 {
    if random.unit() < 0.5 {
        1.0 + random.logarithmic(0.002, 2.0)
    } else {
        random.uniform(1.002, 3.0)
    }
}

/// A law: neo-Hookean, Mooney-Rivlin (a fifth with a slightly negative `C2`) or Yeoh (a half with negative constants).
fn law(random: &mut Random) -> Law {
    let c1 = random.logarithmic(1e4, 1e6);
    match random.bits() % 3 {
        0 => Law::NeoHookean { c1 },
        1 => {
            let ratio = if random.unit() < 0.2 {
                random.uniform(-0.05, 0.0)
            } else {
                random.uniform(0.0, 2.0)
            };
            Law::MooneyRivlin { c1, c2: c1 * ratio }
        }
        _ => Law::Yeoh {
            c1,
            c2: c1 * random.uniform(-0.1, 0.1),
            c3: c1 * random.uniform(-0.005, 0.02),
        },
    }
}

/// Case `index` of the campaign of `seed`.
pub fn case(seed: u64, index: u64) -> Case {
    let mut random = Random(seed ^ index.wrapping_mul(0xd134_2543_de82_ef95));
    random.bits();
    let radial = random.logarithmic(2e-3, 20e-3);
    let membrane = Membrane {
        radial_semi_axis: radial,
        axial_semi_axis: radial * random.uniform(0.3, 2.0),
        thickness: radial * random.logarithmic(0.01, 0.25),
    };
    let pole_stretch = pole_stretch(&mut random);
    let law = law(&mut random);
    // Over `a0^4 / (mu h0)`, none, moderate or extreme.
    let compliance = match random.bits() % 5 {
        0 | 1 => 0.0,
        2 | 3 => random.logarithmic(1e-3, 3.0),
        _ => random.logarithmic(3.0, 1e5),
    };
    let tension_field = if random.bits().is_multiple_of(3) {
        TensionField::Plain
    } else {
        TensionField::Relaxed
    };
    let mut parts = [0.0; INDENTATIONS];
    parts[0] = 1e-4;
    parts[1] = random.logarithmic(1e-4, 1e-2);
    parts[2] = random.logarithmic(1e-2, 1e-1);
    for part in &mut parts[3..INDENTATIONS - 1] {
        *part = random.uniform(0.1, 0.99);
    }
    parts[INDENTATIONS - 1] = 0.999;
    parts.sort_by(f64::total_cmp);
    Case {
        index,
        design: Design {
            membrane,
            law,
            rest: RestBy::PoleStretch(pole_stretch),
            compliance: compliance * radial * radial * radial * radial
                / (law.shear_modulus() * membrane.thickness),
            object: Object::PLATE,
        },
        pole_stretch,
        compliance,
        tension_field,
        parts,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_cover_the_ranges() {
        let cases: Vec<Case> = (0..2000).map(|index| case(1, index)).collect();
        let share = |of: &dyn Fn(&Case) -> bool| cases.iter().filter(|c| of(c)).count();
        assert!(share(&|c| c.pole_stretch < 1.02) > 200);
        assert!(share(&|c| c.pole_stretch > 2.0) > 200);
        assert!(share(&|c| c.compliance > 100.0) > 100);
        assert!(share(&|c| c.tension_field == TensionField::Plain) > 500);
        assert!(share(&|c| matches!(c.design.law, Law::Yeoh { c3, .. } if c3 < 0.0)) > 60);
        for case in &cases {
            assert!((1.002..=3.0).contains(&case.pole_stretch));
            assert!(case.parts.windows(2).all(|pair| pair[0] <= pair[1]));
        }
    }
}
