//! A reader of the lines that have content, which keeps their numbers.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::io::{self, Read};
use std::rc::Rc;

/// Bytes read at a time.
const CHUNK: usize = 8 << 10;

/// Passes on lines with content, each ended by a line feed. Leaves out blank lines and comments,
/// which begin with `#`.
pub(crate) struct ContentLines<R> {
    source: R,
    /// Whether runs of spaces and tabs become one space, and those at the ends of lines vanish.
    single_spaces: bool,
    /// Bytes to pass on, and how many of them are.
    ready: Vec<u8>,
    passed: usize,
    /// Spaces that are passed on only if something follows them on the line.
    spaces: Vec<u8>,
    place: Place,
    /// Whether the last byte was a carriage return.
    after_return: bool,
    line: u64,
    content_line: u64,
    numbers: LineNumbers,
}

#[derive(Clone, Copy, PartialEq)]
enum Place {
    /// Nothing but spaces so far.
    Start,
    Content,
    Comment,
}

/// Numbers of the lines in the file, by their numbers among the lines that are passed on.
#[derive(Clone, Default)]
pub(crate) struct LineNumbers(Rc<RefCell<VecDeque<(u64, u64)>>>);

impl LineNumbers {
    /// The line in the file of the passed line with this number. Numbers must not decrease from
    /// call to call.
    pub(crate) fn in_file(&self, content_line: u64) -> u64 {
        let mut shifts = self.0.borrow_mut();
        // The first entry holds until the second begins.
        while shifts.get(1).is_some_and(|(from, _)| *from <= content_line) {
            shifts.pop_front();
        }
        content_line + shifts.front().map_or(0, |(_, shift)| *shift)
    }
}

impl<R: Read> ContentLines<R> {
    /// `lines_before` are lines of the file before the first of `source`.
    pub(crate) fn new(source: R, single_spaces: bool, lines_before: u64) -> ContentLines<R> {
        ContentLines {
            source,
            single_spaces,
            ready: Vec::new(),
            passed: 0,
            spaces: Vec::new(),
            place: Place::Start,
            after_return: false,
            line: lines_before + 1,
            content_line: 1,
            numbers: LineNumbers::default(),
        }
    }

    /// The numbers of the lines that were passed on so far.
    pub(crate) fn numbers(&self) -> LineNumbers {
        self.numbers.clone()
    }

    fn take(&mut self, byte: u8) {
        let after_return = std::mem::replace(&mut self.after_return, byte == b'\r');
        match byte {
            // The second half of the end of a line.
            b'\n' if after_return => {}
            b'\n' | b'\r' => self.end_line(),
            _ if self.place == Place::Comment => {}
            b' ' | b'\t' if self.single_spaces || self.place == Place::Start => self.spaces.push(byte),
            b'#' if self.place == Place::Start => self.place = Place::Comment,
            _ => {
                if self.place == Place::Start {
                    self.begin_content();
                }
                match (self.single_spaces, self.spaces.is_empty()) {
                    (true, false) => self.ready.push(b' '),
                    _ => self.ready.extend_from_slice(&self.spaces),
                }
                self.spaces.clear();
                self.ready.push(byte);
            }
        }
    }

    fn begin_content(&mut self) {
        self.place = Place::Content;
        if self.single_spaces {
            self.spaces.clear();
        }
        let shift = self.line - self.content_line;
        let mut shifts = self.numbers.0.borrow_mut();
        if shifts.back().map_or(0, |(_, shift)| *shift) != shift {
            shifts.push_back((self.content_line, shift));
        }
    }

    fn end_line(&mut self) {
        if self.place == Place::Content {
            self.ready.push(b'\n');
            self.content_line += 1;
        }
        self.spaces.clear();
        self.place = Place::Start;
        self.line += 1;
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

    fn read(text: &str, single_spaces: bool) -> (String, LineNumbers) {
        let (mut at_once, mut by_bytes) = (String::new(), String::new());
        let mut lines = ContentLines::new(text.as_bytes(), single_spaces, 10);
        let numbers = lines.numbers();
        lines.read_to_string(&mut at_once).expect("text");
        ContentLines::new(Single(text.as_bytes()), single_spaces, 10).read_to_string(&mut by_bytes).expect("text");
        assert_eq!(at_once, by_bytes);
        (at_once, numbers)
    }

    #[test]
    fn blank_lines_and_comments_are_skipped_and_counted() {
        let (text, numbers) = read("a\r\n\r\n# b\n\tc  d \r  # e\n   \nf,#\n\ng", false);
        assert_eq!(text, "a\n\tc  d \nf,#\ng");
        assert_eq!([1, 2, 3, 4].map(|line| numbers.in_file(line)), [11, 14, 17, 19]);
    }

    #[test]
    fn runs_of_spaces_become_one() {
        assert_eq!(read("  1 \t 2\r\n \n3   \n  4 ", true).0, "1 2\n3\n4");
    }
}
