//! Writing `[sensor]` and `[elastomer]`.

use glam::DVec3;
use magsplice_magnet::HallSensor;

use crate::error_unit::ErrorUnit;
use crate::sensor::{Elastomer, StatedSensor};
use crate::tables::sensor::{ElastomerTable, PerAxis, PlatesTable, SensorTable};

/// The table of a sensor, with all numbers written out that a perfect one does not have.
pub(crate) fn sensor_table(sensor: &StatedSensor) -> SensorTable {
    let (perfect, element) = (HallSensor::default(), &sensor.element);
    // A part has numbers of its own, so a perfect value beside it must be written too.
    let given = |value: DVec3, unit: ErrorUnit, default: DVec3| {
        let is_written = value.is_finite() && (value != default || sensor.part.is_some());
        is_written.then(|| per_axis(value.to_array().map(|value| unit.written(value))))
    };
    let plates = element.plates.map(|place| (place != DVec3::ZERO).then(|| place.to_array()));
    let [x, y, z] = plates;
    SensorTable {
        part: sensor.part.clone(),
        noise_ut: given(element.noise_t, ErrorUnit::Microtesla, perfect.noise_t),
        count_ut: given(element.count_t, ErrorUnit::Microtesla, perfect.count_t),
        range_mt: given(element.range_t, ErrorUnit::Millitesla, perfect.range_t),
        rate_hz: sensor.rate_hz,
        gain: (element.gain != perfect.gain).then(|| per_axis(element.gain.to_array())),
        offset_ut: (element.offset_t != perfect.offset_t)
            .then(|| per_axis(element.offset_t.to_array().map(|value| ErrorUnit::Microtesla.written(value)))),
        rotation: sensor.rotation.map(Into::into),
        active_area_mm: (element.active_area != perfect.active_area).then_some(element.active_area),
        plates_mm: plates.iter().any(Option::is_some).then_some(PlatesTable { x, y, z }),
    }
}

/// The table of an elastic layer.
pub(crate) fn elastomer_table(elastomer: &Elastomer) -> ElastomerTable {
    let given = |value: DVec3, default: f64| (value != DVec3::splat(default)).then(|| per_axis(value.to_array()));
    ElastomerTable {
        area_mm2: elastomer.area_mm2,
        thickness_mm: elastomer.thickness_mm,
        youngs_modulus_mpa: elastomer.youngs_modulus_mpa,
        poisson_ratio: elastomer.poisson_ratio,
        scale: given(elastomer.scale, 1.0),
        force_at_rest_n: given(elastomer.force_at_rest_n, 0.0),
    }
}

fn per_axis(values: [f64; 3]) -> PerAxis {
    if values[1..].iter().all(|value| *value == values[0]) { PerAxis::Same(values[0]) } else { PerAxis::Each(values) }
}
