//! The columns that hold the properties of a block, found by their names.

use magsplice::layout::EulerOrder;

use crate::args::import::ImportArgs;
use crate::csv_input::limited_lines::shown;
use crate::csv_input::names::unit_in;
use crate::units::{self, FLUX_DENSITIES, LENGTHS, MAGNETIZATIONS, Unit};

/// Angles in degrees.
const DEGREES: [Unit; 1] = [("deg", 0)];

/// Columns without a unit.
const NO_UNIT: [Unit; 0] = [];

const AXES: [&str; 3] = ["x", "y", "z"];

/// A column, and the power of ten that converts its numbers to millimetres, tesla, A/m or degrees.
#[derive(Clone, Copy)]
pub(crate) struct Column {
    pub(crate) index: usize,
    pub(crate) exponent: i32,
}

/// The columns of all properties.
pub(crate) struct BlockColumns {
    pub(crate) name: Option<Column>,
    pub(crate) position: [Column; 3],
    pub(crate) size: [Column; 3],
    pub(crate) magnet: MagnetColumns,
    pub(crate) rotation: Option<RotationColumns>,
    /// Names of the columns that are not read.
    pub(crate) ignored: Vec<String>,
}

/// The columns of the polarization or the magnetization.
pub(crate) enum MagnetColumns {
    /// In tesla.
    Polarization([Column; 3]),
    /// In A/m.
    Magnetization([Column; 3]),
}

/// The columns of a rotation in one of its forms.
pub(crate) enum RotationColumns {
    Quaternion([Column; 4]),
    /// x, y, z of the axis, then the angle.
    AxisAngle([Column; 4]),
    /// In the order of the rotations.
    Euler([Column; 3], EulerOrder),
    /// Row by row.
    Matrix([Column; 9]),
}

impl RotationColumns {
    pub(crate) fn columns(&self) -> &[Column] {
        match self {
            RotationColumns::Quaternion(columns) | RotationColumns::AxisAngle(columns) => columns,
            RotationColumns::Euler(columns, _) => columns,
            RotationColumns::Matrix(columns) => columns,
        }
    }
}

/// Whether a line is the line of names: it has a position.
pub(crate) fn has_names(names: &[String]) -> bool {
    let is_length = |name: &String, axis: &str| {
        unit_in(name, axis).is_some_and(|unit| unit.is_empty() || units::exponent(&LENGTHS, &unit).is_some())
    };
    AXES.iter().all(|axis| names.iter().any(|name| is_length(name, axis)))
}

/// Finds the columns, or all that is wrong with the names.
pub(crate) fn find(names: &[String], args: &ImportArgs) -> Result<BlockColumns, Vec<String>> {
    let mut finder = Finder { names, used: vec![false; names.len()], faults: Vec::new() };
    let default = args.unit.map(|unit| unit.name());
    let name = finder.group("name", [["name", "label"]], &NO_UNIT, None).map(|[column]| column);
    let position = finder.group("position", AXES.map(|axis| [axis]), &LENGTHS, default);
    let size = finder.group("size", [["size_x", "dx"], ["size_y", "dy"], ["size_z", "dz"]], &LENGTHS, default);
    let polarization = finder.group("polarization", [["jx"], ["jy"], ["jz"]], &FLUX_DENSITIES, None);
    let magnetization = finder.group("magnetization", [["mx"], ["my"], ["mz"]], &MAGNETIZATIONS, None);
    let rotation = finder.rotation(args.euler);
    if let Some(unit) = default {
        finder.check_unit(unit, position.iter().chain(&size).flatten());
    }
    let magnet = match (polarization, magnetization) {
        (Some(columns), None) => Some(MagnetColumns::Polarization(columns)),
        (None, Some(columns)) => Some(MagnetColumns::Magnetization(columns)),
        (Some(_), Some(_)) => {
            finder
                .fault("has both polarization (jx_t, ...) and magnetization (mx_a_per_m, ...), must have one of them");
            None
        }
        (None, None) => {
            finder.missing("polarization: jx_t, jy_t, jz_t, or magnetization: mx_a_per_m, my_a_per_m, mz_a_per_m");
            None
        }
    };
    if position.is_none() {
        finder.missing("position: x_mm, y_mm, z_mm");
    }
    if size.is_none() {
        finder.missing("size: size_x_mm, size_y_mm, size_z_mm");
    }
    let ignored = names.iter().zip(&finder.used).filter(|(name, used)| !**used && !name.is_empty());
    let ignored = ignored.map(|(name, _)| shown(name)).collect();
    match (position, size, magnet) {
        (Some(position), Some(size), Some(magnet)) if finder.faults.is_empty() => {
            Ok(BlockColumns { name, position, size, magnet, rotation, ignored })
        }
        _ => Err(finder.faults),
    }
}

struct Finder<'a> {
    names: &'a [String],
    used: Vec<bool>,
    faults: Vec<String>,
}

impl Finder<'_> {
    fn fault(&mut self, fault: impl Into<String>) {
        self.faults.push(fault.into());
    }

    /// Adds the fault of a group without any column, unless its columns have faults already.
    fn missing(&mut self, columns: &str) {
        let group = columns.split(':').next().unwrap_or(columns);
        if !self.faults.iter().any(|fault| fault.starts_with(group)) {
            self.fault(format!("no columns of the {columns} (found: {})", shown(&self.names.join(","))));
        }
    }

    /// The columns of a group: one for each of `wanted`, which lists the names that it may have.
    /// `None` if there is no such column, or after adding a fault.
    fn group<const N: usize, const M: usize>(
        &mut self,
        group: &str,
        wanted: [[&str; M]; N],
        units: &[Unit],
        default: Option<&str>,
    ) -> Option<[Column; N]> {
        let found = wanted.map(|bases| self.columns(&bases, units));
        let missing: Vec<&str> = (0..N).filter(|i| found[*i].is_empty()).map(|i| wanted[i][0]).collect();
        if missing.len() == N {
            self.explain_unknown_units(group, &wanted, units);
            return None;
        }
        let faults = self.faults.len();
        if !missing.is_empty() {
            self.fault(format!("{group} has no column {}", missing.join(", ")));
        }
        let columns = found.map(|columns| {
            columns.iter().for_each(|(index, _)| self.used[*index] = true);
            let [(index, unit)] = &columns[..] else {
                if columns.len() > 1 {
                    let named: Vec<String> = columns.iter().map(|(index, _)| shown(&self.names[*index])).collect();
                    self.fault(format!("{group} has more than one column of a kind: {}", named.join(", ")));
                }
                return Column { index: 0, exponent: 0 };
            };
            let exponent = match (&**unit, default) {
                _ if units.is_empty() => 0,
                ("", None) => {
                    let (name, units) = (shown(&self.names[*index]), units::names(units));
                    self.fault(format!("{group} in the column {name} has no unit, must name one of: {units}"));
                    0
                }
                ("", Some(unit)) | (unit, _) => units::exponent(units, unit).unwrap_or(0),
            };
            Column { index: *index, exponent }
        });
        (self.faults.len() == faults).then_some(columns)
    }

    /// The columns with one of these names and a known unit or none, with their units.
    fn columns(&self, bases: &[&str], units: &[Unit]) -> Vec<(usize, String)> {
        let named = |(index, name): (usize, &String)| {
            let unit = bases.iter().find_map(|base| unit_in(name, base))?;
            (unit.is_empty() || units::exponent(units, &unit).is_some()).then_some((index, unit))
        };
        self.names.iter().enumerate().filter_map(named).collect()
    }

    /// Adds a fault for each column of a group whose unit is not one of the known.
    fn explain_unknown_units<const N: usize, const M: usize>(
        &mut self,
        group: &str,
        wanted: &[[&str; M]; N],
        units: &[Unit],
    ) {
        for (index, name) in self.names.iter().enumerate() {
            let unit = wanted.iter().flatten().find_map(|base| unit_in(name, base));
            if let Some(unit) = unit.filter(|_| !units.is_empty()) {
                self.used[index] = true;
                let (name, unit, known) = (shown(name), shown(&unit), units::names(units));
                self.faults.push(format!("{group} in the column {name} has the unit {unit}, must be one of: {known}"));
            }
        }
    }

    /// The rotation in its one form.
    fn rotation(&mut self, order: Option<EulerOrder>) -> Option<RotationColumns> {
        let before = self.faults.len();
        let quaternion = self.group("quaternion", [["qx"], ["qy"], ["qz"], ["qw"]], &NO_UNIT, None);
        let axis = self.group("axis", [["axis_x"], ["axis_y"], ["axis_z"]], &NO_UNIT, None);
        let angle = self.group("angle", [["angle"]], &DEGREES, None);
        let about = self.group("Euler angles", [["rx"], ["ry"], ["rz"]], &DEGREES, None);
        let numbered = self.group("Euler angles", [["euler_1"], ["euler_2"], ["euler_3"]], &DEGREES, None);
        let elements = ["r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"].map(|element| [element]);
        let matrix = self.group("matrix", elements, &NO_UNIT, None);
        if self.faults.len() > before {
            return None;
        }
        let mut forms = Vec::new();
        forms.extend(quaternion.map(RotationColumns::Quaternion));
        match (axis, angle) {
            (Some([x, y, z]), Some([angle])) => forms.push(RotationColumns::AxisAngle([x, y, z, angle])),
            (Some(_), None) => self.fault("axis has no column angle_deg"),
            (None, Some(_)) => self.fault("angle has no columns axis_x, axis_y, axis_z"),
            (None, None) => {}
        }
        for (columns, is_numbered) in [(about, false), (numbered, true)] {
            let Some(columns) = columns else { continue };
            let Some(order) = order else {
                self.fault(
                    "Euler angles have no order: give --euler xyz (about the fixed axes) or --euler XYZ (turned)",
                );
                continue;
            };
            let axes = order.axes();
            if is_numbered {
                forms.push(RotationColumns::Euler(columns, order));
            } else if axes[0] == axes[2] {
                self.fault(format!(
                    "Euler angles in the order {order} need columns euler_1_deg, euler_2_deg, euler_3_deg"
                ));
            } else {
                forms.push(RotationColumns::Euler(axes.map(|axis| columns[axis]), order));
            }
        }
        forms.extend(matrix.map(RotationColumns::Matrix));
        if self.faults.len() == before && forms.len() > 1 {
            self.fault("rotation is given in more than one form, must be a quaternion, axis and angle, Euler angles or a matrix");
        }
        if order.is_some() && self.faults.len() == before && !matches!(forms[..], [RotationColumns::Euler(..)]) {
            self.fault("--euler is given, and there are no columns rx_deg, ry_deg, rz_deg");
        }
        forms.pop().filter(|_| self.faults.len() == before)
    }

    /// Refuses `--unit` where a column names another unit.
    fn check_unit<'c>(&mut self, unit: &str, columns: impl Iterator<Item = &'c Column>) {
        let wanted = units::exponent(&LENGTHS, unit);
        let others: Vec<String> =
            columns.filter(|c| Some(c.exponent) != wanted).map(|c| shown(&self.names[c.index])).collect();
        if !others.is_empty() {
            self.fault(format!("--unit {unit} contradicts the columns {}: rename them", others.join(", ")));
        }
    }
}
