use controller::{Controller, DiffDrive, Situation, Status};
use evaluation::physics_trial::PhysicsSettings;
use interfaces::{Purpose, RandomStream, SettingsError, Twist};
use mapper::Mapper;
use nalgebra::Isometry2;
use robot::Permission;

/// Drives to random cells of the map.
pub(crate) struct Driver {
    controller: Controller<DiffDrive>,
    random: RandomStream,
}

impl Driver {
    pub(crate) fn new(settings: &PhysicsSettings, seed: u64) -> Result<Self, SettingsError> {
        let stream = RandomStream::new(seed, Purpose::Controller);
        let controller = Controller::new(settings.controller, DiffDrive::new(settings.drive)?, stream)?;
        Ok(Self { controller, random: RandomStream::new(seed, Purpose::Agent) })
    }

    pub(crate) fn command(&mut self, map: &Mapper, pose: &Isometry2<f64>, permission: Permission) -> Twist {
        let situation = Situation {
            time: map.time(),
            pose,
            map: map.states(),
            transitions: map.transitions(),
            points: map.points(),
        };
        if permission == Permission::LookAround {
            return self.controller.pause(&situation, true);
        }
        let command = self.controller.drive(&situation);
        if matches!(self.controller.status(), Status::Idle | Status::Finished(_)) {
            let cells = map.states().cells().len() as f64;
            let mut draws = (0..1000).map(|_| self.random.uniform(0.0..cells) as usize);
            if let Some(index) = draws.find(|&index| map.is_candidate(index)) {
                self.controller.go_to(map.frame().center(map.frame().cell(index)));
            }
        }
        if permission == Permission::Rest { Twist::STOP } else { command }
    }
}
