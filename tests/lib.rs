//! What several tests share: the reference tables.

pub mod reference_tables;
