//! `magsplice schema`: a JSON Schema of layout files.

use magsplice::layout;

use crate::failure::Failure;
use crate::output;
use crate::text;

pub(crate) fn run() -> Result<(), Failure> {
    output::print(&text::json(&layout::schema()))
}
