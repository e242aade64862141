//! The images of a film in flat iron.

use glam::DVec3;
use magsplice_magnet::{IronPlane, IronPlanes, PointError, PointErrorCause, PointErrors, Reflection, Tile};

use crate::readings::Pose;

/// The iron around a film in a sample.
#[derive(Clone, Debug)]
pub(crate) struct IronAround {
    /// The iron that moves with the film.
    pub(crate) own: IronPlanes,
    /// The iron near it.
    pub(crate) near: Option<IronPlane>,
    pub(crate) pose: Pose,
}

impl IronAround {
    /// How far tiles reach into the iron near the film. `None` if they do not.
    pub(crate) fn depth_of(&self, tiles: &[Tile]) -> Option<f64> {
        let plane = self.near?;
        let corners = tiles.iter().flat_map(Tile::corners_mm);
        let depth_mm = corners.map(|corner| -plane.distance(self.pose.apply(corner))).fold(f64::NEG_INFINITY, f64::max);
        (depth_mm > 0.0).then_some(depth_mm)
    }

    /// Points that are in iron.
    pub(crate) fn check(&self, places: &[DVec3]) -> Result<(), PointErrors> {
        let plane_of = |place: DVec3| {
            let near = || self.near.filter(|plane| plane.distance(place) <= 0.0).map(|_| 0);
            self.own.plane_before(self.pose.undo(place)).or_else(near)
        };
        let in_iron = |(index, place): (usize, &DVec3)| {
            plane_of(*place).map(|plane| PointError { index, point: *place, cause: PointErrorCause::InIron { plane } })
        };
        let errors: Vec<PointError> = places.iter().enumerate().filter_map(in_iron).collect();
        if errors.is_empty() { Ok(()) } else { Err(PointErrors(errors)) }
    }
}

/// How the field of a film and of its images at a place follows from the field of the film alone at
/// several places, one for each reflection.
#[derive(Clone, Debug)]
pub(crate) struct FilmImages {
    /// None for the film itself, then one for each image.
    pub(crate) reflections: Vec<Reflection>,
    /// Whether the iron moves with the film.
    pub(crate) moves: bool,
    /// Whether the iron comes after the reading at the reference point.
    pub(crate) later: bool,
}

impl FilmImages {
    /// The places in the frame of the film at which it has the field of its images of one
    /// reflection.
    pub(crate) fn in_film(&self, reflection: &Reflection, pose: &Pose, places: &[DVec3]) -> Vec<DVec3> {
        let of = |place: &DVec3| match self.moves {
            true => reflection.place(pose.undo(*place)),
            false => pose.undo(reflection.place(*place)),
        };
        places.iter().map(of).collect()
    }

    /// Adds the field of the images of reflection number `number` at each place, from the field of
    /// the film. The last of each `points` places is the reference point.
    pub(crate) fn add(&self, number: usize, pose: &Pose, in_film_t: &[DVec3], points: usize, sums_t: &mut [DVec3]) {
        let reflection = &self.reflections[number];
        for (place, (sum_t, b_t)) in sums_t.iter_mut().zip(in_film_t).enumerate() {
            let is_absent = number > 0 && self.later && place % points == points - 1;
            if !is_absent {
                *sum_t += match self.moves {
                    true => pose.rotation() * reflection.field(*b_t),
                    false => reflection.field(pose.rotation() * *b_t),
                };
            }
        }
    }
}
