//! What a fitted series says, one line each.

use crate::fit::relaxation::record::HoldRecord;
use crate::fit::relaxation::{Identifiability, RelaxationFit};
use model_tables::design_file::DesignFile;
use output::rows::significant;

/// Order in what is left, in standard deviations, that is no chance (one in two hundred).
const ORDERED: f64 = -2.58;
/// Relaxed moduli this far apart are open.
const OPEN: f64 = 0.1;

fn digits(number: f64) -> String {
    significant(number, 3)
}

/// What there is to say.
pub(super) fn findings(file: &DesignFile, record: &HoldRecord, fit: &RelaxationFit) -> Vec<String> {
    let mut lines = vec![format!(
        "{} terms, by the Bayesian information criterion; intervals are of 95 %, of noise and of one term more or less, for a \
         wall that is quasi-linear; the solid's own error in time, 0.3 %, is beside them",
        fit.terms.len()
    )];
    for (misfit, name, unit, factor, noise) in [
        (
            fit.misfit[1],
            "pressure rise",
            "Pa",
            1.0,
            [fit.noise[0], fit.noise[1]],
        ),
        (fit.misfit[0], "force", "mN", 1e3, [fit.noise[2], fit.noise[3]]),
    ] {
        if let Some(misfit) = misfit {
            lines.push(format!(
                "{name}: {} {unit} RMS is left, {:.3} % of the largest, {:.3} % at most; noise of a reading {} {unit} pressing, \
                 {} {unit} held",
                digits(factor * misfit.rms),
                misfit.rms_percent(),
                misfit.largest_percent(),
                digits(factor * noise[0]),
                digits(factor * noise[1])
            ));
        }
    }
    lines.push(match &fit.solid {
        Ok(difference) => format!(
            "the wall was solved in time as a solid: it reads up to {:.1} % from the reduced model while the plate moves and {:.1} % in \
             the hold, which the fit takes into account",
            100.0 * difference.pressing,
            100.0 * difference.held
        ),
        Err(reason) => format!(
            "the reduced model alone was fitted, which errs by up to 5 % while the plate moves and 1 % early in a hold: {reason}"
        ),
    });
    lines.extend(fit.terms.iter().filter_map(|term| {
        let time = digits(term.time);
        match term.identifiability {
            Identifiability::Both => None,
            Identifiability::Product => Some(format!(
                "the record tells g times tau of the term of {time} s only: it relaxes faster than the rows show; press faster, and log \
                 more often, to tell them apart"
            )),
            Identifiability::Weight => Some(format!(
                "the term of {time} s stands for all that relaxes more slowly than the hold of {} s: hold longer to tell its times",
                digits(fit.hold)
            )),
            Identifiability::Neither => Some(format!("the record does not tell the term of {time} s: neither its g nor its tau alone")),
        }
    }));
    lines.push(modulus(fit));
    lines.push(temperature(file, record, fit));
    lines.push(depths(record, fit));
    if let Some(order) = fit.order
        && order < ORDERED
    {
        lines.push(format!(
            "what is left has an order ({order:.1} standard deviations fewer changes of sign than chance): the wall is not quite what the \
             model takes it for, and the intervals are too narrow"
        ));
    }
    lines.push("not told by a press and its hold: the unloading".to_owned());
    lines
}

fn modulus(fit: &RelaxationFit) -> String {
    if let Some(error) = fit.modulus_error {
        return format!(
            "the relaxed modulus is {} times the design's, within {} (one standard error)",
            significant(fit.modulus, 4),
            digits(error * fit.modulus)
        );
    }
    match fit.open_moduli {
        Some([least, most]) if most - least < OPEN => format!(
            "the relaxed modulus was held at the design's; from {least:.2} to {most:.2} times it fits as well"
        ),
        Some([least, most]) => format!(
            "the record does not tell the relaxed modulus, which was held at the design's: from {least:.2} to {most:.2} times it fits as \
             well, with slow terms to match; hold until the pressure stays, or fit the constants to settled readings"
        ),
        None => "the relaxed modulus was held at the design's".to_owned(),
    }
}

fn temperature(file: &DesignFile, record: &HoldRecord, fit: &RelaxationFit) -> String {
    let celsius = fit.series.temperature;
    if let Some(error) = fit.shift_error {
        return format!(
            "times are of {celsius:.1} degrees Celsius; a kelvin shortens them by {} within {} (one standard error, of the logarithm)",
            significant(fit.series.shift, 4),
            digits(error)
        );
    }
    let stated = if record.trials.iter().any(|trial| trial.temperature.is_some()) {
        format!("times are of {celsius:.1} degrees Celsius")
    } else {
        format!("no temperature_c: times are taken to be of {celsius:.1} degrees Celsius")
    };
    let law = match file.relaxation {
        Some(series) if series.shift > 0.0 => format!("shift_per_kelvin = {} is the design's", series.shift),
        _ => "shift_per_kelvin is left out, as of a wall that no temperature changes".to_owned(),
    };
    format!(
        "{stated}; the record does not tell what a kelvin does, for which it takes a second temperature: {law}"
    )
}

fn depths(record: &HoldRecord, fit: &RelaxationFit) -> String {
    let Some(depths) = fit.depths else {
        return format!(
            "whether the wall is quasi-linear is not told by one depth: press to {} mm too",
            digits(500.0 * record.trials[0].depth)
        );
    };
    let [shallow, deep] = depths.depths.map(|depth| digits(1e3 * depth));
    let size = format!(
        "the g(t) of depths from {shallow} to {deep} mm differ from the common one by up to {:.2} % (standard error {:.2} %)",
        100.0 * depths.difference,
        100.0 * depths.error
    );
    if depths.differs {
        format!("{size}: more than noise, the wall is not quasi-linear, or the constants or the zero are off")
    } else {
        format!("{size}: no more than noise, as of a quasi-linear wall")
    }
}
