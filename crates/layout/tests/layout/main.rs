//! Tests of the public interface: each table of a layout file, its rules, and its messages.

mod assembled;
mod briefs;
mod compact;
mod edited;
mod findings;
mod in_memory;
mod limits;
mod made_tiles;
mod material;
mod messages;
mod numbers;
mod parts;
mod rotations;
mod sensor;
mod shapes;
mod single_tiles;
mod tables;
mod tolerance;
