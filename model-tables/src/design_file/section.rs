//! Reads one table of a design file: typed values, and the unknown keys.

mod sub;

use super::bounds::Bounds;
use super::error::{Problem, is_slip};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The line (where there is one) and what is wrong there.
pub type KeyFault = (Option<usize>, Problem);

/// One table, and the keys that were asked for.
pub struct Section<'a> {
    text: &'a str,
    path: String,
    header: usize,
    table: &'a DeTable<'a>,
    known: Vec<&'static str>,
}

impl<'a> Section<'a> {
    /// The document itself.
    pub fn root(text: &'a str, table: &'a DeTable<'a>) -> Self {
        Self {
            text,
            path: String::new(),
            header: 0,
            table,
            known: Vec::new(),
        }
    }

    /// Whole numbers in brackets, if the key is there.
    ///
    /// # Errors
    /// [`KeyFault`] with the key, what was found and what is allowed.
    pub fn whole_numbers(&mut self, key: &'static str, allowed: &str) -> Result<Option<Vec<u32>>, KeyFault> {
        let Some(value) = self.get(key) else {
            return Ok(None);
        };
        let numbers: Option<Vec<u32>> = value.get_ref().as_array().and_then(|array| {
            array
                .iter()
                .map(|item| match item.get_ref() {
                    DeValue::Integer(integer) => u32::from_str_radix(integer.as_str(), integer.radix()).ok(),
                    _ => None,
                })
                .collect()
        });
        numbers.map(Some).ok_or_else(|| self.refuse(key, allowed))
    }

    /// Whether the key is there.
    pub fn has(&mut self, key: &'static str) -> bool {
        self.get(key).is_some()
    }

    /// A number, if the key is there.
    ///
    /// # Errors
    /// [`KeyFault`] with the key, what was found and what is allowed.
    pub fn number(&mut self, key: &'static str, bounds: Bounds) -> Result<Option<f64>, KeyFault> {
        let Some(value) = self.get(key) else {
            return Ok(None);
        };
        let number = to_number(value.get_ref());
        if let Some(slips) = number.and_then(|number| bounds.slips(number)) {
            return Err(self.refuse(key, &format!("in {}: {slips}", bounds.unit)));
        }
        match number.filter(|number| bounds.admits(*number)) {
            Some(number) => Ok(Some(number)),
            None => Err(self.refuse(key, &bounds.describe())),
        }
    }

    /// A number that must be there.
    ///
    /// # Errors
    /// [`KeyFault`] with the key, what was found and what is allowed.
    pub fn needed_number(&mut self, key: &'static str, bounds: Bounds) -> Result<f64, KeyFault> {
        match self.number(key, bounds)? {
            Some(number) => Ok(number),
            None => Err(self.missing(key, &bounds.describe())),
        }
    }

    /// A number (`Some(Some(_))`) or one word in its place (`Some(None)`), if the key is there.
    ///
    /// # Errors
    /// [`KeyFault`] with the key, what was found and what is allowed.
    pub fn number_or_text(
        &mut self,
        key: &'static str,
        bounds: Bounds,
        word: &str,
    ) -> Result<Option<Option<f64>>, KeyFault> {
        let Some(value) = self.get(key) else {
            return Ok(None);
        };
        match value.get_ref() {
            DeValue::String(text) if text.as_ref() == word => Ok(Some(None)),
            other => match to_number(other).filter(|number| bounds.admits(*number)) {
                Some(number) => Ok(Some(Some(number))),
                None => Err(self.refuse(key, &format!("{}, or \"{word}\"", bounds.describe()))),
            },
        }
    }

    /// `true` or `false`, if the key is there.
    ///
    /// # Errors
    /// [`KeyFault`] with the key, what was found and what is allowed.
    pub fn flag(&mut self, key: &'static str) -> Result<Option<bool>, KeyFault> {
        let Some(value) = self.get(key) else {
            return Ok(None);
        };
        match value.get_ref() {
            DeValue::Boolean(flag) => Ok(Some(*flag)),
            _ => Err(self.refuse(key, "true or false")),
        }
    }

    /// Two increasing numbers, if the key is there.
    ///
    /// # Errors
    /// [`KeyFault`] with the key, what was found and what is allowed.
    pub fn pair(&mut self, key: &'static str, bounds: Bounds) -> Result<Option<[f64; 2]>, KeyFault> {
        let Some(value) = self.get(key) else {
            return Ok(None);
        };
        let numbers: Option<Vec<f64>> = value
            .get_ref()
            .as_array()
            .map(|array| array.iter().map(|item| to_number(item.get_ref())).collect())
            .unwrap_or_default();
        match numbers.as_deref() {
            Some(&[low, high]) if low < high && bounds.admits(low) && bounds.admits(high) => {
                Ok(Some([low, high]))
            }
            _ => Err(self.refuse(key, &pair_wanted(bounds))),
        }
    }

    /// Two increasing numbers that must be there.
    ///
    /// # Errors
    /// [`KeyFault`] with the key, what was found and what is allowed.
    pub fn needed_pair(&mut self, key: &'static str, bounds: Bounds) -> Result<[f64; 2], KeyFault> {
        match self.pair(key, bounds)? {
            Some(pair) => Ok(pair),
            None => Err(self.missing(key, &pair_wanted(bounds))),
        }
    }

    /// Two increasing numbers, or one for both, that must be there.
    ///
    /// # Errors
    /// [`KeyFault`] with the key, what was found and what is allowed.
    pub fn span(&mut self, key: &'static str, bounds: Bounds) -> Result<[f64; 2], KeyFault> {
        let array = self.get(key).is_some_and(|value| value.get_ref().is_array());
        if array {
            return self.needed_pair(key, bounds);
        }
        self.needed_number(key, bounds).map(|number| [number; 2])
    }

    /// Texts in brackets that must be there.
    ///
    /// # Errors
    /// [`KeyFault`] with the key, what was found and what is allowed.
    pub fn texts(&mut self, key: &'static str, allowed: &str) -> Result<Vec<&'a str>, KeyFault> {
        let Some(value) = self.get(key) else {
            return Err(self.missing(key, allowed));
        };
        let texts: Option<Vec<&str>> = value
            .get_ref()
            .as_array()
            .and_then(|array| array.iter().map(|item| item.get_ref().as_str()).collect());
        texts
            .filter(|texts| !texts.is_empty())
            .ok_or_else(|| self.refuse(key, allowed))
    }

    /// Strictly increasing numbers, `count[0]` to `count[1]` of them, that must be there.
    ///
    /// # Errors
    /// [`KeyFault`] with the key, what was found and what is allowed.
    pub fn increasing(
        &mut self,
        key: &'static str,
        bounds: Bounds,
        count: [usize; 2],
    ) -> Result<Vec<f64>, KeyFault> {
        let [low, high] = count;
        let wanted = format!(
            "{low} to {high} strictly increasing numbers in brackets, each {}",
            bounds.describe()
        );
        let increase = |numbers: &[f64]| {
            (low..=high).contains(&numbers.len()) && numbers.windows(2).all(|pair| pair[0] < pair[1])
        };
        self.numbers(key, bounds, &wanted, increase)
    }

    /// So many numbers that must be there, in any order.
    ///
    /// # Errors
    /// [`KeyFault`] with the key, what was found and what is allowed.
    pub fn as_many(&mut self, key: &'static str, bounds: Bounds, count: usize) -> Result<Vec<f64>, KeyFault> {
        let wanted = format!(
            "{count} numbers in brackets, as many as the key before it has, each {}",
            bounds.describe()
        );
        self.numbers(key, bounds, &wanted, |numbers| numbers.len() == count)
    }

    /// Numbers that must be there and be as `wanted` says.
    fn numbers(
        &mut self,
        key: &'static str,
        bounds: Bounds,
        wanted: &str,
        admits: impl Fn(&[f64]) -> bool,
    ) -> Result<Vec<f64>, KeyFault> {
        let Some(value) = self.get(key) else {
            return Err(self.missing(key, wanted));
        };
        let numbers: Option<Vec<f64>> = value
            .get_ref()
            .as_array()
            .and_then(|array| array.iter().map(|item| to_number(item.get_ref())).collect());
        numbers
            .filter(|numbers| admits(numbers) && numbers.iter().all(|&number| bounds.admits(number)))
            .ok_or_else(|| self.refuse(key, wanted))
    }

    /// A text, if the key is there.
    ///
    /// # Errors
    /// [`KeyFault`] with the key, what was found and what is allowed.
    pub fn text(&mut self, key: &'static str, allowed: &str) -> Result<Option<&'a str>, KeyFault> {
        let Some(value) = self.get(key) else {
            return Ok(None);
        };
        match value.get_ref() {
            DeValue::String(text) => Ok(Some(text.as_ref())),
            _ => Err(self.refuse(key, allowed)),
        }
    }

    /// A text that must be there.
    ///
    /// # Errors
    /// [`KeyFault`] with the key, what was found and what is allowed.
    pub fn needed_text(&mut self, key: &'static str, allowed: &str) -> Result<&'a str, KeyFault> {
        match self.text(key, allowed)? {
            Some(text) => Ok(text),
            None => Err(self.missing(key, allowed)),
        }
    }

    /// The value of `key` is not `allowed`.
    pub fn refuse(&self, key: &str, allowed: &str) -> KeyFault {
        let found = self
            .table
            .get(key)
            .and_then(|value| self.text.get(value.span()))
            .unwrap_or("not readable");
        let problem = Problem::Value {
            key: self.full(key),
            found: found.to_owned(),
            allowed: allowed.to_owned(),
        };
        (self.line_of(key), problem)
    }

    /// `key` is missing here.
    pub fn missing(&self, key: &str, allowed: &str) -> KeyFault {
        let slip = self.table.keys().find(|found| {
            let found = found.get_ref().as_ref();
            !self.known.contains(&found) && is_slip(found, key)
        });
        if let Some(slip) = slip {
            let problem = Problem::Unknown {
                key: self.full(slip.get_ref()),
                allowed: key.to_owned(),
            };
            return (Some(self.line_at(slip.span().start)), problem);
        }
        let problem = Problem::Missing {
            key: self.full(key),
            allowed: allowed.to_owned(),
        };
        let line = (!self.path.is_empty()).then(|| self.line_at(self.header));
        (line, problem)
    }

    /// Ends the reading: an unknown key is an error. The first in the file is named.
    ///
    /// # Errors
    /// [`KeyFault`] with the key, what was found and what is allowed.
    pub fn finish(self) -> Result<(), KeyFault> {
        let unknown = self
            .table
            .keys()
            .filter(|key| !self.known.contains(&key.get_ref().as_ref()))
            .min_by_key(|key| key.span().start);
        match unknown {
            None => Ok(()),
            Some(key) => Err((
                Some(self.line_at(key.span().start)),
                Problem::Unknown {
                    key: self.full(key.get_ref()),
                    allowed: self.known.join(", "),
                },
            )),
        }
    }

    fn get(&mut self, key: &'static str) -> Option<&'a Spanned<DeValue<'a>>> {
        if !self.known.contains(&key) {
            self.known.push(key);
        }
        self.table.get(key)
    }

    fn full(&self, key: &str) -> String {
        if self.path.is_empty() {
            key.to_owned()
        } else {
            format!("{}.{key}", self.path)
        }
    }

    /// The line of a key, counted from 1, if it is there.
    pub fn line_of(&self, key: &str) -> Option<usize> {
        let (key, _) = self.table.get_key_value(key)?;
        Some(self.line_at(key.span().start))
    }

    /// The line of its header.
    pub fn line(&self) -> Option<usize> {
        Some(self.line_at(self.header))
    }

    fn line_at(&self, offset: usize) -> usize {
        line_at(self.text, offset)
    }
}

/// The line of a byte offset, counted from 1.
pub fn line_at(text: &str, offset: usize) -> usize {
    1 + text.bytes().take(offset).filter(|&byte| byte == b'\n').count()
}

fn pair_wanted(bounds: Bounds) -> String {
    format!("two increasing numbers in brackets, each {}", bounds.describe())
}

fn to_number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
        DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix())
            .ok()
            .map(|number| number as f64),
        _ => None,
    }
}
