//! Material and permeabilities to their tables.

use magsplice_magnet::Permeability;

use crate::material::Material;
use crate::tables::material::{AlongAndAcross, MaterialTable, RecoilPermeability};

/// The table of a material; `None` for the default.
pub(crate) fn material_table(material: &Material) -> Option<MaterialTable> {
    let Material { permeability, recoil_error, knee_field_t, strength_per_k } = *material;
    (*material != Material::default()).then(|| MaterialTable {
        recoil_permeability: (!permeability.is_rigid()).then(|| recoil_permeability(permeability)),
        recoil_error: (recoil_error != Material::default().recoil_error).then_some(recoil_error),
        knee_field_t,
        strength_per_k,
    })
}

/// A permeability as it is written: one number if it is the same in all directions.
pub(crate) fn recoil_permeability(permeability: Permeability) -> RecoilPermeability {
    let (along, across) = (permeability.along(), permeability.across());
    if along == across {
        RecoilPermeability::Isotropic(along)
    } else {
        RecoilPermeability::Axes(AlongAndAcross { along, across })
    }
}
