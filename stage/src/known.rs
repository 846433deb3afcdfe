//! What Stage has and this simulator has not, so that it can be named.

/// Kinds of things that are left out, and why.
pub(super) const KINDS_LEFT_OUT: [(&str, &str); 11] = [
    ("camera", "there are no cameras here"),
    ("blobfinder", "nothing here sees colours"),
    (
        "bumper",
        "Stage's are short beams that may lie anywhere; `[robot.bumper]` is a ring that feels touches",
    ),
    ("gripper", "there are no grippers here; its body is left out too"),
    ("actuator", "there are no actuators here; it and what it carries are left out"),
    ("charger", "there is no energy here"),
    ("powerpack", "there is no energy here"),
    ("power", "there is no energy here"),
    ("loadcell", "there are no load cells here"),
    ("speech", "nobody speaks here"),
    ("wifi", "there is no radio here"),
];

/// Keys and kinds of things that only say how Stage draws or runs a world, or that are about what is not here:
/// rays and contacts are on no grid here, nothing sees colours, nothing slides, in Stage neither.
const HARMLESS: [&str; 32] = [
    "window",
    "blinkenlight",
    "lightindicator",
    "color_rgba",
    "gui_nose",
    "gui_grid",
    "gui_outline",
    "gui_boundary",
    "gui_move",
    "gui_movemask",
    "trail_length",
    "trail_interval",
    "say",
    "wheel",
    "show_clock",
    "show_clock_interval",
    "threads",
    "speedup",
    "paused",
    "interval_real",
    "gui_interval",
    "gui_disable",
    "event_queue",
    "debug",
    "test",
    "resolution",
    "map_resolution",
    "alwayson",
    "blob_return",
    "blobfinder_return",
    "gripper_return",
    "friction",
];

/// Keys that Stage knows and that mean nothing here, and why.
const KEYS_LEFT_OUT: [(&str, &str); 23] = [
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
    ("odom", "Stage itself no longer knows this key"),
    ("scount", OLD_RANGER),
    ("ssize", OLD_RANGER),
    ("sview", OLD_RANGER),
    ("sraycount", OLD_RANGER),
    ("view", "Stage itself knows no such key; use `range` and `fov`"),
    ("blocks", "Stage itself no longer knows this key; use `block( … )`"),
    ("noblocks", "it is only heeded with the value 1"),
    ("size3", "Stage itself no longer knows this key; use `size`"),
    ("origin3", "Stage itself no longer knows this key; use `origin`"),
    ("pose3", "Stage itself no longer knows this key; use `pose`"),
    ("laser_sample_skip", "Stage itself no longer knows this key; use fewer `samples`"),
];

const ENERGY: &str = "there is no energy here: batteries are never empty";
const OLD_RANGER: &str = "Stage itself no longer knows this key; use `sensor( … )`";

/// A key without its index.
fn plain(key: &str) -> &str {
    key.split('[').next().unwrap_or(key)
}

/// Whether nothing changes without this key or kind of thing.
pub(super) fn is_harmless(name: &str) -> bool {
    HARMLESS.contains(&plain(name))
}

/// What to say of a key that nobody has asked for.
pub(super) fn why_unused(key: &str) -> &'static str {
    let indexed = plain(key);
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
