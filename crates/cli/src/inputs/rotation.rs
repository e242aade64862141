//! The columns of a rotation, and the rotation of a row.

use magsplice::layout::{EulerOrder, Rotation, RotationFaults};

use crate::csv_input::finder::{Column, Finder};
use crate::csv_input::quantities::Group;
use crate::csv_input::rows::Cells;
use crate::units::COLUMN_ANGLES;

/// The columns of a rotation in one of its forms.
pub(super) enum RotationColumns {
    Quaternion([Column; 4]),
    /// x, y, z of the axis, then the angle.
    AxisAngle([Column; 4]),
    /// In the order of the rotations. The angle of a missing column is 0.
    Euler([Option<Column>; 3], EulerOrder),
    /// Row by row.
    Matrix([Column; 9]),
}

impl RotationColumns {
    fn columns(&self) -> Vec<Column> {
        match self {
            RotationColumns::Quaternion(columns) | RotationColumns::AxisAngle(columns) => columns.to_vec(),
            RotationColumns::Euler(columns, _) => columns.iter().flatten().copied().collect(),
            RotationColumns::Matrix(columns) => columns.to_vec(),
        }
    }

    /// The rotation of a row. `None` if its cells are empty, or after adding faults.
    pub(super) fn of_row(&self, cells: &mut Cells) -> Option<Rotation> {
        if cells.are_empty(&self.columns()) {
            return None;
        }
        let rotation = match self {
            RotationColumns::Quaternion(columns) => Rotation::Quaternion(cells.numbers(columns)?),
            RotationColumns::AxisAngle(columns) => {
                let [x, y, z, angle_deg] = cells.numbers(columns)?;
                Rotation::AxisAngle { axis: [x, y, z], angle_deg }
            }
            RotationColumns::Euler(columns, order) => {
                let before = cells.faults.len();
                let angles_deg = columns.map(|column| column.map_or(0.0, |column| cells.number(column)));
                if cells.faults.len() > before {
                    return None;
                }
                Rotation::Euler { angles_deg, order: *order }
            }
            RotationColumns::Matrix(columns) => {
                let [a, b, c, d, e, f, g, h, i] = cells.numbers(columns)?;
                Rotation::Matrix([[a, b, c], [d, e, f], [g, h, i]])
            }
        };
        rotation.checked().map_err(|RotationFaults(broken)| cells.faults.extend(broken)).ok()
    }
}

/// Numbers such as `q0` do not say which component is the scalar.
const QUATERNION: Group<4> = plain(
    "quaternion",
    [
        &["qx", "q_x", "quat_x", "quatx", "quaternion_x"],
        &["qy", "q_y", "quat_y", "quaty", "quaternion_y"],
        &["qz", "q_z", "quat_z", "quatz", "quaternion_z"],
        &["qw", "q_w", "quat_w", "quatw", "quaternion_w"],
    ],
);
const AXIS: Group<3> = plain("axis", [&["axis_x"], &["axis_y"], &["axis_z"]]);
const MATRIX: Group<9> =
    plain("matrix", [&["r11"], &["r12"], &["r13"], &["r21"], &["r22"], &["r23"], &["r31"], &["r32"], &["r33"]]);
const ANGLE: Group<1> = angles("angle", [&["angle"]]);
const ABOUT_AXES: Group<3> = angles("Euler angles", [&["rx"], &["ry"], &["rz"]]);
const NUMBERED: Group<3> = angles("Euler angles", [&["euler_1"], &["euler_2"], &["euler_3"]]);

const fn plain<const N: usize>(name: &'static str, columns: [&'static [&'static str]; N]) -> Group<'static, N> {
    Group { name, columns, suffix: "", units: &[] }
}

const fn angles<const N: usize>(name: &'static str, columns: [&'static [&'static str]; N]) -> Group<'static, N> {
    Group { name, columns, suffix: "_deg", units: &COLUMN_ANGLES }
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// The columns that are read, for messages.
const READ: &str = "qx, qy, qz, qw (or quat_x, ...; qw is the scalar), axis_x, axis_y, axis_z, angle_deg, rx_deg, \
    ry_deg, rz_deg or euler_1_deg, euler_2_deg, euler_3_deg with --euler, or r11, r12, ... r33";

/// The rotation in its one form. Adds a fault for each column that looks like a rotation and is not
/// read: without it the blocks would stand unrotated.
pub(super) fn find(finder: &mut Finder, order: Option<EulerOrder>) -> Option<RotationColumns> {
    let before = finder.faults.len();
    let quaternion = finder.group(&QUATERNION);
    let axis = finder.group(&AXIS);
    let angle = finder.column(&ANGLE);
    let about = finder.partial_group(&ABOUT_AXES);
    let numbered = finder.group(&NUMBERED);
    let matrix = finder.group(&MATRIX);
    let unread: Vec<String> = finder.unused().into_iter().filter(|name| looks_like_rotation(name)).collect();
    if !unread.is_empty() {
        let (columns, look) = if unread.len() == 1 {
            ("column", "looks like a rotation and is")
        } else {
            ("columns", "look like a rotation and are")
        };
        finder.fault(format!(
            "{columns} {} {look} not read: name a rotation {READ}; leave out or rename other columns",
            unread.join(", ")
        ));
    }
    if finder.faults.len() > before {
        return None;
    }
    let mut forms = Vec::new();
    forms.extend(quaternion.map(RotationColumns::Quaternion));
    match (axis, angle) {
        (Some([x, y, z]), Some(angle)) => forms.push(RotationColumns::AxisAngle([x, y, z, angle])),
        (Some(_), None) => finder.fault("axis has no column angle_deg"),
        (None, Some(_)) => finder.fault("angle has no columns axis_x, axis_y, axis_z"),
        (None, None) => {}
    }
    forms.extend(euler_about_axes(finder, about, order));
    match (numbered, order) {
        (Some(columns), Some(order)) => forms.push(RotationColumns::Euler(columns.map(Some), order)),
        (Some(_), None) => finder.fault(NO_ORDER),
        (None, _) => {}
    }
    forms.extend(matrix.map(RotationColumns::Matrix));
    let faultless = finder.faults.len() == before;
    if faultless && forms.len() > 1 {
        finder.fault(
            "rotation is given in more than one form, must be a quaternion, axis and angle, Euler angles or a matrix",
        );
    } else if faultless && order.is_some() && !matches!(forms[..], [RotationColumns::Euler(..)]) {
        finder.fault(format!(
            "--euler is given, and there are no columns rx_deg, ry_deg, rz_deg or euler_1_deg, euler_2_deg, \
             euler_3_deg (found: {})",
            finder.names_found()
        ));
    }
    forms.pop().filter(|_| finder.faults.len() == before)
}

const NO_ORDER: &str = "Euler angles have no order: give --euler xyz (about the fixed axes) or --euler XYZ (turned)";

/// Angles in columns that name their axes, in the order of the rotations.
fn euler_about_axes(
    finder: &mut Finder,
    columns: [Option<Column>; 3],
    order: Option<EulerOrder>,
) -> Option<RotationColumns> {
    // A rotation about one axis is the same in every order.
    let any_order = || "xyz".parse().ok().filter(|_| columns.iter().flatten().count() == 1);
    let order = match (columns.iter().any(Option::is_some), order.or_else(any_order)) {
        (false, _) => return None,
        (true, Some(order)) => order,
        (true, None) => {
            finder.fault(NO_ORDER);
            return None;
        }
    };
    let axes = order.axes();
    let given: Vec<usize> = (0..AXES.len()).filter(|&axis| columns[axis].is_some()).collect();
    let names: Vec<String> = given.iter().map(|&axis| format!("r{}", AXES[axis])).collect();
    match given[..] {
        // A rotation about one axis does not depend on the order, as long as the order has this
        // axis.
        [axis] if axes.contains(&axis) => {
            let first = axes.iter().position(|&of_order| of_order == axis).unwrap_or(0);
            Some(RotationColumns::Euler([0, 1, 2].map(|turn| columns[axis].filter(|_| turn == first)), order))
        }
        _ if axes[0] != axes[2] => Some(RotationColumns::Euler(axes.map(|axis| columns[axis]), order)),
        [axis] => {
            finder.fault(format!(
                "the column {} is a rotation about {}, which the order {order} does not have: leave out --euler, or give \
                 the angles of {order} as euler_1_deg, euler_2_deg, euler_3_deg",
                names[0], AXES[axis]
            ));
            None
        }
        _ => {
            finder.fault(format!(
                "the columns {} fit two rotations about {} of the order {order}: name its angles \
                 euler_1_deg, euler_2_deg, euler_3_deg, or give an order such as --euler xyz",
                names.join(", "),
                AXES[axes[0]]
            ));
            None
        }
    }
}

/// Whether the name of a column seems to be that of a rotation.
fn looks_like_rotation(name: &str) -> bool {
    const BEGINNINGS: [&str; 4] = ["quat", "euler", "angle", "rot"];
    const WORDS: [&str; 13] =
        ["q", "rx", "ry", "rz", "alpha", "beta", "gamma", "roll", "pitch", "yaw", "phi", "theta", "psi"];
    let name = name.trim().to_lowercase();
    let word = name.split(|c: char| !c.is_alphabetic()).next().unwrap_or_default();
    // `qx` is the component of a quaternion, while `quality` is not.
    let is_component = word.len() == 2 && word.starts_with('q');
    // A rotor is a part of a motor.
    let begins = BEGINNINGS.iter().any(|beginning| word.starts_with(beginning)) && !word.starts_with("rotor");
    is_component || begins || WORDS.contains(&word)
}

#[cfg(test)]
mod tests {
    use super::looks_like_rotation;

    #[test]
    fn names_of_rotations_are_recognized() {
        for name in
            ["q0", "Q_1", "qx_deg", "quat_1", "Quaternion", "rot_z", "rotation", "euler_x", "angle z", "phi", "Yaw (°)"]
        {
            assert!(looks_like_rotation(name), "{name}");
        }
        for name in ["", "quality", "qty", "quantity", "rotor", "angel_deg", "grade", "phase", "rmse", "color"] {
            assert!(!looks_like_rotation(name), "{name}");
        }
    }
}
