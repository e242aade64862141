//! Exchanged and reversed axes.

use std::fmt;

use glam::{DMat3, DVec3};
use magsplice_magnet::Axis;
use serde::{Serialize, Serializer};

/// A signed exchange of axes: one of the 48 symmetries of a cube. Component i of a result is
/// component `axes[i]` of a vector, negative if `is_reversed[i]`.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct SignedAxes {
    axes: [Axis; 3],
    is_reversed: [bool; 3],
}

impl SignedAxes {
    /// All axes as they are.
    pub const SAME: SignedAxes = SignedAxes { axes: Axis::ALL, is_reversed: [false; 3] };

    /// z is reversed.
    pub(crate) const DOWNWARDS: SignedAxes = SignedAxes { axes: Axis::ALL, is_reversed: [false, false, true] };

    /// The 48 exchanges. The fewer changes, the earlier: [`SignedAxes::SAME`] is the first.
    pub fn all() -> Vec<SignedAxes> {
        let [x, y, z] = Axis::ALL;
        let orders = [[x, y, z], [y, x, z], [x, z, y], [z, y, x], [y, z, x], [z, x, y]];
        let signs = (0..8).map(|bits: u8| [0, 1, 2].map(|axis| bits >> axis & 1 == 1));
        let mut all: Vec<SignedAxes> =
            signs.flat_map(|is_reversed| orders.map(|axes| SignedAxes { axes, is_reversed })).collect();
        all.sort_by_key(|of| of.changes());
        all
    }

    /// Number of axes that are not as they were.
    fn changes(self) -> usize {
        let is_changed = |axis: &Axis| self.axes[axis.index()] != *axis || self.is_reversed[axis.index()];
        Axis::ALL.iter().filter(|axis| is_changed(axis)).count()
    }

    /// The exchanged vector.
    pub fn apply(self, vector: DVec3) -> DVec3 {
        DVec3::from([0, 1, 2].map(|i| {
            let component = vector[self.axes[i].index()];
            if self.is_reversed[i] { -component } else { component }
        }))
    }

    /// The exchange that reverts this one.
    pub fn inverse(self) -> SignedAxes {
        let mut inverse = SignedAxes::SAME;
        for axis in Axis::ALL {
            let from = self.axes[axis.index()].index();
            inverse.axes[from] = axis;
            inverse.is_reversed[from] = self.is_reversed[axis.index()];
        }
        inverse
    }

    /// The exchange as a matrix.
    pub fn matrix(self) -> DMat3 {
        DMat3::from_cols_array_2d(&DVec3::AXES.map(|axis| self.apply(axis).to_array()))
    }

    /// The exchange that is nearest to an orthogonal matrix, a rotation if the matrix is one.
    pub fn nearest(orthogonal: DMat3) -> SignedAxes {
        let likeness = |axes: &SignedAxes| -> f64 {
            let diagonal = (axes.matrix().transpose() * orthogonal).to_cols_array_2d();
            (0..3).map(|i| diagonal[i][i]).sum()
        };
        let is_rotation = orthogonal.determinant() > 0.0;
        let alike = SignedAxes::all().into_iter().filter(|axes| axes.is_rotation() == is_rotation);
        alike.max_by(|a, b| likeness(a).total_cmp(&likeness(b))).unwrap_or(SignedAxes::SAME)
    }

    /// Whether a rotation has the same effect.
    pub fn is_rotation(self) -> bool {
        self.matrix().determinant() > 0.0
    }

    /// What makes a sensor whose component i is component `axes[i]` of the field one without
    /// exchanged axes: other names of the columns, and gains.
    pub fn remedy(self) -> String {
        let mut gain = [1, 1, 1];
        for (axis, is_reversed) in self.axes.iter().zip(self.is_reversed) {
            gain[axis.index()] = if is_reversed { -1 } else { 1 };
        }
        let [x, y, z] = self.axes.map(|axis| axis.name());
        let names = (self.axes != Axis::ALL).then(|| format!("name the columns of the field b{x}, b{y}, b{z}"));
        let gains = (gain != [1, 1, 1]).then(|| format!("set gain = {gain:?} in [sensor]"));
        names.into_iter().chain(gains).collect::<Vec<_>>().join(", ")
    }

    /// [`SignedAxes::remedy`] for readings at stated positions. Before a film with mirror images, a
    /// stage with these axes reads the same.
    pub fn remedy_of_scan(self) -> String {
        let [x, y, z] = Axis::ALL;
        let of_stage = match (self.axes, self.is_reversed) {
            (Axis::ALL, [true, false, false]) => ", or, if x of the positions is reversed, change its column",
            (Axis::ALL, [false, true, false]) => ", or, if y of the positions is reversed, change its column",
            (axes, [false, false, false]) if axes == [y, x, z] => {
                ", or, if x and y of the positions are exchanged, exchange their columns"
            }
            _ => "",
        };
        self.remedy() + of_stage
    }

    /// What makes positions with these axes those that are stated.
    pub fn remedy_of_positions(self) -> &'static str {
        match self == SignedAxes::DOWNWARDS {
            true => "change their columns, or if one plane was scanned from another origin of z, its origin",
            false => "change their columns",
        }
    }

    /// The axes as three words: `-y` for the reversed y axis.
    pub fn names(self) -> [String; 3] {
        [0, 1, 2].map(|i| format!("{}{}", if self.is_reversed[i] { "-" } else { "" }, self.axes[i]))
    }
}

impl Serialize for SignedAxes {
    /// Three words such as `-y`.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.names().serialize(serializer)
    }
}

impl fmt::Display for SignedAxes {
    /// What is exchanged or reversed: `x and y are exchanged`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let moved: Vec<&str> = Axis::ALL.iter().filter(|a| self.axes[a.index()] != **a).map(|a| a.name()).collect();
        let reversed: Vec<&str> = Axis::ALL.iter().filter(|a| self.is_reversed[a.index()]).map(|a| a.name()).collect();
        match (&moved[..], &reversed[..]) {
            ([], []) => f.write_str("x, y and z are as stated"),
            ([], [one]) => write!(f, "{one} is reversed"),
            ([], [one, other]) => write!(f, "{one} and {other} are reversed"),
            ([], _) => f.write_str("x, y and z are reversed"),
            ([one, other], []) => write!(f, "{one} and {other} are exchanged"),
            _ => write!(f, "x, y, z are {}", self.names().join(", ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exchanges_are_the_symmetries_of_a_cube() {
        let all = SignedAxes::all();
        assert_eq!((all.len(), all[0]), (48, SignedAxes::SAME));
        assert!((1..48).all(|n| !all[..n].contains(&all[n])));
        assert_eq!(all.iter().filter(|axes| axes.is_rotation()).count(), 24);
        let vector = DVec3::new(1.0, 2.0, 3.0);
        for axes in all {
            assert_eq!(axes.inverse().apply(axes.apply(vector)), vector);
            assert_eq!(axes.matrix() * vector, axes.apply(vector));
        }
    }

    #[test]
    fn words_name_what_is_changed() {
        let [x, y, z] = Axis::ALL;
        let of = |axes, is_reversed| SignedAxes { axes, is_reversed };
        assert_eq!(of([x, y, z], [false, false, true]).to_string(), "z is reversed");
        assert_eq!(of([y, x, z], [false; 3]).to_string(), "x and y are exchanged");
        assert_eq!(of([y, x, z], [true, false, false]).to_string(), "x, y, z are -y, x, z");
        assert_eq!(of([y, x, z], [false; 3]).remedy(), "name the columns of the field by, bx, bz");
        let both = of([y, x, z], [true, false, false]);
        assert_eq!(both.remedy(), "name the columns of the field by, bx, bz, set gain = [1, -1, 1] in [sensor]");
        assert_eq!(both.remedy_of_scan(), both.remedy());
        let reversed = of([x, y, z], [true, false, false]);
        let of_stage = "or, if x of the positions is reversed, change its column";
        assert_eq!(reversed.remedy_of_scan(), format!("set gain = [-1, 1, 1] in [sensor], {of_stage}"));
        let of_stage = "or, if x and y of the positions are exchanged, exchange their columns";
        let exchanged = of([y, x, z], [false; 3]).remedy_of_scan();
        assert_eq!(exchanged, format!("name the columns of the field by, bx, bz, {of_stage}"));
    }
}
