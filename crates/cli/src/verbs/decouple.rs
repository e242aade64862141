//! `magsplice decouple`: field, distance from the ideal film and decoupling error of a film.

use magsplice::decouple::{Decoupling, PerParameter};
use magsplice::field::{Accuracy, Comparison, IdealFilm, Tolerance};
use magsplice::layout::{Layout, WorkingVolume};
use magsplice::prelude::DVec3;
use magsplice::{Film, FilmError};
use serde::Serialize;

use crate::args::{Format, LayoutArgs};
use crate::failure::Failure;
use crate::output;
use crate::text;
use crate::verbs::compare::ComparisonReport;

pub(crate) fn run(args: &LayoutArgs) -> Result<(), Failure> {
    let layout = Layout::read(&args.layout)?;
    let film = Film::new(&layout).with_accuracy(args.accuracy.get());
    let failed = |error| text::film_failure(&args.layout, &layout, error);
    let evaluated = Evaluated::of(&film).map_err(failed)?;
    output::print(&match args.format {
        Format::Json => evaluated.json(),
        Format::Text => evaluated.text().map_err(failed)?,
    })
}

/// A film with all its numbers.
pub(crate) struct Evaluated<'a> {
    film: &'a Film<'a>,
    ideal: &'a IdealFilm,
    volume: &'a WorkingVolume,
    field_t: Vec<DVec3>,
    comparison: Comparison,
    decoupling: Decoupling,
}

impl<'a> Evaluated<'a> {
    pub(crate) fn of(film: &'a Film<'a>) -> Result<Evaluated<'a>, FilmError> {
        let ideal = film.ideal()?;
        let volume = film.volume()?;
        let field_t = film.volume_field_t()?;
        let comparison = film.compare(&field_t)?;
        let decoupling = film.decouple(&field_t)?;
        Ok(Evaluated { film, ideal, volume, field_t, comparison, decoupling })
    }

    pub(crate) fn json(&self) -> String {
        let Evaluated { film, ideal, volume, comparison, decoupling, .. } = self;
        let k = ideal.wavenumber();
        text::json(&Report {
            source: Source::of(film),
            points: volume.grid.len(),
            reference_mm: volume.reference_mm.to_array(),
            uniformity_rmse: decoupling.uniformity_rmse.into(),
            uniformity_rmse_mm: decoupling.uniformity_rmse.as_lengths(k).into(),
            ideal_rmse: decoupling.ideal_rmse.into(),
            displacement_rmse_mm: decoupling.ideal_rmse.as_lengths(k).into(),
            singular_points_mm: decoupling.singular.iter().map(DVec3::to_array).collect(),
            comparison: comparison.into(),
        })
    }

    pub(crate) fn text(&self) -> Result<String, FilmError> {
        let Evaluated { film, ideal, volume, field_t, comparison, decoupling } = self;
        let at_reference = film.reference_field_t()?;
        let sections = [
            text::header(film, volume),
            text::field(field_t, volume, at_reference, Some(ideal)),
            text::comparison(comparison),
            text::decoupling(decoupling, volume, ideal.wavenumber()),
        ];
        Ok(sections.join("\n"))
    }
}

/// What a result was made from and by.
#[derive(Serialize)]
pub(crate) struct Source<'a> {
    layout: &'a str,
    sha256: &'a str,
    version: &'static str,
    tiles: usize,
    accuracy: AccuracyReport,
}

/// How exact the field of the working volume is.
#[derive(Serialize)]
#[serde(rename_all = "snake_case")]
enum AccuracyReport {
    Exact,
    /// At most this fraction of |B| off at every point.
    Relative(f64),
    /// At most so many tesla off at every point.
    AbsoluteT(f64),
}

impl From<Accuracy> for AccuracyReport {
    fn from(accuracy: Accuracy) -> AccuracyReport {
        match accuracy {
            Accuracy::Exact => AccuracyReport::Exact,
            Accuracy::Within(Tolerance::Relative(fraction)) => AccuracyReport::Relative(fraction),
            Accuracy::Within(Tolerance::AbsoluteT(error_t)) => AccuracyReport::AbsoluteT(error_t),
        }
    }
}

impl<'a> Source<'a> {
    pub(crate) fn of(film: &Film<'a>) -> Source<'a> {
        let layout = film.layout();
        Source {
            layout: &layout.name,
            sha256: &layout.sha256,
            version: env!("CARGO_PKG_VERSION"),
            tiles: layout.tiles.len(),
            accuracy: film.scene().accuracy().into(),
        }
    }
}

#[derive(Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    source: Source<'a>,
    points: usize,
    reference_mm: [f64; 3],
    /// Spread of each parameter over the planes normal to its axis.
    uniformity_rmse: Parameters,
    uniformity_rmse_mm: Lengths,
    /// Error of each parameter's change from the reference point against Eq. 2.
    ideal_rmse: Parameters,
    /// The same as error of the displacement found by Eq. 14.
    displacement_rmse_mm: Lengths,
    singular_points_mm: Vec<[f64; 3]>,
    comparison: ComparisonReport,
}

#[derive(Serialize)]
struct Parameters {
    r_x: f64,
    r_y: f64,
    s_z: f64,
}

impl From<PerParameter> for Parameters {
    fn from(p: PerParameter) -> Parameters {
        Parameters { r_x: p.r_x, r_y: p.r_y, s_z: p.s_z }
    }
}

#[derive(Serialize)]
struct Lengths {
    x: f64,
    y: f64,
    z: f64,
}

impl From<DVec3> for Lengths {
    fn from(v: DVec3) -> Lengths {
        Lengths { x: v.x, y: v.y, z: v.z }
    }
}
