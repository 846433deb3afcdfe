//! Answers that fit in one datagram.
//!
//! The library writes fragments of an answer with one byte too many before the identity of the request (rustdds 0.15.1, `DataFrag`: the
//! tag of an `Option`). No client can read them, and a build with debug assertions ends the thread of the network. Other messages
//! have no such identity, and are sent in fragments as they should.

use crate::service::Reply;
use ros2_client::dds::rustdds::{RepresentationIdentifier, serialization::to_writer_with_rep_id};
use serde::Serialize;
use std::io::{self, Write};

/// The longest answer, bytes: a datagram of 1452 bytes without the headers of RTPS.
const MAX: usize = 1200;

/// The answer, or a shorter one, and whether something that was asked for is missing.
pub(super) fn fitting(reply: Reply) -> (Reply, bool) {
    match reply {
        Reply::Values(values) if length(&values) > MAX => (Reply::Values(Vec::new()), true),
        Reply::Descriptions(mut all) if length(&all) > MAX => {
            for one in &mut all {
                one.description.clear();
                one.additional_constraints.clear();
            }
            match length(&all) > MAX {
                true => (Reply::Descriptions(Vec::new()), true),
                false => (Reply::Descriptions(all), false),
            }
        }
        reply => (reply, false),
    }
}

/// The number of bytes of a message; 0 if it cannot be written, which is noticed where it is.
fn length(message: &impl Serialize) -> usize {
    struct Count(usize);
    impl Write for Count {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0 += bytes.len();
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let mut count = Count(0);
    to_writer_with_rep_id(&mut count, message, RepresentationIdentifier::CDR_LE).map_or(0, |()| count.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::service::wire::{Description, ParameterValue};
    use crate::value::Value;

    #[test]
    fn an_answer_that_is_too_long_is_empty() {
        let values = |count| Reply::Values(vec![ParameterValue::from(&Value::Float(1.0)); count]);
        assert_eq!(fitting(values(20)), (values(20), false));
        assert_eq!(fitting(values(30)), (Reply::Values(Vec::new()), true));
        let text = "What it means. ".repeat(10);
        let described =
            |count| vec![Description { description: text.clone(), ..Description::default() }; count];
        assert_eq!(fitting(Reply::Descriptions(described(5))), (Reply::Descriptions(described(5)), false));
        let (Reply::Descriptions(cut), false) = fitting(Reply::Descriptions(described(15))) else { panic!() };
        assert!(cut.len() == 15 && cut.iter().all(|one| one.description.is_empty()));
    }
}
