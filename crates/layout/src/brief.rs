//! What a layout asks of its design: what may change, within what bounds, and what is wanted.

use std::ops::Range;

use crate::resolve::Problems;
use crate::written::{self, Design};

/// The table `[design]`. Lengths in millimetres, angles in degrees, polarization in tesla.
#[derive(Clone, Debug, PartialEq)]
pub struct Brief {
    /// What may change.
    pub vary: Vary,
    /// Which symmetry stays.
    pub symmetry: Symmetry,
    /// What is to become small.
    pub goal: Goal,
    /// How much R_x, R_y and S_z (or displacement along x, y, z) count.
    pub weights: [f64; 3],
    /// Least best-fit amplitude against the ideal film.
    pub least_amplitude: Option<f64>,
    /// What the tiles must stay within, along x and y, lower and upper end; their own extent if none is given.
    pub outline_mm: [Option<[f64; 2]>; 2],
    /// Shortest side of a tile along x and y; the shortest there is if none is given.
    pub smallest_cut_mm: Option<f64>,
    /// Least distance of neighbouring tiles.
    pub gap_mm: f64,
    /// Bounds of the thickness, where it may change.
    pub thickness_mm: [f64; 2],
    /// Bounds of the strength, where it may change.
    pub strength_t: [f64; 2],
    /// Faces are rounded to multiples of this.
    pub resolution_mm: f64,
    /// Directions are rounded to multiples of this.
    pub resolution_deg: f64,
    /// Step of the points the film is designed on; chosen by the program if none is given.
    pub step_mm: Option<f64>,
    /// At most so many distinct parts.
    pub parts: Option<usize>,
    /// Parts that are at hand.
    pub stock: Vec<StockPart>,
    /// Strengths that are at hand; any if empty.
    pub stock_strengths_t: Vec<f64>,
    /// From how many points the search starts.
    pub starts: usize,
    /// Which random numbers vary them.
    pub seed: u64,
}

/// What of the tiles may change.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vary {
    /// Sides along x and y, about the tile's centre.
    pub size: bool,
    /// Centres along x and y.
    pub position: bool,
    /// Lines parallel to x or y on which faces of tiles lie: all faces of a line move together.
    pub cut: bool,
    /// The upper faces, all at the same height together.
    pub thickness: bool,
    /// The angle of the polarization in the plane of the film.
    pub direction: bool,
    /// The angle of the polarization out of the plane of the film.
    pub tilt: bool,
    /// The magnitude of the polarization.
    pub strength: bool,
}

/// What the film is mapped onto itself by; arrows on tiles are mapped with them, as those of Eq. 1 are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Symmetry {
    /// Nothing.
    #[default]
    None,
    /// Mirrors at x = 0 and y = 0.
    Mirror,
    /// These and the exchange of x and y.
    FourFold,
}

/// What is to become small.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Goal {
    /// The uniformity RMSE of R_x, R_y and S_z.
    #[default]
    Uniformity,
    /// The RMSE of the displacement that R_x, R_y and S_z give, against the true one.
    Displacement,
    /// The RMSE of B against Eq. 2, times the least amplitude if there is one.
    Field,
}

/// A tile that can be had.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StockPart {
    /// Its sides in the plane of the film.
    pub size_mm: [f64; 2],
    /// Its polarization's angle from the first towards the second.
    pub direction_deg: f64,
}

/// Faces need not be finer than tools.
const RESOLUTION_MM: f64 = 0.001;
const RESOLUTION_DEG: f64 = 0.01;

/// On the published film from one to all of them end near the best, by the goal; see docs/design.md.
const STARTS: usize = 8;
const MAX_STARTS: usize = 10_000;

/// Nothing varies, nothing is asked; what the layout file has as defaults.
impl Default for Brief {
    fn default() -> Brief {
        Brief {
            vary: Vary::default(),
            symmetry: Symmetry::None,
            goal: Goal::Uniformity,
            weights: [1.0; 3],
            least_amplitude: None,
            outline_mm: [None; 2],
            smallest_cut_mm: None,
            gap_mm: 0.0,
            thickness_mm: [0.0; 2],
            strength_t: [0.0; 2],
            resolution_mm: RESOLUTION_MM,
            resolution_deg: RESOLUTION_DEG,
            step_mm: None,
            parts: None,
            stock: Vec::new(),
            stock_strengths_t: Vec::new(),
            starts: STARTS,
            seed: 1,
        }
    }
}

impl Brief {
    pub(crate) fn written(&self) -> Design {
        let Vary { size, position, cut, thickness, direction, tilt, strength } = self.vary;
        let kinds = [
            (size, written::Variable::Size),
            (position, written::Variable::Position),
            (cut, written::Variable::Cut),
            (thickness, written::Variable::Thickness),
            (direction, written::Variable::Direction),
            (tilt, written::Variable::Tilt),
            (strength, written::Variable::Strength),
        ];
        let [x, y] = self.outline_mm;
        let [r_x, r_y, s_z] = self.weights;
        let bounds = |used: bool, [min, max]: [f64; 2]| used.then_some(written::Bounds { min, max });
        Design {
            vary: kinds.into_iter().filter(|(used, _)| *used).map(|(_, kind)| kind).collect(),
            symmetry: match self.symmetry {
                Symmetry::None => written::Symmetry::None,
                Symmetry::Mirror => written::Symmetry::Mirror,
                Symmetry::FourFold => written::Symmetry::FourFold,
            },
            goal: match self.goal {
                Goal::Uniformity => written::Goal::Uniformity,
                Goal::Displacement => written::Goal::Displacement,
                Goal::Field => written::Goal::Field,
            },
            weights: Some(written::Weights { r_x, r_y, s_z }),
            amplitude: self.least_amplitude.map(|min| written::Least { min }),
            outline_mm: (x.is_some() || y.is_some()).then_some(written::Outline { x, y }),
            smallest_cut_mm: self.smallest_cut_mm,
            gap_mm: self.gap_mm,
            thickness_mm: bounds(thickness, self.thickness_mm),
            strength_t: bounds(strength, self.strength_t),
            resolution_mm: Some(self.resolution_mm),
            resolution_deg: Some(self.resolution_deg),
            step_mm: self.step_mm,
            parts: self.parts,
            stock: self
                .stock
                .iter()
                .map(|part| written::Stock { size_mm: part.size_mm, direction_deg: part.direction_deg })
                .collect(),
            stock_strengths_t: self.stock_strengths_t.clone(),
            starts: Some(self.starts),
            seed: Some(self.seed),
        }
    }
}

pub(crate) fn resolve(
    written: Design,
    span: &Range<usize>,
    present: [bool; 2],
    problems: &mut Problems,
) -> Option<Brief> {
    let before = problems.count();
    let mut report = |message: String| problems.add(Some(span), "design", message);
    let mut vary = Vary::default();
    for kind in &written.vary {
        let place = match kind {
            written::Variable::Size => &mut vary.size,
            written::Variable::Position => &mut vary.position,
            written::Variable::Cut => &mut vary.cut,
            written::Variable::Thickness => &mut vary.thickness,
            written::Variable::Direction => &mut vary.direction,
            written::Variable::Tilt => &mut vary.tilt,
            written::Variable::Strength => &mut vary.strength,
        };
        *place = true;
    }
    if written.vary.is_empty() {
        report(
            "vary = [], must name what may change: size, position, cut, thickness, direction, tilt, strength"
                .to_owned(),
        );
    }
    if vary.cut && (vary.size || vary.position) {
        report("vary names cut, which moves faces together, and size or position, which move them apart: must name one of the two".to_owned());
    }
    for (table, there) in [("[ideal]", present[0]), ("[volume]", present[1])] {
        if !there {
            report(format!("needs the table {table}, which the layout does not have"));
        }
    }
    let weights = written.weights.map_or([1.0; 3], |w| [w.r_x, w.r_y, w.s_z]);
    for (key, weight) in ["r_x", "r_y", "s_z"].into_iter().zip(weights) {
        if !(weight.is_finite() && weight >= 0.0) {
            report(format!("weights.{key} = {weight}, must be a finite number of at least 0"));
        }
    }
    if weights == [0.0; 3] {
        report("weights are all 0, at least one must be greater".to_owned());
    }
    let positive = [
        ("resolution_mm", written.resolution_mm),
        ("resolution_deg", written.resolution_deg),
        ("step_mm", written.step_mm),
        ("smallest_cut_mm", written.smallest_cut_mm),
        ("amplitude.min", written.amplitude.as_ref().map(|least| least.min)),
    ];
    for (key, value) in positive {
        if let Some(value) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
            report(format!("{key} = {value}, must be a finite number greater than 0"));
        }
    }
    if !(written.gap_mm.is_finite() && written.gap_mm >= 0.0) {
        report(format!("gap_mm = {}, must be a finite number of at least 0", written.gap_mm));
    }
    let outline_mm = written.outline_mm.as_ref().map_or([None; 2], |outline| [outline.x, outline.y]);
    for (key, range) in ["x", "y"].into_iter().zip(outline_mm) {
        if let Some([low, high]) = range.filter(|[low, high]| !(low.is_finite() && high.is_finite() && low < high)) {
            report(format!(
                "outline_mm.{key} = [{low}, {high}], must be two finite numbers, the first less than the second"
            ));
        }
    }
    let ranges = [
        ("thickness_mm", "thickness", vary.thickness, &written.thickness_mm, f64::MIN_POSITIVE),
        ("strength_t", "strength", vary.strength, &written.strength_t, 0.0),
    ];
    for (key, kind, varies, bounds, least) in ranges {
        match bounds {
            Some(written::Bounds { min, max }) if !(*min >= least && min <= max && max.is_finite()) => {
                report(format!(
                    "{key} = {{ min = {min}, max = {max} }}, must be finite, min not below 0 and not above max"
                ));
            }
            None if varies => report(format!("vary names {kind}, so {key} = {{ min = ..., max = ... }} must be given")),
            _ => {}
        }
    }
    if (written.parts.is_some() || !written.stock.is_empty()) && !(vary.size && vary.position) {
        report("parts or stock are given: parts are sizes, so vary must name size and position".to_owned());
    }
    if (written.parts.is_some() || !written.stock.is_empty()) && vary.tilt {
        report("parts or stock are given: parts lie in the plane, so vary must not name tilt".to_owned());
    }
    if written.parts == Some(0) {
        report("parts = 0, must be at least 1".to_owned());
    }
    if let Some(parts) = written.parts.filter(|parts| *parts < written.stock.len()) {
        report(format!("parts = {parts}, must not be less than the {} parts of the stock", written.stock.len()));
    }
    for (index, part) in written.stock.iter().enumerate() {
        if !part.size_mm.iter().all(|side| side.is_finite() && *side > 0.0) {
            report(format!("stock[{index}].size_mm = {:?}, must be two finite numbers greater than 0", part.size_mm));
        }
        if !part.direction_deg.is_finite() {
            report(format!("stock[{index}].direction_deg = {}, must be a finite number", part.direction_deg));
        }
    }
    for strength in written.stock_strengths_t.iter().filter(|s| !(s.is_finite() && **s >= 0.0)) {
        report(format!("stock_strengths_t has {strength}, must be finite numbers of at least 0"));
    }
    if !written.stock_strengths_t.is_empty() && !vary.strength {
        report("stock_strengths_t is given, but vary does not name strength".to_owned());
    }
    let starts = written.starts.unwrap_or(STARTS);
    if !(1..=MAX_STARTS).contains(&starts) {
        report(format!("starts = {starts}, must be from 1 to {MAX_STARTS}"));
    }
    let range = |bounds: Option<written::Bounds>| bounds.map_or([0.0; 2], |b| [b.min, b.max]);
    (problems.count() == before).then(|| Brief {
        vary,
        symmetry: match written.symmetry {
            written::Symmetry::None => Symmetry::None,
            written::Symmetry::Mirror => Symmetry::Mirror,
            written::Symmetry::FourFold => Symmetry::FourFold,
        },
        goal: match written.goal {
            written::Goal::Uniformity => Goal::Uniformity,
            written::Goal::Displacement => Goal::Displacement,
            written::Goal::Field => Goal::Field,
        },
        weights,
        least_amplitude: written.amplitude.map(|least| least.min),
        outline_mm,
        smallest_cut_mm: written.smallest_cut_mm,
        gap_mm: written.gap_mm,
        thickness_mm: range(written.thickness_mm),
        strength_t: range(written.strength_t),
        resolution_mm: written.resolution_mm.unwrap_or(RESOLUTION_MM),
        resolution_deg: written.resolution_deg.unwrap_or(RESOLUTION_DEG),
        step_mm: written.step_mm,
        parts: written.parts,
        stock: written
            .stock
            .iter()
            .map(|part| StockPart { size_mm: part.size_mm, direction_deg: part.direction_deg })
            .collect(),
        stock_strengths_t: written.stock_strengths_t,
        starts,
        seed: written.seed.unwrap_or(1),
    })
}
