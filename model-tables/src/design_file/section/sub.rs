//! The tables within a table.

use super::{KeyFault, Section};
use crate::design_file::error::Problem;
use toml::de::DeValue;

impl<'a> Section<'a> {
    /// The sub-table of that name, if it is there.
    ///
    /// # Errors
    /// [`KeyFault`] with the key, what was found and what is allowed.
    pub fn sub(&mut self, name: &'static str) -> Result<Option<Section<'a>>, KeyFault> {
        let Some(value) = self.get(name) else {
            return Ok(None);
        };
        match value.get_ref() {
            DeValue::Table(table) => Ok(Some(Section {
                text: self.text,
                path: self.full(name),
                header: value.span().start,
                table,
                known: Vec::new(),
            })),
            _ => Err(self.refuse(name, "a table of keys")),
        }
    }

    /// The sub-table of that name, which must be there.
    ///
    /// # Errors
    /// [`KeyFault`] with the key, what was found and what is allowed.
    pub fn needed_sub(&mut self, name: &'static str, holds: &str) -> Result<Section<'a>, KeyFault> {
        match self.sub(name)? {
            Some(section) => Ok(section),
            None => Err((
                None,
                Problem::Missing {
                    key: format!("[{}]", self.full(name)),
                    allowed: format!("a section with {holds}"),
                },
            )),
        }
    }

    /// The tables of an array that must be there, at least one.
    ///
    /// # Errors
    /// [`KeyFault`] with the key, what was found and what is allowed.
    pub fn subs(&mut self, name: &'static str, allowed: &str) -> Result<Vec<Section<'a>>, KeyFault> {
        let Some(value) = self.get(name) else {
            let key = format!("[[{}]]", self.full(name));
            let allowed = allowed.to_owned();
            return Err((None, Problem::Missing { key, allowed }));
        };
        let tables: Option<Vec<Section<'a>>> = value.get_ref().as_array().and_then(|array| {
            array
                .iter()
                .map(|item| {
                    Some(Section {
                        text: self.text,
                        path: self.full(name),
                        header: item.span().start,
                        table: item.get_ref().as_table()?,
                        known: Vec::new(),
                    })
                })
                .collect()
        });
        tables
            .filter(|tables| !tables.is_empty())
            .ok_or_else(|| self.refuse(name, allowed))
    }

    /// Every sub-table, in the order of the text.
    ///
    /// # Errors
    /// [`KeyFault`] for a key that is no table.
    pub fn every_sub(&self) -> Result<Vec<(&'a str, Section<'a>)>, KeyFault> {
        let mut subs: Vec<(&'a str, Section<'a>)> = Vec::new();
        for (name, value) in self.table {
            let name = name.get_ref().as_ref();
            let DeValue::Table(table) = value.get_ref() else {
                return Err(self.refuse(name, "a table of keys"));
            };
            subs.push((
                name,
                Section {
                    text: self.text,
                    path: self.full(name),
                    header: value.span().start,
                    table,
                    known: Vec::new(),
                },
            ));
        }
        subs.sort_by_key(|(_, section)| section.header);
        Ok(subs)
    }
}
