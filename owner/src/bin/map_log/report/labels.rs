//! Where the labels of a plan are, so that they hide nothing.

/// A rectangle: left, top, right, bottom.
pub(super) type Box4 = [f64; 4];

/// The radius of a label.
pub(super) const RADIUS: f64 = 19.0;
/// Labels keep this distance from each other and from what they mark.
const GAP: f64 = 3.0;
/// Directions and distances at which a label is tried.
const DIRECTIONS: u32 = 24;
const DISTANCES: [f64; 12] = [8.0, 14.0, 22.0, 32.0, 44.0, 58.0, 76.0, 100.0, 130.0, 170.0, 220.0, 290.0];
/// What a unit of distance costs, against a share of the label that covers walls, and against a crossing of its line with
/// another one or with another mark.
const PER_UNIT: f64 = 1.0;
const COVERS_ALL: f64 = 900.0;
const CROSSES: f64 = 120.0;
/// How often each label is placed.
const ROUNDS: usize = 3;

/// A label: the middle of its circle, and where its leader line ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Label {
    pub(super) at: [f64; 2],
    pub(super) to: [f64; 2],
}

/// Places a label beside each mark, within a picture of this size; none where there is no room. `covered`: the share of a circle
/// around a point that would hide something.
pub(super) fn labels(
    marks: &[Box4],
    size: [f64; 2],
    covered: impl Fn([f64; 2], f64) -> f64,
) -> Vec<Option<Label>> {
    let mut placed: Vec<Option<Label>> = vec![None; marks.len()];
    // The first round places them one after the other; later ones move each to where it is best, now that all others are known.
    for _ in 0..ROUNDS {
        for number in 0..marks.len() {
            placed[number] = None;
            placed[number] = best(marks, number, &placed, size, &covered);
        }
    }
    placed
}

/// The best label of a mark, beside those that are placed.
fn best(
    marks: &[Box4],
    number: usize,
    placed: &[Option<Label>],
    [width, height]: [f64; 2],
    covered: &impl Fn([f64; 2], f64) -> f64,
) -> Option<Label> {
    let mark = &marks[number];
    let to = [(mark[0] + mark[2]) / 2.0, (mark[1] + mark[3]) / 2.0];
    let mut best: Option<(f64, Label)> = None;
    for (distance, direction) in DISTANCES.iter().flat_map(|d| (0..DIRECTIONS).map(move |n| (d, n))) {
        let at = beside(mark, f64::from(direction) / f64::from(DIRECTIONS), RADIUS + distance);
        let label = Label { at, to: edge(mark, at, to) };
        let is_inside =
            (RADIUS..=width - RADIUS).contains(&at[0]) && (RADIUS..=height - RADIUS).contains(&at[1]);
        let is_free = marks.iter().all(|mark| distance_to(mark, at) >= RADIUS + GAP)
            && placed.iter().flatten().all(|other| far(other.at, at) >= 2.0 * RADIUS + GAP)
            && placed.iter().flatten().all(|other| is_clear(other, &label));
        if !is_inside || !is_free {
            continue;
        }
        let crossings = placed.iter().flatten().filter(|other| cross(other, &label)).count();
        let over = marks.iter().enumerate().filter(|(other, mark)| *other != number && passes(&label, mark));
        let cost = PER_UNIT * distance
            + COVERS_ALL * covered(at, RADIUS)
            + CROSSES * (crossings + over.count()) as f64;
        if best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, label));
        }
    }
    best.map(|(_, label)| label)
}

/// The point at this distance from a rectangle, in a direction from 0 to 1 around its middle.
fn beside(mark: &Box4, direction: f64, distance: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(std::f64::consts::TAU * direction);
    let half = [(mark[2] - mark[0]) / 2.0, (mark[3] - mark[1]) / 2.0];
    [
        (mark[0] + mark[2]) / 2.0 + cos * (half[0] + distance),
        (mark[1] + mark[3]) / 2.0 - sin * (half[1] + distance),
    ]
}

/// Where the line from a point to the middle of a rectangle meets the rectangle.
fn edge(mark: &Box4, from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    let shares = [0, 1].map(|axis| {
        let half = (mark[axis + 2] - mark[axis]) / 2.0;
        half / (from[axis] - to[axis]).abs().max(1e-9)
    });
    let share = shares[0].min(shares[1]).min(1.0);
    [0, 1].map(|axis| to[axis] + share * (from[axis] - to[axis]))
}

fn far(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

/// The distance of a point from a rectangle; 0 inside.
fn distance_to(mark: &Box4, at: [f64; 2]) -> f64 {
    let beyond = [0, 1].map(|axis| (mark[axis] - at[axis]).max(at[axis] - mark[axis + 2]).max(0.0));
    libm::hypot(beyond[0], beyond[1])
}

/// Whether no leader line goes through the circle of the other label.
fn is_clear(a: &Label, b: &Label) -> bool {
    [(a, b), (b, a)].iter().all(|(line, circle)| {
        let along = [line.to[0] - line.at[0], line.to[1] - line.at[1]];
        let from = [circle.at[0] - line.at[0], circle.at[1] - line.at[1]];
        let squared = (along[0] * along[0] + along[1] * along[1]).max(1e-9);
        let share = ((along[0] * from[0] + along[1] * from[1]) / squared).clamp(0.0, 1.0);
        far([along[0] * share, along[1] * share], from) >= RADIUS + GAP
    })
}

/// Whether the leader line of a label passes over a rectangle.
fn passes(label: &Label, mark: &Box4) -> bool {
    const STEPS: u32 = 16;
    (0..=STEPS).map(|step| f64::from(step) / f64::from(STEPS)).any(|share| {
        let at = [0, 1].map(|axis| label.at[axis] + share * (label.to[axis] - label.at[axis]));
        distance_to(mark, at) == 0.0
    })
}

/// Whether two leader lines cross.
fn cross(a: &Label, b: &Label) -> bool {
    let side = |from: [f64; 2], to: [f64; 2], at: [f64; 2]| {
        (to[0] - from[0]) * (at[1] - from[1]) - (to[1] - from[1]) * (at[0] - from[0])
    };
    side(a.at, a.to, b.at) * side(a.at, a.to, b.to) < 0.0
        && side(b.at, b.to, a.at) * side(b.at, b.to, a.to) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_hide_neither_marks_nor_each_other() {
        // A row of marks that touch each other, as along a corridor.
        let marks: Vec<Box4> = (0..12)
            .map(|number| {
                let left = 100.0 + 30.0 * f64::from(number);
                [left, 200.0, left + 28.0, 215.0]
            })
            .collect();
        let found = labels(&marks, [700.0, 400.0], |_, _| 0.0);
        let placed: Vec<Label> = found.iter().flatten().copied().collect();
        assert_eq!(placed.len(), marks.len());
        for (number, label) in placed.iter().enumerate() {
            assert!(marks.iter().all(|mark| distance_to(mark, label.at) >= RADIUS), "{label:?}");
            assert!(distance_to(&marks[number], label.to) < 1e-6, "the line ends at its mark: {label:?}");
            let others = placed.iter().enumerate().filter(|(other, _)| *other != number);
            assert!(
                others.into_iter().all(|(_, other)| far(other.at, label.at) >= 2.0 * RADIUS),
                "{label:?}"
            );
        }
    }

    #[test]
    fn a_label_avoids_what_it_would_hide() {
        let wall_above = |at: [f64; 2], _| f64::from(u8::from(at[1] < 200.0));
        let found = labels(&[[100.0, 200.0, 110.0, 210.0]], [300.0, 300.0], wall_above);
        assert!(found[0].unwrap().at[1] > 200.0, "{found:?}");
    }

    #[test]
    fn without_room_there_is_no_label() {
        assert_eq!(labels(&[[0.0, 0.0, 20.0, 20.0]], [20.0, 20.0], |_, _| 0.0), [None]);
    }
}
