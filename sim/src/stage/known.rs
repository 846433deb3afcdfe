//! What Stage has and this simulator has not, so that it can be named.

/// Kinds of things that are left out, and why.
pub(super) const KINDS_LEFT_OUT: [(&str, &str); 14] = [
    ("window", "there is no window here"),
    ("camera", "there are no cameras here"),
    ("blobfinder", "nothing here sees colours"),
    (
        "bumper",
        "Stage's are short beams that may lie anywhere; `[robot.bumper]` is a ring that feels touches",
    ),
    ("gripper", "there are no grippers here; its body is left out too"),
    ("actuator", "there are no actuators here; it and what it carries are left out"),
    ("blinkenlight", "there are no lights here"),
    ("lightindicator", "there are no lights here"),
    ("charger", "there is no energy here"),
    ("powerpack", "there is no energy here"),
    ("power", "there is no energy here"),
    ("loadcell", "there are no load cells here"),
    ("speech", "nobody speaks here"),
    ("wifi", "there is no radio here"),
];

/// Keys that Stage knows and that mean nothing here, and why.
const KEYS_LEFT_OUT: [(&str, &str); 48] = [
    ("resolution", "rays and contacts are exact here, on no grid"),
    ("map_resolution", "bitmaps are exact here, on the borders of pixels"),
    ("color_rgba", DRAWN),
    ("gui_nose", DRAWN),
    ("gui_grid", DRAWN),
    ("gui_outline", DRAWN),
    ("gui_boundary", DRAWN),
    ("gui_move", DRAWN),
    ("gui_movemask", DRAWN),
    ("trail_length", DRAWN),
    ("trail_interval", DRAWN),
    ("say", DRAWN),
    ("wheel", DRAWN),
    ("show_clock", RUN),
    ("show_clock_interval", RUN),
    ("threads", RUN),
    ("speedup", RUN),
    ("paused", RUN),
    ("interval_real", RUN),
    ("gui_interval", RUN),
    ("gui_disable", RUN),
    ("event_queue", RUN),
    ("debug", RUN),
    ("test", RUN),
    ("alwayson", "a laser here always runs"),
    ("samples_per_second", "the rate of a laser is its update_interval"),
    ("watts", ENERGY),
    ("give_watts", ENERGY),
    ("take_watts", ENERGY),
    ("joules", ENERGY),
    ("joules_capacity", ENERGY),
    ("kjoules", ENERGY),
    ("kjoules_capacity", ENERGY),
    ("give", ENERGY),
    ("input", ENERGY),
    ("fiducial_key", "a fiducial finder here finds every tag, whatever its key"),
    ("blob_return", "nothing here sees colours"),
    ("blobfinder_return", "nothing here sees colours"),
    ("gripper_return", "there are no grippers here: nothing is picked up or pushed by one"),
    ("friction", "models do not slide here, nor in Stage"),
    ("odom", "Stage itself no longer knows this key"),
    ("scount", OLD_RANGER),
    ("ssize", OLD_RANGER),
    ("sview", OLD_RANGER),
    ("sraycount", OLD_RANGER),
    ("view", "Stage itself knows no such key; use `range` and `fov`"),
    ("blocks", "Stage itself no longer knows this key; use `block( … )`"),
    ("noblocks", "it is only heeded with the value 1"),
];

const DRAWN: &str = "it only changes what Stage draws";
const RUN: &str = "how a world is run is not said in its file here";
const ENERGY: &str = "there is no energy here: batteries are never empty";
const OLD_RANGER: &str = "Stage itself no longer knows this key; use `sensor( … )`";

/// What to say of a key that nobody has asked for.
pub(super) fn why_unused(key: &str) -> &'static str {
    let indexed = key.split('[').next().unwrap_or(key);
    if let Some((_, why)) = KEYS_LEFT_OUT.iter().find(|(known, _)| *known == indexed) {
        return why;
    }
    match indexed {
        "spose" | "spose3" => OLD_RANGER,
        indexed if indexed.starts_with("block") => "Stage itself no longer knows this key; use `block( … )`",
        _ => {
            "neither this kind of thing nor this simulator knows the key; Stage ignores such keys in silence"
        }
    }
}
