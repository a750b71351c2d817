// Tables of the design `skin-analogue`, 112 bytes. Generated: change the design, not this file.

/// Its `name`.
pub const NAME: &str = "skin-analogue";

/// What the firmware needs to know of the design beside its tables.
pub const DESIGN: model_tables::constants::DesignConstants = model_tables::constants::DesignConstants {
    hash: 0x021e38b343300df4,
    table_version: 5,
    certificate: 0x7983f97064e31bac,
    rest_pressure: 8269,
    maximum_pressure: 16195,
    transducer: model_tables::constants::Transducer {
        range: [0, 40000],
        resolution: 5000,
        noise: 5000,
        quantity: model_tables::constants::Quantity::Gauge,
        kind: model_tables::constants::TransducerKind::Ratiometric { output: [6554, 58982], supply_measured: false },
    },
    zero: model_tables::constants::ZeroAssumptions::NONE,
};

/// The type of [`TABLES`].
pub type DesignTables = model_tables::table::Tables<7, 4>;

/// Pressure rise -> force and indentation.
pub const TABLES: DesignTables = model_tables::table::Tables {
    layout: model_tables::table::Layout {
        pressure_fraction_bits: 5,
        maximum: 253952,
        bias: 22,
        octaves: 2,
        halvings: 0,
        powers: model_tables::table::Powers::Four,
        constant: model_tables::table::Constant::Half,
        first_index: 7,
        force_shift: 0,
        indentation_shift: 0,
    },
    segments: [
        [107483048, 262539100, 61537043, -14161770],
        [60229283, 262736628, -1312590, -11538937],
        [32768897, 214567980, -4785748, -3475983],
        [16908774, 150538940, -2098082, 64113],
        [8323326, 95029241, -917997, 982275],
        [3670144, 51905891, -721155, 1375765],
        [655426, 12518342, 131298, -1913],
    ],
};
