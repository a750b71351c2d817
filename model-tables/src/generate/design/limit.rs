//! The accuracy limit of tables: the required one, or the limit that prevents it.

use super::Generated;

/// Accuracy limit of tables.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum AccuracyLimit {
    /// What `[accuracy]` asks.
    Accuracy,
    /// Half of what the transducer tells apart, which is coarser.
    Transducer,
    /// What integers reach, which is coarser: `from_design_or_worse`.
    Integers,
}

impl AccuracyLimit {
    /// In a word, as the certificate has it.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Accuracy => "accuracy",
            Self::Transducer => "transducer",
            Self::Integers => "integers",
        }
    }
}

impl Generated {
    /// Accuracy limits of force and indentation.
    pub fn limits(&self) -> [AccuracyLimit; 2] {
        let certificate = &self.certified.certificate;
        let allowed = [&certificate.force, &certificate.indentation].map(|errors| errors.allowed_percent);
        let asked = self.asked_percent();
        [0, 1].map(|output| {
            if allowed[output] <= asked[output] {
                AccuracyLimit::Accuracy
            } else if allowed[output] <= self.floor() {
                AccuracyLimit::Transducer
            } else {
                AccuracyLimit::Integers
            }
        })
    }

    /// One line about the accuracy that `[accuracy]` asks and the tables do not reach; nothing where they do.
    pub fn shortfall(&self) -> Option<String> {
        let limits = self.limits();
        if limits == [AccuracyLimit::Accuracy; 2] {
            return None;
        }
        let remedy = if limits.contains(&AccuracyLimit::Integers) {
            "allow more in [accuracy], or cover less with press.max_indentation_mm"
        } else {
            "allow more in [accuracy], or choose a finer transducer"
        };
        Some(format!("{}: {remedy}", self.choice()))
    }

    /// Percent of reading below which tables are waste for the transducer.
    fn floor(&self) -> f64 {
        let [force, indentation] = self.certified.resolvable_percent;
        force.min(indentation)
    }

    /// Accuracy of force and indentation that `[accuracy]` requires, percent of reading.
    pub fn asked_percent(&self) -> [f64; 2] {
        self.design.accuracy.as_ref().map_or([0.0; 2], |accuracy| {
            [
                accuracy.force_percent_of_reading,
                accuracy.indentation_percent_of_reading,
            ]
        })
    }

    /// One line that justifies the accuracy of the tables: the required one, and the resolution of the transducer.
    pub fn choice(&self) -> String {
        let [force, indentation] = self.asked_percent();
        let tells = format!(
            "half of transducer.resolution_pa = {} is {:.4} % of reading where it is least",
            self.transducer.resolution_pa,
            self.floor()
        );
        let limits = self.limits();
        if limits == [AccuracyLimit::Accuracy; 2] {
            format!("held to the {force} % and {indentation} % that [accuracy] asks; {tells}")
        } else if limits.contains(&AccuracyLimit::Integers) {
            let certificate = &self.certified.certificate;
            format!(
                "[accuracy] asks {force} % and {indentation} %, but no tables keep within that: these keep within {} % and {} %",
                certificate.force.allowed_percent, certificate.indentation.allowed_percent
            )
        } else {
            format!(
                "[accuracy] asks {force} % and {indentation} %, but {tells}: the tables stop there, as finer ones would be waste"
            )
        }
    }
}
