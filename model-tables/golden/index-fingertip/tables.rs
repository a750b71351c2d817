// Tables of the design `index-fingertip`, 128 bytes. Generated: change the design, not this file.

/// Its `name`.
pub const NAME: &str = "index-fingertip";

/// What the firmware needs to know of the design beside its tables.
pub const DESIGN: model_tables::constants::DesignConstants = model_tables::constants::DesignConstants {
    hash: 0xb0b47dd1ad5990fa,
    table_version: 5,
    certificate: 0x4332dbbd67be216c,
    rest_pressure: 0,
    maximum_pressure: 82911,
    transducer: model_tables::constants::Transducer {
        range: [-10000, 100000],
        resolution: 10000,
        noise: 10000,
        quantity: model_tables::constants::Quantity::Gauge,
        kind: model_tables::constants::TransducerKind::Ratiometric { output: [6554, 58982], supply_measured: false },
    },
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
    step: model_tables::material::series::SeriesStep {
        count: 7,
        inverse: model_tables::material::series::Factor { mantissa: 2687298560, shift: 40 },
        terms: [
            model_tables::material::series::TermStep { lost: model_tables::material::series::Factor { mantissa: 2714937127, shift: 32 }, taken: model_tables::material::series::Factor { mantissa: 2337391183, shift: 23 } },
            model_tables::material::series::TermStep { lost: model_tables::material::series::Factor { mantissa: 3269761419, shift: 35 }, taken: model_tables::material::series::Factor { mantissa: 3496473392, shift: 25 } },
            model_tables::material::series::TermStep { lost: model_tables::material::series::Factor { mantissa: 2735080873, shift: 38 }, taken: model_tables::material::series::Factor { mantissa: 2508047793, shift: 27 } },
            model_tables::material::series::TermStep { lost: model_tables::material::series::Factor { mantissa: 2197924110, shift: 41 }, taken: model_tables::material::series::Factor { mantissa: 2392710842, shift: 29 } },
            model_tables::material::series::TermStep { lost: model_tables::material::series::Factor { mantissa: 3518261293, shift: 45 }, taken: model_tables::material::series::Factor { mantissa: 3328433230, shift: 31 } },
            model_tables::material::series::TermStep { lost: model_tables::material::series::Factor { mantissa: 2814735693, shift: 48 }, taken: model_tables::material::series::Factor { mantissa: 3437674635, shift: 33 } },
            model_tables::material::series::TermStep { lost: model_tables::material::series::Factor { mantissa: 2251798688, shift: 51 }, taken: model_tables::material::series::Factor { mantissa: 3714285860, shift: 34 } },
            model_tables::material::series::TermStep { lost: model_tables::material::series::Factor { mantissa: 0, shift: 0 }, taken: model_tables::material::series::Factor { mantissa: 0, shift: 0 } },
        ],
    },
};
