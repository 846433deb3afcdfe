use super::regions::Regions;

/// A slope as a fraction; the denominator is positive.
#[derive(Clone, Copy, Debug)]
struct Slope(i32, i32);

impl Slope {
    fn is_below(self, other: Self) -> bool {
        self.0 * other.1 < other.0 * self.1
    }
}

/// The part of a row of a quadrant, `depth` away from the origin, that is in view between two slopes.
#[derive(Clone, Copy, Debug)]
struct Row {
    depth: i32,
    start: Slope,
    end: Slope,
}

impl Row {
    /// The columns whose regions overlap the view of the row, and some more.
    fn columns(&self) -> std::ops::RangeInclusive<i32> {
        let first = (self.depth * self.start.0).div_euclid(self.start.1) - 1;
        let last = (self.depth * self.end.0).div_euclid(self.end.1) + 2;
        first.max(-self.depth)..=last.min(self.depth)
    }

    fn shows(&self, column: i32) -> bool {
        let middle = Slope(column, self.depth);
        !middle.is_below(self.start) && !self.end.is_below(middle)
    }

    /// The slopes between which a region of this row hides what lies behind it.
    fn shadow(&self, column: i32) -> (Slope, Slope) {
        let (left, right, near, far) =
            (2 * column - 1, 2 * column + 1, 2 * self.depth - 1, 2 * self.depth + 1);
        (Slope(left, if left > 0 { far } else { near }), Slope(right, if right > 0 { near } else { far }))
    }
}

/// The regions in view from `origin` within `reach` regions, sorted. Shadow casting by rows: a region is in view
/// unless the straight line between the centers passes through the inside of an opaque region. Visibility is
/// symmetric.
pub(super) fn cast(regions: &Regions, opaque: &[bool], origin: usize, reach: f64) -> Vec<u32> {
    let (x, y) = ((origin % regions.columns) as i32, (origin / regions.columns) as i32);
    let mut seen = vec![origin as u32];
    let mut rows = Vec::new();
    for quadrant in 0..4 {
        let at = |depth: i32, column: i32| match quadrant {
            0 => regions.at(x + column, y + depth),
            1 => regions.at(x + column, y - depth),
            2 => regions.at(x + depth, y + column),
            _ => regions.at(x - depth, y + column),
        };
        rows.push(Row { depth: 1, start: Slope(-1, 1), end: Slope(1, 1) });
        while let Some(mut row) = rows.pop() {
            let depth = row.depth;
            if f64::from(depth) > reach {
                continue;
            }
            // Within a quadrant, no region hides the center of another region in the same row.
            for column in row.columns() {
                let region = at(depth, column);
                let is_near = f64::from(depth * depth + column * column) <= reach * reach;
                if let Some(region) = region.filter(|_| is_near && row.shows(column)) {
                    seen.push(region as u32);
                }
                let (start, end) = row.shadow(column);
                let is_hiding = row.start.is_below(end) && start.is_below(row.end);
                if is_hiding && region.is_none_or(|region| opaque[region]) {
                    if !start.is_below(row.start) {
                        rows.push(Row { depth: depth + 1, start: row.start, end: start });
                    }
                    row.start = end;
                }
            }
            if !row.end.is_below(row.start) {
                rows.push(Row { depth: depth + 1, ..row });
            }
        }
    }
    // Two quadrants share a diagonal.
    seen.sort_unstable();
    seen.dedup();
    seen
}
