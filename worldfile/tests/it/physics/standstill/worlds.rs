//! Random houses: rooms at a corridor, with doors, boxes, and robots that go from room to room.

use super::super::random::Chance;
use super::super::wall;
use sim::physics::FleetSpec;

const SIZE_M: [f64; 2] = [10.0, 8.0];
/// The width of doorways, m.
const DOORWAY_M: f64 = 0.9;

/// A room, by the middle of its doorway and the direction from the corridor into the room (+1: up).
struct Room {
    doorway_m: f64,
    up: f64,
    /// From the left to the right wall, m.
    sides_m: [f64; 2],
}

/// A robot of a house; `kind`: its behavior.
pub(super) fn body(name: &str, radius_m: f64, at: [f64; 2], heading_deg: f64, kind: &str) -> String {
    format!(
        "[[robot]]\nname = \"{name}\"\nradius_m = {radius_m:?}\nmass_kg = 15.0\npose_m = {at:?}\n\
         heading_deg = {heading_deg:?}\n[robot.drive]\nmax_linear_mps = 0.8\nmax_angular_degps = 120.0\n\
         max_linear_acceleration_mps2 = 1.0\nmax_angular_acceleration_degps2 = 360.0\n\
         [robot.laser]\nbeams = 90\nrange_max_m = 4.0\nrate_hz = 10.0\n[robot.behavior]\nkind = {kind}\n"
    )
}

struct House {
    chance: Chance,
    /// The lower and the upper wall of the corridor, m.
    corridor_m: [f64; 2],
    rooms: Vec<Room>,
    text: String,
    spec: Option<FleetSpec>,
}

/// The house of a seed.
pub(in crate::physics) fn house(seed: u64) -> FleetSpec {
    let mut chance = Chance::new(seed);
    let low_m = chance.between(2.6, 3.2);
    let corridor_m = [low_m, low_m + chance.between(0.8, 1.6)];
    let text = format!("name = \"house {seed}\"\n[map]\nsize_m = {SIZE_M:?}\ncell_m = 0.1\n");
    let mut house = House { chance, corridor_m, rooms: Vec::new(), text, spec: None };
    house.walls();
    house.try_add(String::new());
    (0..house.rooms.len()).for_each(|room| house.door(room));
    for robot in 0..house.whole(2, 5) {
        // Not every way is free, and not every place to start.
        let _ = (0..20).any(|_| house.robot(robot));
    }
    for (robot, kind) in [
        ("driven", "\"driven\""),
        ("wanderer", "\"wander\"\nspeed_mps = 0.3"),
        ("pusher", "\"circle\"\nspeed_mps = 0.3\nturn_radius_m = 0.7"),
    ] {
        let _ = (0..10).any(|_| {
            let at = house.point();
            let robot = house.body(robot, 0.2, at, kind);
            house.try_add(robot)
        });
    }
    (0..house.whole(4, 14)).for_each(|number| house.pushed(number));
    house.spec.unwrap_or_else(|| panic!("{}", house.text))
}

impl House {
    /// A whole number from `low` to below `high`.
    fn whole(&mut self, low: usize, high: usize) -> usize {
        self.chance.between(low as f64, high as f64) as usize
    }

    fn point(&mut self) -> [f64; 2] {
        SIZE_M.map(|size_m| self.chance.between(0.4, size_m - 0.4))
    }

    /// Adds a part, if it fits.
    fn try_add(&mut self, part: String) -> bool {
        let text = format!("{}{part}", self.text);
        let Ok(spec) = worldfile::physics::parse_fleet("house.toml", &text) else { return false };
        (self.spec, self.text) = (Some(spec), text);
        true
    }

    fn wall(&mut self, min: [f64; 2], max: [f64; 2]) {
        self.text += &wall(min, max);
    }

    fn walls(&mut self) {
        let [width_m, height_m] = SIZE_M;
        self.wall([0.0, 0.0], [width_m, 0.1]);
        self.wall([0.0, height_m - 0.1], [width_m, height_m]);
        self.wall([0.0, 0.1], [0.1, height_m - 0.1]);
        self.wall([width_m - 0.1, 0.1], [width_m, height_m - 0.1]);
        for (side, up) in [-1.0, 1.0].into_iter().enumerate() {
            // The wall of the corridor, and the rooms beyond.
            let from_m = self.corridor_m[side];
            let [bottom_m, top_m] = if side == 0 { [from_m - 0.1, from_m] } else { [from_m, from_m + 0.1] };
            let rooms = self.whole(2, 4);
            let mut left_m = 0.1;
            for room in 0..rooms {
                let width_m = (SIZE_M[0] - 0.2) / rooms as f64;
                let right_m = if room + 1 == rooms { SIZE_M[0] - 0.1 } else { left_m + width_m };
                let doorway_m = self.chance.between(left_m + 0.7, right_m - 0.7);
                self.wall([left_m, bottom_m], [doorway_m - DOORWAY_M / 2.0, top_m]);
                self.wall([doorway_m + DOORWAY_M / 2.0, bottom_m], [right_m, top_m]);
                if room + 1 < rooms {
                    let [bottom_m, top_m] =
                        if side == 0 { [0.1, bottom_m] } else { [top_m, SIZE_M[1] - 0.1] };
                    self.wall([right_m - 0.05, bottom_m], [right_m + 0.05, top_m]);
                }
                self.rooms.push(Room { doorway_m, up, sides_m: [left_m, right_m] });
                left_m = right_m;
            }
        }
    }

    /// The height of the middle of the wall between the corridor and a room, m.
    fn threshold_m(&self, room: usize) -> f64 {
        let up = self.rooms[room].up;
        self.corridor_m[usize::from(up > 0.0)] + 0.05 * up
    }

    /// A door of any kind, hinged on either side, that opens in either direction. Not every doorway has one.
    fn door(&mut self, room: usize) {
        let (threshold_m, doorway_m) = (self.threshold_m(room), self.rooms[room].doorway_m);
        let side = if self.whole(0, 2) == 0 { 1.0 } else { -1.0 };
        let [from_m, to_m] = [-side, side].map(|side| [doorway_m + side * DOORWAY_M / 2.0, threshold_m]);
        let kind = ["sliding_door\"", "hinged_door\"\nopen_deg = 90.0", "hinged_door\"\nopen_deg = -90.0"];
        let kind = kind[self.whole(0, 3)];
        let [closed_s, open_s] = [(); 2].map(|()| self.chance.between(3.0, 60.0));
        let opening = match self.whole(0, 4) {
            0 => return,
            1 => format!("\"periodic\"\nclosed_s = {closed_s:?}\nopen_s = {open_s:?}"),
            2 => format!("\"random\"\nclosed_s = {closed_s:?}\nopen_s = {open_s:?}"),
            _ => {
                let switches_s: Vec<f64> = (1..60).map(|i| f64::from(i) * (closed_s + open_s)).collect();
                format!("\"scripted\"\nswitches_s = {switches_s:?}")
            }
        };
        let (starts_open, move_s) = (self.whole(0, 2) == 0, self.chance.between(1.0, 3.0));
        self.try_add(format!(
            "[[obstacle]]\nname = \"door {room}\"\nkind = \"{kind}\nfrom_m = {from_m:?}\nto_m = {to_m:?}\n\
             thickness_m = 0.05\nmove_s = {move_s:?}\nstarts_open = {starts_open}\nopening = {opening}\n"
        ));
    }

    fn pushed(&mut self, number: usize) {
        let (at, size) = (self.point(), [(); 2].map(|()| self.chance.between(0.15, 0.5)));
        let [heading_deg, mass_kg, friction] =
            [(0.0, 90.0), (0.5, 20.0), (0.1, 0.6)].map(|(low, high)| self.chance.between(low, high));
        self.try_add(format!(
            "[[obstacle]]\nname = \"box {number}\"\nkind = \"box\"\ncenter_m = {at:?}\nsize_m = {size:?}\n\
             heading_deg = {heading_deg:?}\nmass_kg = {mass_kg:?}\nfriction = {friction:?}\n"
        ));
    }

    fn body(&mut self, name: &str, radius_m: f64, at: [f64; 2], kind: &str) -> String {
        body(name, radius_m, at, self.chance.between(0.0, 360.0), kind)
    }

    /// A robot that goes from room to room through the corridor. Returns whether it fits.
    fn robot(&mut self, number: usize) -> bool {
        let middle_m = (self.corridor_m[0] + self.corridor_m[1]) / 2.0;
        let mut points: Vec<[f64; 2]> = Vec::new();
        for _ in 0..self.whole(1, 5) {
            let room = self.whole(0, self.rooms.len());
            let Room { doorway_m, up, sides_m: [left_m, right_m] } = self.rooms[room];
            let before = [doorway_m, middle_m];
            let inside = [doorway_m, self.threshold_m(room) + 0.8 * up];
            let depth_m = if up > 0.0 { SIZE_M[1] - inside[1] } else { inside[1] } - 0.5;
            let beyond = [
                self.chance.between(left_m + 0.5, right_m - 0.5),
                inside[1] + up * self.chance.between(0.2, depth_m),
            ];
            points.extend([before, inside, beyond, inside]);
        }
        let repeat = ["loop", "loop", "back_and_forth"][self.whole(0, 3)];
        let first = points[0];
        if repeat == "loop" {
            // Back into the corridor.
            let [inside_m, _] = points[points.len() - 1];
            points.push([inside_m, middle_m]);
            if inside_m == first[0] {
                points.pop();
                points.push([inside_m + 0.3, middle_m]);
            }
        }
        points.dedup();
        let (speed_mps, radius_m) = (self.chance.between(0.2, 0.6), self.chance.between(0.1, 0.25));
        let kind =
            format!("\"waypoints\"\npoints_m = {points:?}\nspeed_mps = {speed_mps:?}\nrepeat = \"{repeat}\"");
        let robot = self.body(&format!("walker {number}"), radius_m, first, &kind);
        self.try_add(robot)
    }
}
