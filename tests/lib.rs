//! What several tests share: the reference tables, an oracle of many digits for what no table holds, and random scenes.

pub mod oracle;
pub mod reference_tables;
pub mod scenes;
