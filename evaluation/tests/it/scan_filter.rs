//! In the shipped worlds no laser makes veils: the scan filter leaves the scans of a robot with exact poses as they are.

use agent::Policy;
use evaluation::physics_trial::{self, PhysicsTrial};
use interfaces::{PoseMode, World};
use mapper::{NoReturn, ScanFilter, ScanFilterSettings};
use worldfile::shipped;

#[test]
fn scans_without_veils_stay_as_they_are() {
    for (name, _) in shipped::PHYSICS {
        let spec = shipped::load(name).unwrap();
        let mut settings = physics_trial::settings(&spec).unwrap();
        settings.pose = PoseMode::Exact;
        let pilot = settings.pilot(settings.agent(&Policy::default(), 0).unwrap(), 0).unwrap();
        let mut trial = PhysicsTrial::new(&spec, 0, &settings, None, pilot).unwrap();
        let filter = ScanFilterSettings { no_return: NoReturn::Free, ..ScanFilterSettings::default() };
        let mut filter = ScanFilter::new(&filter).unwrap();
        let mut changed = 0;
        while trial.world.time_s() < 60.0 {
            trial.turn().unwrap();
            let reading = trial.world.sense();
            let (before, after) = (&reading.scan, filter.filter(reading.clone()).scan);
            let pairs = before.ranges_m.iter().zip(&after.ranges_m);
            changed += pairs.filter(|(before, after)| before.to_bits() != after.to_bits()).count();
        }
        assert_eq!(changed, 0, "{name}");
    }
}
