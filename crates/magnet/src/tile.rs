//! A uniformly magnetized cuboid in space.

use std::fmt;

use glam::{DQuat, DVec3};

use crate::tolerances::{MAX_LENGTH, MAX_POLARIZATION_T, MIN_ASPECT, MIN_SIZE, NORM_ROUNDING, UNIT_NORM_TOLERANCE};

/// A uniformly magnetized cuboid: one tile of a film, or any block magnet.
///
/// # Units
/// Lengths are in any one unit, the same for tiles and points: the field depends on ratios of
/// lengths only. Polarization J = mu0 M is in tesla.
///
/// # Example
/// ```
/// use glam::{DQuat, DVec3};
/// use magsplice_magnet::Tile;
///
/// let tile = Tile::new(DVec3::new(-2.0, 0.0, 0.5), DVec3::new(3.3, 1.7, 1.0), DVec3::new(0.12, 0.0, 0.0))
///     .unwrap()
///     .rotated(DQuat::from_rotation_z(30_f64.to_radians()))
///     .unwrap();
/// assert!(Tile::new(DVec3::ZERO, DVec3::new(1.0, -1.0, 0.0), DVec3::X).unwrap_err().0.len() == 2);
/// # let _ = tile;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "UncheckedTile"))]
pub struct Tile {
    position: DVec3,
    size: DVec3,
    polarization_t: DVec3,
    rotation: DQuat,
}

/// A deserialized tile, before [`Tile::new`] and [`Tile::rotated`] check it.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct UncheckedTile {
    position: DVec3,
    size: DVec3,
    polarization_t: DVec3,
    rotation: DQuat,
}

#[cfg(feature = "serde")]
impl TryFrom<UncheckedTile> for Tile {
    type Error = TileFaults;

    fn try_from(tile: UncheckedTile) -> Result<Tile, TileFaults> {
        Tile::new(tile.position, tile.size, tile.polarization_t)?.rotated(tile.rotation)
    }
}

impl Tile {
    /// An unrotated tile from its centre, its full side lengths and its polarization in its own
    /// frame.
    ///
    /// # Errors
    /// All faults at once: sizes not between [`MIN_SIZE`] and [`MAX_LENGTH`], coordinates not
    /// finite or beyond [`MAX_LENGTH`], one side below [`MIN_ASPECT`] of another, polarization
    /// components not finite or beyond [`MAX_POLARIZATION_T`].
    pub fn new(position: DVec3, size: DVec3, polarization_t: DVec3) -> Result<Tile, TileFaults> {
        let mut faults = Vec::new();
        for axis in 0..3 {
            // Written so that NaN fails each test.
            if !(position[axis].abs() <= MAX_LENGTH) {
                faults.push(TileFault::Position { axis, value: position[axis] });
            }
            if !(size[axis] >= MIN_SIZE && size[axis] <= MAX_LENGTH) {
                faults.push(TileFault::Size { axis, value: size[axis] });
            }
            if !(polarization_t[axis].abs() <= MAX_POLARIZATION_T) {
                faults.push(TileFault::Polarization { axis, value: polarization_t[axis] });
            }
        }
        let (shortest, longest) = (size.min_element(), size.max_element());
        if faults.is_empty() && shortest < MIN_ASPECT * longest {
            faults.push(TileFault::Aspect { shortest, longest });
        }
        if faults.is_empty() {
            Ok(Tile { position, size, polarization_t, rotation: DQuat::IDENTITY })
        } else {
            Err(TileFaults(faults))
        }
    }

    /// The same tile turned about its centre. `rotation` takes the tile's own frame to the frame of
    /// the scene.
    ///
    /// # Errors
    /// If the norm of the quaternion differs from 1 by more than [`UNIT_NORM_TOLERANCE`].
    pub fn rotated(self, rotation: DQuat) -> Result<Tile, TileFaults> {
        let norm = rotation.length();
        if (norm - 1.0).abs() <= NORM_ROUNDING {
            Ok(Tile { rotation, ..self })
        } else if (norm - 1.0).abs() <= UNIT_NORM_TOLERANCE {
            Ok(Tile { rotation: rotation * (1.0 / norm), ..self })
        } else {
            Err(TileFaults(vec![TileFault::Rotation { norm }]))
        }
    }

    /// Centre.
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// Full side lengths along the tile's own axes.
    pub fn size(&self) -> DVec3 {
        self.size
    }

    /// Polarization J = mu0 M in the tile's own frame, in tesla.
    pub fn polarization_t(&self) -> DVec3 {
        self.polarization_t
    }

    /// Rotation from the tile's own frame to the frame of the scene.
    pub fn rotation(&self) -> DQuat {
        self.rotation
    }

    /// Polarization in the frame of the scene, in tesla.
    pub fn scene_polarization_t(&self) -> DVec3 {
        self.rotation * self.polarization_t
    }
}

/// All rules that one tile breaks.
#[derive(Clone, Debug, PartialEq)]
pub struct TileFaults(pub Vec<TileFault>);

/// A rule that a tile breaks. Axes are 0, 1, 2 for x, y, z.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum TileFault {
    /// A coordinate of the centre is not finite or too large.
    Position {
        /// The axis of the coordinate.
        axis: usize,
        /// The given value.
        value: f64,
    },
    /// A side length is not a positive number in range.
    Size {
        /// The axis of the side.
        axis: usize,
        /// The given value.
        value: f64,
    },
    /// The tile is too thin for its length.
    Aspect {
        /// Its shortest side.
        shortest: f64,
        /// Its longest side.
        longest: f64,
    },
    /// A component of the polarization is not finite or too large.
    Polarization {
        /// The axis of the component.
        axis: usize,
        /// The given value, in tesla.
        value: f64,
    },
    /// The rotation quaternion does not have norm 1.
    Rotation {
        /// Its norm.
        norm: f64,
    },
}

impl TileFault {
    /// The text of the broken rule. It follows the name and the value of the quantity.
    pub fn rule(&self) -> String {
        match self {
            TileFault::Position { value, .. } if value.is_finite() => {
                format!("must be at most {MAX_LENGTH:e} in magnitude")
            }
            TileFault::Size { value, .. } if *value <= 0.0 => "must be greater than 0".to_owned(),
            TileFault::Size { value, .. } if value.is_finite() => {
                format!("must be between {MIN_SIZE:e} and {MAX_LENGTH:e}")
            }
            TileFault::Polarization { value, .. } if value.is_finite() => {
                format!("must be at most {MAX_POLARIZATION_T:e} T in magnitude")
            }
            TileFault::Aspect { longest, .. } => {
                format!("must be at least {MIN_ASPECT:e} of the longest side, {longest}")
            }
            TileFault::Rotation { .. } => "must have norm 1".to_owned(),
            _ => "must be a finite number".to_owned(),
        }
    }
}

impl fmt::Display for TileFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rule = self.rule();
        match self {
            TileFault::Position { axis, value } => write!(f, "position[{axis}] = {value}, {rule}"),
            TileFault::Size { axis, value } => write!(f, "size[{axis}] = {value}, {rule}"),
            TileFault::Polarization { axis, value } => write!(f, "polarization_t[{axis}] = {value}, {rule}"),
            TileFault::Aspect { shortest, .. } => write!(f, "shortest side = {shortest}, {rule}"),
            TileFault::Rotation { norm } => write!(f, "rotation has norm {norm}, {rule}"),
        }
    }
}

impl fmt::Display for TileFaults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, fault) in self.0.iter().enumerate() {
            let separator = if i == 0 { "" } else { "; " };
            write!(f, "{separator}{fault}")?;
        }
        Ok(())
    }
}

impl std::error::Error for TileFault {}

impl std::error::Error for TileFaults {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.0.first().map(|fault| fault as _)
    }
}
