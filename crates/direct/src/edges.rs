//! Edges on which the field is unbounded.
//!
//! Close to an edge along axis k the field grows like `-(J_i e_j + J_j e_i) ln(rho) / 2 pi`
//! (docs/physics.md, Eq. P17), and its gradient like 1 / rho with the same coefficient. These terms
//! can cancel where touching tiles share the edge. Field and gradient are then bounded, and the
//! common displacement of the point from the edge (see
//! [`FACE_NUDGE`](magsplice_cuboid::tolerances::FACE_NUDGE)) drops out of the sum of fields.

use glam::DVec3;

use magsplice_cuboid::block::{Block, PlacedPoint};

use crate::prepare::frames::ToScene;
use crate::tolerances::{EDGE_CANCELLATION, SAME_RAY};

/// The edges that start at a point, with the sums of the coefficients of their tiles.
#[derive(Default)]
pub struct EdgesAtPoint {
    rays: Vec<Ray>,
}

struct Ray {
    direction: DVec3,
    coefficient: DVec3,
    magnitude: f64,
    tile: usize,
}

impl EdgesAtPoint {
    /// Adds the edges of `block` through the point.
    pub fn add(&mut self, block: &Block, placed: &PlacedPoint, to_scene: &ToScene) {
        let (j, offsets) = (block.polarization_t, &placed.offsets);
        for edges in 0..3 {
            let (a, b) = ((edges + 1) % 3, (edges + 2) % 3);
            // The point is not on the edge, or only on its extension.
            if !(offsets[a].on_face && offsets[b].on_face) || !(offsets[edges].within() || offsets[edges].on_face) {
                continue;
            }
            let weight = offsets[a].sign() * offsets[b].sign();
            let mut coefficient = DVec3::ZERO;
            coefficient[a] = weight * j[b];
            coefficient[b] = weight * j[a];
            if coefficient == DVec3::ZERO {
                continue;
            }
            // At a corner the edge extends from the point to one side only, along the tile.
            let sides = match (offsets[edges].on_face, offsets[edges].mirrored) {
                (false, _) => [1.0, -1.0].as_slice(),
                (true, mirrored) => &[if mirrored { 1.0 } else { -1.0 }],
            };
            for side in sides {
                let mut direction = DVec3::ZERO;
                direction[edges] = *side;
                self.add_ray(to_scene.vector(direction), to_scene.vector(coefficient), block.tile);
            }
        }
    }

    fn add_ray(&mut self, direction: DVec3, coefficient: DVec3, tile: usize) {
        // Not squared, because J may be as small as the smallest number.
        let magnitude = coefficient.abs().max_element();
        match self.rays.iter_mut().find(|ray| ray.direction.distance(direction) <= SAME_RAY) {
            Some(ray) => {
                ray.coefficient += coefficient;
                ray.magnitude += magnitude;
            }
            None => self.rays.push(Ray { direction, coefficient, magnitude, tile }),
        }
    }

    /// Whether the singular term of an edge remains, so that field and gradient are unbounded.
    pub fn exposed(&self) -> bool {
        self.rays.iter().any(Ray::exposed)
    }

    /// Whether there are singular terms. If none is exposed, the terms of several blocks cancel.
    pub fn singular(&self) -> bool {
        !self.rays.is_empty()
    }

    /// Index of a tile with a singular edge at the point, preferably an exposed edge.
    pub fn tile(&self) -> Option<usize> {
        self.rays.iter().find(|ray| ray.exposed()).or(self.rays.first()).map(|ray| ray.tile)
    }
}

impl Ray {
    fn exposed(&self) -> bool {
        self.coefficient.abs().max_element() > EDGE_CANCELLATION * self.magnitude
    }
}
