//! The fields of MCAP's records: little-endian numbers, and text after its length.

/// The fields that were not read yet. `None` where the bytes end too early, or are no text.
pub(super) struct Fields<'a> {
    bytes: &'a [u8],
}

impl<'a> Fields<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    pub(super) fn skip(&mut self, count: usize) -> Option<&'a [u8]> {
        let (skipped, rest) = self.bytes.split_at_checked(count)?;
        self.bytes = rest;
        Some(skipped)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.skip(N)?.try_into().ok()
    }

    pub(super) fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    pub(super) fn text(&mut self) -> Option<String> {
        let length = self.u32()?;
        let bytes = self.skip(length as usize)?;
        String::from_utf8(bytes.to_vec()).ok()
    }
}
