use super::*;
use crate::design_file::{DEFAULT_MODEL_PERCENT, DesignFile};
use certified_lookup::generate::{ProvenBy, prove};

fn accuracy(percent: f64) -> Accuracy {
    Accuracy {
        force_percent_of_reading: percent,
        indentation_percent_of_reading: percent,
        from_percent_of_full_scale: 1.0,
        model_percent: DEFAULT_MODEL_PERCENT,
    }
}

/// A dome of 9 x 7 x 1 mm Agilus30 pressed to 2.8 mm, from a rest state hardly stretched.
fn hardly_stretched(pole_stretch: f64, resolution: f64) -> Solved {
    let text = format!(
        "name = \"hardly\"\n[membrane]\nradial_semi_axis_mm = 9.0\naxial_semi_axis_mm = 7.0\nthickness_mm = 1.0\n[material]\n\
         law = \"mooney-rivlin\"\nc1_pa = 160355.0\nc2_pa = 46559.0\n[rest]\npole_stretch = {pole_stretch}\n[press]\n\
         max_indentation_mm = 2.8\n[transducer]\nkind = \"ratiometric\"\nrange_kpa = [0.0, 200.0]\n\
         resolution_pa = {resolution:?}\noutput_fraction_at_range = [0.1, 0.9]\n"
    );
    solve(&DesignFile::parse(&text, "hardly.toml").expect("a design")).expect("a curve")
}

/// At first contact the tolerance is more than the force itself: sums that merely keep to it fall there, in every shape.
#[test]
fn hardly_stretched_rests_have_small_tables() {
    for (pole_stretch, resolution) in [(1.02, 10.0), (1.005, 10.0), (1.005, 0.01)] {
        let Solved { curve, end, .. } = hardly_stretched(pole_stretch, resolution);
        let certified = tables(&curve, end, &accuracy(0.1), resolution).expect("tables");
        let errors = [&certified.certificate.force, &certified.certificate.indentation];
        assert!(errors.iter().all(|errors| errors.holds()));
        let (bytes, tried) = (certified.tables.bytes(), certified.tried);
        assert!(
            bytes <= 192 && tried < 1000,
            "{pole_stretch}: {bytes} bytes, {tried} tried"
        );
    }
}

/// What must be the same to the digit, however it is proven.
fn exact(errors: &Errors) -> [u64; 6] {
    [
        errors.of_reading.max.to_bits(),
        errors.of_full_scale.max.to_bits(),
        errors.below_percent_of_from.to_bits(),
        errors.equal_steps,
        errors.falling_steps,
        errors.largest_step as u64,
    ]
}

#[test]
fn bounds_certify_shipped_designs_as_evaluation_does() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("designs");
    for entry in std::fs::read_dir(folder).expect("the designs") {
        let file = DesignFile::read(&entry.expect("a file").path()).expect("a shipped design");
        let Solved {
            transducer,
            curve,
            end,
            ..
        } = solve(&file).expect("a curve");
        let accuracy = file.accuracy.expect("shipped with it");
        let tables = fit(&curve, end, &accuracy, transducer.resolution_pa).expect("tables");
        // A draft may miss its accuracy by a little.
        let any = AccuracyGoal {
            percent_of_reading: [f64::INFINITY; 2],
            ..goal(&accuracy)
        };
        let [every, bounded] = [ProvenBy::Evaluation, ProvenBy::Bounds]
            .map(|by| prove(&tables, &curve, curve_point(end), &any, by).expect("its ends are held"));
        assert!(every.every_input_evaluated && !bounded.every_input_evaluated);
        assert_eq!(
            every.outputs.each_ref().map(exact),
            bounded.outputs.each_ref().map(exact)
        );
        assert_eq!(every.outputs[0].range, bounded.outputs[0].range);
        assert_eq!(every.outputs[1].range, bounded.outputs[1].range);
    }
}
