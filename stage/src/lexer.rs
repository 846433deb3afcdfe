//! From text to names, numbers, texts in quotes and brackets, each with its place.

use std::ops::Range;

/// A place in one of the texts of a world, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Span {
    /// The index of the text, in the order in which they were read.
    pub(super) file: u32,
    pub(super) start: u32,
    pub(super) end: u32,
}

impl Span {
    pub(super) fn range(&self) -> Range<usize> {
        self.start as usize..self.end as usize
    }
}

/// A piece of a world file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Token {
    pub(super) kind: Kind,
    pub(super) place: Span,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// A name, perhaps with an index, as in `point[3]`.
    Word,
    Number(f64),
    /// A text; its place is between the quotes.
    Text,
    Open,
    Close,
    OpenTuple,
    CloseTuple,
}

/// The tokens of a text, which is the `file`th one, without comments and line ends; or what cannot be read: its
/// place, what it is, and what is valid.
pub(super) fn tokens(text: &str, file: u32) -> Result<Vec<Token>, (Span, &'static str, &'static str)> {
    let bytes = text.as_bytes();
    let mut tokens = Vec::new();
    let mut end = 0;
    while let Some(&byte) = bytes.get(end) {
        let start = end;
        let place = |start: usize, end: usize| Span { file, start: start as u32, end: end as u32 };
        let run = |from: usize, is_part: &dyn Fn(u8) -> bool| {
            from + bytes[from..].iter().take_while(|byte| is_part(**byte)).count()
        };
        end += 1;
        let kind = match byte {
            b' ' | b'\t' | b'\r' | b'\n' => continue,
            b'#' => {
                end = run(start, &|byte| byte != b'\n');
                continue;
            }
            b'(' => Kind::Open,
            b')' => Kind::Close,
            b'[' => Kind::OpenTuple,
            b']' => Kind::CloseTuple,
            b'"' => {
                let close = run(end, &|byte| !matches!(byte, b'"' | b'\n' | b'\r'));
                if bytes.get(close) != Some(&b'"') {
                    let help = "a text begins and ends with a quote, on one line";
                    return Err((place(start, close), "a text does not end", help));
                }
                tokens.push(Token { kind: Kind::Text, place: place(end, close) });
                end = close + 1;
                continue;
            }
            b'+' | b'-' | b'.' | b'0'..=b'9' => {
                end = number_end(bytes, start);
                let number = text[start..end].parse().ok().filter(|number: &f64| number.is_finite());
                let help = "a number is written as in 0.5, -12 or 1e-3";
                Kind::Number(number.ok_or((place(start, end), "this is not a number", help))?)
            }
            b'a'..=b'z' | b'A'..=b'Z' | b'_' => {
                end = word_end(bytes, start);
                Kind::Word
            }
            _ => {
                let place = place(start, text.ceil_char_boundary(end));
                let help = "outside of quotes there are names, numbers, ( ) and [ ]; comments begin with #";
                return Err((place, "this character means nothing here", help));
            }
        };
        tokens.push(Token { kind, place: place(start, end) });
    }
    Ok(tokens)
}

/// Where a number that begins at `at` ends. Stage knows no exponents.
fn number_end(bytes: &[u8], mut at: usize) -> usize {
    let is_digit = |at: usize| bytes.get(at).is_some_and(u8::is_ascii_digit);
    while let Some(byte) = bytes.get(at) {
        let is_signed = matches!(bytes.get(at + 1), Some(b'+' | b'-')) && is_digit(at + 2);
        match byte {
            b'+' | b'-' | b'.' | b'0'..=b'9' => at += 1,
            b'e' | b'E' if is_digit(at + 1) => at += 2,
            b'e' | b'E' if is_signed => at += 3,
            _ => break,
        }
    }
    at
}

/// Where a word that begins at `at` ends. An index, as in `point[3]`, belongs to it.
fn word_end(bytes: &[u8], mut at: usize) -> usize {
    while let Some(byte) = bytes.get(at) {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'.' | b'-' | b'_' => at += 1,
            b'[' => {
                let digits = bytes[at + 1..].iter().take_while(|byte| byte.is_ascii_digit()).count();
                if digits == 0 || bytes.get(at + 1 + digits) != Some(&b']') {
                    break;
                }
                at += digits + 2;
            }
            _ => break,
        }
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(text: &str) -> Vec<String> {
        let tokens = tokens(text, 0).unwrap();
        tokens.iter().map(|token| format!("{:?} {}", token.kind, &text[token.place.range()])).collect()
    }

    #[test]
    fn a_line_of_everything() {
        let text = "sick_1( point[12] [-.5 +2 1e-3] name\"a # b\" )# end";
        assert_eq!(
            shown(text),
            [
                "Word sick_1",
                "Open (",
                "Word point[12]",
                "OpenTuple [",
                "Number(-0.5) -.5",
                "Number(2.0) +2",
                "Number(0.001) 1e-3",
                "CloseTuple ]",
                "Word name",
                "Text a # b",
                "Close )"
            ]
        );
        assert_eq!(shown("size[1 2]").len(), 5);
        assert_eq!(shown("# only\r\n\t# comments"), [""; 0]);
    }

    #[test]
    fn faults_have_places() {
        for (text, place) in [("a \"b\nc", 2..4), ("x 1-2", 2..5), ("x é y", 2..4), ("1e999", 0..5)] {
            assert_eq!(tokens(text, 0).unwrap_err().0.range(), place, "{text}");
        }
    }
}
