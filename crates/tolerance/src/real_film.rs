//! Samples of films as made.

use std::borrow::Cow;

use glam::{DQuat, DVec3};
use magsplice_field::Scene;
use magsplice_head::SensorHead;
use magsplice_layout::{ErrorGroup, FilmTolerance, NearIron};
use magsplice_magnet::{BoundingBox, IronPlane, IronPlanes, PerTileError, Reflection, Tile, TileFaults};

use crate::draws::Draws;
use crate::images::{FilmImages, IronAround};
use crate::readings::{Pose, Surroundings};
use crate::weakening::Weakening;

/// A film with the random errors of its tiles, groups and surroundings. Lengths in millimetres, J
/// in tesla.
///
/// ```
/// use glam::DVec3;
/// use magsplice_layout::{Distribution, FilmTolerance, TileErrors};
/// use magsplice_magnet::Tile;
/// use magsplice_tolerance::RealFilm;
///
/// let cube = Tile::new(DVec3::ZERO, DVec3::ONE, DVec3::Z).unwrap();
/// let weak = TileErrors { strength: Distribution::normal(0.1), ..TileErrors::default() };
/// let tolerance = FilmTolerance { tiles: vec![weak, TileErrors::default()], ..FilmTolerance::default() };
/// let film = RealFilm::new(&[cube, cube], &tolerance);
/// let sample = film.sample_tiles(1, 0).unwrap();
/// assert!(sample[0].polarization_t() != cube.polarization_t());
/// assert_eq!(sample[1], cube);
/// ```
#[derive(Clone, Debug)]
pub struct RealFilm {
    tiles: Vec<Tile>,
    tolerance: FilmTolerance,
    /// The point about which the film turns as a whole.
    centre_mm: DVec3,
    weakening: Option<Weakening>,
    /// The head that reads it; `None` for one sensor.
    head: Option<SensorHead>,
    /// The iron that moves with it.
    iron: IronPlanes,
}

impl RealFilm {
    /// Pairs tiles with their errors.
    ///
    /// # Panics
    /// If there are errors of some tiles and not of all, or a group has a tile that does not exist.
    pub fn new(tiles: &[Tile], tolerance: &FilmTolerance) -> RealFilm {
        assert!(tolerance.tiles.is_empty() || tolerance.tiles.len() == tiles.len(), "errors of each tile");
        assert!(
            tolerance.groups.iter().flat_map(|group| &group.tiles).all(|&tile| tile < tiles.len()),
            "tiles of groups"
        );
        let centre_mm = if tiles.is_empty() { DVec3::ZERO } else { BoundingBox::from_tiles(tiles).centre() };
        RealFilm {
            tiles: tiles.to_vec(),
            tolerance: tolerance.clone(),
            centre_mm,
            weakening: None,
            head: None,
            iron: IronPlanes::default(),
        }
    }

    /// The same film with recoil: its tiles weaken and turn in the field of all tiles.
    ///
    /// # Panics
    /// If there are not as many places as tiles, or there is iron near it, which changes the recoil
    /// when it comes.
    pub fn with_weakening(self, weakening: Weakening) -> RealFilm {
        assert!(self.tolerance.common.iron.is_none(), "recoil without iron near it");
        assert_eq!(self.tiles.len(), weakening.place_count(), "a place for each tile");
        RealFilm { weakening: Some(weakening), ..self }
    }

    /// The same film with iron that moves with it, such as a back plate. Tiles with errors may
    /// reach into the iron. The remainder of a weakening has its images.
    ///
    /// # Panics
    /// If the film has iron near it.
    pub fn with_iron(self, iron: IronPlanes) -> RealFilm {
        assert!(iron.is_empty() || self.tolerance.common.iron.is_none(), "iron without other iron");
        RealFilm { iron, ..self }
    }

    /// The reflections by the iron that moves with it.
    pub fn reflections(&self) -> Vec<Reflection> {
        self.iron.reflections(&self.tiles)
    }

    /// Placed tiles, one for each place, with the polarization that they have in the film, and
    /// their images in the iron that moves with it.
    ///
    /// # Errors
    /// The faults of the first tile that cannot exist.
    ///
    /// # Panics
    /// If there is not one tile for each place.
    pub fn scene(&self, tiles: &[Tile]) -> Result<Scene, TileFaults> {
        let in_film = self.in_film(tiles)?;
        Ok(Scene::new(&[&in_film[..], &self.iron.reflected(&in_film)?].concat()))
    }

    /// Its images. `error_mm` is an error of the distance of iron near it.
    pub(crate) fn images(&self, error_mm: f64) -> FilmImages {
        let mut reflections = vec![Reflection::NONE];
        reflections.extend(self.reflections());
        reflections.extend(self.near_iron(error_mm).map(|plane| Reflection::NONE.then(&plane)));
        FilmImages {
            reflections,
            moves: !self.iron.is_empty(),
            later: self.tolerance.common.iron.as_ref().is_some_and(|iron| iron.later),
        }
    }

    fn near_iron(&self, error_mm: f64) -> Option<IronPlane> {
        let plane = |iron: &NearIron| iron.plane(&self.tiles, error_mm).expect("rules of planes were checked");
        self.tolerance.common.iron.as_ref().map(plane)
    }

    /// The iron around it in a sample.
    pub(crate) fn iron_around(&self, surroundings: &Surroundings) -> IronAround {
        let near = self.near_iron(surroundings.iron_error_mm);
        IronAround { own: self.iron.clone(), near, pose: surroundings.pose }
    }

    /// The same film below a head, whose sensors have errors of their own. The sensors count as
    /// points without noise of their own.
    pub fn with_head(self, head: Option<SensorHead>) -> RealFilm {
        RealFilm { head, ..self }
    }

    /// Places and weights of the sensors.
    pub(crate) fn chips(&self) -> Vec<(DVec3, DVec3)> {
        let of_head = |head: &SensorHead| head.elements.iter().map(|of| (of.place, of.weight)).collect();
        self.head.as_ref().map_or_else(|| vec![(DVec3::ZERO, DVec3::ONE)], of_head)
    }

    /// The same film with other errors.
    ///
    /// # Panics
    /// As [`RealFilm::new`].
    pub fn with_tolerance(self, tolerance: &FilmTolerance) -> RealFilm {
        RealFilm {
            weakening: self.weakening,
            head: self.head,
            iron: self.iron,
            ..RealFilm::new(&self.tiles, tolerance)
        }
    }

    pub(crate) fn weakening(&self) -> Option<&Weakening> {
        self.weakening.as_ref()
    }

    /// The tiles without errors, as ordered: their polarization is the remanence.
    pub fn tiles(&self) -> &[Tile] {
        &self.tiles
    }

    /// Placed tiles, one for each place, with the polarization that they have in the film.
    ///
    /// # Errors
    /// The faults of the first tile that cannot exist.
    ///
    /// # Panics
    /// If there is not one tile for each place.
    pub fn in_film<'t>(&self, tiles: &'t [Tile]) -> Result<Cow<'t, [Tile]>, TileFaults> {
        assert_eq!(tiles.len(), self.tiles.len(), "one tile for each place");
        match &self.weakening {
            None => Ok(Cow::Borrowed(tiles)),
            Some(weakening) => weakening.in_film(tiles).map(Cow::Owned),
        }
    }

    /// The errors.
    pub fn tolerance(&self) -> &FilmTolerance {
        &self.tolerance
    }

    /// The point about which the film turns as a whole: the centre of its bounding box.
    pub fn centre_mm(&self) -> DVec3 {
        self.centre_mm
    }

    /// The tiles of sample number `sample`, without the pose of the film. They depend on `seed` and
    /// `sample` only, and each tile on its own errors and the errors of its groups only. Tiles may
    /// overlap.
    ///
    /// # Errors
    /// The faults of the first tile that cannot exist, such as one without thickness.
    pub fn sample_tiles(&self, seed: u64, sample: u64) -> Result<Vec<Tile>, TileFaults> {
        self.draw_tiles(&mut Draws::new(seed, sample))
    }

    /// The tiles of sample number `sample` as cut and magnetized: each at its place, with errors of
    /// size, strength and direction only.
    ///
    /// # Errors
    /// The faults of the first tile that cannot exist, such as one without thickness.
    pub fn cut_tiles(&self, seed: u64, sample: u64) -> Result<Vec<Tile>, TileFaults> {
        (0..self.tiles.len()).map(|tile| self.cut_tile(tile, tile, seed, sample)).collect()
    }

    /// Spare tile number `number` of sample number `sample`: another tile cut like tile number
    /// `tile`, with errors of its own.
    ///
    /// # Errors
    /// The faults of a tile that cannot exist, such as one without thickness.
    ///
    /// # Panics
    /// If the film has no such tile.
    pub fn spare_tile(&self, tile: usize, number: usize, seed: u64, sample: u64) -> Result<Tile, TileFaults> {
        self.cut_tile(tile, self.tiles.len() + number, seed, sample)
    }

    fn cut_tile(&self, tile: usize, number: usize, seed: u64, sample: u64) -> Result<Tile, TileFaults> {
        let Some(errors) = self.tolerance.tiles.get(tile) else { return Ok(self.tiles[tile]) };
        let drawn = Draws::new(seed, sample).of_tile(number, errors);
        let cut = PerTileError { position: [0.0; 3], rotation: [0.0; 3], ..drawn };
        with_errors(&self.tiles[tile], &cut, self.tiles[tile].position())
    }

    /// The tiles of sample number `sample` after placing: `cut`, one for each place, with the
    /// errors of position and rotation of the places and the errors of groups. With the tiles of
    /// [`cut_tiles`](RealFilm::cut_tiles) the result equals
    /// [`sample_tiles`](RealFilm::sample_tiles), except for round-off.
    ///
    /// # Errors
    /// The faults of the first tile that cannot exist, such as one without thickness.
    ///
    /// # Panics
    /// If there is not one tile for each place.
    pub fn placed_tiles(&self, cut: &[Tile], seed: u64, sample: u64) -> Result<Vec<Tile>, TileFaults> {
        assert_eq!(cut.len(), self.tiles.len(), "one tile for each place");
        let [mut of_tiles, of_groups] = self.draw_errors(&mut Draws::new(seed, sample));
        for errors in &mut of_tiles {
            *errors = PerTileError { size: [0.0; 3], strength: 0.0, direction: [0.0; 2], ..*errors };
        }
        self.add_errors(cut, &of_tiles, &of_groups)
    }

    /// The tiles with given errors of each tile and of each group, in millimetres, radians, or as
    /// fractions. Tiles may overlap.
    ///
    /// # Errors
    /// The faults of the first tile that cannot exist, such as one without thickness.
    ///
    /// # Panics
    /// If there are not as many errors as tiles and groups.
    pub fn tiles_with_errors(
        &self,
        of_tiles: &[PerTileError<f64>],
        of_groups: &[PerTileError<f64>],
    ) -> Result<Vec<Tile>, TileFaults> {
        assert_eq!(of_tiles.len(), self.tiles.len(), "errors of each tile");
        assert_eq!(of_groups.len(), self.tolerance.groups.len(), "errors of each group");
        self.add_errors(&self.tiles, of_tiles, of_groups)
    }

    /// These tiles, one for each place, with errors of each tile and of each group.
    fn add_errors(
        &self,
        tiles: &[Tile],
        of_tiles: &[PerTileError<f64>],
        of_groups: &[PerTileError<f64>],
    ) -> Result<Vec<Tile>, TileFaults> {
        let mut tiles = tiles.to_vec();
        for (tile, errors) in tiles.iter_mut().zip(of_tiles) {
            if *errors != PerTileError::default() {
                *tile = with_errors(tile, errors, tile.position())?;
            }
        }
        for (group, errors) in self.tolerance.groups.iter().zip(of_groups) {
            if *errors != PerTileError::default() {
                let centre = self.group_centre_mm(group);
                for &tile in &group.tiles {
                    tiles[tile] = with_errors(&tiles[tile], errors, centre)?;
                }
            }
        }
        Ok(tiles)
    }

    /// The centre of the rotation of a group: the mean of the centres of its tiles.
    pub fn group_centre_mm(&self, group: &ErrorGroup) -> DVec3 {
        let centres = group.tiles.iter().map(|&tile| self.tiles[tile].position());
        centres.sum::<DVec3>() / group.tiles.len().max(1) as f64
    }

    pub(crate) fn draw_tiles(&self, draws: &mut Draws) -> Result<Vec<Tile>, TileFaults> {
        let [of_tiles, of_groups] = self.draw_errors(draws);
        self.tiles_with_errors(&of_tiles, &of_groups)
    }

    /// The errors of each tile and of each group in a sample.
    pub(crate) fn draw_errors(&self, draws: &mut Draws) -> [Vec<PerTileError<f64>>; 2] {
        let FilmTolerance { tiles, groups, .. } = &self.tolerance;
        let of_tile = |tile| tiles.get(tile).map(|errors| draws.of_tile(tile, errors)).unwrap_or_default();
        let of_tiles = (0..self.tiles.len()).map(of_tile).collect();
        let of_group = |(number, group): (usize, &ErrorGroup)| draws.of_group(number, &group.errors);
        [of_tiles, groups.iter().enumerate().map(of_group).collect()]
    }

    /// The pose of the film, other fields and the errors of the sensor in a sample.
    pub(crate) fn draw_surroundings(&self, draws: &mut Draws) -> Surroundings {
        Surroundings::draw(&self.tolerance.common, self.centre_mm, self.chips().len(), draws)
    }

    /// The noise of reading number `reading` in a sample: of a head, that of the weighted sum.
    pub(crate) fn draw_noise_t(&self, draws: &mut Draws, reading: usize) -> DVec3 {
        let chips = self.chips();
        let noise = &self.tolerance.common.sensor.noise_t;
        let of_chip = |(number, (_, weight)): (usize, &(DVec3, DVec3))| {
            *weight * draws.noise_t(reading * chips.len() + number, noise)
        };
        chips.iter().enumerate().map(of_chip).sum()
    }
}

/// A tile with errors, turned about a point.
fn with_errors(tile: &Tile, errors: &PerTileError<f64>, about: DVec3) -> Result<Tile, TileFaults> {
    let pose = Pose::new(about, errors.position.into(), errors.rotation.into());
    let turned_t = turned_in_tile(tile, errors.direction) * (1.0 + errors.strength);
    let made = Tile::new(pose.apply(tile.position()), tile.size() + DVec3::from(errors.size), turned_t)?;
    made.rotated(pose.rotation() * tile.rotation())
}

/// J in the frame of the tile, turned by two angles: in the plane of the film, and out of it.
fn turned_in_tile(tile: &Tile, [in_plane, out_of_plane]: [f64; 2]) -> DVec3 {
    let j_t = tile.polarization_t();
    match direction_axes(tile) {
        Some([normal, level]) if in_plane != 0.0 || out_of_plane != 0.0 => {
            DQuat::from_scaled_axis(in_plane * normal + out_of_plane * level) * j_t
        }
        _ => j_t,
    }
}

/// The axes, in the frame of the tile, about which errors turn J: the part of the film's normal
/// that is normal to J, and the axis normal to both. `None` if J is zero.
pub(crate) fn direction_axes(tile: &Tile) -> Option<[DVec3; 2]> {
    let along = tile.polarization_t().try_normalize()?;
    let reference = direction_normal(tile)?;
    let normal = (reference - along * along.dot(reference)).normalize();
    Some([normal, along.cross(normal)])
}

/// The vector in the frame of the tile whose part normal to J is the axis of errors of direction in
/// the plane: the film's normal. `None` if J is zero.
///
/// Where J is along the film's normal, the normal has no such part. The tile's x replaces it, or
/// its y if J is along x.
pub fn direction_normal(tile: &Tile) -> Option<DVec3> {
    let along = tile.polarization_t().try_normalize()?;
    let film_normal = tile.rotation().inverse() * DVec3::Z;
    let across = film_normal - along * along.dot(film_normal);
    // The sine of a quarter of a degree: J is normal to the film for any magnetizing coil.
    let has_part = across.length() > 0.005;
    Some(match along.x.abs() < 0.9 {
        _ if has_part => film_normal,
        true => DVec3::X,
        false => DVec3::Y,
    })
}

#[cfg(test)]
mod tests;
