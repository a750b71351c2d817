// Tables of the design `skin-light-touch`, 128 bytes. Generated: change the design, not this file.

/// Its `name`.
pub const NAME: &str = "skin-light-touch";

/// What the firmware needs to know of the design beside its tables.
pub const DESIGN: model_tables::constants::DesignConstants = model_tables::constants::DesignConstants {
    hash: 0x8e7fbb454372d43d,
    table_version: 6,
    certificate: 0x8f0eaa43d4494c9f,
    rest_pressure: 1825,
    maximum_pressure: 4483,
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
        fraction_bits: 8,
        maximum: 684032,
        bias: 22,
        octaves: 2,
        halvings: 0,
        powers: model_tables::table::Powers::Six,
        constant: model_tables::table::Constant::Half,
        first_index: 6,
        shifts: [5, 0],
    },
    segments: [
        [540628162, 94044757, 411630676, -52628832],
        [318841193, 93586328, -5637139, -270863711],
        [190190105, 71894111, -61670202, -80217020],
        [99683018, 43189160, -18743571, 1638217],
        [49677772, 25428566, -3801168, 7798431],
        [24183537, 15466856, -2031654, 10681964],
        [11272544, 9437402, -7929927, 46595790],
        [2162876, 2752680, -458772, 1309579],
    ],
};
