//! A design file of a sized membrane.

use super::Sized;
use super::target::Target;
use model_tables::design::RestBy;

impl Sized {
    /// Stretch of the pole at rest.
    pub fn stretch(&self) -> f64 {
        match self.design.rest {
            RestBy::PoleStretch(stretch) => stretch,
            _ => f64::NAN,
        }
    }

    /// A design file of a sized membrane, solved by the model that its wall needs, with the accuracy of its tables in percent.
    pub(super) fn design_file(&self, name: &str, target: &Target, percent: f64) -> String {
        let membrane = &self.design.membrane;
        let micrometres = |metres: f64| libm::round(1e6 * metres) / 1e3;
        let [low, high] = target.range_kpa;
        // A 12-bit converter over four fifths of its range, averaged over sixteen samples.
        let resolution = 1e3 * (high - low) / 4096.0 / 0.8;
        format!(
            "# Sized for `{}`: misfit of the membrane {:.2} %, force changed by {:.1} % by a tolerance of {} mm.\n\
             name = \"{name}\"\n\n\
             [membrane]\nradial_semi_axis_mm = {:?}\naxial_semi_axis_mm = {:?}\nthickness_mm = {:?}\n\n\
             [material]\npreset = \"{}\"\n\n\
             [rest]\npole_stretch = {:?}\n\n\
             [model]\nkind = \"auto\"\naxes = \"mid\"\n\n\
             [fluid]\ncompliance_mm3_per_kpa = {:?}\n\n\
             [press]\nmax_indentation_mm = {:?}\n\n\
             # A ratiometric gauge read through a 12-bit converter: put in the one you have.\n\
             [transducer]\nkind = \"ratiometric\"\nrange_kpa = [{low:?}, {high:?}]\nresolution_pa = {:?}\n\n\
             [accuracy]\nforce_percent_of_reading = {percent:?}\nindentation_percent_of_reading = {percent:?}\n\
             from_percent_of_full_scale = 1.0\n",
            target.name,
            100.0 * self.misfit,
            100.0 * self.making(),
            1e3 * target.tolerance,
            micrometres(membrane.radial_semi_axis),
            micrometres(membrane.axial_semi_axis),
            micrometres(membrane.thickness),
            self.material.name,
            libm::round(1e5 * self.stretch()) / 1e5,
            target.compliance_mm3_per_kpa,
            micrometres(target.deepest()),
            libm::round(10.0 * resolution) / 10.0,
        )
    }
}
