//! Tests of the public interface: searches, fronts, starts without a film, written layouts.

mod head_spacing;
mod pareto_front;
mod search;
mod splice;
mod written_layout;
