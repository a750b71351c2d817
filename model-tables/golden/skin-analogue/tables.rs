// Tables of the design `skin-analogue`, 128 bytes. Generated: change the design, not this file.

/// Its `name`.
pub const NAME: &str = "skin-analogue";

/// What the firmware needs to know of the design beside its tables.
pub const DESIGN: model_tables::constants::DesignConstants = model_tables::constants::DesignConstants {
    hash: 0x390d166db74fda12,
    table_version: 6,
    certificate: 0x68ec0d1f164f222b,
    rest_pressure: 8312,
    maximum_pressure: 16418,
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
pub type DesignTables = model_tables::table::Tables<8, 4>;

/// Pressure rise -> force and indentation.
pub const TABLES: DesignTables = model_tables::table::Tables {
    layout: model_tables::table::Layout {
        fraction_bits: 6,
        maximum: 524287,
        bias: 44,
        octaves: 2,
        halvings: 0,
        powers: model_tables::table::Powers::Four,
        constant: model_tables::table::Constant::Half,
        first_index: 6,
        shifts: [0, 0],
    },
    segments: [
        [117314243, 186253381, 59176162, 60815057],
        [58525526, 185206437, 15661919, -14356162],
        [32703357, 161286246, -4457711, -3475739],
        [17105382, 113641490, -2032414, -852867],
        [8519937, 71173612, -655749, 523991],
        [3997827, 42206193, -327734, 785885],
        [1572925, 22479494, -1769481, 3734598],
        [-393183, -6618517, -196092, 1031712],
    ],
};
