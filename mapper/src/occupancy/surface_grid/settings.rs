use interfaces::{SettingsCheck, SettingsError};

/// Settings of the occupancy model `steady`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct SurfaceGridSettings {
    /// The standard deviation of the range noise of the laser, m. Surfaces that are at least four standard
    /// deviations apart are distinct.
    pub range_noise_std_m: f64,
    /// The number of scans with a hit after which a cell far from every standing surface becomes blocked. 1 is
    /// enough for a laser without spurious returns.
    pub hits_to_block_in_open: u8,
    /// The number of scans that must pass a blocked cell until the cell becomes free, if the cell became blocked
    /// only recently.
    pub misses_to_free_fresh: u8,
    /// The number of scans that must pass a blocked cell until the cell becomes free, if the cell was hit in at least four scans.
    pub misses_to_free: u8,
}

impl Default for SurfaceGridSettings {
    fn default() -> Self {
        Self { range_noise_std_m: 0.01, hits_to_block_in_open: 1, misses_to_free_fresh: 4, misses_to_free: 8 }
    }
}

impl SurfaceGridSettings {
    /// The number of consecutive misses that free a blocked cell after this number of hits.
    pub(crate) fn misses_to_free_after(&self, hits: u16) -> i8 {
        let fresh = u16::from(self.misses_to_free_fresh);
        fresh.saturating_add(hits).min(u16::from(self.misses_to_free)) as i8
    }

    pub(crate) fn check(&self, check: SettingsCheck) -> Result<(), SettingsError> {
        // Every hit searches as far as the range noise reaches.
        check.within("steady.range_noise_std_m", self.range_noise_std_m, 0.0..=0.5, "from 0 to 0.5 m")?;
        check.within(
            "steady.hits_to_block_in_open",
            self.hits_to_block_in_open,
            1.0..=100.0,
            "from 1 to 100",
        )?;
        check.within("steady.misses_to_free", self.misses_to_free, 1.0..=100.0, "from 1 to 100")?;
        let (fresh, most) = (self.misses_to_free_fresh, f64::from(self.misses_to_free));
        check.within("steady.misses_to_free_fresh", fresh, 1.0..=most, "from 1 to steady.misses_to_free")
    }
}
