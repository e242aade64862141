//! A layout of tiles that were not read from a layout file.

use crate::error::LayoutError;
use crate::expectations::Expectations;
use crate::layout::{Layout, NamedTile};
use crate::material::Material;

impl Layout {
    /// A layout with these tiles and nothing else, checked like a layout file. `history` says where
    /// the tiles are from, and `origin` names their source in errors.
    ///
    /// # Errors
    /// [`LayoutError::Invalid`] with every broken rule. The lines of faults are those of
    /// [`Layout::to_toml`].
    ///
    /// # Example
    /// ```
    /// use glam::DVec3;
    /// use magsplice_layout::{Layout, NamedTile};
    /// use magsplice_magnet::Tile;
    ///
    /// let tile = Tile::new(DVec3::ZERO, DVec3::ONE, DVec3::new(0.0, 0.0, 0.12))?;
    /// let named = NamedTile { name: "cube".to_owned(), kind: None, rotation: None, tile, permeability: None };
    /// let layout = Layout::from_tiles("one cube", vec!["by hand".to_owned()], vec![named], "cubes")?;
    /// assert_eq!(layout.tiles[0].tile, tile);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn from_tiles(
        name: &str,
        history: Vec<String>,
        tiles: Vec<NamedTile>,
        origin: &str,
    ) -> Result<Layout, LayoutError> {
        let unchecked = Layout {
            name: name.to_owned(),
            description: None,
            ideal: None,
            volume: None,
            expectations: Expectations::default(),
            brief: None,
            tolerance: None,
            sensor: None,
            elastomer: None,
            material: Material::default(),
            history,
            overlap_mm: 0.0,
            tiles,
            sha256: String::new(),
            findings: Vec::new(),
        };
        Layout::parse(&unchecked.to_toml(), origin)
    }
}
