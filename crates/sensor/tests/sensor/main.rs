//! Tests of the public interface: readings, positions, experiments.

mod experiment;
mod head_locator;
mod heads;
mod locator;
mod polynomial;
mod sensed_field;
