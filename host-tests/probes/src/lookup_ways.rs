//! What the image that compares ways to look up and the host that counts their instructions agree on.

/// Inputs of each function at each size.
pub const INPUTS: usize = 64;

/// Knots of the tables that are searched, one size after the other.
pub const SIZES: [usize; 7] = [8, 16, 32, 64, 128, 256, 512];

/// The functions, by the name that the image has for them, and whether their cost depends on the size of the table.
pub const WAYS: [(&str, bool); 15] = [
    ("uniform_q15", false),
    ("uniform_q31", false),
    ("linear_f32", true),
    ("cubic_f32", true),
    ("warped_f32", false),
    ("octave_linear", false),
    ("octave_quadratic", false),
    ("octave_cubic", false),
    ("rational_f32", false),
    ("power_libm", false),
    ("power_micromath", false),
    ("index_fingertip_elastic_tables", false),
    ("paper_prestretched_tables", false),
    ("skin_analogue_tables", false),
    ("skin_light_touch_tables", false),
];
