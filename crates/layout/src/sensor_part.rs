//! Parts of sensors: their numbers, which may depend on a setting.

use std::fmt;

use glam::DVec3;
use serde::Deserialize;
use toml::Table;

use crate::error_unit::ErrorUnit;
use crate::file::values::from_value;
use crate::one_or_three::OneOrThree;

/// The numbers of the parts.
const PARTS: &str = include_str!("sensor_parts.toml");

/// Values of GAIN_SEL and RES of an MLX90393.
pub(crate) const GAINS: usize = 8;
pub(crate) const RESOLUTIONS: usize = 4;

/// A setting of a part, on which the flux density of a count and the range depend.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PartSetting {
    /// The registers GAIN_SEL (0 to 7) and RES (0 to 3, along x, y, z) of an MLX90393.
    Gain {
        /// Analog gain.
        gain_sel: u8,
        /// Which 16 of the 19 bits are read, for each axis.
        res: [u8; 3],
    },
    /// The full scale of a LIS3MDL.
    FullScale {
        /// In gauss: 4, 8, 12 or 16.
        gauss: u8,
    },
}

/// The numbers of a part.
#[derive(Clone, Default, Deserialize)]
pub(crate) struct Part {
    pub(crate) noise_ut: Option<OneOrThree>,
    count_ut: Option<OneOrThree>,
    range_mt: Option<OneOrThree>,
    pub(crate) rate_hz: Option<f64>,
    gain: Option<GainTable>,
    full_scale: Option<FullScaleTable>,
}

/// Sensitivities for GAIN_SEL and RES.
#[derive(Clone, Deserialize)]
struct GainTable {
    default_gain_sel: u8,
    default_res: u8,
    xy_ut: [[f64; RESOLUTIONS]; GAINS],
    z_ut: [[f64; RESOLUTIONS]; GAINS],
    most_counts: [f64; RESOLUTIONS],
    saturation_mt: f64,
}

/// Sensitivities for full scales.
#[derive(Clone, Deserialize)]
struct FullScaleTable {
    default_gauss: u8,
    gauss: Vec<u8>,
    counts_per_gauss: Vec<f64>,
}

/// The flux density of a count and the range, in tesla.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    pub(crate) count_t: DVec3,
    pub(crate) range_t: DVec3,
}

impl Part {
    /// The part with this name.
    pub(crate) fn named(name: &str) -> Option<Part> {
        parts().remove(name).map(|part| from_value(part).expect("a part is a table of numbers"))
    }

    /// The names of all parts.
    pub(crate) fn names() -> Vec<String> {
        parts().keys().cloned().collect()
    }

    /// The setting whose numbers it has where the layout gives none. `None` for a part with one
    /// setting.
    pub(crate) fn default_setting(&self) -> Option<PartSetting> {
        let gain = self
            .gain
            .as_ref()
            .map(|table| PartSetting::Gain { gain_sel: table.default_gain_sel, res: [table.default_res; 3] });
        gain.or(self.full_scale.as_ref().map(|table| PartSetting::FullScale { gauss: table.default_gauss }))
    }

    /// All settings with one RES for all axes, the finest count first.
    fn settings(&self) -> Vec<PartSetting> {
        let mut settings = Vec::new();
        if self.gain.is_some() {
            // Of the same sensitivity, the higher analog gain has less noise.
            let gains = (0..GAINS as u8).rev();
            settings.extend(gains.flat_map(|gain_sel| {
                (0..RESOLUTIONS as u8).map(move |res| PartSetting::Gain { gain_sel, res: [res; 3] })
            }));
        }
        let scales = self.full_scale.iter().flat_map(|table| &table.gauss);
        settings.extend(scales.map(|&gauss| PartSetting::FullScale { gauss }));
        let fineness = |setting: &PartSetting| self.scale(Some(*setting)).map_or(0.0, |scale| scale.count_t.x);
        settings.sort_by(|one, other| fineness(one).total_cmp(&fineness(other)));
        settings
    }

    /// The flux density of a count and the range with a setting. `None` if the part does not have
    /// it.
    pub(crate) fn scale(&self, setting: Option<PartSetting>) -> Option<Scale> {
        let (ut, mt) = (ErrorUnit::Microtesla, ErrorUnit::Millitesla);
        match setting {
            None => Some(Scale {
                count_t: DVec3::from(self.count_ut?).map(|count| ut.read(count)),
                range_t: DVec3::from(self.range_mt?).map(|range| mt.read(range)),
            }),
            Some(PartSetting::Gain { gain_sel, res }) => {
                let table = self.gain.as_ref()?;
                let [x, y, z] = res.map(usize::from);
                let (xy_ut, z_ut) = (table.xy_ut.get(usize::from(gain_sel))?, table.z_ut.get(usize::from(gain_sel))?);
                let count_ut = DVec3::new(*xy_ut.get(x)?, *xy_ut.get(y)?, *z_ut.get(z)?);
                let most = DVec3::from([x, y, z].map(|res| table.most_counts[res]));
                let count_t = count_ut.map(|count| ut.read(count));
                let range_mt = (count_ut * most / UT_PER_MT).min(DVec3::splat(table.saturation_mt));
                Some(Scale { count_t, range_t: range_mt.map(|range| mt.read(range)) })
            }
            Some(PartSetting::FullScale { gauss }) => {
                let table = self.full_scale.as_ref()?;
                let index = table.gauss.iter().position(|known| *known == gauss)?;
                let count_t = ut.read(UT_PER_GAUSS / table.counts_per_gauss[index]);
                let range_t = mt.read(UT_PER_GAUSS * f64::from(gauss) / UT_PER_MT);
                Some(Scale { count_t: DVec3::splat(count_t), range_t: DVec3::splat(range_t) })
            }
        }
    }

    /// The finest setting with a range above these magnitudes, and its range. `None` if no setting
    /// has one.
    pub(crate) fn setting_for(&self, largest_t: DVec3) -> Option<(PartSetting, DVec3)> {
        let with_range = |setting| Some((setting, self.scale(Some(setting))?.range_t));
        self.settings().into_iter().filter_map(with_range).find(|(_, range_t)| largest_t.cmplt(*range_t).all())
    }
}

/// Microtesla in a gauss, and in a millitesla.
const UT_PER_GAUSS: f64 = 100.0;
const UT_PER_MT: f64 = 1000.0;

fn parts() -> Table {
    PARTS.parse().expect("the list of parts is TOML")
}

/// As in a layout file.
impl fmt::Display for PartSetting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PartSetting::Gain { gain_sel, res: [x, y, z] } if x == y && y == z => {
                write!(f, "gain_sel = {gain_sel}, res = {x}")
            }
            PartSetting::Gain { gain_sel, res } => write!(f, "gain_sel = {gain_sel}, res = {res:?}"),
            PartSetting::FullScale { gauss } => write!(f, "full_scale_gauss = {gauss}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_setting_obeys_the_rules() {
        assert_eq!(Part::names().len(), 4);
        for name in Part::names() {
            let part = Part::named(&name).unwrap();
            assert!(part.scale(part.default_setting()).is_some(), "{name}");
            assert!(part.rate_hz > Some(0.0) && DVec3::from(part.noise_ut.unwrap()).cmpgt(DVec3::ZERO).all());
            let settings: Vec<Option<PartSetting>> = match part.default_setting() {
                None => vec![None],
                Some(_) => part.settings().into_iter().map(Some).collect(),
            };
            for setting in settings {
                let Scale { count_t, range_t } = part.scale(setting).unwrap();
                // A count is finer than the range by more than ten bits.
                assert!(count_t.cmpgt(DVec3::ZERO).all() && (1000.0 * count_t).cmplt(range_t).all(), "{setting:?}");
            }
        }
    }

    /// The values of the datasheet that it also states in its text: the range of the highest gain
    /// is at least 4.8 mT, gains differ by a factor of five, and the magnet saturates at 50 mT.
    #[test]
    fn gains_are_those_of_the_datasheet() {
        let part = Part::named("MLX90393").unwrap();
        let of = |gain_sel, res| part.scale(Some(PartSetting::Gain { gain_sel, res })).unwrap();
        assert!((of(7, [0; 3]).range_t - DVec3::new(4.9152e-3, 4.9152e-3, 7.929856e-3)).length() < 1e-15);
        assert!((of(0, [0; 3]).count_t / of(7, [0; 3]).count_t - 5.0).abs().max_element() < 0.01);
        assert_eq!(of(0, [3; 3]).range_t, DVec3::splat(0.05));
        assert!((of(3, [1, 2, 0]).count_t - DVec3::new(0.751e-6, 1.502e-6, 0.605e-6)).length() < 1e-18);
        assert!((of(3, [1, 2, 0]).range_t.y - 22000.0 * 1.502e-6).abs() < 1e-15);
        assert_eq!(part.scale(Some(PartSetting::Gain { gain_sel: 8, res: [0; 3] })), None);
        assert_eq!(part.scale(Some(PartSetting::FullScale { gauss: 4 })), None);
    }

    #[test]
    fn finest_setting_that_holds_a_field_is_found() {
        let part = Part::named("MLX90393").unwrap();
        let found =
            |largest_mt: f64| part.setting_for(DVec3::splat(1e-3 * largest_mt)).map(|found| found.0.to_string());
        assert_eq!(found(4.0).as_deref(), Some("gain_sel = 7, res = 0"));
        assert_eq!(found(6.0).as_deref(), Some("gain_sel = 6, res = 0"));
        assert_eq!(found(9.0).as_deref(), Some("gain_sel = 7, res = 1"));
        assert_eq!(found(55.0), None);
        let part = Part::named("LIS3MDL").unwrap();
        let found = part.setting_for(DVec3::splat(0.5e-3)).unwrap();
        assert_eq!((found.0.to_string().as_str(), found.1), ("full_scale_gauss = 8", DVec3::splat(0.8e-3)));
        assert!(Part::named("TLV493D").unwrap().setting_for(DVec3::ZERO).is_none());
    }
}
