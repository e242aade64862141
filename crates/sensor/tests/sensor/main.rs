//! Tests of the public interface: readings, positions, experiments.

mod experiment;
mod heads;
mod locator;
mod polynomial;
mod sensed_field;
