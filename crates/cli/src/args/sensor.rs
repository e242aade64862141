//! Arguments of the verbs about sensors: `read`, `resolution`, `scan`, `calibrate`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use magsplice::prelude::DVec3;
use magsplice::scan::FreeParameters;
use magsplice::sensor::Noise;

use super::formats::{ResultArgs, TableFormat};
use super::numbers::flux_density_t;

/// Find where the sensor was when it read given flux densities.
///
/// The result is the displacement of the sensor from the reference point of the working volume, in
/// the frame of the film. The film has moved by the opposite. The exact field of the layout gives
/// it, so that it does not contain the error of the splicing pattern and of the end of the film.
/// With [ideal] the result also has the displacement by the closed form of the ideal film (Dai
/// 2024, Eqs. 14 and 15), and with --noise the standard deviations that noise causes.
///
/// Readings without a position in the working volume, or with two, are named on standard error. The
/// displacement is NaN where there are two positions or none. The column `status` is 0 for a
/// position in the volume, 1 for one outside by more than four deviations of the noise, 2 for two
/// positions, 3 for none, and 4 for a reading at the limit of the sensor's range.
///
/// With [sensor] in the layout, the readings are those of this sensor, with its plates, gains,
/// offsets and rotation, and its noise is that of --noise. With [elastomer], the result has the
/// force on the film.
#[derive(Args)]
#[command(after_help = "Example:\n  magsplice read readings.csv --layout film.toml --noise 5uT -o moved.csv")]
pub(crate) struct ReadArgs {
    /// CSV file with columns bx_t, by_t, bz_t, or bx (mT), ...; - is standard input
    pub(crate) readings: PathBuf,
    /// Layout file of the film
    #[arg(long, value_name = "LAYOUT")]
    pub(crate) layout: PathBuf,
    /// Standard deviation of a reading, such as 5uT, or of its x, y and z: 5uT,5uT,8uT [default:
    /// that of [sensor] in the layout]
    #[arg(long, value_name = "NOISE", value_parser = noise)]
    pub(crate) noise: Option<Noise>,
    /// The first N readings are of the sensor at rest at the reference point: their mean, less the
    /// field of the film there, is subtracted from all
    ///
    /// A constant stray field and the offset of the sensor are then without effect.
    #[arg(long, value_name = "N", default_value = "0")]
    pub(crate) zero: usize,
    /// The first N readings are of the sensor at rest: displacements count from the position of
    /// their mean, not from the reference point
    ///
    /// The film may then lie elsewhere than in the layout. A constant field moves all positions.
    #[arg(long, value_name = "N", default_value = "0", conflicts_with = "zero")]
    pub(crate) rest: usize,
    /// Unit of columns bx, by, bz without a unit in their names; the names are still needed
    #[arg(long, value_enum, ignore_case = true, value_name = "UNIT")]
    pub(crate) unit: Option<FluxUnitArg>,
    /// File to write, complete or not at all [default: -, standard output]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Format of the result [default: by the file's ending, else csv]
    #[arg(long, value_enum)]
    pub(crate) format: Option<TableFormat>,
}

/// Tell how small displacements the noise of a sensor lets it see, over the working volume.
///
/// The standard deviations of the displacement along x, y and z that normal noise of the readings
/// causes: by the exact field (no estimate from one reading has smaller ones: the bound of Cramér
/// and Rao), and, with [ideal], by the closed form of the ideal film (Dai 2024, Eqs. 14 and 15).
/// The text has their root mean squares over the volume, and the largest. With -o, a table of every
/// point is written.
#[derive(Args)]
#[command(after_help = "Example:\n  magsplice resolution layouts/published-film.toml --noise 5uT\n  \
    magsplice resolution film.toml --noise 5uT,5uT,8uT -o resolution.vti")]
pub(crate) struct ResolutionArgs {
    /// Layout file
    pub(crate) layout: PathBuf,
    /// Standard deviation of a reading, such as 5uT, or of its x, y and z: 5uT,5uT,8uT [default:
    /// that of [sensor] in the layout]
    #[arg(long, value_name = "NOISE", value_parser = noise)]
    pub(crate) noise: Option<Noise>,
    /// File for a table of all points, complete or not at all
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Format of the table [default: by the file's ending]
    #[arg(long, value_enum, requires = "output")]
    pub(crate) format: Option<TableFormat>,
}

/// Units of columns of flux densities.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum FluxUnitArg {
    /// Tesla
    T,
    /// Millitesla
    #[value(name = "mT")]
    Mt,
    /// Microtesla
    #[value(name = "uT")]
    Ut,
}

impl FluxUnitArg {
    pub(crate) fn name(self) -> &'static str {
        match self {
            FluxUnitArg::T => "T",
            FluxUnitArg::Mt => "mT",
            FluxUnitArg::Ut => "uT",
        }
    }
}

/// Largest noise: that of a sensor which sees nothing of any permanent magnet.
const MAX_NOISE_T: f64 = 1.0;

pub(crate) fn noise(text: &str) -> Result<Noise, String> {
    let parts: Vec<&str> = text.split(',').collect();
    let axes = match parts[..] {
        [all] => [all; 3],
        [x, y, z] => [x, y, z],
        _ => return Err("must be one flux density, or one for each of x, y, z, such as 5uT,5uT,8uT".to_owned()),
    };
    let mut deviation_t = DVec3::ZERO;
    for (axis, text) in axes.into_iter().enumerate() {
        let value = flux_density_t(text)?;
        if !(value > 0.0 && value <= MAX_NOISE_T) {
            return Err(format!("{text}: must be above 0 and at most {MAX_NOISE_T} T"));
        }
        deviation_t[axis] = value;
    }
    Ok(Noise { deviation_t })
}

/// Compare a measured scan of the field with the layout, and fit what cannot be known beforehand.
///
/// Fits the strength of the tiles, the offset (that of the sensor and a uniform stray field
/// together), the rotation of the sensor, and where in the frame of the film the scan began, with
/// standard deviations from the residuals. Readings farther from the fit than six standard
/// deviations are left out and named, and so are missing and repeated positions. With [ideal], the
/// uniformity RMSE of the readings stands beside that of the layout at the same places.
#[derive(Args)]
#[command(after_help = "Example:\n  magsplice scan scan.csv --layout film.toml\n  \
    magsplice scan scan.csv --layout film.toml --fit strength,offset --save corrected.csv")]
pub(crate) struct ScanArgs {
    /// CSV file with columns x_mm, y_mm, z_mm and bx_mt, by_mt, bz_mt, or in other units, such as
    /// bx (uT); - is standard input
    pub(crate) scan: PathBuf,
    /// Layout file of the film
    #[arg(long, value_name = "LAYOUT")]
    pub(crate) layout: PathBuf,
    /// What is fitted
    #[arg(
        long,
        value_enum,
        value_delimiter = ',',
        value_name = "WHAT",
        default_value = "strength,offset,rotation,start"
    )]
    pub(crate) fit: Vec<FitArg>,
    /// File for a table of the readings, corrected for offset and rotation, with the field of the
    /// layout and the residuals
    #[arg(long, value_name = "FILE")]
    pub(crate) save: Option<PathBuf>,
    /// Folder for figures of planes of the scan, measured beside simulated: B, and R_x, R_y, S_z
    /// (Dai 2024, Figs. 6 to 8)
    #[cfg(feature = "report")]
    #[arg(long, value_name = "FOLDER")]
    pub(crate) figures: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) result: ResultArgs,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum FitArg {
    /// The strength of all tiles over that of the layout
    Strength,
    /// Offset of the sensor and uniform stray field together
    Offset,
    /// Rotation of the sensor
    Rotation,
    /// Position of the sensor where the scan has its origin
    Start,
}

impl ScanArgs {
    pub(crate) fn free(&self) -> FreeParameters {
        let is_free = |what: FitArg| self.fit.contains(&what);
        FreeParameters {
            strength: is_free(FitArg::Strength),
            offset: is_free(FitArg::Offset),
            rotation: is_free(FitArg::Rotation),
            start: is_free(FitArg::Start),
        }
    }
}

/// Fit the stiffness of the elastic layer: forces against displacements.
///
/// Each row has a force on the film and what the sensor read. The displacement of the film is found
/// from the reading, by the exact field of the layout and, with [ideal], by the closed form of the
/// ideal film. For each axis and each way, a line F = stiffness x displacement + force at rest is
/// fitted by least squares (Dai 2024, Eqs. 16 and 17): six coefficients, with intervals of 95 %
/// confidence.
#[derive(Args)]
#[command(after_help = "Example:\n  magsplice calibrate forces.csv --layout film.toml --zero 20")]
pub(crate) struct CalibrateArgs {
    /// CSV file with columns fx_n, fy_n, fz_n and bx_mt, by_mt, bz_mt, or in other units, such as
    /// Fx (mN) and Bx (uT); - is standard input
    pub(crate) readings: PathBuf,
    /// Layout file of the film
    #[arg(long, value_name = "LAYOUT")]
    pub(crate) layout: PathBuf,
    /// The first N readings are of the film at rest: their mean, less the field of the film at the
    /// reference point, is subtracted from all
    #[arg(long, value_name = "N", default_value = "0")]
    pub(crate) zero: usize,
    /// The first N readings are of the film at rest: displacements count from the position of their
    /// mean, not from the reference point
    #[arg(long, value_name = "N", default_value = "0", conflicts_with = "zero")]
    pub(crate) rest: usize,
    #[command(flatten)]
    pub(crate) result: ResultArgs,
}
