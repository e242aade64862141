//! A film as a DXF drawing, seen from above.
//!
//! The format is DXF R12, which every CAD program reads. Polylines, lines and circles need only
//! pairs of a code and a value.

use std::fmt::Display;
use std::io::{self, Write};

use glam::{DVec2, DVec3};
use magsplice_layout::Layout;
use magsplice_magnet::{Tile, convex_hull};

use magsplice::results::{rounded_beside, twelve_digits};

/// The parts of the drawing before its entities: millimetres, metric hatches and line types, a
/// continuous line, the layers, and upright characters of any height in the standard font of CAD
/// programs.
const BEGINNING: &str = include_str!("dxf_head.dxf");

/// Length of an arrow, as a fraction of the shortest side of its tile.
const ARROW: f64 = 0.7;
/// Length and half width of the head of an arrow, as a fraction of the shortest side.
const HEAD: [f64; 2] = [0.2, 0.1];
/// Largest share of the component in the plane of a polarization drawn as a circle.
const VERTICAL: f64 = 0.01;
/// Radius of the circle, as a fraction of the shortest side.
const RADIUS: f64 = 0.2;
/// Number of colours of layers: red, yellow, green, cyan, blue, magenta.
const COLOURS: usize = 6;
/// Distance of a name from the centre of its outline, as a fraction of the way to an edge. It is
/// beside the arrow, which ends at [`ARROW`] of this way at most.
const NAME_AT: f64 = 0.82;
/// Largest height of a name, as a fraction of the width of its outline, to fit between the arrow
/// and the edge.
const NAME_HEIGHT: f64 = 0.1;
/// Largest length of a name, as a fraction of the edge along which it runs.
const NAME_LENGTH: f64 = 0.9;
/// Largest width of a character in the standard font of drawings, as a fraction of its height.
const CHARACTER: f64 = 1.0;

/// Writes the outlines of the tiles in the xy plane and an arrow for each polarization, in
/// millimetres. The tiles of the n-th part of [`Layout::parts`] are on the layer `PART-n`. The name
/// of each tile is a text inside its outline.
///
/// The arrow is the projection of the polarization onto the plane. A polarization normal to the
/// plane is a circle, with a point if it comes up and with a cross if it goes down.
///
/// # Errors
/// Errors of the writer.
pub fn film(layout: &Layout, w: &mut dyn Write) -> io::Result<()> {
    let parts = layout.parts();
    let corners = layout.tiles.iter().flat_map(|named| named.tile.corners_mm());
    let largest_mm = corners.map(|corner| corner.truncate().abs().max_element()).fold(0.0, f64::max);
    let layers = (0..parts.len()).map(|index| (layer(index), 1 + index % COLOURS));
    let layers = std::iter::once(("0".to_owned(), 7)).chain(layers);
    let layers = layers.map(|(name, colour)| format!("0\nLAYER\n2\n{name}\n70\n0\n62\n{colour}\n6\nCONTINUOUS\n"));
    let layers = format!("{}\n{}", parts.len() + 1, layers.collect::<String>());
    w.write_all(BEGINNING.replace("{layers}\n", &layers).as_bytes())?;
    let mut drawing = Drawing { w, layer: String::new(), largest_mm };
    for (index, part) in parts.iter().enumerate() {
        drawing.layer = layer(index);
        for &tile in &part.tiles {
            let named = &layout.tiles[tile];
            let corners = outline(&named.tile);
            drawing.outline(&corners)?;
            drawing.name(&named.name, &corners)?;
            drawing.arrow(&named.tile)?;
        }
    }
    drawing.pair(0, "ENDSEC")?;
    drawing.pair(0, "EOF")
}

fn layer(part: usize) -> String {
    format!("PART-{}", part + 1)
}

/// The corners of the outline from above, counter-clockwise.
fn outline(tile: &Tile) -> Vec<DVec2> {
    let slack = 1e-9 * tile.size().max_element() * tile.size().max_element();
    convex_hull(tile.corners_mm().map(|corner| corner.truncate()).to_vec(), slack)
}

/// A text encoded for DXF R12: characters beyond ASCII and percent signs that would begin a code
/// become numbers. Characters beyond four hexadecimal digits become question marks.
fn encoded(text: &str) -> String {
    let encode = |c: char| match c {
        ' '..='~' => c.to_string(),
        '\u{80}'..='\u{ffff}' => format!("\\U+{:04X}", u32::from(c)),
        _ => "?".to_owned(),
    };
    text.replace("%%", "%%%%%%").chars().map(encode).collect()
}

/// A writer of a drawing, as pairs of a code and a value.
struct Drawing<'w> {
    w: &'w mut dyn Write,
    /// Layer of the entities.
    layer: String,
    /// The largest coordinate, in mm. Coordinates are rounded to its twelve digits.
    largest_mm: f64,
}

impl Drawing<'_> {
    fn pair(&mut self, code: u32, value: impl Display) -> io::Result<()> {
        writeln!(self.w, "{code}\n{value}")
    }

    fn entity(&mut self, name: &str) -> io::Result<()> {
        self.pair(0, name)?;
        let layer = self.layer.clone();
        self.pair(8, layer)
    }

    /// Writes a point, with codes from `first` on.
    fn point(&mut self, first: u32, p: DVec2) -> io::Result<()> {
        self.real(first, p.x)?;
        self.real(first + 10, p.y)?;
        self.pair(first + 20, "0.0")
    }

    /// Writes a length or a coordinate in mm.
    fn real(&mut self, code: u32, value: f64) -> io::Result<()> {
        // `{:?}` has a decimal point, which some readers require of real numbers.
        self.pair(code, format_args!("{:?}", rounded_beside(value, self.largest_mm)))
    }

    fn line(&mut self, from: DVec2, to: DVec2) -> io::Result<()> {
        self.entity("LINE")?;
        self.point(10, from)?;
        self.point(11, to)
    }

    fn outline(&mut self, corners: &[DVec2]) -> io::Result<()> {
        self.entity("POLYLINE")?;
        self.pair(66, 1)?;
        self.point(10, DVec2::ZERO)?;
        // Closed.
        self.pair(70, 1)?;
        for corner in corners {
            self.entity("VERTEX")?;
            self.point(10, *corner)?;
        }
        self.entity("SEQEND")
    }

    /// Writes a name along the longest edge of an outline, the lowest of several; upright or
    /// readable from the right.
    fn name(&mut self, name: &str, corners: &[DVec2]) -> io::Result<()> {
        let centre = corners.iter().sum::<DVec2>() / corners.len() as f64;
        let edges = || corners.iter().zip(corners.iter().cycle().skip(1));
        let longest = edges().map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        // Round-off must not decide between edges of the same length.
        let long = edges().filter(|(a, b)| a.distance(**b) >= (1.0 - 1e-9) * longest);
        let Some((a, b)) = long.min_by(|(a, b), (c, d)| (a.y + b.y).total_cmp(&(c.y + d.y))) else { return Ok(()) };
        let along = (b - a) / longest;
        let along = if along.x < 0.0 || (along.x == 0.0 && along.y < 0.0) { -along } else { along };
        let to_edge = 0.5 * (*a + *b) - centre;
        let width = 2.0 * to_edge.perp_dot(along).abs();
        let characters = name.chars().count().max(1) as f64;
        let height = (NAME_HEIGHT * width).min(NAME_LENGTH * longest / (CHARACTER * characters));
        let at = centre + NAME_AT * to_edge;
        self.entity("TEXT")?;
        self.point(10, at)?;
        self.real(40, height)?;
        self.pair(1, encoded(name))?;
        self.pair(50, format_args!("{:?}", twelve_digits(along.y.atan2(along.x).to_degrees())))?;
        // Centred about its point in both directions.
        self.pair(72, 1)?;
        self.point(11, at)?;
        self.pair(73, 2)
    }

    fn arrow(&mut self, tile: &Tile) -> io::Result<()> {
        let j = tile.scene_polarization_t();
        let largest = j.abs().max_element();
        if largest == 0.0 {
            return Ok(());
        }
        let unit: DVec3 = (j / largest).normalize();
        let (centre, side) =
            (tile.position().truncate(), tile.size().min_element().min(tile.size().truncate().min_element()));
        let along = unit.truncate();
        if along.length() < VERTICAL {
            let radius = RADIUS * side;
            self.entity("CIRCLE")?;
            self.point(10, centre)?;
            self.real(40, radius)?;
            if unit.z > 0.0 {
                self.entity("POINT")?;
                return self.point(10, centre);
            }
            for arm in [DVec2::new(radius, radius), DVec2::new(radius, -radius)] {
                let arm = arm * std::f64::consts::FRAC_1_SQRT_2;
                self.line(centre - arm, centre + arm)?;
            }
            return Ok(());
        }
        let half = 0.5 * ARROW * side * along;
        let tip = centre + half;
        self.line(centre - half, tip)?;
        let direction = along.normalize();
        for sign in [-1.0, 1.0] {
            self.line(tip, tip + side * (sign * HEAD[1] * direction.perp() - HEAD[0] * direction))?;
        }
        Ok(())
    }
}
