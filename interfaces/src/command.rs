use crate::Cell;

/// The velocity of a differential-drive robot in the frame of the robot, as ROS `geometry_msgs/Twist`.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Twist {
    /// Linear velocity, positive forward, m/s.
    pub linear_mps: f64,
    /// Angular velocity, positive counter-clockwise, rad/s.
    pub angular_radps: f64,
}

impl Twist {
    /// Zero velocity.
    pub const STOP: Self = Self { linear_mps: 0.0, angular_radps: 0.0 };
}

/// The action of a robot in a grid world: stay, or move to one of the four cells that share a side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Step {
    /// Stay in the same cell.
    #[default]
    Stay,
    /// One column to the right.
    Right,
    /// One row up.
    Up,
    /// One column to the left.
    Left,
    /// One row down.
    Down,
}

impl Step {
    /// Every action: stay, then the moves in the order of [`Cell::neighbours4`].
    pub const ALL: [Self; 5] = [Self::Stay, Self::Right, Self::Up, Self::Left, Self::Down];

    /// The cell that the action leads to from `cell`.
    #[inline]
    pub const fn target(self, cell: Cell) -> Cell {
        match self {
            Self::Stay => cell,
            Self::Right => Cell::new(cell.x + 1, cell.y),
            Self::Up => Cell::new(cell.x, cell.y + 1),
            Self::Left => Cell::new(cell.x - 1, cell.y),
            Self::Down => Cell::new(cell.x, cell.y - 1),
        }
    }

    /// The action that leads from one cell to another; `None` unless the two cells are the same or share a side.
    #[inline]
    pub fn between(from: Cell, to: Cell) -> Option<Self> {
        Self::ALL.into_iter().find(|step| step.target(from) == to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_lead_to_the_neighbours() {
        let cell = Cell::new(3, -2);
        assert_eq!(
            Step::ALL[1..].iter().map(|step| step.target(cell)).collect::<Vec<_>>(),
            cell.neighbours4()
        );
        for step in Step::ALL {
            assert_eq!(Step::between(cell, step.target(cell)), Some(step));
        }
        assert_eq!(Step::between(cell, Cell::new(4, -1)), None);
    }
}
