//! The depth of a press at a force.

use model_tables::curve::Contact;
use model_tables::limit::Limit;

/// The first depth looked at, over that of the end of the press.
const LOWEST: f64 = 1e-6;
/// The search ends where the force is found to this, relative.
const NEAR: f64 = 1e-11;
/// Presses of one search at most.
const MOST: usize = 60;

/// Why there is no state at a force.
pub(super) enum NoForce<E> {
    /// It lies beyond the end of the press.
    Beyond(String),
    /// A state on the way was not found.
    Model(E),
}

/// The depth in metres at a force in newtons: regula falsi in logarithms, in which a press is nearly a straight line.
pub(super) fn depth<E>(
    force: f64,
    limit: &Limit,
    mut contact_at: impl FnMut(f64) -> Result<Contact, E>,
) -> Result<f64, NoForce<E>> {
    if !(force >= 0.0 && force <= limit.force) {
        return Err(NoForce::Beyond(format!(
            "a force of {force} N is not possible: the press has 0 to {:.6} N, at {:.6} mm, where it ends ({})",
            limit.force,
            1e3 * limit.indentation,
            limit.ends_by.word()
        )));
    }
    if force <= 0.0 {
        return Ok(0.0);
    }
    let mut low = LOWEST * limit.indentation;
    let mut at_low;
    loop {
        at_low = contact_at(low).map_err(NoForce::Model)?.force;
        if at_low <= force {
            break;
        }
        low *= LOWEST;
    }
    let (mut low, mut high) = (libm::log(low), libm::log(limit.indentation));
    let above = |found: f64| libm::log(found / force);
    let (mut at_low, mut at_high) = (above(at_low.max(f64::MIN_POSITIVE)), above(limit.force));
    let mut found = high;
    for _ in 0..MOST {
        if at_high - at_low <= 0.0 {
            break;
        }
        found = (low * at_high - high * at_low) / (at_high - at_low);
        let difference = above(contact_at(libm::exp(found)).map_err(NoForce::Model)?.force);
        if difference.abs() < NEAR {
            break;
        }
        // The end that stays counts half (Illinois), so that both ends come in.
        if difference < 0.0 {
            (low, at_low) = (found, difference);
            at_high *= 0.5;
        } else {
            (high, at_high) = (found, difference);
            at_low *= 0.5;
        }
    }
    Ok(libm::exp(found).min(limit.indentation))
}

#[cfg(test)]
mod tests {
    use super::*;
    use model_tables::limit::EndsBy;

    #[test]
    fn the_depth_of_a_power_law_is_found_and_beyond_its_end_is_refused() {
        // F = 3 (H / 1 mm)^1.7: H = (F / 3)^(1 / 1.7).
        let force = |depth: f64| 3.0 * libm::pow(1e3 * depth, 1.7);
        let contact_at = |depth: f64| -> Result<Contact, ()> {
            Ok(Contact {
                indentation: depth,
                pressure_rise: 1.0,
                force: force(depth) * (1.0 + 40.0 * depth),
            })
        };
        let limit = Limit {
            indentation: 4e-3,
            pressure: 0.0,
            force: force(4e-3) * 1.16,
            ends_by: EndsBy::WallTouchesBase,
        };
        for wanted in [1e-9, 0.05, 2.0, 20.0, limit.force] {
            let depth = depth(wanted, &limit, contact_at).unwrap_or(f64::NAN);
            let found = contact_at(depth).expect("a state").force;
            assert!((found / wanted - 1.0).abs() < 1e-9, "{wanted}: {found}");
        }
        assert!(depth(0.0, &limit, contact_at).is_ok_and(|depth| depth.abs() < 1e-300));
        assert!(
            matches!(depth(60.0, &limit, contact_at), Err(NoForce::Beyond(reason)) if reason.contains("60 N"))
        );
        assert!(depth(-1.0, &limit, contact_at).is_err());
    }
}
