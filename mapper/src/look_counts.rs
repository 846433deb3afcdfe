/// Looks at a cell while its thing was in a certain state: a tile blocked, a door open.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub(crate) struct LookCounts {
    blocked: u16,
    looks: u16,
}

impl LookCounts {
    pub(crate) fn add(&mut self, is_blocked: bool) {
        if self.looks == u16::MAX {
            // The older half counts half.
            (self.blocked, self.looks) = (self.blocked / 2, self.looks / 2);
        }
        self.blocked += u16::from(is_blocked);
        self.looks += 1;
    }

    pub(crate) fn is_empty(self) -> bool {
        self.looks == 0
    }

    /// The share of the looks that found a cell blocked; `prior` counts as this number of looks.
    pub(crate) fn share(self, prior: f64, looks: f64) -> f64 {
        (f64::from(self.blocked) + looks * prior) / (f64::from(self.looks) + looks)
    }
}
