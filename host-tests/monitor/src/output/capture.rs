//! Reports as an MCAP file, which Foxglove and other viewers of robots' logs open: one topic of JSON messages, with a schema.

use crate::output::rows;
use crate::readings::LiveReading;
use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions};
use serde_json::json;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::time::SystemTime;

/// The topic of the reports.
pub const TOPIC: &str = "/fingertip/reading";
/// Bytes of a chunk: half a second of reports. What a killed program leaves lacks at most the last one.
const CHUNK: u64 = 64 * 1024;

/// An MCAP file that takes reports.
pub struct Capture {
    to: mcap::Writer<BufWriter<File>>,
    channel: u16,
    count: u32,
    began: SystemTime,
}

/// What a message holds, for tools that draw it.
fn schema() -> String {
    let number = json!({"type": ["number", "null"]});
    let properties: serde_json::Map<_, _> = rows::COLUMNS
        .iter()
        .map(|column| {
            let kind = match *column {
                "status" | "touch" => json!({"type": "string"}),
                "design" => json!({"type": ["string", "null"]}),
                "missing_before" => json!({"type": "integer"}),
                _ => number.clone(),
            };
            ((*column).to_owned(), kind)
        })
        .collect();
    json!({"type": "object", "properties": properties}).to_string()
}

impl Capture {
    /// Makes the file, which must not be there, of a watch that began then.
    ///
    /// # Errors
    /// What the file system answers.
    pub fn create(path: &Path, began: SystemTime) -> Result<Self, McapError> {
        let file = File::create_new(path)?;
        let mut to = WriteOptions::new()
            .compression(None)
            .chunk_size(Some(CHUNK))
            .create(BufWriter::new(file))?;
        let schema = to.add_schema("fingertip.Reading", "jsonschema", schema().as_bytes())?;
        let channel = to.add_channel(schema, TOPIC, "json", &BTreeMap::new())?;
        Ok(Self {
            to,
            channel,
            count: 0,
            began,
        })
    }

    /// Takes a report, dated by the host's time of its measurement.
    ///
    /// # Errors
    /// What the file system answers.
    pub fn write(&mut self, reading: &LiveReading) -> Result<(), McapError> {
        let time = rows::host_time(reading, self.began).as_nanos() as u64;
        self.count = self.count.wrapping_add(1);
        self.to.write_to_known_channel(
            &MessageHeader {
                channel_id: self.channel,
                sequence: self.count,
                log_time: time,
                publish_time: time,
            },
            rows::object(reading, self.began).to_string().as_bytes(),
        )
    }

    /// Closes it with its index.
    ///
    /// # Errors
    /// What the file system answers.
    pub fn finish(mut self) -> Result<(), McapError> {
        self.to.finish().map(|_| ())
    }
}
