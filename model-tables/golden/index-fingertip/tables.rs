// Tables of the design `index-fingertip`, 128 bytes. Generated: change the design, not this file.

/// Its `name`.
pub const NAME: &str = "index-fingertip";

/// What the firmware needs to know of the design beside its tables.
pub const DESIGN: model_tables::constants::DesignConstants = model_tables::constants::DesignConstants {
    hash: 0x2a86bd08600d07db,
    table_version: 5,
    certificate: 0xb388a31c80ba325c,
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
pub type DesignTables = model_tables::table::Tables<8, 4>;

/// Pressure rise -> force and indentation.
pub const TABLES: DesignTables = model_tables::table::Tables {
    layout: model_tables::table::Layout {
        pressure_fraction_bits: 5,
        maximum: 2654208,
        bias: 64,
        octaves: 2,
        halvings: 0,
        powers: model_tables::table::Powers::Four,
        constant: model_tables::table::Constant::Half,
        first_index: 5,
        force_shift: 0,
        indentation_shift: 0,
    },
    segments: [
        [275007496, 77332931, 476446519, 354482855],
        [94115055, 97059463, 139263660, 63109152],
        [45221537, 108266424, 34078191, -13240869],
        [28902075, 98436300, -2753661, -17302623],
        [16843170, 60294413, -7012725, 2424579],
        [8585451, 34407236, -4325495, 6750064],
        [4522086, 18940411, -8847401, 17235838],
        [1048640, 7274836, 88, 64895],
    ],
};

/// The wall in time: only a wall that relaxes has it.
pub const RELAXATION: model_tables::material::series::WallSeries = model_tables::material::series::WallSeries {
    remaining_permille: 30,
    fluid_half: 332368,
    step: model_tables::material::series::SeriesStep {
        count: 7,
        stiffness: 26814138,
        settled: model_tables::material::series::Factor { mantissa: 2687298560, shift: 8 },
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
