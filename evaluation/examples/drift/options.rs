use crate::shelves;
use sim::physics::{DisplacementSpec, Motion, OdometryError, WorldSpec};

/// Displacements are 20 s apart in the mean.
const NO_DISPLACEMENT: DisplacementSpec = DisplacementSpec { every_s: 20.0, distance_m: 0.0, turn_rad: 0.0 };

fn is_any(displacement: &DisplacementSpec) -> bool {
    displacement.distance_m > 0.0 || displacement.turn_rad > 0.0
}

/// The arguments, each of the form `key=value`.
#[derive(Clone, Debug)]
pub(crate) struct Options {
    world: Option<String>,
    generate: u64,
    seed: u64,
    pub(crate) trials: u64,
    beams: usize,
    noise_m: f64,
    dropout: f64,
    fov_rad: f64,
    sweep_s: f64,
    /// Nothing moves in the world.
    still: bool,
    /// A room with shelves that shift, in place of a house.
    shelves: bool,
    /// The robot rests while they shift.
    rest: bool,
    /// Jumps of the odometry, and the robot carried away.
    jump: DisplacementSpec,
    carried: DisplacementSpec,
    pub(crate) minutes: f64,
    /// The robot drives by its estimate.
    pub(crate) closed: bool,
    pub(crate) odometry_only: bool,
    /// Loops are not closed.
    pub(crate) no_loops: bool,
    /// Unknown starts in the map of the run.
    pub(crate) relocate: bool,
    /// A third of the furniture was moved since the map of the unknown starts was made.
    pub(crate) moved: bool,
    /// Whether a row of a CSV file ends the output, and what the row is called.
    pub(crate) row: bool,
    pub(crate) table: String,
    pub(crate) variant: String,
}

impl Options {
    pub(crate) fn parse(arguments: impl Iterator<Item = String>) -> Result<Self, Box<dyn std::error::Error>> {
        let mut options = Self {
            world: None,
            generate: 1000,
            seed: 1000,
            trials: 1,
            beams: 360,
            noise_m: 0.01,
            dropout: 0.0,
            fov_rad: std::f64::consts::TAU,
            sweep_s: 0.0,
            still: false,
            shelves: false,
            rest: false,
            jump: NO_DISPLACEMENT,
            carried: NO_DISPLACEMENT,
            minutes: 20.0,
            closed: false,
            odometry_only: false,
            no_loops: false,
            relocate: false,
            moved: false,
            row: false,
            table: String::new(),
            variant: String::new(),
        };
        for argument in arguments {
            let (key, value) = argument.split_once('=').ok_or("arguments have the form key=value")?;
            let number = || value.parse::<f64>().map_err(|_| format!("{argument}: not a number"));
            let is_on = value == "1";
            match key {
                "world" => options.world = Some(value.to_owned()),
                "row" => options.row = is_on,
                "table" => value.clone_into(&mut options.table),
                "variant" => value.clone_into(&mut options.variant),
                "generate" => options.generate = number()? as u64,
                "seed" => options.seed = number()? as u64,
                "trials" => options.trials = number()? as u64,
                "beams" => options.beams = number()? as usize,
                "noise" => options.noise_m = number()?,
                "dropout" => options.dropout = number()?,
                "fov_deg" => options.fov_rad = number()?.to_radians(),
                "sweep" => options.sweep_s = number()?,
                "still" => options.still = is_on,
                "shelves" => options.shelves = is_on,
                "rest" => options.rest = is_on,
                "jump_m" => options.jump.distance_m = number()?,
                "jump_deg" => options.jump.turn_rad = number()?.to_radians(),
                "carried_m" => options.carried.distance_m = number()?,
                "carried_deg" => options.carried.turn_rad = number()?.to_radians(),
                "minutes" => options.minutes = number()?,
                "closed" => options.closed = is_on,
                "odometry-only" => options.odometry_only = is_on,
                "no-loops" => options.no_loops = is_on,
                "relocate" => options.relocate = is_on,
                "moved" => options.moved = is_on,
                _ => return Err(format!("{key}: no such option").into()),
            }
        }
        Ok(options)
    }

    pub(crate) fn seeds(&self) -> impl Iterator<Item = u64> + use<> {
        self.seed..self.seed + self.trials
    }

    pub(crate) fn name(&self) -> String {
        self.world.clone().unwrap_or_else(|| "generated".to_owned())
    }

    /// The world, with a robot whose odometry drifts hard. Without a file, each trial has a house of its own.
    pub(crate) fn spec(&self, seed: u64) -> Result<WorldSpec, Box<dyn std::error::Error>> {
        let spec = match &self.world {
            Some(path) => worldfile::physics::parse_world(path, &std::fs::read_to_string(path)?)?,
            None if self.shelves => shelves::room(self.generate + seed - self.seed).ok_or("no room")?,
            None => WorldSpec::generate_house(self.generate + seed - self.seed),
        };
        let mut driven = spec.driven_index();
        let mut fleet = spec.fleet().clone();
        if self.still {
            fleet.obstacles.retain(|obstacle| obstacle.motion == Motion::Fixed);
            fleet.robots = vec![fleet.robots.swap_remove(driven)];
            driven = 0;
        }
        let robot = &mut fleet.robots[driven];
        robot.odometry = OdometryError {
            distance_gain: 0.05,
            turn_gain: -0.05,
            turn_radpm: 3.0_f64.to_radians(),
            distance_noise_m: 0.05,
            turn_noise_rad: 0.05,
            jump: Some(self.jump).filter(is_any),
            carried: Some(self.carried).filter(is_any),
            ..OdometryError::default()
        };
        let laser = &mut robot.laser;
        (laser.beams, laser.noise_std_m, laser.dropout) = (self.beams, self.noise_m, self.dropout);
        (laser.fov_rad, laser.sweep_s) = (self.fov_rad, self.sweep_s);
        WorldSpec::driving(fleet, driven).ok_or_else(|| "no robot".into())
    }

    /// Whether the robot rests at a time, since shelves are about to shift or have just shifted.
    pub(crate) fn rests_at(&self, time_s: f64) -> bool {
        self.shelves && self.rest && shelves::is_near_shift(time_s)
    }
}
