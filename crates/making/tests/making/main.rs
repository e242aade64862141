//! Tests of the public interface: boxes of tiles, and films made from them.

mod assignment;
mod boxed;
mod measured;
mod measured_box;
mod partly_placed;
