//! JSON with one entry per line, and each list on one line.

use std::io::{self, Write};

use serde::Serialize;
use serde_json::ser::{Formatter, PrettyFormatter, Serializer};

/// Writes a value as JSON, with a line feed at the end.
///
/// # Accuracy
/// Numbers have the shortest digits that read back to the same number. NaN and infinities are
/// `null`.
///
/// # Errors
/// Errors of the writer, and of the value's own `Serialize`.
pub fn write(value: &impl Serialize, w: &mut dyn Write) -> io::Result<()> {
    value.serialize(&mut Serializer::with_formatter(&mut *w, ListsOnOneLine(PrettyFormatter::new())))?;
    writeln!(w)
}

struct ListsOnOneLine(PrettyFormatter<'static>);

impl Formatter for ListsOnOneLine {
    fn begin_array_value<W: ?Sized + Write>(&mut self, w: &mut W, first: bool) -> io::Result<()> {
        w.write_all(if first { b"" } else { b", " })
    }

    fn begin_object<W: ?Sized + Write>(&mut self, w: &mut W) -> io::Result<()> {
        self.0.begin_object(w)
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, w: &mut W, first: bool) -> io::Result<()> {
        self.0.begin_object_key(w, first)
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, w: &mut W) -> io::Result<()> {
        self.0.begin_object_value(w)
    }

    fn end_object_value<W: ?Sized + Write>(&mut self, w: &mut W) -> io::Result<()> {
        self.0.end_object_value(w)
    }

    fn end_object<W: ?Sized + Write>(&mut self, w: &mut W) -> io::Result<()> {
        self.0.end_object(w)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn entries_have_a_line_each_and_lists_share_one() {
        let mut text = Vec::new();
        write(&json!({ "a": [[1.5, f64::NAN], []], "b": {}, "c": { "d": 1e-300 } }), &mut text).unwrap();
        let want = "{\n  \"a\": [[1.5, null], []],\n  \"b\": {},\n  \"c\": {\n    \"d\": 1e-300\n  }\n}\n";
        assert_eq!(String::from_utf8(text).unwrap(), want);
    }
}
