//! Points of a file for the verbs that compare with the ideal film.

use std::path::Path;

use magsplice::FilmError;
use magsplice::ideal::IdealFilm;
use magsplice::layout::Layout;
use magsplice::prelude::DVec3;

use crate::args::points::LengthUnitArg;
use crate::failure::Failure;
use crate::faults::FaultList;
use crate::inputs::points;
use crate::words::{film_failure, no_field};

/// The points of a file, which stay below the film.
pub(crate) struct GivenPoints<'a> {
    pub(crate) path: &'a Path,
    pub(crate) points: Vec<DVec3>,
    lines: Vec<u64>,
}

impl<'a> GivenPoints<'a> {
    /// Reads the points. The failure names all that are not below the film and, `within_half_wave`,
    /// all that are half a wavelength or more from the axis. `tell` prints a remark about the file.
    pub(crate) fn read(
        path: &'a Path,
        unit: Option<LengthUnitArg>,
        ideal: &IdealFilm,
        within_half_wave: bool,
        tell: &dyn Fn(&str),
    ) -> Result<GivenPoints<'a>, Failure> {
        let (points, lines) = points::read_all(path, unit, tell)?;
        let half = 0.5 * ideal.wavelength();
        let mut faults = FaultList::default();
        for (p, line) in points.iter().zip(&lines) {
            let at = || format!("line {line}: ({}, {}, {}) mm", p.x, p.y, p.z);
            if ideal.flux_density_t(*p).is_none() {
                faults.add(*line, format!("{} is not below the film, and Eq. 2 holds only for z < 0", at()));
            } else if within_half_wave && p.x.abs().max(p.y.abs()) >= half {
                let (axis, value) = if p.x.abs() >= half { ('x', p.x) } else { ('y', p.y) };
                faults.add(
                    *line,
                    format!(
                        "{}: {axis} = {value}, must be less than half a wavelength, {half} mm, from the axis, where \
                         R_{axis} repeats itself",
                        at()
                    ),
                );
            }
        }
        if faults.is_empty() {
            Ok(GivenPoints { path, points, lines })
        } else {
            Err(faults.failure(path.display().to_string()))
        }
    }

    /// The failure of a film at these points: points without a field with their lines.
    pub(crate) fn failure(&self, layout_path: &Path, layout: &Layout, error: FilmError) -> Failure {
        let FilmError::Points(errors) = error else { return film_failure(layout_path, layout, error) };
        let mut faults = FaultList::default();
        for error in errors.0 {
            let (line, p, cause) = (self.lines[error.index], error.point, no_field(error.cause, layout));
            faults.add(line, format!("line {line}: ({}, {}, {}) mm: {cause}", p.x, p.y, p.z));
        }
        faults.failure(self.path.display().to_string())
    }
}
