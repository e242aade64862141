//! `magsplice schema`: prints the JSON Schema of layout files.

use magsplice::layout;

use crate::failure::Failure;
use crate::json;
use crate::output::destination::print;

pub(crate) fn run() -> Result<(), Failure> {
    print(&json::pretty(&layout::schema()))
}
