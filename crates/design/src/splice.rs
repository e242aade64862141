//! A film to begin with: the pattern of Dai 2024, Fig. 5, for any wavelength and outline.

use std::f64::consts::TAU;
use std::fmt::Write;

use glam::DVec3;
use magsplice_ideal::IdealFilm;
use magsplice_layout::{
    Brief, Goal, Layout, MAX_LENGTH_RATIO, SHORTEST_WAVELENGTH_MM, STRONGEST_MAGNET_T, Symmetry, Variables,
    meant_length, meant_polarization,
};
use magsplice_magnet::Tile;

use crate::error::DesignError;

/// A request for a film that is designed without a layout. Lengths in millimetres, polarization in
/// tesla.
///
/// ```
/// use magsplice_design::SpliceRequest;
/// use magsplice_layout::Goal;
///
/// let request = SpliceRequest {
///     wavelength_mm: 10.0,
///     film_mm: [20.0, 20.0],
///     thickness_mm: 1.0,
///     remanence_t: 0.12,
///     range_mm: [4.0, 4.0],
///     distance_mm: [3.0, 5.0],
///     smallest_cut_mm: 0.8,
///     gap_mm: 0.0,
///     resolution_mm: 0.001,
///     resolution_deg: 0.01,
///     least_amplitude: 0.65,
///     parts: None,
///     goal: Goal::Displacement,
///     starts: 8,
///     seed: 1,
/// };
/// let layout = request.layout()?;
/// assert_eq!(layout.tiles.len(), 56);
/// # Ok::<(), magsplice_design::DesignError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SpliceRequest {
    /// Wavelength of the ideal film.
    pub wavelength_mm: f64,
    /// Extent of the film along x and y.
    pub film_mm: [f64; 2],
    /// Thickness of the film.
    pub thickness_mm: f64,
    /// Magnitude of the polarization of every tile, and amplitude of the ideal film.
    pub remanence_t: f64,
    /// Extent of the working volume along x and y.
    pub range_mm: [f64; 2],
    /// Least and largest distance of the sensor below the film.
    pub distance_mm: [f64; 2],
    /// Shortest side of a tile.
    pub smallest_cut_mm: f64,
    /// Least distance of neighbouring tiles.
    pub gap_mm: f64,
    /// Sizes are rounded to multiples of this, in millimetres; a tile centred on a mirror plane has
    /// its faces at half multiples.
    pub resolution_mm: f64,
    /// Directions are rounded to multiples of this, in degrees.
    pub resolution_deg: f64,
    /// Least best-fit amplitude against the ideal film.
    pub least_amplitude: f64,
    /// Maximum number of distinct parts, if bounded.
    pub parts: Option<usize>,
    /// The error that the design minimizes.
    pub goal: Goal,
    /// Number of starts of the search.
    pub starts: usize,
    /// Seed of the random numbers that vary the starts.
    pub seed: u64,
}

/// Width of the wide intervals, as a fraction of the wavelength. Two thirds of a half-wave at full
/// strength have no third harmonic (Dai 2024, Fig. 5, has 3.3 of 5 mm).
const WIDE: f64 = 1.0 / 3.0;

/// Amplitude that no film of tiles reaches. The fundamental of a square wave is 4 / pi of its
/// height, and the tiles are as strong as the ideal film's crests.
const MAX_AMPLITUDE: f64 = 2.0;

/// Points of the working volume along each axis.
const POINTS: [usize; 3] = [9, 9, 5];

impl SpliceRequest {
    /// The layout to begin the design with. Along each axis it has intervals of a third of the
    /// wavelength about the crests of the ideal polarization (Eq. 1), and of a sixth about its
    /// zeros.
    ///
    /// # Errors
    /// [`DesignError::Request`] with all problems at once: lengths that are not positive, a film
    /// too small for the crests about the middle, a working volume in which B_z of the ideal film
    /// vanishes.
    pub fn layout(&self) -> Result<Layout, DesignError> {
        self.validate()?;
        let cuts = [0, 1].map(|axis| self.intervals(axis));
        let mut tiles = String::new();
        let (height, j) = (self.thickness_mm, self.remanence_t);
        for (i, (x, along_x)) in cuts[0].iter().enumerate() {
            for (k, (y, along_y)) in cuts[1].iter().enumerate() {
                let direction = DVec3::new(*along_x, *along_y, 0.0);
                if direction == DVec3::ZERO {
                    continue;
                }
                let centre = [0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1]), 0.5 * height];
                let size = [x[1] - x[0], y[1] - y[0], height];
                let _ = write!(
                    tiles,
                    "[[tile]]\nname = \"x{}-y{}\"\nposition_mm = {centre:?}\nsize_mm = {size:?}\nstrength_t = {j:?}\ndirection = {:?}\n\n",
                    i + 1,
                    k + 1,
                    direction.to_array()
                );
            }
        }
        let [x, y] = self.range_mm.map(|range| 0.5 * range);
        let [near, far] = self.distance_mm;
        let extents = [2.0 * x, 2.0 * y, far - near];
        let steps = [0, 1, 2].map(|axis| extents[axis] / (POINTS[axis] - 1) as f64);
        let text = format!(
            "format = 1\nname = \"spliced film\"\n\n[ideal]\nwavelength_mm = {:?}\nthickness_mm = {height:?}\namplitude_t = {j:?}\n\n[volume]\n\
             x_mm = [{:?}, {x:?}]\ny_mm = [{:?}, {y:?}]\nz_mm = [{:?}, {:?}]\nstep_mm = {steps:?}\nreference_mm = [0.0, 0.0, {:?}]\n\n{tiles}",
            self.wavelength_mm, -x, -y, -far, -near, -far
        );
        let mut layout =
            Layout::parse(&text, "spliced film").map_err(|error| DesignError::Request(vec![error.to_string()]))?;
        let [width, depth] = self.film_mm;
        layout.name = format!("{width} x {depth} mm for a wavelength of {} mm", self.wavelength_mm);
        layout.brief = Some(self.brief());
        Ok(layout)
    }

    fn brief(&self) -> Brief {
        let square = self.film_mm[0] == self.film_mm[1] && self.range_mm[0] == self.range_mm[1];
        Brief {
            vary: Variables { size: true, position: true, direction: true, ..Variables::default() },
            symmetry: if square { Symmetry::FourFold } else { Symmetry::Mirror },
            goal: self.goal,
            least_amplitude: Some(self.least_amplitude),
            outline_mm: self.film_mm.map(|extent| Some([-0.5 * extent, 0.5 * extent])),
            smallest_cut_mm: Some(self.smallest_cut_mm),
            gap_mm: self.gap_mm,
            resolution_mm: self.resolution_mm,
            resolution_deg: self.resolution_deg,
            parts: self.parts,
            starts: self.starts,
            seed: self.seed,
            ..Brief::default()
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
        let mut problems = Vec::new();
        let lengths = [
            ("wavelength", self.wavelength_mm),
            ("film, along x", self.film_mm[0]),
            ("film, along y", self.film_mm[1]),
            ("thickness", self.thickness_mm),
            ("range, along x", self.range_mm[0]),
            ("range, along y", self.range_mm[1]),
            ("distance, the nearest", self.distance_mm[0]),
            ("smallest cut", self.smallest_cut_mm),
        ];
        let all = lengths.into_iter().chain([("resolution", self.resolution_mm)]);
        // The default lengths follow the wavelength, so that its faults are theirs, too.
        let is_positive = self.wavelength_mm > 0.0 && self.wavelength_mm.is_finite();
        for (name, value) in all.take(if is_positive { lengths.len() + 1 } else { 1 }) {
            if !(value > 0.0 && value.is_finite()) {
                problems.push(format!("{name}: {value} mm, must be a finite number greater than 0"));
            }
        }
        if !(self.remanence_t > 0.0 && self.remanence_t.is_finite()) {
            problems.push(format!("remanence: {} T, must be a finite number greater than 0", self.remanence_t));
        } else if self.remanence_t > STRONGEST_MAGNET_T {
            problems.push(format!(
                "remanence: {} T, must be at most {STRONGEST_MAGNET_T} T, more than any permanent magnet has; {}",
                self.remanence_t,
                meant_polarization(self.remanence_t)
            ));
        }
        if self.least_amplitude > MAX_AMPLITUDE {
            problems.push(format!(
                "amplitude: {}, must be at most {MAX_AMPLITUDE}, which tiles of the remanence of the ideal film cannot \
                 exceed: a fraction, not percent",
                self.least_amplitude
            ));
        }
        // In metres all lengths agree with each other; one of them in metres does not.
        if self.wavelength_mm > 0.0 && self.wavelength_mm < SHORTEST_WAVELENGTH_MM {
            problems.push(format!(
                "wavelength: {} mm, must be at least {SHORTEST_WAVELENGTH_MM} mm, or tiles are no larger than the resolution \
                 of machine tools; {}",
                self.wavelength_mm,
                meant_length(self.wavelength_mm)
            ));
        } else {
            for (name, value) in lengths.into_iter().filter(|(name, _)| *name != "wavelength") {
                if value > 0.0 && value * MAX_LENGTH_RATIO < self.wavelength_mm {
                    problems.push(format!(
                        "{name}: {value} mm, must be at least a thousandth of the wavelength, {} mm; {}",
                        self.wavelength_mm,
                        meant_length(value)
                    ));
                } else if value > MAX_LENGTH_RATIO * self.wavelength_mm && !name.starts_with("film") && is_positive {
                    problems.push(format!(
                        "{name}: {value} mm, must be at most a thousand times the wavelength, {} mm; did you mean {} mm, \
                         which is {value} um?",
                        self.wavelength_mm,
                        1e-3 * value
                    ));
                }
            }
        }
        if !(self.gap_mm >= 0.0 && self.gap_mm.is_finite()) {
            problems.push(format!("gap: {} mm, must be a finite number of at least 0", self.gap_mm));
        }
        if !(self.resolution_deg > 0.0 && self.resolution_deg.is_finite()) {
            let resolution = self.resolution_deg;
            problems
                .push(format!("resolution of directions: {resolution} deg, must be a finite number greater than 0"));
        }
        if is_positive && !(self.distance_mm[0] < self.distance_mm[1]) {
            let [near, far] = self.distance_mm;
            problems.push(format!("distance: {near} to {far} mm, the first must be less than the second"));
        }
        if problems.is_empty() {
            let quarter = 0.25 * self.wavelength_mm;
            for (axis, extent) in ["x", "y"].into_iter().zip(self.film_mm) {
                // A shorter film has no crest on either side.
                if 0.5 * extent < quarter + 0.5 * WIDE * self.wavelength_mm {
                    let least = 2.0 * quarter + WIDE * self.wavelength_mm;
                    let meant =
                        if 1e3 * extent >= least { format!("; {}", meant_length(extent)) } else { String::new() };
                    problems.push(format!(
                        "film: {extent} mm along {axis}, must be at least {least:.4} mm, 5/6 of the wavelength, to hold the \
                         crests about the middle{meant}"
                    ));
                }
            }
            // cos kx + cos ky vanishes first where x + y is half a wavelength.
            let reach = 0.5 * (self.range_mm[0] + self.range_mm[1]);
            if reach >= 0.5 * self.wavelength_mm {
                problems.push(format!(
                    "range: {} x {} mm reaches points where B_z vanishes; half the sum of both must be less than half the wavelength, {} mm",
                    self.range_mm[0],
                    self.range_mm[1],
                    0.5 * self.wavelength_mm
                ));
            }
            if self.smallest_cut_mm > 0.25 * self.wavelength_mm {
                problems.push(format!(
                    "smallest cut: {} mm, must be at most a quarter of the wavelength, {quarter} mm",
                    self.smallest_cut_mm
                ));
            }
            if IdealFilm::new(self.wavelength_mm, self.thickness_mm, self.remanence_t).is_err()
                || Tile::new(DVec3::ZERO, DVec3::splat(self.thickness_mm), DVec3::X * self.remanence_t).is_err()
            {
                problems.push("wavelength, thickness and remanence: out of range".to_owned());
            }
        }
        if problems.is_empty() { Ok(()) } else { Err(DesignError::Request(problems)) }
    }
}

#[cfg(test)]
mod tests {
    use magsplice_layout::Under;

    use super::*;

    fn request() -> SpliceRequest {
        SpliceRequest {
            wavelength_mm: 12.0,
            film_mm: [24.0, 30.0],
            thickness_mm: 1.5,
            remanence_t: 0.2,
            range_mm: [4.0, 3.0],
            distance_mm: [3.0, 5.0],
            smallest_cut_mm: 0.9,
            gap_mm: 0.05,
            resolution_mm: 0.02,
            resolution_deg: 0.5,
            least_amplitude: 0.6,
            parts: Some(7),
            goal: Goal::Displacement,
            starts: 17,
            seed: 23,
        }
    }

    fn brief(request: &SpliceRequest) -> Brief {
        request.layout().unwrap_or_else(|e| panic!("{e}")).brief.expect("a brief")
    }

    /// Each demand of the request differs from the value that a brief has without it.
    #[test]
    fn brief_has_the_demands_of_the_request() {
        let Brief {
            vary,
            symmetry,
            goal,
            under,
            weights,
            least_amplitude,
            outline_mm,
            smallest_cut_mm,
            gap_mm,
            resolution_mm,
            resolution_deg,
            parts,
            stock,
            stock_strengths_t,
            starts,
            seed,
            ..
        } = brief(&request());
        assert_eq!((goal, under, weights), (Goal::Displacement, Under::Nominal, [1.0; 3]));
        assert_eq!((least_amplitude, smallest_cut_mm, gap_mm), (Some(0.6), Some(0.9), 0.05));
        assert_eq!((resolution_mm, resolution_deg), (0.02, 0.5));
        assert_eq!((parts, starts, seed), (Some(7), 17, 23));
        assert!(stock.is_empty() && stock_strengths_t.is_empty());
        // Half of the extents, because the film is centred on 0.
        assert_eq!(outline_mm, [Some([-12.0, 12.0]), Some([-15.0, 15.0])]);
        // Shapes and directions are free. Cut lines, heights and J are the user's.
        assert!(vary.size && vary.position && vary.direction, "{vary:?}");
        assert!(!(vary.cut || vary.thickness || vary.strength || vary.tilt), "{vary:?}");
        assert_eq!(symmetry, Symmetry::Mirror);
    }

    /// x and y can be exchanged only if neither the film nor the working volume tells them apart.
    #[test]
    fn square_films_over_square_ranges_are_four_fold() {
        let square = SpliceRequest { film_mm: [24.0, 24.0], range_mm: [4.0, 4.0], ..request() };
        assert_eq!(brief(&square).symmetry, Symmetry::FourFold);
        let over_a_strip = SpliceRequest { range_mm: [4.0, 3.0], ..square.clone() };
        assert_eq!(brief(&over_a_strip).symmetry, Symmetry::Mirror);
        let oblong = SpliceRequest { film_mm: [24.0, 30.0], ..square };
        assert_eq!(brief(&oblong).symmetry, Symmetry::Mirror);
    }
}
