//! The field of cuboids against reference tables, an oracle of 130 digits, and physical laws.

/// Adversarial scenes against the oracle.
mod attacks;
/// Derivatives of B by the faces of a tile against the oracle and against gradients.
mod face_derivatives;
/// B against the reference tables.
mod golden;
/// The gradient of many tiles against the oracle.
mod gradients;
/// Scenes with every instruction set of the processor against the oracle.
mod instruction_sets;
/// Flat iron beside tiles, against explicit images and the law of its surface.
mod iron;
/// Physical laws on chosen scenes: superposition, div B = 0, curl H = 0, the dipole limit.
mod laws;
/// B, H and the gradient of one tile against the oracle.
mod one_tile;
/// Plans of evaluations to a tolerance against the evaluations themselves.
mod plan;
/// The linear map from polarizations to B against scenes.
mod polarization_map;
/// Progress of evaluations, and their interruption by it.
mod progress;
/// Physical laws on random scenes.
mod properties;
/// Tolerances near the error bound of the exact field against the oracle.
mod refusals;
/// Rods, alone and among other tiles.
mod rods;
/// Touching tiles of one polarization against the block they form.
mod seams;
/// Independence of the result from threads and batches.
mod threads;
/// Tolerances on lists of points.
mod tree;
/// Tolerances on grids and in prepared boxes.
mod within;
