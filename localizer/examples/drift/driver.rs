use controller::{Controller, DiffDrive, DiffDriveSettings, Situation, Status};
use interfaces::{Purpose, RandomStream, SettingsError, Twist};
use mapper::Mapper;
use nalgebra::Isometry2;
use sim::physics::WorldSpec;

/// Drives to random cells of the map.
pub(crate) struct Driver {
    controller: Controller<DiffDrive>,
    random: RandomStream,
}

impl Driver {
    pub(crate) fn new(spec: &WorldSpec, seed: u64) -> Result<Self, SettingsError> {
        let robot = spec.driven();
        let drive = DiffDriveSettings {
            radius_m: robot.radius_m,
            max_linear_mps: robot.drive.max_linear_mps,
            max_angular_radps: robot.drive.max_angular_radps,
            acceleration_mps2: robot.drive.max_linear_acceleration_mps2,
            angular_acceleration_radps2: robot.drive.max_angular_acceleration_radps2,
            reaction_s: 1.0 / robot.laser.rate_hz + spec.step_s,
            ..DiffDriveSettings::default()
        };
        let stream = RandomStream::new(seed, Purpose::Controller);
        let controller = Controller::new(controller::Settings::default(), DiffDrive::new(drive)?, stream)?;
        Ok(Self { controller, random: RandomStream::new(seed, Purpose::Agent) })
    }

    pub(crate) fn command(&mut self, map: &Mapper, pose: &Isometry2<f64>, rests: bool) -> Twist {
        let situation = Situation {
            time: map.time(),
            pose,
            map: map.states(),
            transitions: map.transitions(),
            points: map.points(),
        };
        let command = self.controller.drive(&situation);
        if matches!(self.controller.status(), Status::Idle | Status::Finished(_)) {
            let cells = map.states().cells().len() as f64;
            let mut draws = (0..1000).map(|_| self.random.uniform(0.0..cells) as usize);
            if let Some(index) = draws.find(|&index| map.is_candidate(index)) {
                self.controller.go_to(map.frame().center(map.frame().cell(index)));
            }
        }
        if rests { Twist::STOP } else { command }
    }
}
