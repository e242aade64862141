//! Faults of a log of forces and readings.

use glam::{DMat3, DVec3};
use magsplice_magnet::Axis;
use magsplice_scan::FrozenLog;
use thiserror::Error;

use super::significant::number;

/// Least share of the coefficients of a force, in the fit to displacements along all three axes,
/// that its own axis has: axes turned by 60 degrees have it. Axes along which the film moves alike
/// have a half each.
const OWN_SHARE: f64 = 0.25;

/// Least share of the variation of a force that the fit explains: other forces are noise.
const EXPLAINED: f64 = 0.5;

/// Least deviation of the displacement along an axis over the largest, without which a force along
/// it tells nothing.
const LEAST_MOTION: f64 = 0.2;

/// Added to the correlations of the displacements, so that those along a line have a fit too, with
/// equal shares: far above round-off and the noise of a sensor, far below a measured correlation.
const RIDGE: f64 = 1e-3;

/// Most rows by which forces are tried to be late or early against the readings.
const MOST_SHIFT: i64 = 10;

/// Least number of pairs for which another shift of the rows is no accident.
const LEAST_SHIFTED: usize = 12;

/// Unexplained share of the forces over that with the rows as they are, below which a shift of the
/// rows is named: the residual is half.
const SHIFTED: f64 = 0.25;

/// Unexplained share of the forces up to which no shift is looked for: a residual of a tenth.
const GOOD: f64 = 0.01;

/// Share of the rows, and least number of them, that have the extreme of a force only where the
/// load cell is at its limit.
const AT_LIMIT: (f64, usize) = (0.05, 4);

/// Share of the deviation of the displacement, within rows of one force, above which the film moves
/// there.
const MOVES: f64 = 0.2;

/// Share of the residual of a straight line that another cause explains where it is named.
const OTHER_CAUSE: f64 = 0.5;

/// A fault of a log, which straight lines of the forces over the displacements show.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum LogFault {
    /// The forces do not change while the film moves.
    #[error("{0} of the forces while the film moves: the log was frozen; leave these rows out")]
    Frozen(FrozenLog),
    /// A force does not change while the film moves along its axis.
    #[error(
        "rows {} to {} have the same force along {axis} while the film moves along it: the log was frozen; leave these rows \
         out", frozen.first + 1, frozen.first + frozen.count
    )]
    FrozenForce {
        /// The axis of the force.
        axis: Axis,
        /// The rows.
        frozen: FrozenLog,
    },
    /// The readings do not change while the forces do.
    #[error("{0} of the readings while the forces change: the log was frozen; leave these rows out")]
    FrozenReadings(FrozenLog),
    /// Many rows have the extreme of a force while the film moves.
    #[error(
        "{rows} rows have the {} force along {axis}, {} N, while the film moves: the load cell was at its limit; leave \
         these rows out", if *.force_n > 0.0 { "largest" } else { "smallest" }, number(*.force_n)
    )]
    AtLimit {
        /// The axis of the force.
        axis: Axis,
        /// The force.
        force_n: f64,
        /// Number of rows.
        rows: usize,
    },
    /// Forces belong to readings of other rows, before or after their own.
    #[error(
        "the forces fit the readings {} {} {} far better than those of their own rows: forces and readings are not in step, \
         or the layer creeps; move the columns against each other",
        .0.abs(), if .0.abs() == 1 { "row" } else { "rows" }, if *.0 > 0 { "before" } else { "after" }
    )]
    Late(i64),
    /// A force follows displacements along other axes alone.
    #[error(
        "the force along {0} follows displacements along other axes, not along {0}: the columns of the forces or of the \
         sensor are exchanged"
    )]
    Exchanged(Axis),
    /// A force follows displacements along another axis too.
    #[error(
        "the force along {force} follows displacements along {other} too: the axes of the load cell are turned against \
         those of the sensor, or the layer couples them"
    )]
    Coupled {
        /// The axis of the force.
        force: Axis,
        /// The other axis.
        other: Axis,
    },
    /// A force changes with time.
    #[error(
        "the force along {axis} drifts by {} N from the first row to the last: the load cell drifts, or the layer creeps", number(*.drift_n)
    )]
    Drift {
        /// The axis of the force.
        axis: Axis,
        /// Its change.
        drift_n: f64,
    },
}

impl LogFault {
    /// The faults of a log. A missing force, and a displacement of a reading without a position,
    /// are NaN.
    pub(super) fn of_log(forces_n: &[DVec3], displacements_mm: &[DVec3]) -> Vec<LogFault> {
        let changes = |of: &[DVec3], within: &FrozenLog| {
            Axis::ALL.iter().any(|axis| {
                let along = |rows: &[DVec3]| deviation(rows.iter().map(|row| row[axis.index()]));
                along(&of[within.rows()]) > MOVES * along(of)
            })
        };
        let forces = FrozenLog::among(forces_n).filter(|frozen| changes(displacements_mm, frozen));
        let readings = FrozenLog::among(displacements_mm).filter(|frozen| changes(forces_n, frozen));
        let frozen = forces.map(LogFault::Frozen).into_iter().chain(readings.map(LogFault::FrozenReadings));
        let mut faults: Vec<LogFault> = frozen.collect();
        if faults.is_empty() {
            let of_axis = |axis: Axis| {
                let along = |of: &[DVec3]| -> Vec<DVec3> {
                    of.iter().map(|row| DVec3::new(row[axis.index()], f64::NAN, f64::NAN)).collect()
                };
                let frozen = FrozenLog::among(&along(forces_n))?;
                changes(&along(displacements_mm), &frozen).then_some(LogFault::FrozenForce { axis, frozen })
            };
            faults.extend(Axis::ALL.into_iter().filter_map(of_axis));
        }
        // Whatever else the lines show is a consequence.
        if faults.is_empty() {
            let exchanged = exchanged(forces_n, displacements_mm);
            faults.extend(late_rows(forces_n, displacements_mm).map(LogFault::Late));
            let is_clear = faults.is_empty() && exchanged.is_empty();
            for axis in Axis::ALL {
                let limit = at_limit(axis, forces_n, displacements_mm);
                let other = || other_cause(axis, forces_n, displacements_mm);
                faults.extend(limit.or_else(|| other().filter(|_| is_clear)));
            }
            faults.extend(exchanged.into_iter().map(LogFault::Exchanged));
        }
        faults
    }
}

/// The standard deviation of the values that are there; 0 without any.
fn deviation(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt()
}

/// Rows that have the extreme of a force along an axis while the film moves along it.
fn at_limit(axis: Axis, forces_n: &[DVec3], displacements_mm: &[DVec3]) -> Option<LogFault> {
    let index = axis.index();
    let forces = || forces_n.iter().map(|force| force[index]).filter(|force| force.is_finite());
    let moved = |force_n: Option<f64>| {
        let rows = forces_n.iter().zip(displacements_mm);
        let of_force = rows.filter(move |(force, _)| force_n.is_none_or(|force_n| force[index] == force_n));
        of_force.map(|(_, displacement)| displacement[index])
    };
    let count = forces().count() as f64;
    let is_limit = |force_n: &f64| {
        let rows = moved(Some(*force_n)).count();
        let (share, least) = AT_LIMIT;
        let has_many = rows >= least && rows as f64 >= share * count && (rows as f64) < count;
        has_many && deviation(moved(Some(*force_n))) > MOVES * deviation(moved(None))
    };
    let extremes = [forces().reduce(f64::max), forces().reduce(f64::min)];
    let force_n = extremes.into_iter().flatten().find(is_limit)?;
    Some(LogFault::AtLimit { axis, force_n, rows: moved(Some(force_n)).count() })
}

/// What explains most of the residual of a straight line of the force along an axis.
fn other_cause(axis: Axis, forces_n: &[DVec3], displacements_mm: &[DVec3]) -> Option<LogFault> {
    let index = axis.index();
    let rows = forces_n.iter().zip(displacements_mm).enumerate();
    let rows: Vec<(f64, f64, DVec3)> = rows
        .filter(|(_, (force, displacement))| force[index].is_finite() && displacement.is_finite())
        .map(|(row, (force, displacement))| (row as f64, force[index], *displacement))
        .collect();
    if rows.len() < LEAST_SHIFTED {
        return None;
    }
    let own: Vec<f64> = rows.iter().map(|(.., displacement)| displacement[index]).collect();
    let column = |of: &dyn Fn(&(f64, f64, DVec3)) -> f64| without(&rows.iter().map(of).collect::<Vec<_>>(), &own);
    let (residual, all) = (column(&|row| row.1), deviation(rows.iter().map(|row| row.1)));
    let squares = |of: &[f64]| of.iter().map(|value| value * value).sum::<f64>();
    if squares(&residual) <= GOOD * rows.len() as f64 * all * all {
        return None;
    }
    // The share of the residual that a column explains, and its coefficient.
    let explained = |column: &[f64]| {
        let product: f64 = column.iter().zip(&residual).map(|(a, b)| a * b).sum();
        let square = squares(column);
        if square > 0.0 { (product * product / square / squares(&residual), product / square) } else { (0.0, 0.0) }
    };
    let (time, per_row) = explained(&column(&|row| row.0));
    let others = Axis::ALL.into_iter().filter(|other| *other != axis);
    let (coupled, other) = others
        .map(|other| (explained(&column(&|row| row.2[other.index()])).0, other))
        .max_by(|a, b| a.0.total_cmp(&b.0))?;
    let drift_n = per_row * (forces_n.len() - 1) as f64;
    match time.max(coupled) > OTHER_CAUSE {
        true if time >= coupled => Some(LogFault::Drift { axis, drift_n }),
        true => Some(LogFault::Coupled { force: axis, other }),
        false => None,
    }
}

/// Values without their mean and their straight line over others.
fn without(values: &[f64], others: &[f64]) -> Vec<f64> {
    let centred = |of: &[f64]| {
        let mean = of.iter().sum::<f64>() / of.len() as f64;
        of.iter().map(|value| value - mean).collect::<Vec<f64>>()
    };
    let (values, others) = (centred(values), centred(others));
    let product: f64 = values.iter().zip(&others).map(|(a, b)| a * b).sum();
    let square: f64 = others.iter().map(|value| value * value).sum();
    let slope = if square > 0.0 { product / square } else { 0.0 };
    values.iter().zip(&others).map(|(value, other)| value - slope * other).collect()
}

/// Axes whose force follows displacements along other axes.
fn exchanged(forces_n: &[DVec3], displacements_mm: &[DVec3]) -> Vec<Axis> {
    let pairs = || forces_n.iter().zip(displacements_mm).filter(|(of, by)| of.is_finite() && by.is_finite());
    let count = pairs().count().max(1) as f64;
    let mean = |of: &dyn Fn(&DVec3, &DVec3) -> DVec3| pairs().map(|(force, by)| of(force, by)).sum::<DVec3>() / count;
    let (force, moved) = (mean(&|force, _| *force), mean(&|_, by| *by));
    // In units of their deviations, so that coefficients are comparable.
    let deviation = mean(&|_, by| (*by - moved).powf(2.0)).map(f64::sqrt);
    let unit = |by: &DVec3| (*by - moved) / deviation;
    let correlations = DMat3::from_cols_array_2d(&[0, 1, 2].map(|j| mean(&|_, by| unit(by)[j] * unit(by)).to_array()));
    let inverse = (correlations + DMat3::from_diagonal(DVec3::splat(RIDGE))).inverse();
    let is_exchanged = |axis: &Axis| {
        let i = axis.index();
        let covariances = mean(&|of, by| (of - force)[i] * unit(by));
        let fitted = inverse * covariances;
        let explained = fitted.dot(covariances) / mean(&|of, _| (of - force).powf(2.0))[i];
        let own_share = fitted[i].powi(2) / fitted.length_squared();
        deviation[i] > LEAST_MOTION * deviation.max_element() && explained > EXPLAINED && own_share < OWN_SHARE
    };
    Axis::ALL.into_iter().filter(is_exchanged).collect()
}

/// Rows by which forces are later than the displacements of a film, negative if earlier. `None` if
/// no shift halves the residual of straight lines.
fn late_rows(forces_n: &[DVec3], displacements_mm: &[DVec3]) -> Option<i64> {
    let (rows, as_they_are) = (forces_n.len() as i64, unexplained(forces_n, displacements_mm, 0)?);
    let of_shift = |shift: i64| Some((shift, unexplained(forces_n, displacements_mm, shift)?));
    let tried = (-MOST_SHIFT..=MOST_SHIFT).filter(|shift| shift.abs() < rows).filter_map(of_shift);
    let (shift, least) = tried.min_by(|a, b| a.1.total_cmp(&b.1))?;
    (as_they_are > GOOD && least < SHIFTED * as_they_are).then_some(shift)
}

/// The share of the variation of the forces along all axes that straight lines do not explain,
/// where each force belongs to the displacement `shift` rows before. `None` for too few pairs.
fn unexplained(forces_n: &[DVec3], displacements_mm: &[DVec3], shift: i64) -> Option<f64> {
    let (mut sum, mut axes) = (0.0, 0);
    for axis in 0..3 {
        let displacement = |row: usize| displacements_mm.get(usize::try_from(row as i64 - shift).ok()?);
        let pair = |(row, force): (usize, &DVec3)| Some((displacement(row)?[axis], force[axis]));
        let pairs = forces_n.iter().enumerate().filter_map(pair).filter(|(d, f)| d.is_finite() && f.is_finite());
        let pairs: Vec<(f64, f64)> = pairs.collect();
        if pairs.len() < LEAST_SHIFTED {
            continue;
        }
        let count = pairs.len() as f64;
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / count;
        let (d, f) = (mean(&|pair| pair.0), mean(&|pair| pair.1));
        let (dd, ff) = (mean(&|pair| (pair.0 - d).powi(2)), mean(&|pair| (pair.1 - f).powi(2)));
        let df = mean(&|pair| (pair.0 - d) * (pair.1 - f));
        if dd * ff > 0.0 {
            sum += 1.0 - df * df / (dd * ff);
            axes += 1;
        }
    }
    (axes > 0).then(|| sum / f64::from(axes))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Motions along all axes, which no line of rows or of another axis explains.
    fn displacements_mm() -> Vec<DVec3> {
        let at = |n: usize| {
            let wave = |first: f64, step: f64| (first + step * n as f64).sin();
            DVec3::new(wave(0.3, 1.1), wave(1.7, 2.3), -0.5 + 0.5 * wave(0.9, 3.1))
        };
        (0..60).map(at).collect()
    }

    /// Forces of a layer, a hundredth wrong.
    fn forces_n(displacements_mm: &[DVec3]) -> Vec<DVec3> {
        let force = |(n, moved): (usize, &DVec3)| DVec3::new(2.0, 2.1, 5.7) * (*moved + 0.01 * (97.0 * n as f64).sin());
        displacements_mm.iter().enumerate().map(force).collect()
    }

    fn found(change: impl Fn(&mut Vec<DVec3>, &mut Vec<DVec3>)) -> Vec<LogFault> {
        let mut moved = displacements_mm();
        let mut forces = forces_n(&moved);
        change(&mut forces, &mut moved);
        LogFault::of_log(&forces, &moved)
    }

    #[test]
    fn faults_of_logs_are_named() {
        assert_eq!(found(|_, _| ()), []);
        let frozen = FrozenLog { first: 30, count: 30 };
        let freeze = |rows: &mut Vec<DVec3>| {
            let last = rows[30];
            rows[30..].fill(last);
        };
        let all = found(|forces, _| freeze(forces));
        assert_eq!(all, [LogFault::Frozen(frozen)]);
        let alone = found(|forces, _| {
            let stuck = forces[30].z;
            forces[30..].iter_mut().for_each(|force| force.z = stuck);
        });
        assert_eq!(alone, [LogFault::FrozenForce { axis: Axis::Z, frozen }]);
        let readings = found(|_, moved| freeze(moved));
        assert_eq!(readings, [LogFault::FrozenReadings(frozen)]);
        let limited = found(|forces, _| forces.iter_mut().for_each(|force| force.z = force.z.max(-4.0)));
        assert!(
            matches!(limited[..], [LogFault::AtLimit { axis: Axis::Z, force_n: -4.0, rows: 15..25 }]),
            "{limited:?}"
        );
        let late = found(|forces, _| forces.rotate_right(2));
        assert_eq!(late, [LogFault::Late(2)]);
        let drifting = found(|forces, _| {
            forces.iter_mut().enumerate().for_each(|(n, force)| force.z += 1.5 * n as f64 / 59.0);
        });
        let [LogFault::Drift { axis: Axis::Z, drift_n }] = drifting[..] else { panic!("{drifting:?}") };
        assert!((drift_n - 1.5).abs() < 0.1, "{drift_n}");
        let (sine, cosine) = 20.0_f64.to_radians().sin_cos();
        let turned = found(|forces, _| {
            let turn = |of: &DVec3| DVec3::new(cosine * of.x - sine * of.y, sine * of.x + cosine * of.y, of.z);
            forces.iter_mut().for_each(|force| *force = turn(force));
        });
        let coupled = |force: Axis, other: Axis| LogFault::Coupled { force, other };
        assert_eq!(turned, [coupled(Axis::X, Axis::Y), coupled(Axis::Y, Axis::X)]);
    }

    /// Forces that were read as a load cell rounds them, and a film at rest, are no faults.
    #[test]
    fn coarse_forces_and_rest_are_no_faults() {
        assert_eq!(found(|forces, _| forces.iter_mut().for_each(|force| *force = (10.0 * *force).round() / 10.0)), []);
        let rest = found(|forces, moved| {
            forces[..20].fill(DVec3::ZERO);
            moved[..20].fill(DVec3::ZERO);
        });
        assert_eq!(rest, []);
    }
}
