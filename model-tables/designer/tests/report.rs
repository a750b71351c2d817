//! The page of `designer report`, read as a parser of XML reads it: complete in itself, every number with its unit, and the
//! numbers those of independent solutions.

use model_tables::design_file::DesignFile;
use roxmltree::{Document, Node, ParsingOptions};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../designs/{name}.toml"))
}

/// An empty folder of its own for a test.
fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("report-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("the test folder");
    folder
}

fn report(design: &Path, out: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_designer"))
        .arg("report")
        .arg(design)
        .arg("--out")
        .arg(out)
        .output()
        .expect("the binary runs")
}

/// The page of a design.
fn page(design: &Path, name: &str) -> String {
    let out = scratch(name).join("out");
    let output = report(design, &out);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let written: Vec<_> = fs::read_dir(&out).expect("made").collect();
    assert_eq!(written.len(), 1, "one file a design");
    let file = written[0].as_ref().expect("listed").path();
    let rows = String::from_utf8(output.stdout).expect("text");
    assert!(rows.contains(&file.display().to_string()), "{rows}");
    fs::read_to_string(file).expect("written")
}

fn parsed(text: &str) -> Document<'_> {
    let options = ParsingOptions {
        allow_dtd: true,
        ..ParsingOptions::default()
    };
    Document::parse_with_options(text, options).expect("well-formed")
}

fn text_of(node: Node<'_, '_>) -> String {
    node.descendants()
        .filter_map(|inner| inner.is_text().then(|| inner.text())?)
        .collect()
}

fn class<'a>(node: Node<'a, '_>) -> &'a str {
    node.attribute("class").unwrap_or_default()
}

/// Nothing that a browser would fetch; pictures have words; numbers have units.
fn is_complete(document: &Document<'_>) {
    let mut numbers = 0;
    for node in document.descendants().filter(Node::is_element) {
        let name = node.tag_name().name();
        assert!(
            !["script", "link", "img", "iframe", "object", "image", "use"].contains(&name),
            "<{name}>"
        );
        for attribute in node.attributes() {
            assert!(
                !["src", "href", "srcset", "data", "style"].contains(&attribute.name()),
                "{attribute:?}"
            );
        }
        match name {
            "style" => {
                let style = text_of(node);
                assert!(!style.contains("url(") && !style.contains("@import"));
            }
            "svg" => {
                for words in ["title", "desc"] {
                    let child = node
                        .children()
                        .find(|child| child.has_tag_name((node.tag_name().namespace().unwrap_or(""), words)));
                    assert!(
                        child.is_some_and(|child| !text_of(child).is_empty()),
                        "{words} of a picture"
                    );
                }
            }
            "td" => {
                let cell = text_of(node);
                if cell.contains(|c: char| c.is_ascii_digit()) && class(node) == "value" {
                    let unit = node.descendants().any(|inner| class(inner) == "unit");
                    let word = cell.starts_with(char::is_alphabetic);
                    assert!(unit || word, "{cell} has no unit");
                }
            }
            _ => {}
        }
        if class(node) == "number" {
            numbers += 1;
            let unit = node.next_sibling_element().filter(|next| class(*next) == "unit");
            assert!(
                unit.is_some_and(|unit| !text_of(unit).is_empty()),
                "{}",
                text_of(node)
            );
        }
    }
    assert!(numbers > 50, "{numbers} numbers");
}

/// The cells of the row of that name.
fn row(document: &Document<'_>, words: &str) -> Vec<String> {
    let cells = document
        .descendants()
        .filter(|node| node.tag_name().name() == "tr")
        .map(|row| {
            row.children()
                .filter(Node::is_element)
                .map(text_of)
                .collect::<Vec<_>>()
        })
        .find(|cells| cells[0] == words);
    let Some(cells) = cells else {
        panic!("no row {words}");
    };
    cells[1..].to_vec()
}

fn value(cell: &str, unit: &str) -> f64 {
    cell.strip_suffix(unit)
        .and_then(|number| number.trim_end().parse().ok())
        .unwrap_or_else(|| panic!("{cell} in {unit}"))
}

fn near(found: f64, truth: f64) {
    assert!((found / truth - 1.0).abs() < 1e-3, "{found} for {truth}");
}

/// Reference: collocation cross-checked by shooting.
#[test]
fn a_page_of_a_membrane_has_the_reference_states_and_the_certificate() {
    let file = shipped("paper-prestretched");
    let text = page(&file, "membrane");
    let document = parsed(&text);
    is_complete(&document);
    near(
        value(&row(&document, "rest pressure, gauge")[0], "kPa"),
        179.061_844,
    );
    near(
        value(&row(&document, "radius of the equator")[0], "mm"),
        8.575_201,
    );
    near(
        value(&row(&document, "volume of the fluid")[0], "mm\u{b3}"),
        1_242.150,
    );
    near(value(&row(&document, "limit of the press")[0], "mm"), 4.166_107);
    let design = DesignFile::read(&file).expect("shipped");
    let mut hash = String::new();
    for byte in design.hash() {
        let _ = write!(hash, "{byte:02x}");
    }
    assert!(text.contains(&hash));
    let allowed = row(&document, "allowed");
    let largest = row(&document, "largest");
    for (largest, allowed) in largest.iter().zip(&allowed) {
        assert!(
            value(largest, "%") <= value(allowed, "%"),
            "{largest} of {allowed}"
        );
    }
    // The material is Agilus30, and the page says what that means.
    assert!(text.contains("viscoelastic") && text.contains("not a medical device"));
    // The press, four sections, four charts along the meridian, two of the tables, speed.
    let pictures = document
        .descendants()
        .filter(|node| node.tag_name().name() == "svg")
        .count();
    assert_eq!(pictures, 4 + 4 + 4 + 2 + 1);
    let labels: Vec<String> = document
        .descendants()
        .filter(|node| node.tag_name().name() == "text" && node.attribute("transform").is_some())
        .map(text_of)
        .collect();
    assert!(
        labels.len() >= 11 && labels.iter().all(|label| label.contains(" / ")),
        "{labels:?}"
    );
}

/// An independent finite-element solution of the printed part.
#[test]
fn a_page_of_a_solid_leaves_out_what_has_no_meaning() {
    let folder = scratch("solid-design");
    let file = folder.join("printed.toml");
    fs::write(
        &file,
        "name = \"printed\"\n[membrane]\nradial_semi_axis_mm = 9\naxial_semi_axis_mm = 7\nthickness_mm = 1\n\
         [material]\npreset = \"agilus30\"\n[model]\nkind = \"solid\"\nthrough = 2\nalong = 24\n\
         [press]\nmax_indentation_mm = 2\n[actuator]\ndiameter_mm = 9\n",
    )
    .expect("the test folder");
    let text = page(&file, "solid");
    let document = parsed(&text);
    is_complete(&document);
    let states = row(&document, "2\u{a0}mm");
    assert!((value(&states[0], "N") / 5.754 - 1.0).abs() < 0.015, "{states:?}");
    assert!(
        (value(&states[1], "kPa") / 41.5 - 1.0).abs() < 0.015,
        "{states:?}"
    );
    assert!(text.contains("the design has no <code>[transducer]</code>"));
    assert!(text.contains("Feedback actuator") && !text.contains("A membrane does not bend"));
}

#[test]
fn a_design_without_tables_gives_a_reason_and_no_page() {
    let folder = scratch("refused");
    let file = folder.join("narrow.toml");
    let text = fs::read_to_string(shipped("index-fingertip-elastic")).expect("shipped");
    fs::write(
        &file,
        text.replace("range_kpa = [0.0, 100.0]", "range_kpa = [0.0, 10.0]"),
    )
    .expect("the test folder");
    let output = report(&file, &folder.join("out"));
    assert_eq!(output.status.code(), Some(1));
    assert!(output.stdout.is_empty());
    let reason = String::from_utf8(output.stderr).expect("text");
    assert!(
        reason.lines().count() == 1 && reason.contains("transducer.range_kpa = [0, 10]"),
        "{reason}"
    );
    assert!(!folder.join("out").exists());
}

/// The printed fingertip pressed to 5 N in 1 s at an even speed: an independent finite-element code, with static tables over its own
/// press, reads
/// 8.26 N and 2.18 mm at a true 0.566 mm. With a force that grows evenly the wall creeps deeper.
#[test]
fn a_page_of_a_wall_that_relaxes_says_what_static_tables_make_of_it() {
    let folder = scratch("relaxing");
    let design = folder.join("relaxing.toml");
    let text = "name = \"relaxing\"\n\
        [membrane]\nradial_semi_axis_mm = 9\naxial_semi_axis_mm = 7\nthickness_mm = 1\n\
        [material]\npreset = \"agilus30\"\n[material.relaxation]\npreset = \"agilus30\"\n\
        [model]\nkind = \"solid\"\nthrough = 1\nalong = 24\n\
        [press]\nmax_indentation_mm = 2.5\n\
        [transducer]\nkind = \"ratiometric\"\nrange_kpa = [-10, 900]\nresolution_pa = 100\n\
        [accuracy]\nforce_percent_of_reading = 1\nindentation_percent_of_reading = 1\nfrom_percent_of_full_scale = 1\n";
    fs::write(&design, text).expect("the test folder");
    let text = page(&design, "relaxing-out");
    let document = parsed(&text);
    is_complete(&document);
    let row = row(&document, "1\u{a0}s");
    // A third of the 14.69 N at 2.5 mm.
    assert!((value(&row[1], "N") - 4.9).abs() < 0.1, "{row:?}");
    assert!(
        (value(&row[3], "%") / (100.0 * (8.26 / 5.0 - 1.0)) - 1.0).abs() < 0.05,
        "{row:?}"
    );
    assert!((value(&row[5], "mm") / 2.18 - 1.0).abs() < 0.02, "{row:?}");
    assert!((0.566..1.0).contains(&value(&row[4], "mm")), "{row:?}");
    assert!(!page(&shipped("skin-analogue"), "elastic").contains("Static tables in time"));
}

/// Fingertip and actuator share the fluid in every state of the page: what `designer loop` gives, and what the tables were made of.
#[test]
fn a_page_of_a_haptic_loop_is_of_fingertip_and_actuator_together() {
    let design = shipped("haptic-loop");
    let text = page(&design, "loop");
    let document = parsed(&text);
    let solved = Command::new(env!("CARGO_BIN_EXE_designer"))
        .arg("loop")
        .arg(&design)
        .args(["--indentation-mm", "2.5", "--format", "csv"])
        .output()
        .expect("the binary runs");
    let solved = String::from_utf8(solved.stdout).expect("text");
    let cells: Vec<f64> = solved
        .lines()
        .nth(1)
        .expect("a row")
        .split(',')
        .map(|cell| cell.parse().expect("a number"))
        .collect();
    for (label, unit, truth) in [
        ("force there", "N", cells[2]),
        ("pressure rise there", "kPa", cells[1]),
    ] {
        let term = document
            .descendants()
            .find(|node| node.has_tag_name("dt") && text_of(*node) == label)
            .unwrap_or_else(|| panic!("no {label}"));
        let number = term.next_sibling_element().map(text_of).expect("its value");
        assert!(
            (value(&number, unit) / truth - 1.0).abs() < 1e-3,
            "{label}: {number} for {truth}"
        );
    }
    // The errors of the tables against these states are those of the certificate, not of another press.
    let described: Vec<&str> = text
        .split("force: at most ")
        .skip(1)
        .filter_map(|rest| rest.split(' ').next())
        .collect();
    assert!(!described.is_empty());
    for percent in described {
        let percent: f64 = percent.parse().expect("a number");
        assert!(percent < 0.5, "{percent} %");
    }
}
