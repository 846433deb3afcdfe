//! The fields of MCAP's records: little-endian numbers, and names after their length.

use crate::bounds::MAX_NAME_BYTES;

/// The fields that were not read yet. Errors are the rest of a sentence about the record.
pub(super) struct Fields<'a> {
    bytes: &'a [u8],
}

impl<'a> Fields<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    pub(super) fn skip(&mut self, count: usize) -> Result<&'a [u8], String> {
        let (skipped, rest) = self.bytes.split_at_checked(count).ok_or("ends too early")?;
        self.bytes = rest;
        Ok(skipped)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], String> {
        self.skip(N)?.try_into().map_err(|_| "ends too early".to_owned())
    }

    pub(super) fn u16(&mut self) -> Result<u16, String> {
        self.array().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Result<u32, String> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Result<u64, String> {
        self.array().map(u64::from_le_bytes)
    }

    pub(super) fn name(&mut self) -> Result<String, String> {
        let length = self.u32()? as usize;
        if length > MAX_NAME_BYTES {
            return Err(format!("has a name of {length} bytes; at most {MAX_NAME_BYTES} are read"));
        }
        let bytes = self.skip(length)?;
        String::from_utf8(bytes.to_vec()).map_err(|_| "has a name that is no text".to_owned())
    }
}
