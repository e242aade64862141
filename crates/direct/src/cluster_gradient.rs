//! The gradient of the tiles of a cluster, in vectors.

use std::any::Any;

use fearless_simd::prelude::*;
use magsplice_cuboid::closed_form::gradient::{COMPONENTS, GradientTerms};
use magsplice_simd::lanes::{Lanes, Number};

use super::cluster_kernel::{Places, load};
use crate::prepare::corner_tables::CornerTables;

/// Buffer for the tables of the instruction set last used.
#[derive(Default)]
pub(super) struct KeptPlaces {
    places: Option<Box<dyn Any + Send>>,
    terms: Vec<GradientTerms>,
}

impl KeptPlaces {
    /// Writes the gradient of B of the tiles of `cluster` in tesla per length, in their frame: xx,
    /// yy, zz, yz, xz, xy. The points, in whole vectors, are in the range of the closed form.
    #[inline(never)]
    pub(super) fn gradients<S: Simd>(
        &mut self,
        simd: S,
        cluster: &CornerTables,
        points: [&[f64]; 3],
        mut gradients: [&mut [f64]; COMPONENTS],
    ) {
        self.terms.clear();
        self.terms.extend(cluster.tiles.iter().map(|tile| cluster.gradient_terms(tile)));
        simd.vectorize(
            #[inline(always)]
            || {
                let kept = self.places.take().and_then(|places| places.downcast::<Places<S>>().ok());
                let mut places = kept.unwrap_or_else(|| Box::new(Places::new(simd)));
                for start in (0..points[0].len()).step_by(Lanes::<S>::LEN) {
                    places.set(cluster, load(simd, points, start));
                    let mut sum = [Lanes::splat(simd, 0.0); COMPONENTS];
                    for (tile, terms) in cluster.tiles.iter().zip(&self.terms) {
                        terms.add(simd, &places.of(tile), &mut sum);
                    }
                    for (gradients, component) in gradients.iter_mut().zip(sum) {
                        component.store(&mut gradients[start..start + Lanes::<S>::LEN]);
                    }
                }
                self.places = Some(places);
            },
        );
    }
}
