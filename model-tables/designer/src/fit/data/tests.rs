use super::*;

const GOOD: &str = "trial,indentation_mm,force_n,pressure_rise_kpa\n\
    a,0.1,0.01,0.1\na,0.5,0.1,0.6\na,1.0,0.3,1.5\na,0.5,0.08,0.5\na,0.1,0.01,0.1\n\
    b,1.0,0.31,1.4\nb,,0.1,0.6\nb,0.2,,\n";

fn parse(text: &str) -> Result<Data, DataError> {
    Data::parse(text, "data.csv", &DataChoice::default())
}

#[test]
fn reads_rows_trials_and_directions() {
    use Direction::{Loading, Unloading};
    let data = parse(GOOD).expect("good data");
    assert_eq!((data.rows.len(), data.incomplete), (7, 1));
    assert_eq!(data.trials, ["a", "b"]);
    assert_eq!(data.rows[6].indentation, None);
    assert!((data.rows[0].rise.expect("given") - 100.0).abs() < 1e-9);
    let of_a: Vec<Direction> = data.rows[..5].iter().map(|row| row.direction).collect();
    assert_eq!(of_a, [Loading, Loading, Loading, Unloading, Unloading]);
}

#[test]
fn rows_in_no_order_have_no_direction() {
    let depths = [0.5, 2.0, 0.1, 1.5, 0.2, 1.9, 0.3, 1.2];
    assert!(zigzag(&depths).iter().all(|&d| d == Direction::Unknown));
    // Noise is no turn.
    let noisy = [0.0, 0.4, 0.38, 0.8, 1.2, 1.15, 1.6];
    assert!(zigzag(&noisy).iter().all(|&d| d == Direction::Loading));
}

#[test]
fn chooses_rows_and_the_pressure_column() {
    let text = "position_mm,indentation_mm,p\n10,0.1,1\n50.0,0.2,2\n50,0.4,4\n50,0.6,6\n";
    let choice = DataChoice {
        columns: vec![("pressure_rise_kpa".to_owned(), "p".to_owned())],
        only: vec![("position_mm".to_owned(), "50".to_owned())],
        direction: None,
    };
    let data = Data::parse(text, "d", &choice).expect("good data");
    assert_eq!(data.rows.len(), 3);
    assert!((data.rows[0].rise.expect("given") - 2000.0).abs() < 1e-9);
}

#[test]
fn nonsense_is_refused_with_its_reason() {
    for (text, reason) in [
        ("a,b\n1,2\n", "needs at least two of the columns"),
        ("indentation_mm,force_n\n0.1,x\n", "line 2: `force_n` is `x`"),
        ("indentation_mm,force_n\n0.1,inf\n", "must be a finite number"),
        (
            "indentation_mm,force_n\n0.1,1\n0.2,2\n",
            "2 rows have two of the three",
        ),
        (
            "indentation_mm,force_n\n0.1,1\n0.1,2\n0.1,3\n",
            "`indentation_mm` is 0.1 in every row",
        ),
        (
            "indentation_mm,force_n\n0.1,3\n0.2,2\n0.3,1\n",
            "`force_n` falls as it should grow with `indentation_mm` (rank correlation -1.00)",
        ),
        (
            "indentation_mm,force_n\n0.1,1\n0.2,1\n0.3\n",
            "line 4 has 1 cells and the header 2",
        ),
        (
            "indentation_mm,force_n,direction\n0.1,1,sideways\n",
            "`direction` is `sideways`",
        ),
    ] {
        let error = parse(text).expect_err(text).to_string();
        assert!(error.contains(reason), "{error}");
        assert_eq!(error.lines().count(), 1);
    }
}
