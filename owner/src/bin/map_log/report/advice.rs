//! What to do at a place.

use owner::words::Seen;
use survey::PlaceKind;

/// From this number of passages per hour on, a robot should slow down.
const BUSY_PER_HOUR: f64 = 6.0;
/// A place that is blocked for more than this share of the time is better left out of a route.
const MOSTLY: f64 = 0.5;

/// What a robot and the owner of the building should do, each in one sentence or two.
pub(super) fn advice(
    kind: PlaceKind,
    seen: &Seen,
    share_blocked: f64,
    has_hours: bool,
    is_line: bool,
) -> Vec<(&'static str, String)> {
    let is_known = seen.is_known();
    let is_busy = seen.has_cycle && seen.per_hour.0 >= BUSY_PER_HOUR;
    let hours = if has_hours { " Plan another route at the hours above." } else { "" };
    let robot = match kind {
        PlaceKind::Door { .. } => format!("look whether the door is open before planning through it.{hours}"),
        PlaceKind::Traffic if !is_known => "slow down here, and look again.".to_owned(),
        _ if !is_known => "look again: this was not seen often enough to rely on.".to_owned(),
        _ if share_blocked > MOSTLY => {
            format!(
                "plan another route: the place is blocked {:.0} % of the time.{hours}",
                100.0 * share_blocked
            )
        }
        _ if is_busy => format!("slow down here.{hours}"),
        _ => format!("drive as usual, and expect something in the way.{hours}"),
    };
    let owner = match kind {
        PlaceKind::Object { .. } => Some("check whether it should be here.".to_owned()),
        PlaceKind::Unknown if is_known => Some("check what it is, and give the place a name.".to_owned()),
        PlaceKind::Unknown if is_line => {
            Some("check whether there is a door, or a wall that is drawn twice.".to_owned())
        }
        PlaceKind::Unknown => Some("check whether something was left here, or taken away.".to_owned()),
        PlaceKind::Traffic if is_known => Some("keep this way clear.".to_owned()),
        PlaceKind::Door { .. } | PlaceKind::Traffic => None,
    };
    [("Robot", Some(robot)), ("Owner", owner)]
        .into_iter()
        .filter_map(|(who, what)| Some((who, what?)))
        .collect()
}
