//! Rules of the table `rotation` of a tile.

use crate::read::faults::TableFaults;
use crate::read::names::shown;
use crate::rotation::{EulerOrder, InvalidEulerOrder, Rotation};
use crate::tables::rotation::RotationTable;

/// The rotation of a table, or `None` after adding its faults.
pub(crate) fn resolve(table: &RotationTable, faults: &mut TableFaults) -> Option<Rotation> {
    let RotationTable { axis, angle_deg, quaternion, euler_deg, order, matrix } = table;
    let given = [
        ("axis and angle_deg", axis.is_some() || angle_deg.is_some()),
        ("quaternion", quaternion.is_some()),
        ("euler_deg and order", euler_deg.is_some() || order.is_some()),
        ("matrix", matrix.is_some()),
    ];
    let given: Vec<&str> = given.into_iter().filter(|(_, given)| *given).map(|(keys, _)| keys).collect();
    if given.len() != 1 {
        let found = if given.is_empty() { "nothing".to_owned() } else { given.join(", ") };
        faults.add(format!(
            "rotation gives {found}, must give one of: axis and angle_deg; quaternion; euler_deg and order; matrix"
        ));
        return None;
    }
    let rotation = match (axis, angle_deg, quaternion, euler_deg, order, matrix) {
        (Some(axis), Some(angle_deg), ..) => Rotation::from_axis_angle(*axis, *angle_deg),
        (_, _, Some(quaternion), ..) => Rotation::from_quaternion(*quaternion),
        (_, _, _, Some(euler_deg), Some(order), _) => {
            let order: EulerOrder = order
                .parse()
                .map_err(|rule: InvalidEulerOrder| {
                    faults.add(format!("rotation.order = \"{}\", {rule}", shown(order)));
                })
                .ok()?;
            Rotation::from_euler(*euler_deg, order)
        }
        (.., Some(matrix)) => Rotation::from_matrix(*matrix),
        _ => {
            let missing = match (axis.is_some(), angle_deg.is_some(), euler_deg.is_some()) {
                (true, ..) => "axis without an angle_deg",
                (_, true, _) => "angle_deg without an axis",
                (.., true) => "euler_deg without an order, such as \"xyz\"",
                _ => "order without euler_deg",
            };
            faults.add(format!("rotation has {missing}"));
            return None;
        }
    };
    rotation.map_err(|broken| broken.0.into_iter().for_each(|fault| faults.add(format!("rotation.{fault}")))).ok()
}
