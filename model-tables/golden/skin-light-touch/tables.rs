// Tables of the design `skin-light-touch`, 128 bytes. Generated: change the design, not this file.

/// Its `name`.
pub const NAME: &str = "skin-light-touch";

/// What the firmware needs to know of the design beside its tables.
pub const DESIGN: model_tables::constants::DesignConstants = model_tables::constants::DesignConstants {
    hash: 0xcf52ef64f58d3e8b,
    table_version: 5,
    certificate: 0x116569d925b98743,
    rest_pressure: 1811,
    maximum_pressure: 4133,
    transducer: model_tables::constants::Transducer {
        range: [30000, 120000],
        resolution: 1000,
        noise: 1000,
        quantity: model_tables::constants::Quantity::Absolute,
        kind: model_tables::constants::TransducerKind::Dps310 { address: 119 },
    },
    zero: model_tables::constants::ZeroAssumptions::NONE,
};

/// The type of [`TABLES`].
pub type DesignTables = model_tables::table::Tables<8, 4>;

/// Pressure rise -> force and indentation.
pub const TABLES: DesignTables = model_tables::table::Tables {
    layout: model_tables::table::Layout {
        pressure_fraction_bits: 8,
        maximum: 598016,
        bias: 16,
        octaves: 2,
        halvings: 0,
        powers: model_tables::table::Powers::Four,
        constant: model_tables::table::Constant::Half,
        first_index: 6,
        force_shift: 5,
        indentation_shift: 0,
    },
    segments: [
        [490817902, 101908874, 213646241, 185793125],
        [263724534, 102761425, 50199997, -106956663],
        [159780658, 94635134, -33227357, -48170474],
        [90310909, 76153973, -20709893, -16581546],
        [47711525, 54133712, -9175365, 589293],
        [23855814, 34931416, -3080378, 2096872],
        [11796817, 19923441, -10944610, 20315991],
        [3080385, 6881630, 1507404, -2556395],
    ],
};
