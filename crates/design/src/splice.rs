//! A start for the search: the pattern of Dai 2024, Fig. 5, for any wavelength and outline.

use std::f64::consts::TAU;

use glam::DVec3;
use magsplice_head::Board;
use magsplice_ideal::IdealFilm;
use magsplice_layout::{
    Brief, FilmTolerance, Goal, Layout, LayoutError, LayoutFault, MAX_LENGTH_RATIO, NamedTile, NearIron, Outline,
    Preset, SHORTEST_WAVELENGTH_MM, STRONGEST_MAGNET_T, StatedSensor, Symmetry, Under, Variable, WorkingVolume,
};
use magsplice_magnet::Tile;

use crate::error::DesignError;
use crate::splice_fault::{MAX_AMPLITUDE, SpliceFault, WIDE, least_extent};

/// A request for a film designed without a layout. Lengths in millimetres, polarization in
/// tesla.
///
/// ```
/// use magsplice_design::SpliceRequest;
///
/// let mut request = SpliceRequest::new(10.0, [20.0, 20.0]);
/// request.brief.parts = Some(4);
/// let layout = request.layout()?;
/// assert_eq!(layout.tiles.len(), 56);
/// # Ok::<(), magsplice_design::DesignError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SpliceRequest {
    /// Name of the film. Default: its extent and the wavelength.
    pub name: Option<String>,
    /// Wavelength of the ideal film.
    pub wavelength_mm: f64,
    /// Extent of the film along x and y.
    pub film_mm: [f64; 2],
    /// Thickness of the film. Default: 0.1 of the wavelength.
    pub thickness_mm: f64,
    /// Magnitude of the polarization of every tile, and amplitude of the ideal film. Default: 0.12.
    pub remanence_t: f64,
    /// Extent of the working volume along x and y. Default: 0.4 of the wavelength each.
    pub range_mm: [f64; 2],
    /// Least and largest distance of the sensor below the film. Default: 0.3 and 0.5 of the
    /// wavelength.
    pub distance_mm: [f64; 2],
    /// Shortest side of a tile. Default: 0.08 of the wavelength.
    pub smallest_cut_mm: f64,
    /// Usual errors of the tiles, for the table `[tolerance]` of the film. Default: none.
    pub preset: Option<Preset>,
    /// Whether iron that comes near the upper face after the first reading, at a tenth of the
    /// wavelength, is one of the errors of the film, for `[tolerance.iron]`. Films are then
    /// designed under their errors, magnetized out of the plane too. Default: no.
    pub one_sided: bool,
    /// The sensor below the film. Default: none.
    pub sensor: Option<StatedSensor>,
    /// The board of a head of such sensors, and their spacing where it is not that of the board.
    /// Default: one sensor.
    pub head: Option<(Board, Option<f64>)>,
    /// Goal and demands of the search. The request itself sets the free parameters, the symmetry,
    /// the outline and the shortest side. Default: the displacement, with an amplitude of at least
    /// 0.65.
    pub brief: Brief,
}

/// Default of the shortest side of a tile, as a fraction of the wavelength.
pub(crate) const SMALLEST_CUT: f64 = 0.08;

/// Distance of iron from the upper face of a one-sided film, as a fraction of the wavelength: the
/// thickness of a cup, or of the glue on a back plate.
const IRON_DISTANCE: f64 = 0.1;

/// Points of the working volume along each axis.
const POINTS: [usize; 3] = [9, 9, 5];

/// The distances below the film of an interval of distances or, where both ends are negative, of z.
pub fn distances_of([one, other]: [f64; 2]) -> [f64; 2] {
    if one < 0.0 && other < 0.0 { [(-one).min(-other), (-one).max(-other)] } else { [one, other] }
}

/// Most cells of a pattern. A search of a film takes minutes from a thousand tiles.
const MOST_CELLS: usize = 100_000;

impl SpliceRequest {
    /// A film of this wavelength and extent along x and y, with the defaults of `magsplice splice`:
    /// lengths in fractions of the wavelength, rounded to four digits.
    pub fn new(wavelength_mm: f64, film_mm: [f64; 2]) -> SpliceRequest {
        let fraction = |of: f64| four_digits(of * wavelength_mm);
        SpliceRequest {
            name: None,
            wavelength_mm,
            film_mm,
            thickness_mm: fraction(0.1),
            remanence_t: 0.12,
            range_mm: [fraction(0.4); 2],
            distance_mm: [fraction(0.3), fraction(0.5)],
            smallest_cut_mm: fraction(SMALLEST_CUT),
            preset: None,
            one_sided: false,
            sensor: None,
            head: None,
            brief: Brief { goal: Goal::Displacement, least_amplitude: Some(0.65), ..Brief::default() },
        }
    }

    /// The layout from which the design starts. Along each axis it has intervals of a third of the
    /// wavelength about the crests of the ideal polarization (Eq. 1), and of a sixth about its
    /// zeros.
    ///
    /// # Errors
    /// [`DesignError::Request`] with all problems at once: lengths that are not positive, a film
    /// too small for the crests about the middle, a working volume in which B_z of the ideal film
    /// vanishes.
    pub fn layout(&self) -> Result<Layout, DesignError> {
        self.validate()?;
        let refused =
            |faults: Vec<LayoutFault>| DesignError::Request(faults.into_iter().map(SpliceFault::Layout).collect());
        let [width, depth] = self.film_mm;
        let default_name = || format!("{width} x {depth} mm for a wavelength of {} mm", self.wavelength_mm);
        let unchecked = Layout {
            name: self.name.clone().unwrap_or_else(default_name),
            ideal: IdealFilm::new(self.wavelength_mm, self.thickness_mm, self.remanence_t).ok(),
            volume: Some(self.volume().map_err(refused)?),
            tiles: self.tiles().map_err(|fault| refused(vec![fault]))?,
            sensor: self.sensor_or_head().map_err(refused)?,
            ..Layout::default()
        };
        let layout = unchecked.checked("spliced film").map_err(|error| {
            refused(match error {
                LayoutError::Invalid { faults, .. } => faults,
                other => vec![LayoutFault { line: None, place: "layout".to_owned(), message: other.to_string() }],
            })
        })?;
        // In the order in which a file lists the tiles: samples of films as made depend on it.
        let written = Layout::parse(&layout.to_compact_toml(), "spliced film");
        let tiles = written.expect("a valid layout is a valid file").tiles;
        let mut tolerance = self.preset.map(|preset| FilmTolerance::of_tiles(&preset.errors(), tiles.len()));
        if self.one_sided {
            let distance_mm = four_digits(IRON_DISTANCE * self.wavelength_mm);
            let iron = NearIron { distance_mm, ..NearIron::default() };
            tolerance.get_or_insert_default().common.iron = Some(iron);
        }
        Ok(Layout { brief: Some(self.brief()), tolerance, tiles, ..layout })
    }

    fn sensor_or_head(&self) -> Result<Option<StatedSensor>, Vec<LayoutFault>> {
        let Some((board, spacing_mm)) = self.head else { return Ok(self.sensor.clone()) };
        let sensor = self.sensor.clone().unwrap_or_else(StatedSensor::perfect);
        sensor.on_board(board, spacing_mm, self.wavelength_mm).map(Some)
    }

    fn tiles(&self) -> Result<Vec<NamedTile>, LayoutFault> {
        let (height, j_t) = (self.thickness_mm, self.remanence_t);
        let [columns, rows] = [0, 1].map(|axis| self.intervals(axis));
        let cells = columns.len() * rows.len();
        if cells > MOST_CELLS {
            let message =
                format!("the pattern has {cells} cells, must have at most {MOST_CELLS}: choose a smaller film");
            return Err(LayoutFault { line: None, place: "film".to_owned(), message });
        }
        let mut tiles = Vec::new();
        for (i, ([left, right], along_x)) in columns.iter().enumerate() {
            for (k, ([front, back], along_y)) in rows.iter().enumerate() {
                let direction = DVec3::new(*along_x, *along_y, 0.0);
                if direction == DVec3::ZERO {
                    continue;
                }
                let name = format!("x{}-y{}", i + 1, k + 1);
                let centre = DVec3::new(0.5 * (left + right), 0.5 * (front + back), 0.5 * height);
                let tile =
                    Tile::new(centre, DVec3::new(right - left, back - front, height), j_t * direction.normalize());
                let tile = tile.map_err(|faults| LayoutFault {
                    line: None,
                    place: format!("tile \"{name}\""),
                    message: faults.to_string(),
                })?;
                tiles.push(NamedTile::new(name, tile));
            }
        }
        Ok(tiles)
    }

    fn volume(&self) -> Result<WorkingVolume, Vec<LayoutFault>> {
        let [x, y] = self.range_mm.map(|range| 0.5 * range);
        let [near, far] = self.distance_mm;
        let steps = [2.0 * x, 2.0 * y, far - near];
        let steps = [0, 1, 2].map(|axis| steps[axis] / (POINTS[axis] - 1) as f64);
        let (lower, upper) = (DVec3::new(-x, -y, -far), DVec3::new(x, y, -near));
        WorkingVolume::new(lower, upper, steps.into(), DVec3::new(0.0, 0.0, -far))
    }

    fn brief(&self) -> Brief {
        let square = self.film_mm[0] == self.film_mm[1] && self.range_mm[0] == self.range_mm[1];
        let [x, y] = self.film_mm.map(|extent| Some([-0.5 * extent, 0.5 * extent]));
        let in_plane = [Variable::Size, Variable::Position, Variable::Direction];
        Brief {
            vary: in_plane.into_iter().chain(self.one_sided.then_some(Variable::Tilt)).collect(),
            under: if self.one_sided { Under::Tolerance } else { self.brief.under },
            symmetry: if square { Symmetry::FourFold } else { Symmetry::Mirror },
            outline_mm: Outline { x, y },
            smallest_cut_mm: Some(self.smallest_cut_mm),
            ..self.brief.clone()
        }
    }

    /// Intervals along an axis, each with the sign of the ideal polarization, which is 0 about its
    /// zeros.
    fn intervals(&self, axis: usize) -> Vec<([f64; 2], f64)> {
        let (wavelength, edge) = (self.wavelength_mm, 0.5 * self.film_mm[axis]);
        let half_wide = 0.5 * WIDE * wavelength;
        let crests = (edge / (0.5 * wavelength)).ceil() as i64 + 1;
        // The ends of the wide intervals. The narrow intervals lie between them.
        let mut cuts = vec![-edge];
        for crest in -crests..crests {
            let centre = (crest as f64 + 0.5) * 0.5 * wavelength;
            cuts.extend([centre - half_wide, centre + half_wide]);
        }
        cuts.push(edge);
        cuts.retain(|cut| cut.abs() <= edge);
        cuts.sort_by(f64::total_cmp);
        // Slivers at the rim are joined to their neighbours.
        let sliver = |a: f64, b: f64| b - a < self.smallest_cut_mm;
        while cuts.len() > 2 && sliver(cuts[0], cuts[1]) {
            cuts.remove(1);
            cuts.remove(cuts.len() - 2);
        }
        let signed = |ends: &[f64]| {
            let centre = 0.5 * (ends[0] + ends[1]);
            let phase = (TAU * centre / wavelength).sin();
            // The centre of a wide interval is within a twelfth of the wavelength of a crest, that
            // of a narrow one of a zero.
            ([ends[0], ends[1]], if phase.abs() > 0.7 { phase.signum() } else { 0.0 })
        };
        cuts.windows(2).map(signed).collect()
    }

    fn validate(&self) -> Result<(), DesignError> {
        let wave = self.wavelength_mm;
        let mut faults = Vec::new();
        let lengths = [
            ("wavelength", wave),
            ("film, along x", self.film_mm[0]),
            ("film, along y", self.film_mm[1]),
            ("thickness", self.thickness_mm),
            ("range, along x", self.range_mm[0]),
            ("range, along y", self.range_mm[1]),
            ("distance, the nearest", self.distance_mm[0]),
            ("smallest cut", self.smallest_cut_mm),
        ];
        // The default lengths follow the wavelength, so that its faults are theirs, too.
        let is_wave = not_positive("wavelength", wave, "mm").is_none();
        let all = lengths.into_iter().chain([("resolution", self.brief.resolution_mm)]);
        let all = all.take(if is_wave { lengths.len() + 1 } else { 1 });
        faults.extend(all.filter_map(|(name, mm)| not_positive(name, mm, "mm")));
        let j = self.remanence_t;
        faults.extend(not_positive("remanence", j, "T"));
        faults.extend((j.is_finite() && j > STRONGEST_MAGNET_T).then_some(SpliceFault::TooStrong(j)));
        let unreachable = self.brief.least_amplitude.filter(|least| *least > MAX_AMPLITUDE);
        faults.extend(unreachable.map(SpliceFault::UnreachableAmplitude));
        // In metres all lengths agree with each other; one of them in metres does not.
        if wave > 0.0 && wave < SHORTEST_WAVELENGTH_MM {
            faults.push(SpliceFault::ShortWavelength(wave));
        } else {
            for &(name, mm) in &lengths[1..] {
                if mm > 0.0 && mm * MAX_LENGTH_RATIO < wave {
                    faults.push(SpliceFault::TooShort(name, mm, wave));
                } else if mm > MAX_LENGTH_RATIO * wave && is_wave {
                    faults.push(SpliceFault::TooLong(name, mm, wave));
                }
            }
        }
        let parts = self.brief.parts.filter(|_| self.one_sided);
        faults.extend(parts.map(SpliceFault::OneSidedParts));
        let is_gap = self.brief.gap_mm >= 0.0 && self.brief.gap_mm.is_finite();
        faults.extend((!is_gap).then_some(SpliceFault::Gap(self.brief.gap_mm)));
        let seed = self.brief.seed;
        faults.extend(i64::try_from(seed).is_err().then_some(SpliceFault::LargeSeed(seed)));
        faults.extend(not_positive("resolution of directions", self.brief.resolution_deg, "deg"));
        let [near, far] = self.distance_mm;
        faults.extend((is_wave && !(near < far)).then_some(SpliceFault::Distances(near, far)));
        if faults.is_empty() {
            for (axis, extent) in ['x', 'y'].into_iter().zip(self.film_mm) {
                faults.extend((extent < least_extent(wave)).then_some(SpliceFault::NoCrests(axis, extent, wave)));
            }
            // cos kx + cos ky vanishes first where x + y is half a wavelength.
            let is_singular = 0.5 * (self.range_mm[0] + self.range_mm[1]) >= 0.5 * wave;
            faults.extend(is_singular.then_some(SpliceFault::SingularRange(self.range_mm, wave)));
            let cut = self.smallest_cut_mm;
            faults.extend((cut > 0.25 * wave).then_some(SpliceFault::LongCut(cut, wave)));
            let is_film = IdealFilm::new(wave, self.thickness_mm, j).is_ok()
                && Tile::new(DVec3::ZERO, DVec3::splat(self.thickness_mm), DVec3::X * j).is_ok();
            faults.extend((!is_film).then_some(SpliceFault::OutOfRange));
        }
        if faults.is_empty() { Ok(()) } else { Err(DesignError::Request(faults)) }
    }
}

/// Four significant digits, as a person would write a default.
pub(crate) fn four_digits(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

fn not_positive(name: &'static str, value: f64, unit: &'static str) -> Option<SpliceFault> {
    let is_positive = value > 0.0 && value.is_finite();
    (!is_positive).then_some(SpliceFault::NotPositive(name, value, unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wavelength of 12 mm: wide intervals of 4 mm about 3 and 9 mm, with alternating signs.
    fn request(film_mm: [f64; 2]) -> SpliceRequest {
        let distance_mm = [3.0, 5.0];
        SpliceRequest { range_mm: [4.0, 3.0], distance_mm, smallest_cut_mm: 0.9, ..SpliceRequest::new(12.0, film_mm) }
    }

    fn assert_intervals(width: f64, cuts: &[f64], signs: &[f64]) {
        let request = request([width, 24.0]);
        let found = request.intervals(0);
        let ends: Vec<f64> =
            found.iter().map(|(ends, _)| ends[0]).chain(found.last().map(|(ends, _)| ends[1])).collect();
        assert_eq!(ends.len(), cuts.len(), "{width}: {ends:?}");
        assert!(ends.iter().zip(cuts).all(|(a, b)| (a - b).abs() < 1e-12), "{width}: {ends:?}");
        assert!(found.windows(2).all(|pair| pair[0].0[1] == pair[1].0[0]));
        assert_eq!(found.iter().map(|(_, sign)| *sign).collect::<Vec<_>>(), signs, "{width}");
    }

    #[test]
    fn intervals_are_about_crests_and_zeros() {
        let inner = [-7.0, -5.0, -1.0, 1.0, 5.0, 7.0];
        let with = |left: &[f64], right: &[f64]| [left, &inner[..], right].concat();
        let signs = [1.0, 0.0, -1.0, 0.0, 1.0, 0.0, -1.0];
        let zeros = |signs: &[f64]| [&[0.0][..], signs, &[0.0][..]].concat();
        assert_intervals(24.0, &with(&[-12.0, -11.0], &[11.0, 12.0]), &zeros(&signs));
        // The rim is a part of a crest, or a sliver that its neighbour absorbs.
        assert_intervals(21.0, &with(&[-10.5], &[10.5]), &signs);
        assert_intervals(22.0, &with(&[-11.0], &[11.0]), &signs);
        assert_intervals(23.0, &with(&[-11.5], &[11.5]), &signs);
        assert_intervals(23.9, &with(&[-11.95, -11.0], &[11.0, 11.95]), &zeros(&signs));
        assert_intervals(10.0, &inner[1..5], &[-1.0, 0.0, 1.0]);
    }

    #[test]
    fn volume_and_tiles_are_those_of_the_request() {
        let request = SpliceRequest { thickness_mm: 1.5, remanence_t: 0.2, ..request([10.0, 24.0]) };
        let volume = request.volume().expect("a volume");
        assert_eq!((volume.lower_mm, volume.upper_mm), (DVec3::new(-2.0, -1.5, -5.0), DVec3::new(2.0, 1.5, -3.0)));
        assert_eq!((volume.grid.counts(), volume.reference_mm), ([9, 9, 5], DVec3::new(0.0, 0.0, -5.0)));
        let tiles = request.tiles().expect("tiles");
        // 3 columns and 9 rows without the fields of two zeros.
        assert_eq!(tiles.len(), 3 * 9 - 5);
        let named = |name: &str| tiles.iter().find(|named| named.name == name).expect("a tile").tile;
        let corner = named("x1-y2");
        assert_eq!((corner.position(), corner.size()), (DVec3::new(-3.0, -9.0, 0.75), DVec3::new(4.0, 4.0, 1.5)));
        let j_t = 0.2 * DVec3::new(-1.0, 1.0, 0.0) / 2.0_f64.sqrt();
        assert!(corner.polarization_t().distance(j_t) < 1e-16, "{corner:?}");
        let edge = named("x2-y2");
        assert_eq!((edge.size(), edge.polarization_t()), (DVec3::new(2.0, 4.0, 1.5), DVec3::new(0.0, 0.2, 0.0)));
    }

    #[test]
    fn distances_may_be_heights() {
        assert_eq!(distances_of([3.0, 5.0]), [3.0, 5.0]);
        assert_eq!([distances_of([-5.0, -3.0]), distances_of([-3.0, -5.0])], [[3.0, 5.0]; 2]);
        assert_eq!([distances_of([-3.0, 5.0]), distances_of([0.0, -5.0])], [[-3.0, 5.0], [0.0, -5.0]]);
        assert_eq!([four_digits(1.234_56), four_digits(0.1 * 7.0)], [1.235, 0.7]);
    }

    #[test]
    fn defaults_are_fractions_of_the_wavelength() {
        let request = SpliceRequest::new(7.0, [20.0, 30.0]);
        assert_eq!((request.thickness_mm, request.range_mm, request.distance_mm), (0.7, [2.8; 2], [2.1, 3.5]));
        assert_eq!((request.smallest_cut_mm, request.remanence_t, request.film_mm), (0.56, 0.12, [20.0, 30.0]));
        assert_eq!((request.brief.goal, request.brief.least_amplitude), (Goal::Displacement, Some(0.65)));
        let name = request.layout().unwrap_or_else(|e| panic!("{e}")).name;
        assert_eq!(name, "20 x 30 mm for a wavelength of 7 mm");
    }

    /// The faults of a request, for numbers at their limits and just beyond.
    #[test]
    fn numbers_out_of_range_are_refused() {
        let good = || request([24.0, 30.0]);
        let faults = |request: SpliceRequest| match request.validate() {
            Ok(()) => Vec::new(),
            Err(DesignError::Request(faults)) => faults,
            Err(other) => panic!("{other}"),
        };
        let brief = |change: &dyn Fn(&mut Brief)| {
            let mut request = good();
            change(&mut request.brief);
            request
        };
        let not_positive = SpliceFault::NotPositive;
        let cases = [
            (good(), vec![]),
            (SpliceRequest { thickness_mm: 0.0, ..good() }, vec![not_positive("thickness", 0.0, "mm")]),
            (SpliceRequest { film_mm: [24.0, -1.0], ..good() }, vec![not_positive("film, along y", -1.0, "mm")]),
            (
                SpliceRequest { range_mm: [f64::INFINITY, 3.0], ..good() },
                vec![
                    not_positive("range, along x", f64::INFINITY, "mm"),
                    SpliceFault::TooLong("range, along x", f64::INFINITY, 12.0),
                ],
            ),
            // The other lengths follow the wavelength.
            (SpliceRequest { wavelength_mm: -1.0, ..good() }, vec![not_positive("wavelength", -1.0, "mm")]),
            (brief(&|brief| brief.resolution_mm = 0.0), vec![not_positive("resolution", 0.0, "mm")]),
            (brief(&|brief| brief.resolution_deg = 0.0), vec![not_positive("resolution of directions", 0.0, "deg")]),
            (SpliceRequest { remanence_t: -0.1, ..good() }, vec![not_positive("remanence", -0.1, "T")]),
            (SpliceRequest { remanence_t: 2.0, ..good() }, vec![]),
            (SpliceRequest { remanence_t: 2.1, ..good() }, vec![SpliceFault::TooStrong(2.1)]),
            (brief(&|brief| brief.least_amplitude = Some(2.0)), vec![]),
            (brief(&|brief| brief.least_amplitude = Some(2.1)), vec![SpliceFault::UnreachableAmplitude(2.1)]),
            (SpliceRequest::new(0.1, [0.24, 0.3]), vec![]),
            (SpliceRequest::new(0.099, [0.24, 0.3]), vec![SpliceFault::ShortWavelength(0.099)]),
            (SpliceRequest { thickness_mm: 0.012, ..good() }, vec![]),
            (SpliceRequest { thickness_mm: 0.0119, ..good() }, vec![SpliceFault::TooShort("thickness", 0.0119, 12.0)]),
            (SpliceRequest { thickness_mm: 12_000.0, ..good() }, vec![]),
            (
                SpliceRequest { thickness_mm: 12_001.0, ..good() },
                vec![SpliceFault::TooLong("thickness", 12_001.0, 12.0)],
            ),
            (brief(&|brief| brief.gap_mm = 0.0), vec![]),
            (brief(&|brief| brief.gap_mm = -0.1), vec![SpliceFault::Gap(-0.1)]),
            (brief(&|brief| brief.gap_mm = f64::INFINITY), vec![SpliceFault::Gap(f64::INFINITY)]),
            (SpliceRequest { distance_mm: [5.0, 5.0], ..good() }, vec![SpliceFault::Distances(5.0, 5.0)]),
            // Five sixths of the wavelength, 10 mm.
            (SpliceRequest { film_mm: [10.0, 30.0], ..good() }, vec![]),
            (SpliceRequest { film_mm: [9.9, 30.0], ..good() }, vec![SpliceFault::NoCrests('x', 9.9, 12.0)]),
            (SpliceRequest { film_mm: [24.0, 9.9], ..good() }, vec![SpliceFault::NoCrests('y', 9.9, 12.0)]),
            // Half the sum of the extents at half a wavelength, 6 mm.
            (SpliceRequest { range_mm: [6.0, 5.9], ..good() }, vec![]),
            (SpliceRequest { range_mm: [6.0, 6.0], ..good() }, vec![SpliceFault::SingularRange([6.0, 6.0], 12.0)]),
            (SpliceRequest { smallest_cut_mm: 3.0, ..good() }, vec![]),
            (SpliceRequest { smallest_cut_mm: 3.1, ..good() }, vec![SpliceFault::LongCut(3.1, 12.0)]),
        ];
        for (request, known) in cases {
            assert_eq!(faults(request.clone()), known, "{request:?}");
        }
        let film = |mm: f64| SpliceFault::NoCrests('x', mm, 12.0).to_string();
        assert!(film(0.024).ends_with("next to the middle; did you mean 24 mm, which is 0.024 m?"), "{}", film(0.024));
        assert!(film(0.009).ends_with("next to the middle") && film(9.9).ends_with("next to the middle"));
    }
}
