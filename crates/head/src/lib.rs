//! Heads: several Hall sensors on one rigid board, read as one weighted sum.
//!
//! * [`SensorHead`]: sensors with their places on the board and their weights.
//! * [`Board`]: the places of boards that people build.
//! * [`least_noise_weights`]: weights that reject stray fields and keep the form of Eq. 2.
//! * [`HeadForm`]: the response to an ideal film, and to uniform and linear fields.
//!
//! # Why weights keep the form of Eq. 2
//! A head at p with sensors at d_i on the board and weights w_i reads b(p) = sum w_i B(p + d_i).
//! The field of an ideal film (Dai 2024, Eq. 2) has B_z = C_x + C_y with
//! C_x - i B_x = K e^(kz) e^(ikx) and C_y - i B_y = K e^(kz) e^(iky). A shift by d multiplies these
//! by e^(k d_z) e^(ik d_x) and e^(k d_z) e^(ik d_y). If
//!
//! ```text
//! sum w_i e^(k z_i) e^(ik x_i) = sum w_i e^(k z_i) e^(ik y_i) = c, a real number,   (1)
//! sum w_i = 0,                                                                       (2)
//! sum w_i d_i = 0,                                                                   (3)
//! ```
//!
//! then b = c B, uniform fields cancel by (2), and fields that change linearly by (3).
//!
//! Lengths are in any one unit. This crate reads no files and prints nothing.
//!
//! # Example
//! ```
//! use std::f64::consts::TAU;
//!
//! use magsplice_head::{Board, least_noise_weights};
//!
//! let board = Board::Cross.places(5.0);
//! let weights = least_noise_weights(&board, &[1.0; 5], TAU / 10.0)?;
//! assert!((weights[0] - 0.5).abs() < 1e-12 && (weights[1] + 0.125).abs() < 1e-12);
//! # Ok::<(), magsplice_head::WeightsError>(())
//! ```

/// The places of boards that people build.
mod board;
/// The response to an ideal film, and to stray fields.
mod form;
/// Sensors with places and weights.
mod sensor_head;
/// Weights with the least noise.
mod weights;

pub use board::Board;
pub use form::HeadForm;
pub use sensor_head::{HeadElement, SensorHead};
pub use weights::{WeightsError, least_noise_weights};
