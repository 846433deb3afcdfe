//! The encoding of messages: CDR after four bytes that name the order of the bytes.

use byteorder::{BigEndian, LittleEndian};
use serde::{Deserialize, Serialize};

/// A message from its bytes: two bytes name the order of the bytes, two are options.
///
/// # Errors
///
/// When the encoding is none of these, or the bytes end too early.
pub fn decoded<'a, T: Deserialize<'a>>(bytes: &'a [u8]) -> Result<T, String> {
    let Some((start, body)) = bytes.split_at_checked(4) else {
        return Err(format!("{} bytes, too short for a message", bytes.len()));
    };
    let message = match start[..2] {
        [0, 0] => cdr_encoding::from_bytes::<T, BigEndian>(body),
        [0, 1] => cdr_encoding::from_bytes::<T, LittleEndian>(body),
        _ => return Err(format!("the encoding {:02x}{:02x} is not CDR", start[0], start[1])),
    };
    message.map(|(message, _)| message).map_err(|error| format!("it is damaged: {error}"))
}

/// A message as bytes, in little-endian order.
///
/// # Errors
///
/// When a list is too long for its format.
pub fn encoded<T: Serialize>(message: &T) -> Result<Vec<u8>, String> {
    let mut bytes = vec![0, 1, 0, 0];
    bytes.extend(cdr_encoding::to_vec::<T, LittleEndian>(message).map_err(|error| error.to_string())?);
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::messages::{Time, Transforms};

    #[test]
    fn both_orders_of_bytes_are_read() {
        let time = Time { sec: 1, nanosec: 2 };
        let little = [0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0];
        assert_eq!(encoded(&time).unwrap(), little);
        assert_eq!(decoded::<Time>(&little), Ok(time));
        assert_eq!(decoded::<Time>(&[0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2]), Ok(time));
        assert_eq!(decoded::<Time>(&[0, 7, 0, 0]).unwrap_err(), "the encoding 0007 is not CDR");
        // 2³² − 1 transforms in 4 bytes.
        let error = decoded::<Transforms>(&[0, 1, 0, 0, 255, 255, 255, 255]).unwrap_err();
        assert!(error.starts_with("it is damaged: "), "{error}");
    }
}
