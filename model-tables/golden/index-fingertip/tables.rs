// Tables of the design `index-fingertip`, 160 bytes. Generated: change the design, not this file.

/// Its `name`.
pub const NAME: &str = "index-fingertip";

/// What the firmware needs to know of the design beside its tables.
pub const DESIGN: model_tables::constants::DesignConstants = model_tables::constants::DesignConstants {
    hash: 0x2a86bd08600d07db,
    table_version: 6,
    certificate: 0xe6536fcff1b75a00,
    rest_pressure: 0,
    maximum_pressure: 82911,
    transducer: model_tables::constants::Transducer {
        range: [-10000, 100000],
        resolution: 10000,
        noise: 10000,
        quantity: model_tables::constants::Quantity::Gauge,
        kind: model_tables::constants::TransducerKind::Ratiometric { output: [6554, 58982], supply_measured: false },
    },
    zero: model_tables::constants::ZeroAssumptions::NONE,
};

/// The type of [`TABLES`].
pub type DesignTables = model_tables::table::Tables<10, 4>;

/// Pressure rise -> force and indentation.
pub const TABLES: DesignTables = model_tables::table::Tables {
    layout: model_tables::table::Layout {
        fraction_bits: 6,
        maximum: 5308416,
        bias: 16,
        octaves: 2,
        halvings: 0,
        powers: model_tables::table::Powers::Six,
        constant: model_tables::table::Constant::Half,
        first_index: 4,
        shifts: [0, 3],
    },
    segments: [
        [490879020, 632408918, -472743935, 2147450879],
        [107289535, 502860495, 218821299, 172210610],
        [43780146, 603066351, 53275571, 12755002],
        [25363161, 617289434, 5039064, -29188735],
        [16122228, 455613838, -6296816, -8325420],
        [8454377, 261101460, -1508620, -197906],
        [4259965, 154209820, -393811, 587978],
        [2097215, 93915188, -459142, 3668022],
        [1048605, 54723908, -917859, 5504139],
        [262160, 19858320, 65450, 128804],
    ],
};

/// The wall in time: only a wall that relaxes has it.
pub const RELAXATION: model_tables::material::series::WallSeries = model_tables::material::series::WallSeries {
    remaining_permille: 30,
    fluid_least: 14379,
    fluid_half: 925880,
    weight_gain: 20722,
    weight_half: 67294,
    retouch: 17317,
    temperature_gain: 25493,
    step: model_tables::material::series::SeriesStep {
        count: 7,
        stiffness: 26814138,
        settled: model_tables::material::series::Factor { mantissa: 2687298560, shift: 8 },
        forgets: model_tables::material::series::Factor { mantissa: 2198473591, shift: 10 },
        terms: [
            model_tables::material::series::TermStep { lost: model_tables::material::series::Factor { mantissa: 2714937127, shift: 0 }, share: model_tables::material::series::Factor { mantissa: 2924943324, shift: 0 } },
            model_tables::material::series::TermStep { lost: model_tables::material::series::Factor { mantissa: 3269761419, shift: 3 }, share: model_tables::material::series::Factor { mantissa: 2187692539, shift: 1 } },
            model_tables::material::series::TermStep { lost: model_tables::material::series::Factor { mantissa: 2735080873, shift: 6 }, share: model_tables::material::series::Factor { mantissa: 3138498040, shift: 4 } },
            model_tables::material::series::TermStep { lost: model_tables::material::series::Factor { mantissa: 2197924110, shift: 9 }, share: model_tables::material::series::Factor { mantissa: 2994168735, shift: 6 } },
            model_tables::material::series::TermStep { lost: model_tables::material::series::Factor { mantissa: 3518261293, shift: 13 }, share: model_tables::material::series::Factor { mantissa: 4165104509, shift: 8 } },
            model_tables::material::series::TermStep { lost: model_tables::material::series::Factor { mantissa: 2814735693, shift: 16 }, share: model_tables::material::series::Factor { mantissa: 2150903013, shift: 9 } },
            model_tables::material::series::TermStep { lost: model_tables::material::series::Factor { mantissa: 2251798688, shift: 19 }, share: model_tables::material::series::Factor { mantissa: 2323974632, shift: 10 } },
            model_tables::material::series::TermStep { lost: model_tables::material::series::Factor { mantissa: 0, shift: 0 }, share: model_tables::material::series::Factor { mantissa: 0, shift: 0 } },
        ],
    },
};
