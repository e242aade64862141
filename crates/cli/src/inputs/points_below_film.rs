//! Points of a file for the verbs that compare with the ideal film.

use std::path::Path;

use magsplice::FilmError;
use magsplice::prelude::DVec3;

use crate::args::points::PointsArgs;
use crate::failure::Failure;
use crate::faults::FaultList;
use crate::inputs::points;
use crate::session::Session;
use crate::text::number::point;
use crate::words::no_field;

/// The points of a file, which stay below the film.
pub(crate) struct GivenPoints<'a> {
    session: &'a Session<'a>,
    path: &'a Path,
    pub(crate) points: Vec<DVec3>,
    lines: Vec<u64>,
}

impl<'a> GivenPoints<'a> {
    /// Reads the points; `None` if the arguments have no file. The failure names all that are not
    /// below the film and, `within_half_wave`, all that are half a wavelength or more from the
    /// axis.
    pub(crate) fn read(
        session: &'a Session,
        args: &'a PointsArgs,
        within_half_wave: bool,
    ) -> Result<Option<GivenPoints<'a>>, Failure> {
        let (Some(path), Some(ideal)) = (args.path(), &session.layout.ideal) else { return Ok(None) };
        let (points, lines) = points::read_all(path, args.unit.as_ref(), &|remark| session.tell(remark))?;
        let half = 0.5 * ideal.wavelength();
        let mut faults = FaultList::default();
        for (p, line) in points.iter().zip(&lines) {
            let at = || format!("line {line}: {} mm", point(*p));
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
            Ok(Some(GivenPoints { session, path, points, lines }))
        } else {
            Err(faults.failure(path.display()))
        }
    }

    /// The file, and the number of its points.
    pub(crate) fn summary(&self) -> (&Path, usize) {
        (self.path, self.points.len())
    }

    /// The failure of a film at these points: points without a field with their lines.
    pub(crate) fn failure(&self, error: FilmError) -> Failure {
        let errors = match error {
            // The reference point is no point of the file.
            FilmError::Points(errors) if errors.0.iter().all(|e| self.points.get(e.index) == Some(&e.point)) => errors,
            error => return self.session.failed(error),
        };
        let mut faults = FaultList::default();
        for error in errors.0 {
            let (line, p) = (self.lines[error.index], error.point);
            let cause = no_field(error.cause, &self.session.layout);
            faults.add(line, format!("line {line}: ({}, {}, {}) mm: {cause}", p.x, p.y, p.z));
        }
        faults.failure(self.path.display())
    }
}
