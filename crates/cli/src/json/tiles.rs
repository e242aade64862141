//! `tiles`: a layout with one entry per tile, and its parts.

use magsplice::layout::PlainLayout;
use serde::Serialize;

use crate::cut_list::CutList;

/// The layout with one `tile` for each tile, and `parts` beside the keys of the layout file.
#[derive(Serialize)]
pub(crate) struct TilesJson<'a> {
    #[serde(flatten)]
    layout: PlainLayout<'a>,
    parts: Vec<PartJson<'a>>,
}

/// A part as the cut list has it.
#[derive(Serialize)]
struct PartJson<'a> {
    part: usize,
    count: usize,
    size_mm: [f64; 3],
    strength_t: f64,
    /// Absent without polarization, like `tilt_deg`.
    #[serde(skip_serializing_if = "Option::is_none")]
    direction_deg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tilt_deg: Option<f64>,
    tiles: Vec<&'a str>,
}

impl<'a> TilesJson<'a> {
    pub(crate) fn new(list: &'a CutList) -> TilesJson<'a> {
        let part = |(index, part): (usize, &'a magsplice::layout::Part)| {
            let angles = part.angles_deg();
            PartJson {
                part: index + 1,
                count: part.count,
                size_mm: part.size_mm.to_array(),
                strength_t: part.strength_t,
                direction_deg: angles.map(|[direction, _]| direction),
                tilt_deg: angles.map(|[_, tilt]| tilt),
                tiles: list.names(part),
            }
        };
        TilesJson { layout: list.layout.plain(), parts: list.parts.iter().enumerate().map(part).collect() }
    }
}
