//! `magsplice schema`: prints the JSON Schema of layout files.

use magsplice::layout;

use crate::failure::Failure;
use crate::output::destination::print;
use crate::output::json;

pub(crate) fn run() -> Result<(), Failure> {
    print(&json::pretty(&layout::schema()))
}
