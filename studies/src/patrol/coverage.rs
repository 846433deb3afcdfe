use super::fixed_length::NextViewpoint;
use super::view::View;
use interfaces::RandomStream;

/// Even coverage: the viewpoint with the largest sum of the times since its things were last seen, per time to get there.
pub(super) struct Coverage;

impl NextViewpoint for Coverage {
    fn next(&mut self, view: &View<'_>, _: &mut RandomStream) -> Option<usize> {
        let worth = |viewpoint: usize| {
            let ages = view.building.viewpoints[viewpoint].sees.iter().map(|thing| view.age(*thing));
            ages.sum::<usize>() as f64 / view.building.steps[view.at][viewpoint] as f64
        };
        let allowed = (0..view.building.viewpoints.len()).filter(|viewpoint| view.is_open(*viewpoint));
        // At the beginning no age differs: the nearest one.
        allowed.max_by(|a, b| worth(*a).total_cmp(&worth(*b)).then(b.cmp(a)))
    }
}
