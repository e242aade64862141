//! Many points at once: each tile's field from the cheapest form that keeps the bound, for all points alike in this at the same time,
//! in the widest vectors the processor has.
//!
//! | form | where | file |
//! |---|---|---|
//! | the kernel of one point | in a tile or beside it, if it is a plate or a needle or the point in a plane of its faces | [`crate::kernel`] |
//! | terms of edges and corners in vectors | otherwise in a tile or beside it | `beside` |
//! | closed form in vectors, tiles that share corners together or a tile by itself | up to 15 of its sides | `elements`, `closed_form`, `alone` |
//! | multipole series in vectors, tile by tile | beyond | `multipole` |
//! | expansion in solid harmonics, many tiles together | from three radii of the sphere around them on | `expansion`, `harmonics` |
//!
//! A tile that is alone in its scene has no sums: its points wait in queues until there are vectors of one form (`streams`, `queues`).
//!
//! Which form serves a tile at a point depends on the two alone, and so does every digit of the answer: neither on the other points, nor on
//! their number, order, or division among threads.

mod ahead;
mod alone;
pub(crate) mod assignment;
mod bars;
mod beside;
mod closed_form;
mod cluster;
mod column;
mod elements;
mod expansion;
pub(crate) mod far;
mod functions;
pub(crate) mod harmonics;
pub(crate) mod instruction_set;
pub(crate) mod lanes;
mod local;
mod multipole;
mod one_tile;
mod pairwise;
mod points;
mod queues;
mod range;
mod series;
mod streams;
mod stretches;
mod superposition;
pub(crate) mod table;
mod terms;
mod totals;
mod translation;
pub(crate) mod tree;

pub(crate) use superposition::Superposition;

#[cfg(test)]
mod tests;
