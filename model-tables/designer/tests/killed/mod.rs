//! A sweep that is killed and goes on.

use super::{LONG, cell, names, number, parts, rows, run, scratch, space};
use model_tables::random::Random;
use parquet::record::Field;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Kills of the running binary.
const KILLS: usize = 20;

/// Starts a sweep and kills it so many seconds after there are so many parts; `false` if it was over before.
fn killed_at(space: &str, out: &Path, parts: usize, onward: f64) -> bool {
    let mut child = Command::new(env!("CARGO_BIN_EXE_designer"))
        .args(["sweep", space, "--out", &out.display().to_string()])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the binary runs");
    let mut is_over = || child.try_wait().expect("a child").is_some();
    while !is_over() && parts > 0 && (!out.is_dir() || names(out).len() < parts) {
        sleep(Duration::from_millis(1));
    }
    sleep(Duration::from_secs_f64(onward));
    if is_over() {
        return false;
    }
    child.kill().expect("killed");
    child.wait().expect("ended");
    true
}

/// Runs a space whole; then again, killed at [`KILLS`] instants that a seed draws over the whole of that run, and once more to its end. Every
/// part that a kill leaves is one of the whole run, and in the end all are there: as bytes, and as rows.
fn killed_and_resumed(name: &str, sweep: &str, seed: u64) {
    let folder = scratch(name);
    let space = space(&folder, sweep);
    let (whole, killed) = (folder.join("whole"), folder.join("killed"));
    let begun = Instant::now();
    run(&space, &whole);
    let unbroken = begun.elapsed();
    let truth = parts(&whole);
    let of_part = unbroken.as_secs_f64() / truth.len() as f64;

    let mut random = Random(seed);
    let mut instants: Vec<f64> = (0..KILLS).map(|_| random.uniform(0.0, 0.95)).collect();
    instants.sort_by(f64::total_cmp);
    let (mut before, mut left) = (0, Vec::new());
    for instant in instants {
        let wanted = (instant * truth.len() as f64) as usize;
        // Anywhere in the part that is computed then, or in one after it.
        let mut onward = random.uniform(0.0, 1.5) * of_part;
        while !killed_at(&space, &killed, wanted, onward) {
            // Over before, as what else the machine did has ended: from an empty folder, at the beginning of that part.
            assert_eq!(parts(&killed), truth);
            fs::remove_dir_all(&killed).expect("removed");
            (before, onward) = (0, 0.0);
        }
        let there = if killed.is_dir() {
            parts(&killed)
        } else {
            BTreeMap::new()
        };
        assert!(there.len() >= before, "a part is gone");
        assert!(there.iter().all(|(name, content)| truth[name] == *content));
        before = there.len();
        left.push(before);
    }
    run(&space, &killed);
    assert_eq!(parts(&killed), truth);
    // The rows: none lost, none doubled, each the same.
    let sorted = |folder: &Path| {
        let mut all: Vec<String> = rows(folder).iter().map(ToString::to_string).collect();
        all.sort();
        all
    };
    let rows_of_whole = sorted(&whole);
    assert_eq!(sorted(&killed), rows_of_whole);
    for (place, row) in rows(&killed).iter().enumerate() {
        assert!((number(row, "design_number") - place as f64).abs() < 1e-9);
    }
    // Nothing half-written stays beside the parts: the manifest and the lock of the shard.
    assert_eq!(fs::read_dir(&killed).expect("there").count(), truth.len() + 2);
    println!(
        "{} rows in {} parts, {KILLS} kills with {left:?} parts there: the same rows",
        rows_of_whole.len(),
        truth.len()
    );
}

#[test]
fn a_run_killed_at_any_instant_goes_on_and_loses_and_doubles_nothing() {
    killed_and_resumed("sweep-kill", LONG, 20);
    let rows = rows(&Path::new(env!("CARGO_TARGET_TMPDIR")).join("sweep-kill/killed"));
    assert_eq!(rows.len(), 150);
    assert!(rows.iter().any(|row| cell(row, "reason") != &Field::Null));
}

/// The same of three thousand designs: `cargo test -p designer --test sweep -- --ignored --nocapture`.
#[test]
#[ignore = "a minute or two of one core: three thousand designs, twice"]
fn three_thousand_designs_killed_at_twenty_instants() {
    let sweep = LONG
        .replace("count = 150", "count = 3000")
        .replace("designs_per_part = 7", "designs_per_part = 50");
    killed_and_resumed("sweep-kill-3000", &sweep, 2026);
}
