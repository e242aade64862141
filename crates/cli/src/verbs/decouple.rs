//! `magsplice decouple`: field, distance from the ideal film and decoupling error of a film.

use magsplice::decouple::PerParameter;
use magsplice::field::{Accuracy, Comparison, IdealFilm, Tolerance};
use magsplice::layout::{Layout, WorkingVolume};
use magsplice::prelude::{DVec3, Decoupling, Parameters as AtPoint};
use magsplice::{Film, FilmError, Stage};
use magsplice_export::{ColumnQuantity, MetadataValue, Points, Table};
use serde::Serialize;

use crate::args::{DecoupleArgs, QuantityArg};
use crate::failure::{self, Failure};
use crate::formats::{self, ReportFormat, TableFormat};
use crate::output::Output;
use crate::progress::Progress;
use crate::text;
use crate::verbs::compare::ComparisonReport;

pub(crate) fn run(args: &DecoupleArgs, quiet: bool) -> Result<(), Failure> {
    let format = formats::choose(args.format, args.output.as_deref(), Some(ReportFormat::Text))?;
    if let ReportFormat::Table(format) = format {
        formats::accept(format, args.output.as_deref(), true)?;
    }
    let progress = Progress::start(!quiet);
    let tell = |stage: Stage| progress.show(stage);
    let layout = Layout::read(&args.layout)?;
    let film = Film::new(&layout).with_accuracy(args.accuracy.get()).with_progress(&tell);
    let failed = |error| text::film_failure(&args.layout, &layout, error);
    film.ideal().and(film.volume().map(|_| ())).map_err(failed)?;
    // Whether the file can be written is known before anything is computed.
    let mut output = Output::open(args.output.as_deref(), &[&args.layout])?;
    let evaluated = Evaluated::of(&film).map_err(failed)?;
    let ReportFormat::Table(format) = format else {
        let text = evaluated.text().map_err(failed)?;
        progress.end();
        output.write(|w| w.write_all(text.as_bytes()))?;
        return output.finish();
    };
    let table = evaluated.table();
    match &output {
        Output::Stdout(_) => progress.end(),
        _ => progress.show(Stage::uncounted("writing")),
    }
    formats::write(&table, &evaluated.report(Some(&table)), format, &mut output)?;
    output.finish()?;
    progress.end();
    let singular = evaluated.decoupling.singular.len();
    if singular > 0 && !quiet && format != TableFormat::Json {
        let points = if singular == 1 { "point has" } else { "points have" };
        failure::tell(&format_args!("{singular} singular {points} B_z = 0: their R_x, R_y, S_z are written as NaN"));
    }
    Ok(())
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

    #[cfg(feature = "report")]
    pub(crate) fn into_field_t(self) -> Vec<DVec3> {
        self.field_t
    }

    #[cfg(feature = "report")]
    pub(crate) fn json(&self) -> String {
        text::json(&self.report(None))
    }

    fn report<'t>(&self, table: Option<&'t Table>) -> Report<'t>
    where
        'a: 't,
    {
        let Evaluated { film, ideal, volume, comparison, decoupling, .. } = self;
        let k = ideal.wavenumber();
        Report {
            source: Source::of(film),
            points: volume.grid.len(),
            reference_mm: volume.reference_mm.to_array(),
            uniformity_rmse: decoupling.uniformity_rmse.into(),
            uniformity_rmse_mm: decoupling.uniformity_rmse.as_lengths(k).into(),
            ideal_rmse: decoupling.ideal_rmse.into(),
            displacement_rmse_mm: decoupling.ideal_rmse.as_lengths(k).into(),
            singular_points_mm: decoupling.singular.iter().map(DVec3::to_array).collect(),
            comparison: comparison.into(),
            table: table.map(|table| Columns { shape: table.points().shape(), columns: table }),
        }
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

    /// B and the parameters at every point of the volume.
    fn table(&self) -> Table {
        let Evaluated { film, volume, field_t, decoupling, .. } = self;
        let (b, b_components) = QuantityArg::B.names();
        let parameter = |components: &'static [&'static str; 1], of: fn(&AtPoint) -> f64| {
            let values = decoupling.parameters.iter().map(|p| p.as_ref().map_or(f64::NAN, of)).collect();
            ColumnQuantity { name: components[0], components, values }
        };
        let all = |p: PerParameter| MetadataValue::Numbers(vec![p.r_x, p.r_y, p.s_z]);
        let mut metadata = formats::metadata(film);
        metadata.extend([
            ("reference_mm", MetadataValue::Numbers(volume.reference_mm.to_array().to_vec())),
            ("uniformity_rmse", all(decoupling.uniformity_rmse)),
            ("ideal_rmse", all(decoupling.ideal_rmse)),
            ("singular_points", MetadataValue::Count(decoupling.singular.len())),
        ]);
        let quantities = vec![
            ColumnQuantity {
                name: b,
                components: b_components,
                values: field_t.iter().flat_map(DVec3::to_array).collect(),
            },
            parameter(&["r_x_rad"], |p| p.r_x),
            parameter(&["r_y_rad"], |p| p.r_y),
            parameter(&["s_z"], |p| p.s_z),
        ];
        Table::new(Points::Grid(volume.grid), quantities, metadata).expect("every point has a value")
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
            Accuracy::Within(Tolerance::Relative { fraction, .. }) => AccuracyReport::Relative(fraction),
            Accuracy::Within(Tolerance::AbsoluteT { error_t, .. }) => AccuracyReport::AbsoluteT(error_t),
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
    /// Every point, where that is asked for.
    #[serde(flatten)]
    table: Option<Columns<'a>>,
}

#[derive(Serialize)]
struct Columns<'a> {
    /// Of the columns as an array: counts along x, y, z.
    shape: Vec<usize>,
    columns: &'a Table,
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
