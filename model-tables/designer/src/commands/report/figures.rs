//! The figures of a report as files of their own, and the numbers behind them as CSV.

use super::findings::Findings;
use super::{charts, logarithmic, shapes};
use output::Refusal;
use output::rows::{Cell, Format, Rows};

const STATES: &[&str] = &[
    "indentation_mm",
    "force_n",
    "pressure_rise_kpa",
    "contact_radius_mm",
];
const TABLES: &[&str] = &[
    "pressure_rise_kpa",
    "force_n",
    "indentation_mm",
    "force_error_percent",
    "indentation_error_percent",
];
const MERIDIANS: &[&str] = &[
    "state_indentation_mm",
    "parameter_deg",
    "radius_mm",
    "height_mm",
    "meridional_stretch",
    "hoop_stretch",
    "meridional_tension_n_per_m",
    "hoop_tension_n_per_m",
];

/// A picture of a page as a file: with its own ground and type.
fn alone(svg: &str) -> Vec<u8> {
    svg.replacen(
        "role=\"img\">",
        "role=\"img\" font-family=\"Helvetica, Arial, sans-serif\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>",
        1,
    )
    .into_bytes()
}

/// Every figure and table of numbers, with the names of their files.
pub(super) fn files(found: &Findings) -> Result<Vec<(String, Vec<u8>)>, Refusal> {
    let name = &found.file.name;
    let mut files = Vec::new();
    let mut picture = |what: &str, svg: &str| files.push((format!("{name}-{what}.svg"), alone(svg)));
    for (k, svg) in shapes::draw(found).iter().enumerate() {
        picture(&format!("shape-{}", k + 1), svg);
    }
    picture("force", &charts::force(found));
    picture("pressure", &charts::pressure(found));
    picture("contact", &charts::contact(found));
    picture("readout", &charts::readout(found));
    picture("depth", &charts::depth(found));
    if let Some(svg) = logarithmic::errors(found) {
        picture("error", &svg);
    }
    let along = [
        "stretch-along",
        "stretch-around",
        "tension-along",
        "tension-around",
    ];
    for (what, svg) in along.iter().zip(charts::meridians(found)) {
        picture(what, &svg);
    }
    if let Some(svg) = charts::speed(&found.costs) {
        picture("speed", &svg);
    }
    for (what, rows) in [
        ("states", states(found)),
        ("tables", tables(found)),
        ("meridians", meridians(found)),
    ] {
        let text = rows.print(Format::Csv).map_err(Refusal)?;
        files.push((format!("{name}-{what}.csv"), text.into_bytes()));
    }
    Ok(files)
}

fn states(found: &Findings) -> Rows {
    let gain = found.file.calibration.pressure_gain;
    let mut rows = Rows::new(STATES);
    for state in &found.states {
        rows.push(vec![
            Cell::Number(1e3 * state.indentation),
            Cell::Number(state.force),
            Cell::Number(1e-3 * gain * state.pressure_rise),
            Cell::Number(1e3 * state.contact_radius),
        ]);
    }
    rows
}

fn tables(found: &Findings) -> Rows {
    let mut rows = Rows::new(TABLES);
    for reading in &found.table_readings {
        let [force, indentation] = reading
            .errors
            .map_or([Cell::Empty, Cell::Empty], |errors| errors.map(Cell::Number));
        rows.push(vec![
            Cell::Number(1e-3 * reading.pressure_rise),
            Cell::Number(reading.force),
            Cell::Number(1e3 * reading.indentation),
            force,
            indentation,
        ]);
    }
    rows
}

fn meridians(found: &Findings) -> Rows {
    let mut rows = Rows::new(MERIDIANS);
    for meridian in &found.meridians {
        for point in &meridian.points {
            rows.push(vec![
                Cell::Number(1e3 * meridian.indentation),
                Cell::Number(point.parameter.to_degrees()),
                Cell::Number(1e3 * point.radius),
                Cell::Number(1e3 * point.height),
                Cell::Number(point.stretches[0]),
                Cell::Number(point.stretches[1]),
                Cell::Number(point.tensions[0]),
                Cell::Number(point.tensions[1]),
            ]);
        }
    }
    rows
}
