// Tables of the design `skin-light-touch`, 160 bytes. Generated: change the design, not this file.

/// Its `name`.
pub const NAME: &str = "skin-light-touch";

/// What the firmware needs to know of the design beside its tables.
pub const DESIGN: model_tables::constants::DesignConstants = model_tables::constants::DesignConstants {
    hash: 0x43755a609c58964e,
    table_version: 4,
    certificate: 0x509f9ad5043e9ddd,
    rest_pressure: 1811,
    maximum_pressure: 4133,
    transducer: model_tables::constants::Transducer {
        range: [30000, 120000],
        resolution: 1000,
        noise: 1000,
        quantity: model_tables::constants::Quantity::Absolute,
        kind: model_tables::constants::TransducerKind::Dps310 { address: 119 },
    },
};

/// The type of [`TABLES`].
pub type DesignTables = model_tables::table::Tables<8, 5>;

/// Pressure rise -> force and indentation.
pub const TABLES: DesignTables = model_tables::table::Tables {
    layout: model_tables::table::Layout {
        pressure_fraction_bits: 8,
        maximum: 598016,
        bias: 16,
        octaves: 2,
        halvings: 0,
        powers: model_tables::table::Powers::Four,
        constant: model_tables::table::Constant::Whole,
        first_index: 6,
        force_shift: 0,
        indentation_shift: 0,
    },
    segments: [
        [15279778, 99905711, 38732277, 7273653, 5437795],
        [8263148, 102739119, 15664081, 1441214, -3016568],
        [4980960, 94621943, 7996542, -852573, -1639913],
        [2817081, 76117132, 4719733, -524803, -590763],
        [1495622, 54133508, 2687952, -262469, 130541],
        [749823, 34911997, 1442521, -65720, 130791],
        [352873, 19952030, 721393, -131170, 458582],
        [94884, 6862123, 393566, 65613, -66027],
    ],
};
