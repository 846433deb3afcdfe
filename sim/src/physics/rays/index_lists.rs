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

    /// Replaces everything by `lists` lists of the given entries, each with the list that it belongs to. Entries of
    /// one list keep their order.
    pub(super) fn sort(
        &mut self,
        lists: usize,
        entries: impl DoubleEndedIterator<Item = (usize, T)> + Clone,
    ) {
        // Counting sort: the number of entries per list, summed up to the end of each list. Filled from the back,
        // ends become starts.
        self.starts.clear();
        self.starts.resize(lists + 1, 0);
        entries.clone().for_each(|(list, _)| self.starts[list] += 1);
        let mut end = 0;
        for start in &mut self.starts {
            end += *start;
            *start = end;
        }
        self.items.resize(end as usize, T::default());
        for (list, item) in entries.rev() {
            let start = &mut self.starts[list];
            *start -= 1;
            self.items[*start as usize] = item;
        }
    }

    /// One of the lists.
    pub(super) fn get(&self, list: usize) -> &[T] {
        &self.items[self.starts[list] as usize..self.starts[list + 1] as usize]
    }
}
