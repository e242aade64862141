//! The figures, one file per kind.

/// Each decoupling parameter along its own axis.
pub(crate) mod along_axes;
/// The error budget as bars.
pub(crate) mod budget;
/// Faulty tiles, and the resolution of a scan for each.
pub(crate) mod diagnosis;
/// Errors of films as made.
pub(crate) mod distributions;
/// Curves of a film that is moved along each axis.
pub(crate) mod experiment;
/// B_x, B_y, B_z on a plane: spliced film, ideal film, difference.
pub(crate) mod field_maps;
/// Panels that show the tiles from above.
mod film_panel;
/// The tiles from above with the force on each.
pub(crate) mod forces;
/// Errors of the films of a Pareto front.
pub(crate) mod front;
/// The ideal film: its polarization, and vectors of its field.
pub(crate) mod ideal_film;
/// The tiles from above with their polarization and names.
pub(crate) mod layout_from_above;
/// The legend of the figure of the tiles.
mod layout_legend;
/// Maps in rows and columns.
pub(crate) mod map_grid;
/// R_x, R_y, S_z on planes through the working volume.
pub(crate) mod parameter_maps;
/// The plan by which a film is placed.
pub(crate) mod placement_plan;
/// How far recoil weakens and turns each tile.
pub(crate) mod recoil_map;
/// Resolution of the sensor on planes.
pub(crate) mod resolution;
/// A measured plane of a scan beside the field of the layout.
pub(crate) mod scan_maps;
/// Places for the arrow and the name of each tile.
mod tile_annotations;
/// Arrows of the field in three planes.
pub(crate) mod vectors;
