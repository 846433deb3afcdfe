use controller::{ControlInput, Controller, DiffDrive, Driver as _, Status};
use interfaces::{Purpose, RandomStream, SettingsError, Twist};
use mapper::Mapper;
use nalgebra::Isometry2;
use robot::{Permission, Settings};

/// Drives to random cells of the map.
pub(crate) struct Driver {
    controller: Controller<DiffDrive>,
    random: RandomStream,
}

impl Driver {
    pub(crate) fn new(settings: &Settings, seed: u64) -> Result<Self, SettingsError> {
        Ok(Self { controller: settings.controller(seed)?, random: RandomStream::new(seed, Purpose::Agent) })
    }

    pub(crate) fn command(&mut self, map: &Mapper, pose: &Isometry2<f64>, permission: Permission) -> Twist {
        let input = ControlInput {
            time: map.time(),
            pose,
            map: map.states(),
            transitions: map.transitions(),
            points: map.points(),
            obstacles: None,
        };
        if permission == Permission::LookAround {
            return self.controller.pause(&input, true);
        }
        let command = self.controller.drive(&input);
        if matches!(self.controller.view().status, Status::Idle | Status::Finished(_)) {
            let cells = map.states().cells().len() as f64;
            let mut draws = (0..1000).map(|_| self.random.uniform(0.0..cells) as usize);
            if let Some(index) = draws.find(|&index| map.is_candidate(index)) {
                self.controller.set_goal(map.frame().center(map.frame().cell(index)), Some(0.0));
            }
        }
        if permission == Permission::Rest { Twist::STOP } else { command }
    }
}
