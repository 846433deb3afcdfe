//! The parts of Stage that this simulator does not have, so that messages can name them.

/// Kinds of entities that are left out, and why.
const KINDS: [(&str, &str); 10] = [
    ("camera", "there are no cameras here"),
    ("blobfinder", "nothing here sees colors"),
    (
        "bumper",
        "Stage's are short beams that may lie anywhere; `[robot.bumper]` is a ring that feels touches",
    ),
    ("fiducial", "nothing here finds tags"),
    ("gripper", "there are no grippers here; its body is left out too"),
    ("actuator", "there are no actuators here; it and what it carries are left out"),
    ("charger powerpack power", "there is no energy here"),
    ("loadcell", "there are no load cells here"),
    ("speech", "nobody speaks here"),
    ("wifi", "there is no radio here"),
];

/// Keys and kinds of entities that only affect how Stage draws or runs a world, or that concern something else
/// which does not exist here: rays and contacts use no grid, nothing sees colors, and nothing slides (nor does it
/// in Stage).
const NO_EFFECT: &str = "color quit_time window blinkenlight lightindicator color_rgba trail_length trail_interval say wheel \
    gui_nose gui_grid gui_outline gui_boundary gui_move gui_movemask gui_interval gui_disable show_clock \
    show_clock_interval threads speedup paused interval_real event_queue debug test resolution map_resolution \
    alwayson blob_return blobfinder_return gripper_return friction stack_children z";

/// Keys that Stage knows or knew and that mean nothing here, and why.
const KEYS: [(&str, &str); 12] = [
    ("samples_per_second", "the rate of a laser is its update_interval"),
    (
        "watts give_watts take_watts joules joules_capacity kjoules kjoules_capacity give input",
        "there is no energy here: batteries are never empty",
    ),
    ("fiducial_return fiducial_key", "nothing here finds tags"),
    ("odom", "Stage itself no longer knows this key"),
    ("scount ssize sview sraycount spose spose3", "Stage itself no longer knows this key; use `sensor( … )`"),
    ("view", "Stage itself knows no such key; use `range` and `fov`"),
    ("blocks block", "Stage itself no longer knows this key; use `block( … )`"),
    ("noblocks", "it is only heeded with the value 1"),
    ("size3", "Stage itself no longer knows this key; use `size`"),
    ("origin3", "Stage itself no longer knows this key; use `origin`"),
    ("pose3", "Stage itself no longer knows this key; use `pose`"),
    ("laser_sample_skip", "Stage itself no longer knows this key; use fewer `samples`"),
];

/// Whether a name is one of `names`, whatever its index.
fn is_one(name: &str, names: &str) -> bool {
    let plain = name.split('[').next();
    names.split_whitespace().any(|known| Some(known) == plain)
}

/// Whether nothing changes without this key or kind of entity.
pub(super) fn has_no_effect(name: &str) -> bool {
    is_one(name, NO_EFFECT)
}

/// Why a kind of entity is left out, if it is one that Stage knows.
pub(super) fn why_not_here(kind: &str) -> Option<&'static str> {
    KINDS.iter().find(|(kinds, _)| is_one(kind, kinds)).map(|(_, why)| *why)
}

/// Why nothing here has read a key.
pub(super) fn why_unused(key: &str) -> &'static str {
    let known = KEYS.iter().find(|(keys, _)| is_one(key, keys)).map(|(_, why)| *why);
    known.unwrap_or(
        "neither this kind of thing nor this simulator knows the key; Stage ignores such keys in silence",
    )
}
