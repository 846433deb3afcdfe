use interfaces::GroundTruth;
use mapper::Mapper;

/// How well the estimated rates separate the cells that truly changed from static cells: the area under the
/// ROC curve. Only observed cells count. Cells within one cell of the border of the swept area are left out.
/// `None` without cells of both classes.
pub(super) fn rate_auc(mapper: &Mapper, truth: &impl GroundTruth) -> Option<f64> {
    let frame = truth.frame();
    let (mut changing, mut static_) = (Vec::new(), Vec::new());
    for index in (0..frame.len()).filter(|&index| mapper.was_ever_seen(index)) {
        let is_swept = |cell| frame.index(cell).is_some_and(|near| truth.is_swept(near));
        let cell = frame.cell(index);
        let swept_neighbours = cell.neighbours8().into_iter().filter(|&near| is_swept(near)).count();
        match (truth.is_swept(index), swept_neighbours) {
            (true, 8) if truth.cycle_rate(index) > 0.0 => changing.push(mapper.rate(index)),
            (false, 0) => static_.push(mapper.rate(index)),
            _ => {}
        }
    }
    area_under_roc(&changing, &static_)
}

/// The probability that a positive is above a negative, ties counting half (Mann and Whitney, 1947).
fn area_under_roc(positives: &[f64], negatives: &[f64]) -> Option<f64> {
    if positives.is_empty() || negatives.is_empty() {
        return None;
    }
    let mut sorted = negatives.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let won = |value: &f64| {
        let below = sorted.partition_point(|negative| negative < value);
        let not_above = sorted.partition_point(|negative| negative <= value);
        (below + not_above) as f64 / 2.0
    };
    let sum: f64 = positives.iter().map(won).sum();
    Some(sum / (positives.len() * negatives.len()) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_area_is_the_share_of_pairs_in_order() {
        let (positives, negatives) = ([1.0, 0.0, 3.0], [0.0, 2.0]);
        let brute: f64 = positives
            .iter()
            .flat_map(|p| {
                negatives.iter().map(move |n| {
                    if p > n {
                        1.0
                    } else if p == n {
                        0.5
                    } else {
                        0.0
                    }
                })
            })
            .sum();
        assert_eq!(area_under_roc(&positives, &negatives), Some(brute / 6.0));
        assert_eq!(area_under_roc(&[], &negatives), None);
    }
}
