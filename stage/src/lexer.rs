//! From text to words, numbers, texts in quotes and brackets, each with its place.

use super::place::Place;

/// A piece of a world file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Token {
    pub(super) kind: Kind,
    pub(super) place: Place,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// A name, perhaps with an index, as in `point[3]`.
    Word,
    Number(f64),
    /// A text; its place is what stands between the quotes.
    Text,
    Open,
    Close,
    OpenTuple,
    CloseTuple,
}

/// What cannot be read, and where.
#[derive(Debug, PartialEq)]
pub(super) struct LexError {
    pub(super) what: &'static str,
    pub(super) help: &'static str,
    pub(super) place: Place,
}

/// The tokens of a text, which is the `file`th one. Comments and line ends are left out.
pub(super) fn tokens(text: &str, file: u32) -> Result<Vec<Token>, LexError> {
    let bytes = text.as_bytes();
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(&byte) = bytes.get(at) {
        let start = at;
        let place = |end: usize| Place { file, start: start as u32, end: end as u32 };
        let run = |from: usize, part: &dyn Fn(u8) -> bool| {
            from + bytes[from..].iter().take_while(|byte| part(**byte)).count()
        };
        let kind = match byte {
            b' ' | b'\t' | b'\r' | b'\n' => {
                at += 1;
                continue;
            }
            b'#' => {
                at = run(at, &|byte| byte != b'\n');
                continue;
            }
            b'(' => Kind::Open,
            b')' => Kind::Close,
            b'[' => Kind::OpenTuple,
            b']' => Kind::CloseTuple,
            b'"' => {
                let end = run(at + 1, &|byte| !matches!(byte, b'"' | b'\n' | b'\r'));
                if bytes.get(end) != Some(&b'"') {
                    let help = "a text begins and ends with a quote, on one line";
                    return Err(LexError { what: "a text does not end", help, place: place(end) });
                }
                tokens.push(Token {
                    kind: Kind::Text,
                    place: Place { file, start: start as u32 + 1, end: end as u32 },
                });
                at = end + 1;
                continue;
            }
            b'+' | b'-' | b'.' | b'0'..=b'9' => {
                let end = number_end(bytes, at);
                let number = text[start..end].parse().ok().filter(|number: &f64| number.is_finite());
                let Some(number) = number else {
                    let help = "a number is written as in 0.5, -12 or 1e-3";
                    return Err(LexError { what: "this is not a number", help, place: place(end) });
                };
                tokens.push(Token { kind: Kind::Number(number), place: place(end) });
                at = end;
                continue;
            }
            b'a'..=b'z' | b'A'..=b'Z' | b'_' => {
                let end = word_end(bytes, at);
                tokens.push(Token { kind: Kind::Word, place: place(end) });
                at = end;
                continue;
            }
            _ => {
                let end = text.ceil_char_boundary(start + 1);
                let help = "outside of quotes there are names, numbers, ( ) and [ ]; comments begin with #";
                return Err(LexError { what: "this character means nothing here", help, place: place(end) });
            }
        };
        at += 1;
        tokens.push(Token { kind, place: place(at) });
    }
    Ok(tokens)
}

/// Where a number that begins at `at` ends. Stage knows no exponents; they do no harm.
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
            assert_eq!(tokens(text, 0).unwrap_err().place.range(), place, "{text}");
        }
    }
}
