//! A reader of the lines that have content, which keeps their numbers.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::io::{self, Read};
use std::rc::Rc;

/// Bytes read at a time.
const CHUNK: usize = 8 << 10;

/// Passes on lines with content, each ended by a line feed. Leaves out blank lines, comments, and
/// the spaces between a separator and its cell: a quote behind them would not begin a quoted cell.
pub(crate) struct ContentLines<R> {
    source: R,
    form: LineForm,
    /// Bytes to pass on, and how many of them are.
    ready: Vec<u8>,
    passed: usize,
    /// Spaces that are passed on only if something follows them on the line.
    spaces: Vec<u8>,
    place: Place,
    in_quotes: bool,
    /// Whether the last byte was a carriage return.
    after_return: bool,
    line: u64,
    content_line: u64,
    lines: Lines,
}

/// What the bytes of a line mean.
#[derive(Clone, Copy)]
pub(crate) struct LineForm {
    /// The byte between cells. Between spaces, runs of spaces and tabs become one space, and those
    /// at the ends of lines vanish.
    pub(crate) separator: u8,
    /// The bytes that comments begin with.
    pub(crate) comments: &'static [u8],
}

#[derive(Clone, Copy, PartialEq)]
enum Place {
    /// Nothing but spaces so far.
    Start,
    /// Nothing but spaces since the separator before a cell.
    Cell,
    Content,
    Comment,
}

/// What is known of the lines that were passed on.
#[derive(Clone, Default)]
pub(crate) struct Lines {
    /// Their numbers in the file, by their numbers among themselves.
    shifts: Rc<RefCell<VecDeque<(u64, u64)>>>,
    is_cut: Rc<Cell<bool>>,
}

impl Lines {
    /// The line in the file of the passed line with this number. Numbers must not decrease from
    /// call to call.
    pub(crate) fn in_file(&self, content_line: u64) -> u64 {
        let mut shifts = self.shifts.borrow_mut();
        // The first entry holds until the second begins.
        while shifts.get(1).is_some_and(|(from, _)| *from <= content_line) {
            shifts.pop_front();
        }
        content_line + shifts.front().map_or(0, |(_, shift)| *shift)
    }

    /// Whether the file ended within the last line, which has no line feed.
    pub(crate) fn is_last_cut(&self) -> bool {
        self.is_cut.get()
    }
}

impl<R: Read> ContentLines<R> {
    /// `lines_before` are lines of the file before the first of `source`.
    pub(crate) fn new(source: R, form: LineForm, lines_before: u64) -> ContentLines<R> {
        ContentLines {
            source,
            form,
            ready: Vec::new(),
            passed: 0,
            spaces: Vec::new(),
            place: Place::Start,
            in_quotes: false,
            after_return: false,
            line: lines_before + 1,
            content_line: 1,
            lines: Lines::default(),
        }
    }

    /// What is known of the lines that were passed on so far.
    pub(crate) fn lines(&self) -> Lines {
        self.lines.clone()
    }

    fn take(&mut self, byte: u8) {
        let after_return = std::mem::replace(&mut self.after_return, byte == b'\r');
        let single_spaces = self.form.separator == b' ';
        match byte {
            // The second half of the end of a line.
            b'\n' if after_return => {}
            b'\n' | b'\r' => self.end_line(),
            _ if self.place == Place::Comment => {}
            b' ' if self.place == Place::Cell => {}
            b' ' | b'\t' if single_spaces || self.place == Place::Start => self.spaces.push(byte),
            _ if self.place == Place::Start && self.form.comments.contains(&byte) => self.place = Place::Comment,
            _ => {
                if self.place == Place::Start {
                    self.begin_content();
                }
                match (single_spaces, self.spaces.is_empty()) {
                    (true, false) => self.ready.push(b' '),
                    _ => self.ready.extend_from_slice(&self.spaces),
                }
                self.spaces.clear();
                self.ready.push(byte);
                self.in_quotes ^= byte == b'"';
                let is_separator = !single_spaces && byte == self.form.separator;
                self.place = if is_separator && !self.in_quotes { Place::Cell } else { Place::Content };
            }
        }
    }

    fn begin_content(&mut self) {
        self.place = Place::Content;
        if self.form.separator == b' ' {
            self.spaces.clear();
        }
        let shift = self.line - self.content_line;
        let mut shifts = self.lines.shifts.borrow_mut();
        if shifts.back().map_or(0, |(_, shift)| *shift) != shift {
            shifts.push_back((self.content_line, shift));
        }
    }

    fn end_line(&mut self) {
        if self.has_content() {
            self.ready.push(b'\n');
            self.content_line += 1;
        }
        self.spaces.clear();
        self.place = Place::Start;
        self.in_quotes = false;
        self.line += 1;
    }

    fn has_content(&self) -> bool {
        matches!(self.place, Place::Content | Place::Cell)
    }
}

impl<R: Read> Read for ContentLines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.passed == self.ready.len() {
            (self.passed, self.ready) = (0, std::mem::take(&mut self.ready));
            self.ready.clear();
            let mut chunk = [0; CHUNK];
            let count = self.source.read(&mut chunk)?;
            if count == 0 {
                self.lines.is_cut.set(self.has_content());
                return Ok(0);
            }
            chunk[..count].iter().for_each(|byte| self.take(*byte));
        }
        let count = buffer.len().min(self.ready.len() - self.passed);
        buffer[..count].copy_from_slice(&self.ready[self.passed..self.passed + count]);
        self.passed += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A source that gives one byte at a time.
    struct Single<'a>(&'a [u8]);

    impl Read for Single<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            self.0.read(&mut buffer[..1])
        }
    }

    fn read(text: &str, separator: u8, comments: &'static [u8]) -> (String, Lines) {
        let form = LineForm { separator, comments };
        let (mut at_once, mut by_bytes) = (String::new(), String::new());
        let mut source = ContentLines::new(text.as_bytes(), form, 10);
        let lines = source.lines();
        source.read_to_string(&mut at_once).expect("text");
        ContentLines::new(Single(text.as_bytes()), form, 10).read_to_string(&mut by_bytes).expect("text");
        assert_eq!(at_once, by_bytes);
        (at_once, lines)
    }

    #[test]
    fn blank_lines_and_comments_are_skipped_and_counted() {
        let (text, lines) = read("a\r\n\r\n# b\n\tc  d \r  % e\n ; h\n   \nf,#\n\ng", b',', b"#%;");
        assert_eq!(text, "a\n\tc  d \nf,#\ng");
        assert_eq!([1, 2, 3, 4].map(|line| lines.in_file(line)), [11, 14, 18, 20]);
    }

    #[test]
    fn bytes_of_comments_depend_on_the_form() {
        assert_eq!(read(";1\n%;2\n3;4\n", b';', b"#%").0, ";1\n3;4\n");
    }

    #[test]
    fn runs_of_spaces_become_one() {
        assert_eq!(read("  1 \t 2\r\n \n3   \n  4 ", b' ', b"#").0, "1 2\n3\n4");
    }

    #[test]
    fn spaces_before_a_cell_vanish_but_not_within_quotes() {
        assert_eq!(read("\"a\",  \"b, c\" ,d\n", b',', b"#%;").0, "\"a\",\"b, c\" ,d\n");
    }

    #[test]
    fn cut_lines_are_recognized() {
        for (text, is_cut) in
            [("1\n2", true), ("1\n2,", true), ("1\n2\n", false), ("1\n2\n# c", false), ("1\n ", false)]
        {
            assert_eq!(read(text, b',', b"#%;").1.is_last_cut(), is_cut, "{text:?}");
        }
    }
}
