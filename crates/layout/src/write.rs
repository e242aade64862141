//! Writing a layout: values become tables, tables become TOML or any other format of serde.

use magsplice_decouple::{PerAxis, PerParameter};
use serde::Serialize;
use toml::Spanned;

use crate::brief::{Brief, Variables};
use crate::expectations::{Expectations, FigureBounds, MadeExpectations};
use crate::layout::{Layout, NamedTile, WorkingVolume};
use crate::limits::FORMAT;
use crate::tables::design::{DesignTable, MinMax, Outline, Variable, Weights};
use crate::tables::expect::{DisplacementBounds, ExpectTable, LowerBound, MadeTable, UniformityBounds};
use crate::tables::ideal::IdealTable;
use crate::tables::material::MaterialTable;
use crate::tables::sensor::{ElastomerTable, SensorTable};
use crate::tables::tile::TileTable;
use crate::tables::tolerance::ToleranceTable;
use crate::tables::volume::{Step, VolumeTable};
use crate::write_material::{material_table, recoil_permeability};
use crate::write_sensor::{elastomer_table, sensor_table};
use crate::write_tolerance::tolerance_table;

impl Layout {
    /// The layout as TOML in the plain form: one `[[tile]]` for each tile. Parsing the text gives
    /// the same tiles, bit for bit.
    ///
    /// # Panics
    /// If the path of the expected field is not UTF-8, which no layout file can express.
    ///
    /// # Example
    /// ```
    /// use magsplice_layout::{COMMENTED_LAYOUT, Layout};
    ///
    /// let layout = Layout::parse(COMMENTED_LAYOUT, "commented")?;
    /// let again = Layout::parse(&layout.to_toml(), "plain form")?;
    /// assert_eq!(again.tiles[55].tile, layout.tiles[55].tile);
    /// # Ok::<(), magsplice_layout::LayoutError>(())
    /// ```
    pub fn to_toml(&self) -> String {
        toml::to_string(&self.plain()).expect("numbers and strings can always be written as TOML")
    }

    /// The layout in the plain form, to be serialized in any format: an object with the keys of a
    /// layout file.
    pub fn plain(&self) -> PlainLayout<'_> {
        PlainLayout {
            format: FORMAT,
            name: &self.name,
            description: self.description.as_deref(),
            history: &self.history,
            overlap_mm: (self.overlap_mm > 0.0).then_some(self.overlap_mm),
            ideal: self.ideal.map(|film| IdealTable {
                wavelength_mm: film.wavelength(),
                thickness_mm: film.thickness(),
                amplitude_t: film.amplitude_t(),
            }),
            volume: self.volume.as_ref().map(volume_table),
            expect: expect_table(&self.expectations),
            design: self.brief.as_ref().map(design_table),
            tolerance: self.tolerance.as_ref().map(|tolerance| {
                let names: Vec<&str> = self.tiles.iter().map(|named| named.name.as_str()).collect();
                tolerance_table(tolerance, &names)
            }),
            sensor: self.sensor.as_ref().map(sensor_table),
            elastomer: self.elastomer.as_ref().map(elastomer_table),
            material: material_table(&self.material),
            tile: self.tiles.iter().map(tile_table).collect(),
        }
    }
}

/// A layout in the plain form: repetitions written out as one `tile` each. It only serializes; see
/// [`Layout::plain`].
#[derive(Serialize)]
pub struct PlainLayout<'a> {
    format: i64,
    name: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    description: Option<&'a str>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    history: &'a [String],
    #[serde(skip_serializing_if = "Option::is_none")]
    overlap_mm: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ideal: Option<IdealTable>,
    #[serde(skip_serializing_if = "Option::is_none")]
    volume: Option<VolumeTable>,
    #[serde(skip_serializing_if = "Option::is_none")]
    expect: Option<ExpectTable>,
    #[serde(skip_serializing_if = "Option::is_none")]
    design: Option<DesignTable>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tolerance: Option<Spanned<ToleranceTable>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sensor: Option<SensorTable>,
    #[serde(skip_serializing_if = "Option::is_none")]
    elastomer: Option<ElastomerTable>,
    #[serde(skip_serializing_if = "Option::is_none")]
    material: Option<MaterialTable>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) tile: Vec<TileTable>,
}

pub(crate) fn volume_table(volume: &WorkingVolume) -> VolumeTable {
    let range = |axis: usize| [volume.lower_mm[axis], volume.upper_mm[axis]];
    let step = volume.step_mm;
    let same = step.x == step.y && step.x == step.z;
    VolumeTable {
        x_mm: range(0),
        y_mm: range(1),
        z_mm: range(2),
        step_mm: if same { Step::Same(step.x) } else { Step::PerAxis(step.to_array()) },
        reference_mm: Some(volume.reference_mm.to_array()),
    }
}

pub(crate) fn expect_table(expectations: &Expectations) -> Option<ExpectTable> {
    let Expectations { bounds, field, least_clearance_mm, made } = expectations;
    (!expectations.is_empty()).then(|| ExpectTable {
        uniformity_rmse: uniformity_bounds(bounds),
        displacement_rmse_mm: displacement_bounds(bounds),
        amplitude: at_least(bounds.least_amplitude),
        field: field.clone(),
        clearance_mm: at_least(*least_clearance_mm),
        made: made.as_ref().map(|made| Spanned::new(0..0, made_table(made))),
    })
}

fn made_table(made: &MadeExpectations) -> MadeTable {
    MadeTable {
        percentile: Some(made.percentile),
        uniformity_rmse: uniformity_bounds(&made.bounds),
        displacement_rmse_mm: displacement_bounds(&made.bounds),
        amplitude: at_least(made.bounds.least_amplitude),
        samples: made.samples,
        confidence: Some(made.confidence),
    }
}

fn uniformity_bounds(bounds: &FigureBounds) -> Option<UniformityBounds> {
    let PerParameter { r_x, r_y, s_z } = bounds.uniformity_rmse;
    r_x.or(r_y).or(s_z).map(|_| UniformityBounds { r_x, r_y, s_z })
}

fn displacement_bounds(bounds: &FigureBounds) -> Option<DisplacementBounds> {
    let PerAxis { x, y, z } = bounds.displacement_rmse_mm;
    x.or(y).or(z).map(|_| DisplacementBounds { x, y, z })
}

fn at_least(min: Option<f64>) -> Option<LowerBound> {
    min.map(|min| LowerBound { min })
}

pub(crate) fn design_table(brief: &Brief) -> DesignTable {
    let Variables { size, position, cut, thickness, direction, tilt, strength } = brief.vary;
    let variables = [
        (size, Variable::Size),
        (position, Variable::Position),
        (cut, Variable::Cut),
        (thickness, Variable::Thickness),
        (direction, Variable::Direction),
        (tilt, Variable::Tilt),
        (strength, Variable::Strength),
    ];
    let [x, y] = brief.outline_mm;
    let [r_x, r_y, s_z] = brief.weights;
    let bounds = |used: bool, [min, max]: [f64; 2]| used.then_some(MinMax { min, max });
    DesignTable {
        vary: variables.into_iter().filter(|(varies, _)| *varies).map(|(_, variable)| variable).collect(),
        symmetry: brief.symmetry,
        goal: brief.goal,
        under: brief.under,
        weights: Some(Weights { r_x, r_y, s_z }),
        amplitude: brief.least_amplitude.map(|min| LowerBound { min }),
        outline_mm: (x.is_some() || y.is_some()).then_some(Outline { x, y }),
        smallest_cut_mm: brief.smallest_cut_mm,
        gap_mm: brief.gap_mm,
        thickness_mm: bounds(thickness, brief.thickness_mm),
        strength_t: bounds(strength, brief.strength_t),
        resolution_mm: Some(brief.resolution_mm),
        resolution_deg: Some(brief.resolution_deg),
        step_mm: brief.step_mm,
        parts: brief.parts,
        stock: brief.stock.clone(),
        stock_strengths_t: brief.stock_strengths_t.clone(),
        starts: Some(brief.starts),
        seed: Some(brief.seed),
    }
}

fn tile_table(named: &NamedTile) -> TileTable {
    TileTable {
        name: Some(named.name.clone()),
        kind: None,
        position_mm: named.tile.position().to_array(),
        size_mm: Some(named.tile.size().to_array()),
        polarization_t: Some(named.tile.polarization_t().to_array()),
        strength_t: None,
        direction: None,
        direction_deg: None,
        tilt_deg: None,
        recoil_permeability: named.permeability.map(recoil_permeability),
        rotation: named.rotation.map(Into::into),
        grid: None,
        mirror: None,
    }
}
