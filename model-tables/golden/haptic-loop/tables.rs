// Tables of the design `haptic-loop`, 224 bytes. Generated: change the design, not this file.

/// Its `name`.
pub const NAME: &str = "haptic-loop";

/// What the firmware needs to know of the design beside its tables.
pub const DESIGN: model_tables::constants::DesignConstants = model_tables::constants::DesignConstants {
    hash: 0x547036dece5f5511,
    table_version: 6,
    certificate: 0xce5f2e04cbc1363c,
    rest_pressure: 0,
    maximum_pressure: 60440,
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
pub type DesignTables = model_tables::table::Tables<14, 4>;

/// Pressure rise -> force and indentation.
pub const TABLES: DesignTables = model_tables::table::Tables {
    layout: model_tables::table::Layout {
        fraction_bits: 5,
        maximum: 1941504,
        bias: 192,
        octaves: 1,
        halvings: 0,
        powers: model_tables::table::Powers::Four,
        constant: model_tables::table::Constant::Half,
        first_index: 11,
        shifts: [0, 0],
    },
    segments: [
        [127081731, 69337476, 154599022, 207879503],
        [106174211, 108659358, 144899377, 78183336],
        [49547533, 82182736, 49937897, 24378283],
        [51513149, 120718304, 20315221, 50592204],
        [27788088, 84280122, 11664626, -29426639],
        [32703222, 108791128, -11011024, 16447139],
        [17957279, 63243311, -6291943, -3605776],
        [18940370, 67765687, -8847754, 6881003],
        [9437442, 35259253, -4653109, 11009814],
        [9306378, 37684161, -7668005, 28639552],
        [4391044, 18088470, -6488116, 27394007],
        [3604610, 16646711, -9306183, 41221952],
        [1507373, 5570875, -14417992, 63896927],
        [-1179575, -7142943, -523904, 2466585],
    ],
};

/// Pressure rise -> force of the feedback actuator, in the layout of [`TABLES`].
pub const FEEDBACK: model_tables::table::feedback::FeedbackTables<14, 2> = model_tables::table::feedback::FeedbackTables {
    scale: model_tables::table::feedback::FeedbackScale { shift: 6, at_rest: 0 },
    segments: [
        [1048396805, -665591817],
        [1143757737, -769523345],
        [568211745, -247918831],
        [556220073, -110752516],
        [275652652, -32176667],
        [274145387, -23132916],
        [136122432, -9436631],
        [134680637, -12778685],
        [65865755, -8388047],
        [63703032, -25491833],
        [29230057, -22280757],
        [23921606, -37942918],
        [7930261, -58847381],
        [-9174493, 21359771],
    ],
};
