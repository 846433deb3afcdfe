//! The places of names in a plan.

/// A rectangle of pixels; rows count from the top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plate {
    pub(super) left: i32,
    pub(super) right: i32,
    pub(super) top: i32,
    pub(super) bottom: i32,
}

impl Plate {
    /// The rectangle around `center` of a width and a height.
    pub(super) fn around((x, y): (i32, i32), [width, height]: [i32; 2]) -> Self {
        let (left, top) = (x - width / 2, y - height / 2);
        Self { left, right: left + width, top, bottom: top + height }
    }

    pub(super) fn width(&self) -> i32 {
        self.right - self.left
    }

    pub(super) fn height(&self) -> i32 {
        self.bottom - self.top
    }

    pub(super) fn center(&self) -> (i32, i32) {
        ((self.left + self.right) / 2, (self.top + self.bottom) / 2)
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    fn contains(&self, other: &Self) -> bool {
        self.left <= other.left
            && other.right <= self.right
            && self.top <= other.top
            && other.bottom <= self.bottom
    }

    /// A rectangle of `size` beside this one with a `gap`: below, above, at the right or at the left, the first that
    /// is inside `area` and overlaps nothing that is `taken`; below if there is none.
    pub(super) fn place_beside(&self, size: [i32; 2], gap: i32, area: &Self, taken: &[Self]) -> Self {
        let ((x, y), [width, height]) = (self.center(), size);
        let below = Self::around((x, self.bottom + gap + height / 2), size);
        let others = [
            (x, self.top - gap - height / 2),
            (self.right + gap + width / 2, y),
            (self.left - gap - width / 2, y),
        ];
        let is_free = |plate: &Self| area.contains(plate) && !taken.iter().any(|other| plate.overlaps(other));
        let places = others.map(|center| Self::around(center, size));
        [below].into_iter().chain(places).find(is_free).unwrap_or(below)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: Plate = Plate { left: 0, right: 100, top: 0, bottom: 100 };

    #[test]
    fn names_give_way_to_each_other_and_to_the_border() {
        let owner = Plate::around((50, 50), [10, 10]);
        let mut taken = Vec::new();
        let centers = [(); 5].map(|()| {
            let plate = owner.place_beside([20, 10], 2, &AREA, &taken);
            taken.push(plate);
            plate.center()
        });
        // Below, above, right, left; then below again.
        assert_eq!(centers, [(50, 62), (50, 38), (67, 50), (33, 50), (50, 62)]);
        let at_the_bottom = Plate::around((50, 92), [10, 10]);
        assert_eq!(at_the_bottom.place_beside([20, 10], 2, &AREA, &[]).center(), (50, 80));
    }
}
