//! Tables and tiles for ParaView and other programs that use VTK: XML files with their numbers appended as they are in memory.

mod dataset;
mod film;
mod table;

pub use film::film;
pub use table::table;
