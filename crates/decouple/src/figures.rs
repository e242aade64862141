//! The figures of a film: seven measures of its decoupling.

use magsplice_magnet::Axis;

use crate::decoupling::Decoupling;
use crate::per_axis::PerAxis;
use crate::per_parameter::{Parameter, PerParameter};

/// The figures of a film over its working volume, or one value for each of them, such as their
/// statistics.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Figures<T = f64> {
    /// Uniformity RMSE; see [`Decoupling::uniformity_rmse`]. `None` where the planes normal to the
    /// axis of the parameter have one point each.
    pub uniformity_rmse: PerParameter<Option<T>>,
    /// RMSE of the displacement along x, y, z computed from the parameters (Dai 2024, Eq. 14), in
    /// millimetres; see [`Decoupling::displacement_rmse_mm`].
    pub displacement_rmse_mm: PerAxis<T>,
    /// The factor of the ideal film's field that fits the field of the film best.
    pub amplitude: T,
}

/// One of the [`Figures`]. They are ordered as in [`Figure::ALL`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Figure {
    /// Uniformity RMSE of one parameter, in radians for R_x and R_y.
    Uniformity(Parameter),
    /// RMSE of the displacement along an axis, in millimetres.
    Displacement(Axis),
    /// Best-fit amplitude against the ideal film.
    Amplitude,
}

impl Figure {
    /// All figures.
    pub const ALL: [Figure; 7] = [
        Figure::Uniformity(Parameter::Rx),
        Figure::Uniformity(Parameter::Ry),
        Figure::Uniformity(Parameter::Sz),
        Figure::Displacement(Axis::X),
        Figure::Displacement(Axis::Y),
        Figure::Displacement(Axis::Z),
        Figure::Amplitude,
    ];

    /// The index of the figure in [`Figure::ALL`].
    pub const fn index(self) -> usize {
        match self {
            Figure::Uniformity(parameter) => parameter.axis().index(),
            Figure::Displacement(axis) => 3 + axis.index(),
            Figure::Amplitude => 6,
        }
    }

    /// The key of the figure with its unit, for tables and files.
    pub const fn key(self) -> &'static str {
        match self {
            Figure::Uniformity(Parameter::Rx) => "uniformity_rmse.r_x",
            Figure::Uniformity(Parameter::Ry) => "uniformity_rmse.r_y",
            Figure::Uniformity(Parameter::Sz) => "uniformity_rmse.s_z",
            Figure::Displacement(Axis::X) => "displacement_rmse_mm.x",
            Figure::Displacement(Axis::Y) => "displacement_rmse_mm.y",
            Figure::Displacement(Axis::Z) => "displacement_rmse_mm.z",
            Figure::Amplitude => "amplitude",
        }
    }
}

impl Figures {
    /// The figures of a film with this decoupling and this best-fit amplitude against the ideal
    /// film.
    pub fn new(decoupling: &Decoupling, amplitude: f64) -> Figures {
        Figures {
            uniformity_rmse: decoupling.uniformity_rmse,
            displacement_rmse_mm: decoupling.displacement_rmse_mm,
            amplitude,
        }
    }
}

impl<T> Figures<T> {
    /// The values of a function of the figure. `None` if it returns `None` for a displacement or
    /// for the amplitude.
    pub fn from_fn(mut value: impl FnMut(Figure) -> Option<T>) -> Option<Figures<T>> {
        let uniformity_rmse = Parameter::ALL.map(|parameter| value(Figure::Uniformity(parameter))).into();
        let [x, y, z] = Axis::ALL.map(|axis| value(Figure::Displacement(axis)));
        let displacement_rmse_mm = PerAxis { x: x?, y: y?, z: z? };
        Some(Figures { uniformity_rmse, displacement_rmse_mm, amplitude: value(Figure::Amplitude)? })
    }

    /// The value of one figure. `None` for an undefined uniformity.
    pub fn get(&self, figure: Figure) -> Option<&T> {
        match figure {
            Figure::Uniformity(parameter) => self.uniformity_rmse[parameter].as_ref(),
            Figure::Displacement(axis) => Some(&self.displacement_rmse_mm[axis]),
            Figure::Amplitude => Some(&self.amplitude),
        }
    }

    /// Every figure with its value, in the order of [`Figure::ALL`].
    pub fn iter(&self) -> impl Iterator<Item = (Figure, Option<&T>)> {
        Figure::ALL.into_iter().map(|figure| (figure, self.get(figure)))
    }

    /// Applies a function to each value.
    pub fn map<U>(self, mut f: impl FnMut(T) -> U) -> Figures<U> {
        Figures {
            uniformity_rmse: self.uniformity_rmse.map(|value| value.map(&mut f)),
            displacement_rmse_mm: self.displacement_rmse_mm.map(&mut f),
            amplitude: f(self.amplitude),
        }
    }
}

/// A key, such as `uniformity_rmse.r_x`.
#[cfg(feature = "serde")]
impl serde::Serialize for Figure {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.key())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_come_in_the_order_of_all_figures() {
        assert!(Figure::ALL.is_sorted());
        let places = Figures::from_fn(|figure| Some(figure.index())).expect("all are defined");
        for (place, (figure, value)) in places.iter().enumerate() {
            assert_eq!((figure, figure.index(), value), (Figure::ALL[place], place, Some(&place)));
            assert_eq!(Figure::ALL.iter().filter(|other| other.key() == figure.key()).count(), 1);
        }
        assert_eq!(places.map(|place| place + 1).amplitude, 7);
    }

    #[test]
    fn only_a_uniformity_may_be_undefined() {
        for undefined in Figure::ALL {
            let found = Figures::from_fn(|figure| (figure != undefined).then_some(1.0));
            match undefined {
                Figure::Uniformity(parameter) => {
                    let found = found.expect("defined but for a uniformity");
                    assert_eq!((found.get(undefined), found.uniformity_rmse[parameter]), (None, None));
                    assert_eq!(found.iter().filter(|(_, value)| value.is_none()).count(), 1);
                }
                _ => assert_eq!(found, None),
            }
        }
    }
}
