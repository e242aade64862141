//! The twelve errors of a tile, and one value for each of them.

use std::ops::{Index, IndexMut};

use crate::axis::Axis;

/// One of the twelve errors with which a tile is made. They are ordered as in [`TileError::ALL`].
///
/// # Units
/// Values are in millimetres, radians, or fractions of the strength. [`TileError::shown`] turns
/// them into [`TileError::unit`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum TileError {
    /// Error of the centre along an axis of the layout.
    Position(Axis),
    /// Component, along an axis of the layout, of the rotation vector of the tile about its centre.
    Rotation(Axis),
    /// Error of a side, along an axis of the tile.
    Size(Axis),
    /// Error of |J|, as a fraction of it.
    Strength,
    /// Angle by which J is turned within the tile.
    Direction(DirectionError),
}

/// A turn of J within its tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum DirectionError {
    /// In the plane of the film: about the component of the film's normal that is normal to J.
    InPlane,
    /// Out of the plane of the film: about the axis normal to J and to the axis of the turn in the
    /// plane.
    OutOfPlane,
}

impl TileError {
    /// All errors: three each of position, rotation and size, one of strength, and two of
    /// direction.
    pub const ALL: [TileError; 12] = [
        TileError::Position(Axis::X),
        TileError::Position(Axis::Y),
        TileError::Position(Axis::Z),
        TileError::Rotation(Axis::X),
        TileError::Rotation(Axis::Y),
        TileError::Rotation(Axis::Z),
        TileError::Size(Axis::X),
        TileError::Size(Axis::Y),
        TileError::Size(Axis::Z),
        TileError::Strength,
        TileError::Direction(DirectionError::InPlane),
        TileError::Direction(DirectionError::OutOfPlane),
    ];

    /// The index of the error in [`TileError::ALL`].
    pub const fn index(self) -> usize {
        match self {
            TileError::Position(axis) => axis.index(),
            TileError::Rotation(axis) => 3 + axis.index(),
            TileError::Size(axis) => 6 + axis.index(),
            TileError::Strength => 9,
            TileError::Direction(turn) => 10 + turn as usize,
        }
    }

    /// The key of the error with its [unit](TileError::unit), for tables and files.
    pub const fn key(self) -> &'static str {
        const KEYS: [&str; TileError::ALL.len()] = [
            "position_x_mm",
            "position_y_mm",
            "position_z_mm",
            "rotation_x_deg",
            "rotation_y_deg",
            "rotation_z_deg",
            "size_x_mm",
            "size_y_mm",
            "size_z_mm",
            "strength_percent",
            "direction_in_plane_deg",
            "direction_out_of_plane_deg",
        ];
        KEYS[self.index()]
    }

    /// The error in words, without its unit.
    pub const fn name(self) -> &'static str {
        const NAMES: [&str; TileError::ALL.len()] = [
            "position x",
            "position y",
            "position z",
            "rotation about x",
            "rotation about y",
            "rotation about z",
            "size x",
            "size y",
            "size z",
            "strength",
            "direction of J in the plane",
            "direction of J out of the plane",
        ];
        NAMES[self.index()]
    }

    /// The display unit of the error: mm, deg or %.
    pub const fn unit(self) -> &'static str {
        match self {
            TileError::Position(_) | TileError::Size(_) => "mm",
            TileError::Rotation(_) | TileError::Direction(_) => "deg",
            TileError::Strength => "%",
        }
    }

    /// Converts a value in millimetres, radians or as a fraction to [`TileError::unit`].
    pub fn shown(self, value: f64) -> f64 {
        match self {
            TileError::Position(_) | TileError::Size(_) => value,
            TileError::Rotation(_) | TileError::Direction(_) => value.to_degrees(),
            TileError::Strength => 100.0 * value,
        }
    }
}

/// A value for each error of a tile.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PerTileError<T> {
    /// Values of the centre, along each axis of the layout; in millimetres.
    pub position: [T; 3],
    /// Values of the rotation vector's components along the axes of the layout; in radians.
    pub rotation: [T; 3],
    /// Values of the sides, along the axes of the tile; in millimetres.
    pub size: [T; 3],
    /// Value of |J|, as a fraction of it.
    pub strength: T,
    /// Values of the direction of J, in the plane of the film and out of it; in radians.
    pub direction: [T; 2],
}

impl<T> PerTileError<T> {
    /// The values of a function of the error, called in the order of [`TileError::ALL`].
    pub fn from_fn(mut value: impl FnMut(TileError) -> T) -> PerTileError<T> {
        let turns = [DirectionError::InPlane, DirectionError::OutOfPlane];
        PerTileError {
            position: Axis::ALL.map(|axis| value(TileError::Position(axis))),
            rotation: Axis::ALL.map(|axis| value(TileError::Rotation(axis))),
            size: Axis::ALL.map(|axis| value(TileError::Size(axis))),
            strength: value(TileError::Strength),
            direction: turns.map(|turn| value(TileError::Direction(turn))),
        }
    }

    /// Applies a function to each value, in the order of [`TileError::ALL`].
    pub fn map<U>(self, mut f: impl FnMut(T) -> U) -> PerTileError<U> {
        PerTileError {
            position: self.position.map(&mut f),
            rotation: self.rotation.map(&mut f),
            size: self.size.map(&mut f),
            strength: f(self.strength),
            direction: self.direction.map(f),
        }
    }

    /// References to the values.
    pub fn each_ref(&self) -> PerTileError<&T> {
        PerTileError::from_fn(|error| &self[error])
    }

    /// Every error with its value, in the order of [`TileError::ALL`].
    pub fn iter(&self) -> impl Iterator<Item = (TileError, &T)> {
        TileError::ALL.into_iter().zip(self.values())
    }

    /// Every error with a mutable reference to its value, in the order of [`TileError::ALL`].
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (TileError, &mut T)> {
        let PerTileError { position, rotation, size, strength, direction } = self;
        let values = position.iter_mut().chain(rotation).chain(size).chain([strength]).chain(direction);
        TileError::ALL.into_iter().zip(values)
    }

    /// The values, in the order of [`TileError::ALL`].
    pub fn values(&self) -> impl Iterator<Item = &T> + Clone {
        let PerTileError { position, rotation, size, strength, direction } = self;
        position.iter().chain(rotation).chain(size).chain([strength]).chain(direction)
    }
}

impl<T> Index<TileError> for PerTileError<T> {
    type Output = T;

    fn index(&self, error: TileError) -> &T {
        match error {
            TileError::Position(axis) => &self.position[axis.index()],
            TileError::Rotation(axis) => &self.rotation[axis.index()],
            TileError::Size(axis) => &self.size[axis.index()],
            TileError::Strength => &self.strength,
            TileError::Direction(turn) => &self.direction[turn as usize],
        }
    }
}

impl<T> IndexMut<TileError> for PerTileError<T> {
    fn index_mut(&mut self, error: TileError) -> &mut T {
        match error {
            TileError::Position(axis) => &mut self.position[axis.index()],
            TileError::Rotation(axis) => &mut self.rotation[axis.index()],
            TileError::Size(axis) => &mut self.size[axis.index()],
            TileError::Strength => &mut self.strength,
            TileError::Direction(turn) => &mut self.direction[turn as usize],
        }
    }
}

/// A key, such as `position_x_mm`.
#[cfg(feature = "serde")]
impl serde::Serialize for TileError {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.key())
    }
}

/// A key, such as `position_x_mm`.
#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for TileError {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<TileError, D::Error> {
        let key = <std::borrow::Cow<'de, str>>::deserialize(deserializer)?;
        let found = TileError::ALL.into_iter().find(|error| error.key() == key);
        found.ok_or_else(|| serde::de::Error::custom(format_args!("no error of a tile has the key {key:?}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_come_in_the_order_of_all_errors() {
        assert!(TileError::ALL.is_sorted());
        let places = PerTileError::from_fn(TileError::index);
        for (place, (error, value)) in places.iter().enumerate() {
            assert_eq!((error, error.index(), *value, places[error]), (TileError::ALL[place], place, place, place));
        }
        let mut called = Vec::new();
        let doubled = places.map(|place| {
            called.push(place);
            2 * place
        });
        assert!(called.is_sorted());
        let mut changed = places;
        changed.iter_mut().for_each(|(error, value)| *value += error.index());
        assert_eq!(changed, doubled);
        assert!(doubled.each_ref().values().copied().eq(doubled.values()));
        changed[TileError::Strength] = 0;
        assert_eq!(changed, PerTileError { strength: 0, ..doubled });
    }

    #[test]
    fn keys_end_with_the_unit_of_shown_values() {
        for error in TileError::ALL {
            let (suffix, wanted) = match error.unit() {
                "mm" => ("_mm", 0.5),
                "deg" => ("_deg", 0.5_f64.to_degrees()),
                _ => ("_percent", 50.0),
            };
            assert!(error.key().ends_with(suffix), "{error:?}");
            assert_eq!(error.shown(0.5), wanted, "{error:?}");
            assert_eq!(TileError::ALL.iter().filter(|other| other.key() == error.key()).count(), 1);
            assert_eq!(TileError::ALL.iter().filter(|other| other.name() == error.name()).count(), 1);
        }
    }
}
