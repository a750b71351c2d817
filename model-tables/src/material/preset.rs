//! Materials by name: constants from published tests, with their range of validity.
//!
//! Starting points, not properties of a part: published moduli of one and the same product differ by a factor of two,
//! so a part is calibrated on the bench. The silicones are Yeoh laws: a Mooney-Rivlin law fitted to rubber that
//! stiffens in uniaxial tension gets `C2 < 0`, which is unstable under equal stretches both ways and so useless for a
//! membrane. A Yeoh law with `C3 < 0` holds only inside the strain it was fitted to: [`Preset::largest_invariant`].

use super::Law;
use super::relaxation::{AGILUS30_RELAXATION, Relaxation};

/// A material by name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// Its name in a design file.
    pub name: &'static str,
    /// Its name for people.
    pub title: &'static str,
    /// The constants, pascals.
    pub law: Law,
    /// How it relaxes, which a design takes by `[material.relaxation] preset`; `None` where no published series
    /// exists.
    pub relaxation: Option<Relaxation>,
    /// Where they come from.
    pub source: &'static str,
    /// How fast the test was.
    pub rate: &'static str,
    /// Largest engineering strain of the uniaxial test that was fitted, dimensionless; `None` where it is not known.
    pub strain: Option<f64>,
    /// Behaviour of the material beyond a static law.
    pub caution: &'static str,
}

const DATABASE: &str = "least-squares fit to uniaxial tension, engineering stress, one specimen: Soft Robotics Materials \
                        Database, Marechal et al. 2020, doi 10.1089/soro.2019.0115";
const DATABASE_RATE: &str = "450 mm/min";
const SILICONE: &str = "softens in its first cycles (Mullins): press it several times before a calibration; a soft pad \
                        relaxes 7 to 10 % of its force in a hold of 2 s";

const fn silicone(name: &'static str, title: &'static str, c1: f64, c2: f64, c3: f64) -> Preset {
    Preset {
        name,
        title,
        law: Law::Yeoh { c1, c2, c3 },
        relaxation: None,
        source: DATABASE,
        rate: DATABASE_RATE,
        strain: Some(1.0),
        caution: SILICONE,
    }
}

/// Agilus30, relaxed: Shi et al., Soft Matter 18 (2022) 9076.
pub const AGILUS30: Law = Law::MooneyRivlin {
    c1: 160_355.0,
    c2: 46_559.0,
};
/// Human fingertip skin: Serina et al. 1998, as Shi et al. use it.
pub const SKIN: Law = Law::MooneyRivlin {
    c1: 13_400.0,
    c2: 29_500.0,
};

/// Every material with a name.
pub const PRESETS: [Preset; 13] = [
    silicone("ecoflex-00-10", "Ecoflex 00-10", 3.52e3, 0.256e3, -0.030e3),
    Preset {
        caution: "another group's uniaxial test and an inflation give C1 = 16 kPa, twice this one; softens in its first \
                  cycles (Mullins): press it several times before a calibration; a soft pad relaxes 7 to 10 % of its \
                  force in a hold of 2 s",
        ..silicone("ecoflex-00-30", "Ecoflex 00-30", 7.18e3, 0.619e3, -0.114e3)
    },
    silicone("ecoflex-00-50", "Ecoflex 00-50", 9.83e3, 0.912e3, -0.156e3),
    silicone(
        "dragon-skin-10",
        "Dragon Skin 10 Medium",
        20.4e3,
        4.47e3,
        -0.534e3,
    ),
    silicone("dragon-skin-20", "Dragon Skin 20", 55.4e3, 14.8e3, -2.04e3),
    silicone("dragon-skin-30", "Dragon Skin 30", 86.6e3, 13.8e3, -1.47e3),
    silicone("platsil-gel-10", "PlatSil Gel 10", 25.8e3, 5.36e3, -0.464e3),
    silicone("mold-star-16", "Mold Star 16 Fast", 40.7e3, 3.58e3, -0.185e3),
    silicone("mold-star-20t", "Mold Star 20T", 54.0e3, 4.07e3, -0.184e3),
    silicone("sortaclear-40", "SortaClear 40", 139e3, 5.25e3, 0.087e3),
    silicone("rtv615", "RTV615", 166e3, 12.8e3, 0.944e3),
    Preset {
        name: "agilus30",
        title: "Agilus30",
        law: AGILUS30,
        relaxation: Some(AGILUS30_RELAXATION),
        source: "Shi et al., Soft Matter 18 (2022) 9076; small-strain modulus 1.24 MPa",
        rate: "relaxed",
        strain: None,
        caution: "Agilus30 is a viscoelastic glass-former at room temperature, and these constants are its relaxed \
                  stiffness: a press of 30 s meets about 2.2 times, one of 1 s about 9 times as much, and at 1 Hz it \
                  loses about 13 % per kelvin between 20 and 25 degC; forces read from pressure inherit this",
    },
    Preset {
        name: "skin",
        title: "human fingertip skin",
        law: SKIN,
        relaxation: None,
        source: "Serina et al. 1998, as Shi et al., Soft Matter 18 (2022) 9076, use it",
        rate: "not stated",
        strain: None,
        caution: "constants of a fingertip model, not of a material that can be bought",
    },
];

impl Preset {
    /// The material of that name.
    pub fn named(name: &str) -> Option<&'static Self> {
        PRESETS.iter().find(|preset| preset.name == name)
    }

    /// The material that has these constants.
    pub fn of(law: &Law) -> Option<&'static Self> {
        PRESETS.iter().find(|preset| preset.law == *law)
    }

    /// `I1 - 3` at the largest strain of the test: the measure in which a law of `I1` alone carries over from one
    /// kind of stretch to another.
    pub fn largest_invariant(&self) -> Option<f64> {
        self.strain.map(|strain| {
            let stretch = 1.0 + strain;
            stretch * stretch + 2.0 / stretch - 3.0
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Hyperelastic as _;
    use crate::material::stability;

    #[test]
    fn names_are_unique_and_found() {
        for (i, preset) in PRESETS.iter().enumerate() {
            assert_eq!(Preset::named(preset.name), Some(preset));
            assert_eq!(Preset::of(&preset.law), Some(preset), "{}", preset.name);
            assert!(PRESETS[..i].iter().all(|other| other.name != preset.name));
        }
        assert_eq!(Preset::named("rubber"), None);
    }

    /// The neo-Hookean constants fitted to the same tests up to a strain of 1 give a stress there that the Yeoh laws
    /// have to meet within their common misfit.
    #[test]
    fn yeoh_laws_agree_with_neo_hookean_fits_of_the_same_tests() {
        let neo_hookean = [
            ("ecoflex-00-10", 3.98),
            ("ecoflex-00-30", 8.07),
            ("ecoflex-00-50", 11.2),
            ("dragon-skin-10", 28.2),
            ("dragon-skin-20", 80.2),
            ("dragon-skin-30", 111.0),
            ("platsil-gel-10", 36.2),
            ("mold-star-16", 48.1),
            ("mold-star-20t", 62.5),
            ("sortaclear-40", 152.0),
            ("rtv615", 201.0),
        ];
        for (name, c1) in neo_hookean {
            let law = Preset::named(name).expect("listed").law;
            // Mean engineering stress of uniaxial tension over the fitted strain: the energy at its end.
            let energy = |law: &Law| law.energy(2.0, core::f64::consts::FRAC_1_SQRT_2);
            let ratio = energy(&law) / energy(&Law::NeoHookean { c1: c1 * 1e3 });
            assert!((0.9..1.05).contains(&ratio), "{name}: {ratio}");
        }
    }

    #[test]
    fn every_law_is_stable_where_it_was_fitted() {
        for preset in PRESETS {
            let reach = preset.largest_invariant().unwrap_or(2.0);
            let limit = stability::equibiaxial_limit(&preset.law, 3.0);
            let invariant = |l: f64| 2.0 * l * l + 1.0 / (l * l * l * l) - 3.0;
            assert!(
                limit.is_none_or(|stretch| invariant(stretch) > reach),
                "{}: {limit:?}",
                preset.name
            );
        }
    }

    /// Strain 1 is stretch 2: `4 + 2 / 2 - 3`.
    #[test]
    fn range_is_stated_as_an_invariant() {
        assert_eq!(
            Preset::named("rtv615").and_then(Preset::largest_invariant),
            Some(2.0)
        );
        assert_eq!(
            Preset::named("agilus30").and_then(Preset::largest_invariant),
            None
        );
    }
}
