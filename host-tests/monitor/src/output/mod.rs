//! What takes reports: [`rows`] (CSV and JSON) in [`whole`] rows, and [`capture`] (MCAP).

pub mod capture;
pub mod rows;
pub mod whole;
