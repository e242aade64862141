//! The table `[tolerance]`: the errors of the films that are made from a layout.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use toml::Spanned;

use crate::presets::Preset;
use crate::tables::distribution::{Components, WrittenDistribution};
use crate::tables::rotation::RotationTable;
use crate::tables::tile::AxisName;

/// The errors of the films that are made from the layout. A plain number is the standard deviation
/// of normal errors of mean 0; a table gives another distribution. Errors of different tiles, axes
/// and keys are independent.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ToleranceTable {
    /// Usual errors of a way to make films. The keys beside it replace its numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) preset: Option<Preset>,
    /// Errors of each tile's centre along x, y, z, in mm: one for all axes, or three.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) position_mm: Option<Components<3>>,
    /// Angles by which each tile is turned about axes parallel to x, y, z, in degrees: one for all
    /// axes, or three.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) rotation_deg: Option<Components<3>>,
    /// Errors of each side, along the tile's own axes, in mm: one for all sides, or three.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) size_mm: Option<Components<3>>,
    /// Error of |J|, as a fraction of it: 0.01 is 1 %.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) strength: Option<WrittenDistribution>,
    /// Angles by which J is turned within the tile, in degrees: one for both directions, or two, in
    /// the plane of the film and out of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) direction_deg: Option<Components<2>>,
    /// Number of films that `check` and `tolerance` evaluate. Default: 1000.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) samples: Option<u64>,
    /// Seed of the random numbers. Default: 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) seed: Option<u64>,
    /// Pose of the film against the sensor.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<FilmTable>")]
    pub(crate) film: Option<Spanned<FilmTable>>,
    /// A uniform field from elsewhere, such as that of the earth.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<StrayFieldTable>")]
    pub(crate) stray_field: Option<Spanned<StrayFieldTable>>,
    /// Another film nearby.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<NeighbourTable>")]
    pub(crate) neighbour: Option<Spanned<NeighbourTable>>,
    /// A change of temperature after the reading at the reference point.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<TemperatureTable>")]
    pub(crate) temperature: Option<Spanned<TemperatureTable>>,
    /// Errors of the sensor.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<SensorTable>")]
    pub(crate) sensor: Option<Spanned<SensorTable>>,
    /// Errors of the tiles of a kind, by its name. They replace those above, key by key.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(with = "BTreeMap<String, KindErrorsTable>")]
    pub(crate) kind: BTreeMap<String, Spanned<KindErrorsTable>>,
    /// Errors of tiles by name. They replace those of kinds, and later entries replace earlier
    /// ones, key by key.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(with = "Vec<TileErrorsTable>")]
    pub(crate) tile: Vec<Spanned<TileErrorsTable>>,
    /// Groups of tiles that move or change together, in addition to the errors of each tile.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(with = "Vec<GroupTable>")]
    pub(crate) group: Vec<Spanned<GroupTable>>,
}

/// Errors of the tiles of one kind.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct KindErrorsTable {
    /// Errors of each tile's centre along x, y, z, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) position_mm: Option<Components<3>>,
    /// Angles by which each tile is turned, in degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) rotation_deg: Option<Components<3>>,
    /// Errors of each side, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) size_mm: Option<Components<3>>,
    /// Error of |J|, as a fraction of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) strength: Option<WrittenDistribution>,
    /// Angles by which J is turned within the tile, in degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) direction_deg: Option<Components<2>>,
}

/// Errors of tiles by name.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TileErrorsTable {
    /// Names of tiles. An asterisk stands for any letters, unless the text is the name of a tile.
    #[schemars(extend("example" = "[\"corner*\"]"))]
    pub(crate) tiles: Vec<String>,
    /// Errors of each tile's centre along x, y, z, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) position_mm: Option<Components<3>>,
    /// Angles by which each tile is turned, in degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) rotation_deg: Option<Components<3>>,
    /// Errors of each side, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) size_mm: Option<Components<3>>,
    /// Error of |J|, as a fraction of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) strength: Option<WrittenDistribution>,
    /// Angles by which J is turned within the tile, in degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) direction_deg: Option<Components<2>>,
}

/// Tiles that move or change together: all tiles, or those of `tiles` or `kinds`, as one group or
/// as one for each row or kind.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct GroupTable {
    /// Unique name. Default: group-1, group-2 and so on, numbered in the order of the file. Groups
    /// for rows are named NAME-1, NAME-2, and groups for kinds NAME-KIND.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) name: Option<String>,
    /// Names of its tiles. An asterisk stands for any letters, unless the text is the name of a
    /// tile.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "[\"corner*\"]"))]
    pub(crate) tiles: Option<Vec<String>>,
    /// Kinds of its tiles, instead of names.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "[\"square\"]"))]
    pub(crate) kinds: Option<Vec<String>>,
    /// A group for each row of tiles along this axis: tiles whose centres differ along it only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) rows_along: Option<AxisName>,
    /// A group for each kind.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) each: Option<Each>,
    /// Shift of the group along x, y, z, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) position_mm: Option<Components<3>>,
    /// Angles by which the group turns about the mean of its tiles' centres, in degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) rotation_deg: Option<Components<3>>,
    /// Errors of each side, the same for all its tiles, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) size_mm: Option<Components<3>>,
    /// Error of |J|, the same for all its tiles, as a fraction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) strength: Option<WrittenDistribution>,
    /// Angles by which J is turned, the same for all its tiles, in degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) direction_deg: Option<Components<2>>,
}

/// What there is a group for each of.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Each {
    /// The tiles of each kind.
    Kind,
}

/// Pose of the film against the sensor. The film turns about the centre of its bounding box.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FilmTable {
    /// Errors of position along x, y, z, in mm: one for all axes, or three.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) position_mm: Option<Components<3>>,
    /// Angles about axes parallel to x, y, z, in degrees: one for all axes, or three.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) rotation_deg: Option<Components<3>>,
}

/// A uniform field: the sum of one with given components and one of any direction.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StrayFieldTable {
    /// Components along x, y, z, in microtesla: one for all axes, or three.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) field_ut: Option<Components<3>>,
    /// Magnitude of a field of any direction of space with equal probability, in microtesla.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) any_direction_ut: Option<WrittenDistribution>,
    /// Whether the field is there when the sensor is read at the reference point. Default: before.
    #[serde(default)]
    pub(crate) when: When,
}

/// Whether a cause of errors is there before or after the reading at the reference point.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum When {
    /// There at all readings.
    #[default]
    Before,
    /// There after the reading at the reference point.
    After,
}

/// Another film nearby, such as that of the opposing jaw of a gripper.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct NeighbourTable {
    /// Layout file, relative to the folder of this one. Its own [tolerance] does not count.
    pub(crate) layout: String,
    /// Place of its origin, in mm. Required.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "[0.0, 0.0, -12.0]"))]
    pub(crate) position_mm: Option<[f64; 3]>,
    /// Rotation about its origin. Default: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) rotation: Option<RotationTable>,
    /// Whether it is there when the sensor is read at the reference point. Default: before.
    #[serde(default)]
    pub(crate) when: When,
}

/// A change of temperature after the reading at the reference point.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TemperatureTable {
    /// The change, in kelvin.
    pub(crate) change_k: WrittenDistribution,
    /// Relative change of the strength of all tiles per kelvin, a fraction: -0.0012 is -0.12 % per
    /// kelvin. Default: that of [material].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) strength_per_k: Option<f64>,
}

/// Errors of the sensor, along or about its three axes: one for all, or three.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SensorTable {
    /// Offsets, in microtesla.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) offset_ut: Option<Components<3>>,
    /// Angles by which its axes are turned, in degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) rotation_deg: Option<Components<3>>,
    /// Errors of the gain, as fractions: 0.01 is 1 %.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) gain: Option<Components<3>>,
    /// Noise, independent in every reading, in microtesla.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) noise_ut: Option<Components<3>>,
}
