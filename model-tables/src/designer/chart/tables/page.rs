//! The page: Markdown around the numbers.

use super::fronts::{self, Front, PERCENTS};
use std::fmt::Write as _;

/// What writes the page.
const COMMAND: &str = "cargo designer chart --tables --out model-tables/tables";

/// The whole page.
pub(super) fn markdown(fronts: &[Front]) -> String {
    let percents = PERCENTS.map(|percent| format!("{percent} %")).join(" | ");
    let mut text = format!(
        "# What the tables cost over designs and accuracies\n\
         \n\
         Written by `{COMMAND}`; a test fails when it is stale.\n\
         \n\
         Bytes / instructions of force and indentation together, at a largest error of so much of reading from 1 % of full scale up\n\
         (the same in absolute terms below), certified over every input; a transducer of 2 Pa. No output falls anywhere. The\n\
         instructions are the lookup's own, from its shape.\n\
         \n\
         | design | pole stretch at rest | octaves | exponent | {percents} |\n\
         |---|---|---|---|---|---|---|---|---|\n"
    );
    for row in fronts::rows(fronts) {
        let _ = writeln!(text, "{row}");
    }
    text.push_str(
        "\nWhat a design needs goes with two of its numbers. *Octaves*: from the pressure at 1 % of the full indentation to that at\n\
         the end; below, the errors are absolute and one segment does. A segment spans two octaves, so half as many segments\n\
         are needed, and one or two for first contact, at 16 bytes each (20 with four powers). *Exponent*: the local power with\n\
         which the indentation follows the pressure, there and at the end; the further it goes, the more each sum has to bend.\n\
         Domes that are hardly stretched at rest touch down softly: most octaves, hence more than 128 bytes at 0.125 %.\n\
         *none*: 16-bit coefficients do not reach so far there.\n",
    );
    text
}
