//! The numbers of one or more films as tables of a page.

use std::fmt::Write;

use glam::DVec3;
use magsplice::decouple::Figure;
use magsplice::magnet::Axis;
use magsplice::results::FilmEvaluation;

use crate::film_results::FilmResults;
use crate::survey::{BOUNDS_OF_ZERO, without_round_off};
use crate::typeset::{AXIS_NAMES, PARAMETER_NAMES, number};
use magsplice_live_page::html::escaped;

pub(crate) const MT_PER_T: f64 = 1e3;
pub(crate) const UM_PER_MM: f64 = 1e3;
pub(crate) const UT_PER_T: f64 = 1e6;
const PER_CENT: f64 = 1e2;

const COMPONENTS: [&str; 3] = ["B_x", "B_y", "B_z"];

/// Numbers of one kind.
pub(crate) struct NumberTable {
    /// The id of its heading.
    id: &'static str,
    pub(crate) heading: &'static str,
    columns: Vec<&'static str>,
    rows: Vec<Row>,
}

/// A row: one number, or one for each column.
struct Row {
    /// With its unit.
    name: String,
    /// For each film its numbers. `None` where there is none.
    films: Vec<Vec<Option<f64>>>,
}

/// A table whose rows are filled film by film.
struct Filling<'f, 'a> {
    films: &'f [FilmResults<'a>],
    table: NumberTable,
}

impl<'a> Filling<'_, 'a> {
    fn row(&mut self, name: impl Into<String>, of: impl Fn(&FilmResults<'a>) -> Option<Vec<Option<f64>>>) {
        let films: Vec<Vec<Option<f64>>> = self.films.iter().map(|film| of(film).unwrap_or_default()).collect();
        if films.iter().any(|numbers| !numbers.is_empty()) {
            self.table.rows.push(Row { name: name.into(), films });
        }
    }

    fn evaluated(&mut self, name: &str, of: impl Fn(&FilmEvaluation) -> Vec<Option<f64>>) {
        self.row(name, |film| film.evaluation.as_ref().map(&of));
    }
}

fn filled<'f, 'a>(
    films: &'f [FilmResults<'a>],
    id: &'static str,
    heading: &'static str,
    columns: &[&'static str],
    fill: impl FnOnce(&mut Filling<'f, 'a>),
) -> NumberTable {
    let table = NumberTable { id, heading, columns: columns.to_vec(), rows: Vec::new() };
    let mut filling = Filling { films, table };
    fill(&mut filling);
    filling.table
}

fn numbers(vector: DVec3, per_unit: f64) -> Vec<Option<f64>> {
    vector.to_array().map(|component| Some(per_unit * component)).to_vec()
}

/// All numbers of the films. A table without any row is left out.
pub(crate) fn number_tables(films: &[FilmResults]) -> Vec<NumberTable> {
    let all = [field(films), against_ideal(films), decoupling(films), made(films), sensor(films), recoil(films)];
    all.into_iter().filter(|table| !table.rows.is_empty()).collect()
}

fn field(films: &[FilmResults]) -> NumberTable {
    filled(films, "field", "Field", &COMPONENTS, |table| {
        table.row("at the reference point, mT", |film| Some(numbers(film.reference_field_t()?, MT_PER_T)));
        table.row("ideal film (Eq. 2) there, mT", |film| {
            let at_mm = film.survey.as_ref()?.volume.reference_mm;
            Some(numbers(film.film.ideal().ok()?.flux_density_t(at_mm)?, MT_PER_T))
        });
        for (name, pick) in [
            ("least in the volume, mT", DVec3::min as fn(DVec3, DVec3) -> DVec3),
            ("most in the volume, mT", DVec3::max),
        ] {
            table.row(name, |film| {
                let most = film.survey.as_ref()?.field_t.iter().copied().reduce(pick)?;
                Some(numbers(most, MT_PER_T))
            });
        }
    })
}

fn against_ideal(films: &[FilmResults]) -> NumberTable {
    filled(films, "against-ideal", "Against the ideal film (Eq. 2)", &COMPONENTS, |table| {
        table.evaluated("RMSE, mT", |found| numbers(found.comparison.component_rmse_t, MT_PER_T));
        table.evaluated("correlation", |found| found.comparison.correlation.to_vec());
        table.evaluated("best-fit amplitude", |found| vec![Some(found.comparison.amplitude)]);
        table.evaluated("relative RMSE as is", |found| vec![Some(found.comparison.relative_rmse)]);
        table.evaluated("relative RMSE after scaling", |found| vec![found.comparison.scaled_relative_rmse]);
        table.evaluated("largest difference, mT", |found| vec![Some(MT_PER_T * found.comparison.worst_t)]);
    })
}

fn decoupling(films: &[FilmResults]) -> NumberTable {
    filled(films, "decoupling", "Decoupling (Eq. 15)", &PARAMETER_NAMES, |table| {
        table.evaluated("uniformity RMSE", |found| found.decoupling.decoupling.uniformity_rmse.to_array().to_vec());
        table.evaluated("uniformity RMSE as displacement x, y, z, mm", |found| {
            found.decoupling.uniformity_rmse_mm.to_array().to_vec()
        });
        table.evaluated("RMSE against the ideal film", |found| {
            found.decoupling.decoupling.ideal_rmse.map(Some).to_array().to_vec()
        });
        table.evaluated("RMSE against the ideal film as displacement x, y, z, mm", |found| {
            found.decoupling.decoupling.displacement_rmse_mm.map(Some).to_array().to_vec()
        });
        table.evaluated("singular points (B_z = 0), excluded", |found| {
            vec![Some(found.decoupling.decoupling.singular.len() as f64)]
        });
    })
}

/// The name of a figure with its unit.
fn figure_name(figure: Figure) -> String {
    match figure {
        Figure::Uniformity(parameter) => format!("uniformity RMSE of {}", PARAMETER_NAMES[parameter.axis().index()]),
        Figure::Displacement(axis) => format!("displacement RMSE, {axis}, mm"),
        Figure::Amplitude => "amplitude, which 95 % and 99 % exceed".to_owned(),
    }
}

fn made(films: &[FilmResults]) -> NumberTable {
    let columns = ["as ordered", "median", "95 % of films", "99 % of films"];
    filled(films, "made", "Films as made", &columns, |table| {
        for figure in Figure::ALL {
            table.row(figure_name(figure), |film| {
                let of = film.input.samples.as_ref()?.found.figures.get(figure)?;
                let s = &of.statistics;
                let [most, nearly_all] = if figure == Figure::Amplitude { [s.p5, s.p1] } else { [s.p95, s.p99] };
                Some([of.nominal, s.p50.value, most.value, nearly_all.value].map(Some).to_vec())
            });
        }
        table.row("films that meet all bounds of [expect.made], %", |film| {
            Some(vec![Some(PER_CENT * film.input.samples.as_ref()?.found.yield_made.as_ref()?.value)])
        });
    })
}

fn sensor(films: &[FilmResults]) -> NumberTable {
    filled(films, "sensor", "Resolution of the sensor (standard deviations)", &AXIS_NAMES, |table| {
        table.row("noise of a reading, \u{b5}T", |film| {
            Some(numbers(film.resolution.as_ref()?.noise.deviation_t, UT_PER_T))
        });
        table.row("by the field of the layout, RMS, mm", |film| Some(numbers(film.resolution_mm()?.rms_mm, 1.0)));
        table.row("by the field of the layout, least, mm", |film| Some(numbers(film.resolution_mm()?.least_mm, 1.0)));
        table.row("by the field of the layout, largest, mm", |film| {
            Some(numbers(film.resolution_mm()?.largest_mm, 1.0))
        });
        table.row("by the closed form (Eq. 14), RMS, mm", |film| {
            let found = film.resolution.as_ref()?;
            Some(numbers(found.summary(found.by_closed_form_mm.as_ref()?)?.rms_mm, 1.0))
        });
        table.row("points out of range of the sensor", |film| {
            let saturated = film.resolution.as_ref()?.saturated.iter().filter(|is| **is).count();
            Some(vec![Some(saturated as f64)])
        });
    })
}

fn recoil(films: &[FilmResults]) -> NumberTable {
    filled(films, "recoil-numbers", "Recoil", &["without", "with", "known to"], |table| {
        for figure in Figure::ALL {
            table.row(figure_name(figure).replace(", which 95 % and 99 % exceed", ""), |film| {
                let found = film.film.recoil()?.summary.figures.as_ref()?;
                Some([&found.without, &found.with_recoil, &found.errors].map(|of| of.get(figure).copied()).to_vec())
            });
        }
        table.row("largest weakening of a tile, %", |film| {
            Some(vec![Some(PER_CENT * film.film.recoil()?.summary.largest_weakening)])
        });
        table.row("largest turn of a tile, degrees", |film| {
            Some(vec![Some(film.film.recoil()?.summary.largest_turn_deg)])
        });
    })
}

impl FilmResults<'_> {
    /// B at the reference point in tesla. Components that are round-off are 0.
    pub(crate) fn reference_field_t(&self) -> Option<DVec3> {
        let at_mm = self.survey.as_ref()?.volume.reference_mm;
        let bound_t = self.film.scene().error_bounds_t(&[at_mm])[0];
        Some(without_round_off(self.film.reference_field_t().ok()?, BOUNDS_OF_ZERO * bound_t))
    }

    /// The displacements that errors of the parameters along these axes are, in mm.
    pub(crate) fn uniformity_mm(&self) -> Option<[Option<f64>; 3]> {
        Some(self.evaluation.as_ref()?.decoupling.uniformity_rmse_mm.to_array())
    }

    /// The 95th percentiles of the displacement RMSE of films as made, in mm.
    pub(crate) fn made_mm(&self) -> Option<[f64; 3]> {
        let figures = &self.input.samples.as_ref()?.found.figures;
        let of = |axis| figures.get(Figure::Displacement(axis)).map(|of| of.statistics.p95.value);
        let [x, y, z] = Axis::ALL.map(of);
        Some([x?, y?, z?])
    }
}

fn text(value: Option<f64>) -> String {
    value.map_or("none".to_owned(), number)
}

const CELL: &str = "<td role=\"cell\">";

/// The tables of one film, each with a heading of this level.
pub(crate) fn tables_of_film(tables: &[NumberTable]) -> String {
    let mut html = String::new();
    for NumberTable { id, heading, columns, rows } in tables {
        html += &head(id, heading, columns.iter().map(|column| (*column).to_owned()));
        for Row { name, films } in rows {
            let numbers = &films[0];
            let all = (0..columns.len()).map(|column| numbers.get(column));
            html += &row(name, all.map(|value| format!("{CELL}{}</td>", value.map_or(String::new(), |v| text(*v)))));
        }
        html += "</tbody></table>\n";
    }
    html
}

/// The tables of two films: a row for each number, with both values and the second minus the first.
pub(crate) fn tables_of_pair(tables: &[NumberTable], labels: &[String; 2]) -> String {
    let mut html = String::new();
    for NumberTable { id, heading, columns, rows } in tables {
        html += &head(id, heading, labels.iter().cloned().chain(["second \u{2212} first".to_owned()]));
        for Row { name, films } in rows {
            let count = films.iter().map(Vec::len).max().unwrap_or(0);
            for (index, column) in columns.iter().enumerate().take(count) {
                let [first, second] = [0, 1].map(|film| films[film].get(index).copied().flatten());
                let difference = first.zip(second).map(|(first, second)| second - first);
                let name = if count > 1 { format!("{name}: {column}") } else { name.clone() };
                html += &row(&name, [first, second, difference].map(|value| format!("{CELL}{}</td>", text(value))));
            }
        }
        html += "</tbody></table>\n";
    }
    html
}

/// A heading, and a table up to its first row. Roles are explicit: on a telephone the table has
/// another display, with which it would lose its own.
fn head(id: &str, heading: &str, columns: impl Iterator<Item = String>) -> String {
    let mut cells = String::new();
    let mut count = 0;
    for column in columns {
        let _ = write!(cells, "<th scope=\"col\" role=\"columnheader\">{column}</th>");
        count += 1;
    }
    format!(
        "<h3 id=\"{id}\">{heading}</h3>\n<table class=\"numbers\" role=\"table\" aria-labelledby=\"{id}\" style=\"--columns: \
         {count}\">\n<thead role=\"rowgroup\"><tr role=\"row\"><th scope=\"col\" role=\"columnheader\"></th>{cells}</tr></thead>\n\
         <tbody role=\"rowgroup\">\n"
    )
}

fn row(name: &str, cells: impl IntoIterator<Item = String>) -> String {
    let cells: String = cells.into_iter().collect();
    format!("<tr role=\"row\"><th scope=\"row\" role=\"rowheader\">{}</th>{cells}</tr>\n", escaped(name))
}

/// Entries of the contents: ids and headings.
pub(crate) fn entries(tables: &[NumberTable]) -> impl Iterator<Item = (String, String)> {
    tables.iter().map(|table| (table.id.to_owned(), table.heading.to_owned()))
}
