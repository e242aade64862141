//! Serialized values: their form, and the rules that deserialized values obey.

use glam::{DQuat, DVec3};
use serde_json::{from_str, to_string};

use crate::{Accuracy, Axis, Grid, PerTileError, Quantity, Tile, TileError, Tolerance};

#[test]
fn values_read_back() {
    let relative = Accuracy::Within(Tolerance::relative(1e-6).unwrap());
    let absolute = Accuracy::Within(Tolerance::absolute_t(2.5e-6).unwrap());
    for (accuracy, json) in
        [(Accuracy::Exact, r#""exact""#), (relative, r#"{"relative":1e-6}"#), (absolute, r#"{"absolute_t":2.5e-6}"#)]
    {
        assert_eq!(to_string(&accuracy).unwrap(), json);
        assert_eq!(from_str::<Accuracy>(json).unwrap(), accuracy);
    }
    assert_eq!(to_string(&Quantity::FluxDensity).unwrap(), r#""flux_density""#);
    let grid = Grid::new(DVec3::ZERO, DVec3::ONE, [1, 2, 3]).unwrap();
    let json = to_string(&grid).unwrap();
    assert_eq!(json, r#"{"lower":[0.0,0.0,0.0],"upper":[1.0,1.0,1.0],"counts":[1,2,3]}"#);
    assert_eq!(from_str::<Grid>(&json).unwrap(), grid);
    let tile = Tile::new(DVec3::ZERO, DVec3::ONE, DVec3::X).unwrap().rotated(DQuat::from_rotation_z(0.3)).unwrap();
    assert_eq!(from_str::<Tile>(&to_string(&tile).unwrap()).unwrap(), tile);
    assert_eq!(to_string(&TileError::Position(Axis::Y)).unwrap(), r#""position_y_mm""#);
    for error in TileError::ALL {
        assert_eq!(from_str::<TileError>(&to_string(&error).unwrap()).unwrap(), error);
    }
    let places = PerTileError::from_fn(TileError::index);
    let json = to_string(&places).unwrap();
    assert_eq!(json, r#"{"position":[0,1,2],"rotation":[3,4,5],"size":[6,7,8],"strength":9,"direction":[10,11]}"#);
    assert_eq!(from_str::<PerTileError<usize>>(&json).unwrap(), places);
}

#[test]
fn invalid_values_are_refused() {
    let refused = |error: serde_json::Error, rule: &str| assert!(error.to_string().contains(rule), "{error}");
    refused(from_str::<Tolerance>(r#"{"relative":-1.0}"#).unwrap_err(), "must be a finite number above zero");
    assert!(from_str::<Accuracy>(r#"{"absolute_t":0.0}"#).is_err());
    assert!(from_str::<Grid>(r#"{"lower":[0,0,0],"upper":[1,1,1],"counts":[1,0,3]}"#).is_err());
    let tile = r#"{"position":[0,0,0],"size":[1,0,1],"polarization_t":[1,0,0],"rotation":[0,0,0,1]}"#;
    assert!(from_str::<Tile>(tile).is_err());
    refused(from_str::<TileError>(r#""position""#).unwrap_err(), "no error of a tile has the key \"position\"");
}
