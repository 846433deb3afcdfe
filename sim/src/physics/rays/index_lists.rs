/// Many short lists in one allocation.
#[derive(Clone, Debug)]
pub(super) struct IndexLists<T = u32> {
    /// The start of each list, and the end of the last one.
    starts: Vec<u32>,
    /// The items of all lists.
    pub(super) items: Vec<T>,
}

impl<T> Default for IndexLists<T> {
    /// No lists yet.
    fn default() -> Self {
        Self { starts: vec![0], items: Vec::new() }
    }
}

impl<T: Clone + Default> IndexLists<T> {
    /// Adds a list at the end.
    pub(super) fn push(&mut self, items: impl Iterator<Item = T>) {
        self.items.extend(items);
        self.starts.push(self.items.len() as u32);
    }

    /// `lists` lists of the given entries, each with the list that it belongs to. Entries of one list keep their order.
    pub(super) fn sorted(lists: usize, entries: impl DoubleEndedIterator<Item = (usize, T)> + Clone) -> Self {
        // Counting sort: the number of entries per list, summed up to the end of each list. Filled from the back,
        // ends become starts.
        let mut starts = vec![0; lists + 1];
        entries.clone().for_each(|(list, _)| starts[list] += 1);
        let mut end = 0;
        for start in &mut starts {
            end += *start;
            *start = end;
        }
        let mut items = vec![T::default(); end as usize];
        for (list, item) in entries.rev() {
            starts[list] -= 1;
            items[starts[list] as usize] = item;
        }
        Self { starts, items }
    }

    /// One of the lists.
    pub(super) fn get(&self, list: usize) -> &[T] {
        &self.items[self.starts[list] as usize..self.starts[list + 1] as usize]
    }
}
