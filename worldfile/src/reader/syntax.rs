//! What is invalid in a text that is not TOML, in other words than those of the parser, which are about its grammar.

const KEY: &str = "a key and its value are written as in `radius_m = 0.2`";
const VALUE: &str =
    "a number is written as in 0.5 or -12, a text in quotes as in \"curious\", a flag as `true` or `false`";
const LIST: &str = "a list is written as in `[1.0, 2.0]`, a table on one line as in `{ kind = \"driven\" }`";

/// What the parser's message about the text `found` means, and what is valid.
pub(super) fn fault(message: &str, found: &str) -> (&'static str, &'static str) {
    match message.split(", expected ").next().unwrap_or_default() {
        "duplicate key" => ("a key is given twice", "leave one of them out"),
        what if what.starts_with("cannot extend value") => {
            ("a key has both a value and keys of its own", "leave one of them out")
        }
        "recursion limit" | "cannot recurse further; max recursion depth met" => {
            ("too many lists or tables in each other", "80 are the most")
        }
        "key with no value"
        | "missing value"
        | "missing value for key"
        | "missing assignment between key-value pairs"
        | "missing key for inline table element" => ("a key without a value, or a value without a key", KEY),
        "extra `=`" | "extra assignment between key-value pairs" | "unexpected `=` in array" => {
            ("one `=` too many", KEY)
        }
        "string values must be quoted" if found.trim().is_empty() => ("a value is missing", VALUE),
        "string values must be quoted" => ("this is neither a number nor a text in quotes", VALUE),
        "missing comma between array elements" | "missing comma between key-value pairs" => {
            ("a comma is missing", LIST)
        }
        "extra comma in array" | "extra comma in inline table" => ("one comma too many", LIST),
        "unclosed array" => ("a list does not end", LIST),
        "unclosed inline table" => ("a table does not end", LIST),
        "unclosed table" | "unclosed array table" => {
            ("the header of a table does not end", "a header is written as in `[map]` or `[[robot]]`")
        }
        "unexpected key or value" => {
            ("a line goes on after its value", "write each key on a line of its own; comments begin with `#`")
        }
        what if what.contains("key") => ("this is no key", "a key has letters, digits, `_` and `-` only"),
        what if ["string", "quote", "escape", "unicode"].iter().any(|word| what.contains(word)) => (
            "a value is missing, or a text in quotes is not complete",
            "a text begins and ends with `\"`, on one line; `\\` is written as `\\\\` in it",
        ),
        what if what.contains("comment") || what.contains("carriage return") => {
            ("a control character", "a world file is printable text")
        }
        what if what.contains("invalid") || what.contains("sign") || what.contains("digit") => {
            ("this is no value", VALUE)
        }
        what if what.contains("zero") || what.contains("radix") || what.contains("number") => {
            ("this is no number", VALUE)
        }
        _ => ("this is neither a key with a value nor the header of a table", KEY),
    }
}
