//! The bitmaps of a world, each decoded once.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use worldfile::Files;
use worldfile::floor_plan::{Bitmap, MAX_FILE_BYTES};

/// A pixel is blocked if its first color is below this.
const BLOCKED_BELOW: f64 = 128.0 / 255.0;
/// The maximum number of pixels of all bitmaps together, each as often as it is used.
const MAX_PIXELS: u64 = 1 << 27;
/// The maximum number of rectangles of all bitmaps together, each as often as it is used.
const MAX_RECTANGLES: usize = 1 << 20;

/// Bitmaps by their paths.
#[derive(Default)]
pub(super) struct Pictures {
    decoded: BTreeMap<PathBuf, Arc<Bitmap>>,
    pixels: u64,
    rectangles: usize,
}

impl Pictures {
    /// The bitmap of a file: dark is blocked, by the first color as in Stage.
    pub(super) fn get(&mut self, files: &dyn Files, path: &Path) -> Result<Arc<Bitmap>, String> {
        if !self.decoded.contains_key(path) {
            let bytes = files.read(path, MAX_FILE_BYTES).map_err(|error| error.to_string())?;
            let bitmap = Bitmap::decode(&bytes, |pixel| pixel.red < BLOCKED_BELOW)?;
            self.decoded.insert(path.to_owned(), Arc::new(bitmap));
        }
        let bitmap = Arc::clone(&self.decoded[path]);
        self.pixels += u64::from(bitmap.width()) * u64::from(bitmap.height());
        if self.pixels > MAX_PIXELS {
            return Err(format!("the bitmaps of this world have more than {MAX_PIXELS} pixels together"));
        }
        self.rectangles += bitmap.rectangles().len();
        if self.rectangles > MAX_RECTANGLES {
            return Err(format!(
                "the bitmaps of this world make more than {MAX_RECTANGLES} rectangles together"
            ));
        }
        Ok(bitmap)
    }
}
