//! Doors for `nav2_route`: the edges of a graph of routes, with the probability that each is open.

use super::CuriousNode;
use crate::link::Link;
use crate::message::DynamicEdges;
use crate::parameters::Parameters;
use crate::service::wire::Trigger;
use anyhow::{Context, bail};
use serde_json::{Value, json};
use std::time::{Duration, Instant};
use survey::{EdgeOutlook, Outlook, RouteGraph, Travel};

/// The number of edges in a request, so that it fits in one datagram: with CycloneDDS, a longer one is damaged as answers are
/// (`dds/services.rs`).
const MAX_EDGES: usize = 100;

/// The number of edges in an answer: it must fit in one datagram.
const MAX_ANSWERED: usize = 10;

/// The graph, and what is known of its edges.
pub(super) struct Routes {
    graph: RouteGraph,
    next_round: Instant,
    /// The number of the edge that is looked at next. One edge per reading bounds the time of a turn.
    next_edge: usize,
    /// What is known of all edges, for the ways round them.
    known: Vec<Option<EdgeOutlook>>,
    found: Vec<EdgeOutlook>,
}

impl Routes {
    /// The graph that the parameters name; `None` if they name none.
    ///
    /// # Errors
    ///
    /// When it cannot be read, or cannot be sent to `nav2_route`.
    pub(super) fn new(parameters: &Parameters) -> anyhow::Result<Option<Self>> {
        let name = &parameters.route_graph;
        if name.is_empty() {
            return Ok(None);
        }
        let text = files::read_text(name.as_ref(), RouteGraph::MAX_BYTES)
            .with_context(|| format!("{name}: cannot read it"))?;
        let graph =
            RouteGraph::parse(&text).with_context(|| format!("{name}: this is no graph of nav2_route"))?;
        if let Some(id) = graph.edges().find(|id| u16::try_from(*id).is_err()) {
            bail!("{name}: edge {id}: the service DynamicEdges has numbers up to 65535");
        }
        let known = vec![None; graph.edges().count()];
        Ok(Some(Self { graph, next_round: Instant::now(), next_edge: 0, known, found: Vec::new() }))
    }

    /// Looks at the next edge. Returns a request when `MAX_EDGES` wait for it, and after the last edge. Each round sends all edges
    /// that were ever seen, so that a server that has started anew knows them as well.
    fn next(
        &mut self,
        outlook: &Outlook<'_>,
        travel: Travel,
        now: Instant,
        interval_s: f64,
    ) -> Option<DynamicEdges> {
        if now < self.next_round {
            return None;
        }
        self.known[self.next_edge] = self.graph.edge_outlook(self.next_edge, outlook, travel);
        self.graph.expect(self.next_edge, &mut self.known, travel);
        self.found.extend(self.known[self.next_edge].clone());
        self.next_edge += 1;
        let is_last = self.next_edge >= self.known.len();
        if is_last {
            self.next_edge = 0;
        }
        if self.found.is_empty() || !is_last && self.found.len() < MAX_EDGES {
            return None; // nothing is known of the place yet
        }
        if is_last {
            self.next_round = now + Duration::from_secs_f64(interval_s);
        }
        Some(request(&std::mem::take(&mut self.found)))
    }
}

/// How long to wait at the edges that are most probably blocked, if it is known, before the way round; JSON has `null` for “without end”
/// and “no way round”.
fn patience(known: &[Option<EdgeOutlook>]) -> Value {
    let waits = |edge: &&EdgeOutlook| edge.open < 1.0 && edge.patience_s.is_some();
    let mut blocked: Vec<_> = known.iter().flatten().filter(waits).collect();
    blocked.sort_by(|a, b| a.open.total_cmp(&b.open));
    let rounded = |value: f64| (100.0 * value).round() / 100.0;
    let row = |edge: &&EdgeOutlook| {
        let (patience_s, detour_s) = (edge.patience_s.map(rounded), rounded(edge.detour_s));
        json!({"edge": edge.id, "open": rounded(edge.open), "patience_s": patience_s, "detour_s": detour_s})
    };
    blocked.iter().take(MAX_ANSWERED).map(row).collect()
}

fn request(found: &[EdgeOutlook]) -> DynamicEdges {
    let id = |edge: &EdgeOutlook| edge.id as u16;
    DynamicEdges {
        closed: found.iter().filter(|edge| edge.is_closed()).map(id).collect(),
        opened: found.iter().filter(|edge| !edge.is_closed()).map(id).collect(),
        // `nav2_route` adds this to what its other scorers say, of which one is the length.
        adjusted: found.iter().map(|edge| (id(edge), (edge.cost_m() - edge.length_m) as f32)).collect(),
    }
}

impl<L: Link> CuriousNode<L> {
    /// Tells `nav2_route` which edges are open, now and then.
    pub(super) fn publish_edges(&mut self, now: Instant) {
        let Some(routes) = &mut self.routes else { return };
        let outlook = Outlook::live(&self.robot.mapper);
        let travel = Travel {
            departure_s: outlook.now_s() + self.parameters.prediction_horizon_s,
            speed_m_s: self.parameters.max_vel_x_mps,
            radius_m: self.parameters.robot_radius_m,
        };
        if let Some(edges) = routes.next(&outlook, travel, now, self.parameters.route_update_interval_s) {
            self.link.adjust_edges(edges);
        }
    }

    /// How long to wait at the edges that are probably blocked, as JSON.
    pub(super) fn patience(&self) -> Trigger {
        let none = || "there is no graph of routes: give one by the parameter `route_graph`".to_owned();
        let text = self.routes.as_ref().map(|routes| patience(&routes.known).to_string());
        Trigger { is_done: text.is_some(), text: text.unwrap_or_else(none) }
    }

    /// Says once in a while that the edges are not adjusted.
    pub(super) fn note_edges(&mut self, are_adjusted: bool, now: Instant) {
        if !are_adjusted {
            let service = &self.parameters.route_edges_service;
            self.notes
                .note(&format!("the edges of the routes are not adjusted: `{service}` does not answer"), now);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_door_that_is_closed_closes_its_edge() {
        let graph = r#"{"features": [
            {"properties": {"id": 0}, "geometry": {"type": "Point", "coordinates": [0, 0]}},
            {"properties": {"id": 1}, "geometry": {"type": "Point", "coordinates": [2, 0]}},
            {"properties": {"id": 7, "startid": 0, "endid": 1}, "geometry": {"type": "LineString"}}]}"#;
        let graph = RouteGraph::parse(graph).unwrap();
        let mapper = crate::maps::tests::corridor();
        let outlook = Outlook::live(&mapper);
        let travel = Travel { departure_s: outlook.now_s(), speed_m_s: 0.5, radius_m: 0.1 };
        let open = graph.edge_outlook(0, &outlook, travel).unwrap();
        assert!(open.open < 1.0, "{open:?}");
        // Nothing is known of how long it lasts, nor of a way round.
        let loss_m = 1000.0 * (1.0 - open.open) as f32;
        let (mut closed, mut half) = (open.clone(), open);
        (closed.open, half.open, half.id) = (0.05, 0.5, 8);
        let mut waits = half.clone();
        (waits.patience_s, waits.detour_s) = (Some(f64::INFINITY), 20.123);
        let answer = patience(&[None, Some(closed.clone()), Some(waits)]).to_string();
        assert_eq!(answer, r#"[{"detour_s":20.12,"edge":8,"open":0.5,"patience_s":null}]"#);
        let sent = request(&[closed, half]);
        assert_eq!((sent.closed, sent.opened), (vec![7], vec![8]));
        assert!(
            sent.adjusted.iter().all(|(_, more_m)| (more_m - loss_m).abs() < 1e-2),
            "{:?}",
            sent.adjusted
        );
    }
}
