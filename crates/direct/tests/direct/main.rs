//! Tests of the exact field of many cuboids, in one program because each program links all kernels.

mod expansions;
mod magnitude;
mod merge;
mod open_points;
mod orientation;
mod queues;
