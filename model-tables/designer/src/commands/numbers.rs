//! A list of numbers in an option: `0.2,0.5,1`, also with blanks in quotes, and ranges `0:0.1:2` (start:step:end, the end included).

use super::remark;

/// Numbers of a range at most.
const MOST: f64 = 10_000.0;
/// How near the end of a range has to be to a step of it, in steps.
const NEAR: f64 = 1e-6;

/// One occurrence of a list option.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Numbers {
    values: Vec<f64>,
    /// What it was read as, where it may have been meant otherwise.
    doubt: Option<String>,
}

/// The numbers of every occurrence of an option, in their order. What may have been meant otherwise is told with the answer.
pub(super) fn all(option: &str, lists: &[Numbers]) -> Vec<f64> {
    for doubt in lists.iter().filter_map(|list| list.doubt.as_ref()) {
        remark(format!("note: {option} {doubt}"));
    }
    lists
        .iter()
        .flat_map(|list| list.values.iter().copied())
        .collect()
}

/// A finite number; `inf` and `nan` are words that a float would take.
pub(super) fn finite(text: &str) -> Result<f64, String> {
    let text = text.trim();
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ if text.is_empty() => Err("a number is missing".to_owned()),
        _ => match decimal_comma(text) {
            Some(meant) => Err(format!(
                "not a finite number: a decimal comma is written as a point, {meant}"
            )),
            None => Err("not a finite number".to_owned()),
        },
    }
}

/// What a text with one comma between digits is with a point.
fn decimal_comma(text: &str) -> Option<String> {
    let meant = text.replacen(',', ".", 1);
    let is_number = meant != text && meant.parse::<f64>().is_ok_and(f64::is_finite);
    is_number.then_some(meant)
}

/// The list in the text of an option.
pub(super) fn list(text: &str) -> Result<Numbers, String> {
    if text.contains(';') {
        return Err("numbers are separated by commas, and a decimal comma is written as a point".to_owned());
    }
    let mut values = Vec::new();
    // A blank separates too, beside a comma or without one.
    for item in text.split(',') {
        let mut words = item.split_whitespace().peekable();
        if words.peek().is_none() {
            return Err("a number is missing: a list with blanks stands in quotes, \"0.2, 0.5\"".to_owned());
        }
        for word in words {
            if word.contains(':') {
                values.extend(range(word)?);
            } else {
                values.push(finite(word)?);
            }
        }
    }
    Ok(Numbers {
        doubt: doubt(text.trim(), &values),
        values,
    })
}

/// `start:step:end`, the end included where a step comes to it.
fn range(text: &str) -> Result<Vec<f64>, String> {
    let parts = text
        .split(':')
        .map(finite)
        .collect::<Result<Vec<f64>, String>>()?;
    let &[start, step, end] = parts.as_slice() else {
        return Err(format!(
            "{text:?} is no range: a range is start:step:end, as 0:0.1:2"
        ));
    };
    let steps = (end - start) / step;
    if !(steps.is_finite() && steps >= 0.0) {
        return Err(format!(
            "the step of {text:?} does not lead from its start to its end"
        ));
    }
    if steps >= MOST {
        return Err(format!(
            "{text:?} has more than {MOST} numbers: take a larger step"
        ));
    }
    let last = (steps + NEAR).floor();
    Ok((0..=last as u32)
        .map(|k| {
            let value = start + f64::from(k) * step;
            // Twelve digits: 0.3, and not 0.30000000000000004.
            format!("{value:.11e}").parse().unwrap_or(value)
        })
        .collect())
}

/// Two whole numbers that may be one with a decimal comma: `0,2`, `1,5`, `12,25`; or several of them, `0,2,0,5`.
fn doubt(text: &str, values: &[f64]) -> Option<String> {
    let items: Vec<&str> = text.split(',').collect();
    let is_whole = |item: &&str| item.bytes().all(|byte| byte.is_ascii_digit());
    let may_be_decimals = match items.as_slice() {
        [first, _] => first.len() <= 2,
        // Increasing numbers are what they seem.
        _ => items.len().is_multiple_of(2) && values.windows(2).any(|pair| pair[0] >= pair[1]),
    };
    if !may_be_decimals || !items.iter().all(is_whole) {
        return None;
    }
    let apart: Vec<String> = values.iter().map(f64::to_string).collect();
    let meant: Vec<String> = items.chunks(2).map(|pair| pair.join(".")).collect();
    Some(format!(
        "{text} is read as the numbers {}; a decimal comma is written as a point: {}",
        apart.join(" and "),
        meant.join(",")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Vec<f64> {
        list(text).expect(text).values
    }

    #[test]
    fn ranges_and_blanks_are_read_and_decimals_stay_short() {
        assert_eq!(values("0.2,0.5, 1.0"), [0.2, 0.5, 1.0]);
        assert_eq!(values(" 0.2 0.5\t1 "), [0.2, 0.5, 1.0]);
        assert_eq!(values("0:0.1:0.3"), [0.0, 0.1, 0.2, 0.3]);
        assert_eq!(values("0:0.1:2").len(), 21);
        assert_eq!(values("0:0.1:2")[20].to_bits(), 2.0_f64.to_bits());
        // A step does not come to this end.
        assert_eq!(values("0:0.4:1"), [0.0, 0.4, 0.8]);
        assert_eq!(values("1:-0.5:0,-2"), [1.0, 0.5, 0.0, -2.0]);
        assert_eq!(values("0.7:0.1:0.7"), [0.7]);
    }

    #[test]
    fn what_is_no_list_is_refused_by_its_reason() {
        for (text, reason) in [
            ("0.2,", "a number is missing"),
            ("", "a number is missing"),
            ("0:0.1", "start:step:end"),
            ("0:0:1", "does not lead"),
            ("0:-0.1:1", "does not lead"),
            ("0:1e-9:1", "more than 10000"),
            ("0:nan:1", "not a finite number"),
            ("0,2;0,5", "decimal comma"),
            ("inf", "not a finite number"),
        ] {
            let error = list(text).expect_err(text);
            assert!(error.contains(reason), "{text}: {error}");
        }
        assert!(finite("0,2").expect_err("a comma").contains("0.2"));
        assert!(finite("1,2,3").is_err_and(|error| !error.contains("comma")));
    }

    #[test]
    fn a_decimal_comma_is_doubted_and_a_plain_list_is_not() {
        for (text, meant) in [
            ("0,2", "0.2"),
            ("1,5", "1.5"),
            ("0,2,0,5", "0.2,0.5"),
            ("2,1,3,0", "2.1,3.0"),
        ] {
            let doubt = list(text).expect("numbers").doubt.expect(text);
            assert!(doubt.contains(meant), "{doubt}");
        }
        for text in [
            "642,2571", "0.2,0.5", "5,17.9", "1,2,3", "1,2,3,4", "2", "0:1:3", "0.0,2",
        ] {
            assert_eq!(list(text).expect("numbers").doubt, None, "{text}");
        }
    }
}
