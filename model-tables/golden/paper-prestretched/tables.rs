// Tables of the design `paper-prestretched`, 112 bytes. Generated: change the design, not this file.

/// Its `name`.
pub const NAME: &str = "paper-prestretched";

/// What the firmware needs to know of the design beside its tables.
pub const DESIGN: model_tables::constants::DesignConstants = model_tables::constants::DesignConstants {
    hash: 0x0b0805c0f73222b7,
    table_version: 6,
    certificate: 0x56953ec9b104b038,
    rest_pressure: 179062,
    maximum_pressure: 278482,
    transducer: model_tables::constants::Transducer {
        range: [0, 400000],
        resolution: 20000,
        noise: 40000,
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
        fraction_bits: 5,
        maximum: 3194880,
        bias: 576,
        octaves: 2,
        halvings: 0,
        powers: model_tables::table::Powers::Four,
        constant: model_tables::table::Constant::Half,
        first_index: 5,
        shifts: [0, 0],
    },
    segments: [
        [480660739, 70386266, 312868580, 55245110],
        [241049302, 66388766, 36765179, 982013],
        [121769621, 50135855, -196981, 2293268],
        [60426051, 33096339, -2031803, 3079921],
        [28771232, 19792332, -2490463, 4915050],
        [11796923, 9634091, -8388661, 16514958],
        [-982805, -458545, 196659, 326500],
    ],
};
