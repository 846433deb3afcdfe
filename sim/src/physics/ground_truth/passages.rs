//! What moving things did to a cell.

use crate::physics::report::Body;

/// What moving things did to a cell so far, and do now.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub(super) struct Passages {
    /// The number of robots that overlap the cell, and the number of robots that cover all of the cell.
    pub(super) overlapped: u16,
    pub(super) covered: u16,
    pub(super) block_events: u32,
    /// How often the cell was free and then overlapped.
    pub(super) pass_events: u32,
    pub(super) mover: Mover,
}

impl Passages {
    /// The same without events.
    pub(super) fn without_events(self) -> Self {
        Self { block_events: 0, pass_events: 0, ..self }
    }
}

/// The first moving thing that touched a cell, in four bytes: 0 for none.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub(super) struct Mover(u32);

impl Mover {
    pub(super) fn of(body: Body) -> Self {
        let (kind, index) = match body {
            Body::Wall(index) => (1, index),
            Body::Obstacle(index) => (2, index),
            Body::Robot(index) => (3, index),
        };
        Self(3 * index as u32 + kind)
    }

    pub(super) fn body(self) -> Option<Body> {
        let number = self.0.checked_sub(1)?;
        let index = (number / 3) as usize;
        Some(match number % 3 {
            0 => Body::Wall(index),
            1 => Body::Obstacle(index),
            _ => Body::Robot(index),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mover_is_its_body() {
        assert_eq!(Mover::default().body(), None);
        for body in
            [Body::Wall(0), Body::Obstacle(0), Body::Robot(0), Body::Obstacle(7), Body::Robot(1 << 20)]
        {
            assert_eq!(Mover::of(body).body(), Some(body));
        }
        assert_eq!(size_of::<Passages>(), 16);
    }
}
