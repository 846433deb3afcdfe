//! In the shipped worlds no laser makes veils: the scan filter changes no scan of a robot with exact poses.

use agent::Policy;
use evaluation::physics_trial::{PhysicsSettings, PhysicsTrial, PoseChoice};
use mapper::{NoReturn, ReadingError, ScanFilter, ScanFilterSettings};
use std::ops::ControlFlow;
use worldfile::shipped;

#[test]
fn scans_without_veils_stay_as_they_are() {
    for (name, _) in shipped::PHYSICS {
        let spec = shipped::load(name).unwrap();
        let mut settings = PhysicsSettings::of(&spec).unwrap();
        settings.pose = PoseChoice::Exact;
        let pilot = settings.pilot(settings.agent(&Policy::default(), 0).unwrap(), 0).unwrap();
        let mut trial = PhysicsTrial::new(&spec, 0, &settings, None, pilot).unwrap();
        let filter = ScanFilterSettings { no_return: NoReturn::Free, ..ScanFilterSettings::default() };
        let mut filter = ScanFilter::new(&filter).unwrap();
        let mut changed = 0;
        trial
            .run_with(|_, reading, _, _, _| -> Result<_, ReadingError> {
                let (before, after) = (&reading.scan, filter.filter(reading.clone()).scan);
                let pairs = before.ranges_m.iter().zip(&after.ranges_m);
                changed += pairs.filter(|(before, after)| before.to_bits() != after.to_bits()).count();
                Ok(if reading.time_s < 60.0 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
            })
            .unwrap();
        assert_eq!(changed, 0, "{name}");
    }
}
