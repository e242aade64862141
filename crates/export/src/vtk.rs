//! Tables and tiles for ParaView and other programs with VTK: XML files with the numbers appended
//! in binary form. Lengths are in millimetres.

/// The structure of a VTK XML file.
mod dataset;
/// [`film`]: tiles as poly data.
mod film;
/// [`table`]: a grid as image data, scattered points as poly data.
mod table;

pub use film::film;
pub use table::table;
