//! The columns of the magnetization of a tile in one of its forms, and the magnetization of a row.

use magsplice::layout::direction_from_degrees;
use magsplice::making::MeasuredMagnet;
use magsplice::prelude::DVec3;

use crate::csv_input::finder::{Column, Finder};
use crate::csv_input::quantities::{DIRECTION, Fit, MAGNETIZATION, MOMENT, POLARIZATION, STRENGTH, TILT};
use crate::csv_input::rows::Cells;

/// The columns of the magnetization.
pub(super) enum MagnetColumns {
    /// In tesla, also from a magnetization.
    Polarization([Column; 3]),
    Moment([Column; 3]),
    Strength {
        strength: Column,
        direction: Option<Column>,
        tilt: Option<Column>,
    },
}

/// What a magnetization must have.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum MagnetForm {
    /// A polarization, whatever the size of the tile: no moment, and no strength without direction.
    Polarization,
    Any,
}

/// How well a line has the names of a magnetization.
pub(super) fn fit(names: &[String]) -> Fit {
    POLARIZATION.fit(names).max(MAGNETIZATION.fit(names)).max(MOMENT.fit(names)).max(STRENGTH.fit(names))
}

/// The magnetization in its one form. `None` after adding a fault.
pub(super) fn find(finder: &mut Finder, form: MagnetForm) -> Option<MagnetColumns> {
    let is_any = form == MagnetForm::Any;
    let polarization = finder.group(&POLARIZATION);
    let magnetization = finder.group(&MAGNETIZATION);
    let moment = if is_any { finder.group(&MOMENT) } else { None };
    let strength = finder.column(&STRENGTH);
    let (direction, tilt) = (finder.column(&DIRECTION), finder.column(&TILT));
    let forms = [
        polarization.map(MagnetColumns::Polarization),
        magnetization.map(MagnetColumns::Polarization),
        moment.map(MagnetColumns::Moment),
        strength.map(|strength| MagnetColumns::Strength { strength, direction, tilt }),
    ];
    let mut found: Vec<MagnetColumns> = forms.into_iter().flatten().collect();
    let moments = if is_any { ", moment (moment_x_a_m2, ...)" } else { "" };
    if found.len() > 1 {
        finder.fault(format!(
            "has more than one of polarization (jx_t, ...), magnetization (mx_a_per_m, ...){moments} and strength \
             (strength_t), must have one of them"
        ));
        return None;
    }
    match found.pop() {
        None => {
            let mut needed = vec![POLARIZATION.needed(), MAGNETIZATION.needed()];
            needed.extend(is_any.then(|| MOMENT.needed()));
            needed.push(STRENGTH.needed());
            finder.missing(&needed);
            None
        }
        Some(MagnetColumns::Strength { direction: None, .. }) if !is_any || tilt.is_some() => {
            finder.missing(&[DIRECTION.needed()]);
            None
        }
        found => found,
    }
}

impl MagnetColumns {
    /// All columns.
    pub(super) fn columns(&self) -> Vec<Column> {
        match self {
            MagnetColumns::Polarization(columns) | MagnetColumns::Moment(columns) => columns.to_vec(),
            MagnetColumns::Strength { strength, direction, tilt } => {
                [Some(*strength), *direction, *tilt].into_iter().flatten().collect()
            }
        }
    }

    /// The column of a component of the polarization, for messages.
    pub(super) fn component(&self, axis: usize) -> Column {
        self.columns().get(axis).copied().unwrap_or_else(|| self.columns()[0])
    }

    /// The magnetization of a row. `None` after adding faults.
    pub(super) fn of_row(&self, cells: &mut Cells) -> Option<MeasuredMagnet> {
        match self {
            MagnetColumns::Polarization(columns) => cells.vector(columns).map(MeasuredMagnet::Polarization),
            MagnetColumns::Moment(columns) => cells.vector(columns).map(MeasuredMagnet::Moment),
            MagnetColumns::Strength { strength, direction: None, .. } => {
                cells.numbers(&[*strength]).map(|[strength_t]| MeasuredMagnet::Strength(strength_t))
            }
            MagnetColumns::Strength { strength, direction: Some(direction), tilt } => {
                let before = cells.faults.len();
                let [strength_t, direction_deg] = [*strength, *direction].map(|column| cells.number(column));
                let tilt_deg = tilt.map_or(0.0, |tilt| cells.number(tilt));
                let polarization_t = strength_t * direction_from_degrees([direction_deg, tilt_deg]);
                (cells.faults.len() == before).then_some(MeasuredMagnet::Polarization(polarization_t))
            }
        }
    }

    /// The polarization of a row, of columns of the form [`MagnetForm::Polarization`].
    pub(super) fn polarization_of_row(&self, cells: &mut Cells) -> Option<DVec3> {
        match self.of_row(cells)? {
            MeasuredMagnet::Polarization(polarization_t) => Some(polarization_t),
            _ => None,
        }
    }
}
