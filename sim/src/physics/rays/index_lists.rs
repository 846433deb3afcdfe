/// Many short lists of indices in one allocation.
#[derive(Clone, Debug)]
pub(super) struct IndexLists {
    /// The start of each list, and the end of the last one.
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl IndexLists {
    /// No lists yet.
    pub(super) fn new() -> Self {
        Self { starts: vec![0], items: Vec::new() }
    }

    /// Adds a list at the end.
    pub(super) fn push(&mut self, items: impl Iterator<Item = u32>) {
        self.items.extend(items);
        self.starts.push(self.items.len() as u32);
    }

    /// One of the lists.
    pub(super) fn get(&self, list: usize) -> &[u32] {
        &self.items[self.starts[list] as usize..self.starts[list + 1] as usize]
    }
}
