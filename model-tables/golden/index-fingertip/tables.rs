// Tables of the design `index-fingertip`, 144 bytes. Generated: change the design, not this file.

/// What the firmware needs to know of the design beside its tables.
pub const DESIGN: model_tables::constants::DesignConstants = model_tables::constants::DesignConstants {
    name: "index-fingertip",
    hash: 0xc0a22711ecc209f2,
    table_version: 3,
    certificate: 0xd10e0b3548d61cca,
    rest_pressure: 8965,
    maximum_pressure: 73731,
    transducer: model_tables::constants::Transducer {
        range: [0, 100000],
        resolution: 10000,
        noise: 10000,
        kind: model_tables::constants::TransducerKind::Ratiometric { output: [6554, 58982] },
    },
};

/// The type of [`TABLES`].
pub type DesignTables = model_tables::table::Tables<9, 4>;

/// Pressure rise -> force and indentation.
pub const TABLES: DesignTables = model_tables::table::Tables {
    layout: model_tables::table::Layout {
        pressure_fraction_bits: 5,
        maximum: 2097151,
        bias: 16,
        octaves: 2,
        halvings: 0,
        powers: model_tables::table::Powers::Four,
        constant: model_tables::table::Constant::Half,
        first_index: 5,
        force_shift: 0,
        indentation_shift: 0,
    },
    segments: [
        [297746401, 95026922, 260307238, 453443150],
        [105649280, 107807397, 123731523, 35256136],
        [54920984, 119735314, 22347138, -15862003],
        [33030977, 115803396, -3801847, -11339634],
        [19136989, 96994647, -4719233, -3540279],
        [10486030, 71566536, -4653503, 4717823],
        [5505166, 47383479, -4194572, 7208551],
        [3538983, 27591324, -13828243, 27262729],
        [720937, 9634274, -196497, 195879],
    ],
};
