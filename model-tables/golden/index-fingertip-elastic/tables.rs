// Tables of the design `index-fingertip-elastic`, 128 bytes. Generated: change the design, not this file.

/// Its `name`.
pub const NAME: &str = "index-fingertip-elastic";

/// What the firmware needs to know of the design beside its tables.
pub const DESIGN: model_tables::constants::DesignConstants = model_tables::constants::DesignConstants {
    hash: 0xe2df7fbb5c5fdaa7,
    table_version: 6,
    certificate: 0x32b43230c4274da1,
    rest_pressure: 0,
    maximum_pressure: 82911,
    transducer: model_tables::constants::Transducer {
        range: [0, 100000],
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
        fraction_bits: 5,
        maximum: 2654208,
        bias: 64,
        octaves: 2,
        halvings: 0,
        powers: model_tables::table::Powers::Four,
        constant: model_tables::table::Constant::Half,
        first_index: 5,
        shifts: [0, 0],
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
