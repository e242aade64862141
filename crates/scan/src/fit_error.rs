//! The reason why a scan cannot be fitted.

use magsplice_magnet::PointErrors;
use thiserror::Error;

use crate::column_fault::ColumnFault;
use crate::exclusion::Plateau;
use crate::parameters::ScanParameter;
use crate::row_order::RowOrder;
use crate::turned_film::FilmTurn;

/// The reason why a scan cannot be fitted.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum ScanError {
    /// There are too few readings for the parameters.
    #[error(
        "too few readings for the parameters: {readings}{}, must be at least {needed}",
        if *excluded > 0 { format!(" beside {excluded} incomplete or saturated") } else { String::new() }
    )]
    TooFew {
        /// Number of usable readings.
        readings: usize,
        /// Number of readings that are incomplete or at the limit of the sensor's range.
        excluded: usize,
        /// Smallest sufficient number of readings.
        needed: usize,
    },
    /// The scan does not separate these parameters, or has no information about them.
    #[error(
        "the scan does not determine {}: fit fewer parameters",
        .0.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
    )]
    Undetermined(Vec<ScanParameter>),
    /// The film has no field at the points of the scan.
    #[error("the film has no field at the points of the scan, so parameters are undetermined: fit fewer parameters")]
    NoField,
    /// The number of readings far from every fit exceeds the limit of outliers.
    #[error(
        "readings farther from the fit than the noise allows: {outliers}; the scan belongs to another film, or its positions \
         have errors of more than a quarter of a wavelength{}",
        plateau.map_or(String::new(), |plateau| format!("; {plateau}"))
    )]
    AnotherFilm {
        /// Number of readings far from the fit.
        outliers: usize,
        /// Those that share the extreme of a component.
        plateau: Option<Plateau>,
    },
    /// The residuals are a large part of the readings.
    #[error(
        "the layout does not explain the scan: the residual of the best fit is {:.0} uT, {:.0} % of the readings: the scan \
         belongs to another film, its positions are wrong, or its readings have another unit", 1e6 * residual_t, 100.0 * residual_t / reading_t
    )]
    Misfit {
        /// Standard deviation of the residuals of one component, in tesla.
        residual_t: f64,
        /// Root mean square of a component of the readings without offset, in tesla.
        reading_t: f64,
    },
    /// The offset of the best fit is larger than the readings.
    #[error(
        "the best fit has an offset of {:.1} mT, and no reading is above {:.1} mT: the scan belongs to another film, or its \
         positions are wrong or in another unit", 1e3 * offset_t, 1e3 * largest_t
    )]
    Offset {
        /// Largest component of the offset, in tesla.
        offset_t: f64,
        /// Largest component of a reading, in tesla.
        largest_t: f64,
    },
    /// The readings fit the film at positions in another unit.
    #[error(
        "the readings fit the film at positions {length} times as large: the positions are in {unit}, must be in mm"
    )]
    Unit {
        /// The unit of the positions.
        unit: &'static str,
        /// Its length in the unit of the tiles.
        length: f64,
    },
    /// The readings fit the film in another unit.
    #[error(
        "the readings times {unit} fit the film: they have another unit, such as {example}, or the polarization in the \
         layout is wrong"
    )]
    ReadingUnit {
        /// The unit of the readings over the stated one.
        unit: f64,
        /// An example of the two units.
        example: &'static str,
    },
    /// The film was turned against the positions.
    #[error(
        "the film as ordered explains the scan to {:.1} uT if it was turned by {:.1} deg about z against the positions: turn \
         positions and readings by {:.1} deg, or the film", 1e6 * .0.residual_t, .0.angle_deg, -.0.angle_deg
    )]
    Turned(FilmTurn),
    /// The readings fit in another order.
    #[error("{0}")]
    RowOrder(RowOrder),
    /// The readings do not fit, and their columns have a fault.
    #[error("the layout does not explain the scan, and {0}")]
    Columns(ColumnFault),
    /// The steps did not converge.
    #[error(
        "the fit does not converge: the positions may have errors of more than a quarter of a wavelength, or errors of \
         tiles look like another strength and height, which a fit of offset, rotation and start alone avoids"
    )]
    NoConvergence,
    /// Points without a field.
    #[error("points of the scan have no field: {0}")]
    Points(PointErrors),
}
