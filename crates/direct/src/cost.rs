//! The time of the exact field, by counted operations.

use glam::DVec3;
use magsplice_cuboid::method::Method;
use magsplice_cuboid::tolerances::{CLOSED_FORM_COST, SINGLE_TILE_COST};

use super::direct_sum::DirectSum;
use crate::prepare::clusters::Cluster;
use crate::prepare::frames::Frame;
use crate::tolerances::COST_POINTS;

impl DirectSum {
    /// The mean time of the exact field at the points, in exact fields of one tile of a film, from
    /// the methods of a few points. Distant tiles take less than one each.
    pub fn cost(&self, count: usize, point: impl Fn(usize) -> DVec3) -> f64 {
        let chosen = count.min(COST_POINTS);
        let total: f64 = (0..chosen).map(|n| self.cost_at(point((2 * n + 1) * count / (2 * chosen)))).sum();
        total / chosen.max(1) as f64
    }

    fn cost_at(&self, point: DVec3) -> f64 {
        let of_frame = |frame: &Frame| -> f64 {
            let local = self.frames().coordinates(frame, point);
            frame.clusters.clusters.iter().map(|cluster| cost_of_cluster(cluster, local)).sum()
        };
        self.frames().frames().iter().map(of_frame).sum()
    }

    /// The time of a cluster of `frame` at a point, in exact fields of one tile of a film.
    pub fn cost_of_cluster(&self, frame: &Frame, cluster: &Cluster, point: DVec3) -> f64 {
        cost_of_cluster(cluster, self.frames().coordinates(frame, point))
    }
}

fn cost_of_cluster(cluster: &Cluster, point: [f64; 3]) -> f64 {
    let (tiles, method) = (cluster.blocks.len(), cluster.ranges.method_at(point));
    let alone = SINGLE_TILE_COST * tiles as f64;
    let cost = match method {
        Method::Scalar => alone,
        Method::ClosedForm | Method::SmallElements if cluster.corners.is_none() => alone,
        method => method.cost(tiles),
    };
    cost / CLOSED_FORM_COST
}
