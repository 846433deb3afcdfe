//! A graph of routes in the GeoJSON of `nav2_route`, whose edges are open with a probability.

use crate::outlook::{Outlook, Stop};
use interfaces::FARTHEST_M;
use mapper::Waiting;
use nalgebra::Point2;
use serde_json::{Map, Value, json};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

/// What a way costs that is blocked, stays so, and has no way round, m: much, and not infinitely much.
const FAR_M: f64 = 1000.0;
/// An edge is no part of the way round another one if the same thing blocks it with at least this part of the probability.
const SAME_BLOCKED: f64 = 0.5;
/// An edge that is open with a smaller probability is closed, if no wait is worth it: its cost would be more than ten times its length.
const CLOSED_BELOW: f64 = 0.1;
/// An edge that is open with a smaller probability is no part of a detour.
const DETOUR_OPEN: f64 = 0.5;
/// Without a way round, a wait is worth it if half of all waits are over after this time, s.
const LONG_S: f64 = 600.0;

/// The error for a graph that cannot be used, in one sentence.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct RouteGraphError(String);

/// How a body travels.
#[derive(Clone, Copy, Debug)]
pub struct Travel {
    /// When it departs, s.
    pub departure_s: f64,
    /// Its speed, m/s.
    pub speed_m_s: f64,
    /// Its radius, m.
    pub radius_m: f64,
}

/// An edge at the time at which the robot comes to it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EdgeOutlook {
    /// The position of the edge among the features.
    position: usize,
    /// The number of the edge.
    pub id: u64,
    /// Its length, m.
    pub length_m: f64,
    /// The time of arrival at its start, s.
    pub arrival_s: f64,
    /// The probability that it is open then.
    pub open: f64,
    /// How much longer the best way over other edges takes, s; infinite without a known one.
    pub detour_s: f64,
    /// How long to wait in front of what most probably blocks it, before the detour is taken, s; infinite where there is none. `None` where
    /// it is not known how long it blocks, or without a detour, if it probably blocks for long.
    pub patience_s: Option<f64>,
    /// The expected loss by waits and ways round, as a length, m.
    loss_m: f64,
    /// What can stop the body, and for how long; `None` where nothing is known of that.
    stops: Vec<(Stop, Option<Waiting>)>,
}

impl EdgeOutlook {
    /// The length that costs as much time as is expected of the edge, m: what blocks it is waited for, or costs the way round, whichever is
    /// less; the way round where nothing is known of how long it blocks, and a kilometer without a known way round.
    pub fn cost_m(&self) -> f64 {
        self.length_m + self.loss_m
    }

    /// Whether nobody should take it: it is most probably blocked, and no wait for the contrary is worth it.
    pub fn is_closed(&self) -> bool {
        self.open < CLOSED_BELOW && self.patience_s.is_none_or(|patience_s| patience_s == 0.0)
    }

    /// Sets the length that costs as much time as the way over other edges, m, and what follows from it.
    fn set_detour(&mut self, detour_m: f64, speed_m_s: f64) {
        self.detour_s = (detour_m - self.length_m).max(0.0) / speed_m_s;
        let most = self.stops.iter().max_by(|(a, _), (b, _)| a.blocked.total_cmp(&b.blocked));
        let is_worth = |waiting: &&Waiting| detour_m.is_finite() || waiting.lasts(LONG_S) < 0.5;
        let waiting = most.and_then(|(_, waiting)| waiting.as_ref()).filter(is_worth);
        self.patience_s = waiting.map(|waiting| waiting.patience_s(self.detour_s));
        let round_s = self.detour_s.min(FAR_M / speed_m_s);
        let loss_s = |(stop, waiting): &(Stop, Option<Waiting>)| {
            stop.blocked * waiting.as_ref().map_or(round_s, |waiting| waiting.best_s(round_s))
        };
        self.loss_m = speed_m_s * self.stops.iter().map(loss_s).sum::<f64>().min(round_s);
    }
}

/// An edge: its position in the features, its number, and the nodes where it starts and ends.
#[derive(Clone, Copy, Debug)]
struct Edge {
    position: usize,
    id: u64,
    ends: [usize; 2],
}

/// A graph of routes.
#[derive(Clone, Debug)]
pub struct RouteGraph {
    content: Value,
    /// The positions of the nodes among all nodes, by their numbers.
    numbers: BTreeMap<u64, usize>,
    nodes: Vec<Point2<f64>>,
    edges: Vec<Edge>,
    /// The edges that start at each node.
    starting: Vec<Vec<usize>>,
}

fn error<T>(text: impl Into<String>) -> Result<T, RouteGraphError> {
    Err(RouteGraphError(text.into()))
}

impl RouteGraph {
    /// The longest file of a graph or a route, bytes.
    pub const MAX_BYTES: u64 = 16 << 20;

    /// The graph in the text of a file.
    ///
    /// # Errors
    ///
    /// When it is no GeoJSON, or no graph of `nav2_route`.
    pub fn parse(text: &str) -> Result<Self, RouteGraphError> {
        match serde_json::from_str(text) {
            Ok(content) => Self::of(content),
            Err(why) => error(format!("this is not GeoJSON: {why}")),
        }
    }

    /// The graph in GeoJSON.
    ///
    /// # Errors
    ///
    /// When it is no graph of `nav2_route`.
    pub fn of(content: Value) -> Result<Self, RouteGraphError> {
        let Some(features) = content["features"].as_array() else {
            return error("it has no list `features`");
        };
        let (mut numbers, mut nodes, mut ends) = (BTreeMap::new(), Vec::new(), Vec::new());
        for (position, feature) in features.iter().enumerate() {
            let properties = &feature["properties"];
            let id = |key: &str| match properties[key].as_u64() {
                Some(id) => Ok(id),
                None => error(format!("feature {position} has no number `properties.{key}`")),
            };
            let own = id("id")?;
            match feature["geometry"]["type"].as_str() {
                Some("Point") => {
                    let at = &feature["geometry"]["coordinates"];
                    let Some((x, y)) = at[0].as_f64().zip(at[1].as_f64()) else {
                        return error(format!(
                            "node {own} needs `geometry.coordinates` of two numbers, as [1.5, 2.0]"
                        ));
                    };
                    if [x, y].iter().any(|at_m| at_m.abs() > FARTHEST_M) {
                        return error(format!(
                            "node {own} is at [{x}, {y}]: coordinates must be from -{FARTHEST_M} to {FARTHEST_M} m"
                        ));
                    }
                    if numbers.insert(own, nodes.len()).is_some() {
                        return error(format!("node {own} is there twice"));
                    }
                    nodes.push(Point2::new(x, y));
                }
                Some("MultiLineString" | "LineString") => {
                    ends.push((position, own, [id("startid")?, id("endid")?]));
                }
                other => {
                    return error(format!(
                        "feature {position} is a {}: nodes are Point, edges MultiLineString",
                        other.unwrap_or("thing without `geometry.type`")
                    ));
                }
            }
        }
        let (mut edges, mut starting) = (Vec::new(), vec![Vec::new(); nodes.len()]);
        for (position, id, ends) in ends {
            let [Some(start), Some(end)] = ends.map(|end| numbers.get(&end).copied()) else {
                let missing = ends.iter().find(|end| !numbers.contains_key(end)).unwrap_or(&0);
                return error(format!("feature {position} joins node {missing}, which is not in the graph"));
            };
            starting[start].push(edges.len());
            edges.push(Edge { position, id, ends: [start, end] });
        }
        if edges.is_empty() {
            return error("it has no edge, a feature with the geometry MultiLineString");
        }
        Ok(Self { content, numbers, nodes, edges, starting })
    }

    /// The numbers of the edges.
    pub fn edges(&self) -> impl Iterator<Item = u64> {
        self.edges.iter().map(|edge| edge.id)
    }

    /// The length of an edge, m.
    fn length_m(&self, [start, end]: [usize; 2]) -> f64 {
        (self.nodes[end] - self.nodes[start]).norm()
    }

    /// The costs of the best ways from a node to all nodes, or to those that are nearer than `to`, m (Dijkstra); infinite where there is
    /// none. `cost_m`: that of an edge, `None` if it is no way.
    fn ways_m(&self, from: usize, to: Option<usize>, cost_m: impl Fn(usize) -> Option<f64>) -> Vec<f64> {
        let mut ways_m = vec![f64::INFINITY; self.nodes.len()];
        ways_m[from] = 0.0;
        // The bits of positive numbers are in the order of the numbers.
        let mut next = BinaryHeap::from([Reverse((0.0_f64.to_bits(), from))]);
        while let Some(Reverse((way_m, node))) = next.pop().filter(|Reverse((_, node))| to != Some(*node)) {
            let way_m = f64::from_bits(way_m);
            for &edge in &self.starting[node] {
                let (Some(cost_m), [_, end]) = (cost_m(edge), self.edges[edge].ends) else { continue };
                if way_m + cost_m < ways_m[end] {
                    ways_m[end] = way_m + cost_m;
                    next.push(Reverse((ways_m[end].to_bits(), end)));
                }
            }
        }
        ways_m
    }

    /// The edges at the times of arrival, on the ways of the least expected time. Edges that were never seen, and those that cannot be
    /// reached, are left out. Without a node to start from, every edge is met at the departure.
    ///
    /// # Errors
    ///
    /// When the graph has no such node.
    pub fn outlook(
        &self,
        outlook: &Outlook<'_>,
        travel: Travel,
        from: Option<u64>,
    ) -> Result<Vec<EdgeOutlook>, RouteGraphError> {
        let missing = |from: u64| RouteGraphError(format!("--from {from}: the graph has no such node"));
        let number = |from: u64| self.numbers.get(&from).copied().ok_or_else(|| missing(from));
        let start = from.map(number).transpose()?;
        let mut known: Vec<Option<EdgeOutlook>> = vec![None; self.edges.len()];
        // The times of arrival follow from the costs, and the costs from the times of arrival.
        for _ in 0..=usize::from(start.is_some()) {
            let length_m = |edge: usize| self.length_m(self.edges[edge].ends);
            let cost_m = |edge: usize| Some(known[edge].as_ref().map_or(length_m(edge), EdgeOutlook::cost_m));
            let ways_m = start.map_or(vec![0.0; self.nodes.len()], |start| self.ways_m(start, None, cost_m));
            let way_m = |edge: &Edge| Some(ways_m[edge.ends[0]]).filter(|way_m| way_m.is_finite());
            known = self.edges.iter().map(|edge| self.edge(edge, outlook, travel, way_m(edge)?)).collect();
            // A detour can have doors with detours of their own.
            for _ in 0..2 {
                let detours_m: Vec<f64> =
                    (0..known.len()).map(|number| self.detour_m(number, &known)).collect();
                for (edge, detour_m) in known.iter_mut().zip(detours_m) {
                    edge.iter_mut().for_each(|edge| edge.set_detour(detour_m, travel.speed_m_s));
                }
            }
        }
        Ok(known.into_iter().flatten().collect())
    }

    /// The edge with a position among all edges, met at the departure, as if there were no way round it; `None` if it was never seen, or
    /// if there is none.
    pub fn edge_outlook(&self, number: usize, outlook: &Outlook<'_>, travel: Travel) -> Option<EdgeOutlook> {
        self.edge(self.edges.get(number)?, outlook, travel, 0.0)
    }

    /// Finds the way round an edge. `known`: all edges.
    pub fn expect(&self, number: usize, known: &mut [Option<EdgeOutlook>], travel: Travel) {
        let detour_m = self.detour_m(number, known);
        known[number].iter_mut().for_each(|edge| edge.set_detour(detour_m, travel.speed_m_s));
    }

    /// The cost of the way round an edge, m, over edges that were seen, are probably open, and are not blocked by the same thing; infinite
    /// where there is none, and of an edge that needs none.
    fn detour_m(&self, number: usize, known: &[Option<EdgeOutlook>]) -> f64 {
        let Some(edge) = known[number].as_ref().filter(|edge| edge.open < 1.0) else { return f64::INFINITY };
        let blocks_both = |(stop, _): &(Stop, Option<Waiting>)| {
            let same = edge.stops.iter().filter(|(own, _)| own.is_same(stop));
            same.into_iter().any(|(own, _)| stop.blocked >= SAME_BLOCKED * own.blocked)
        };
        let cost_m = |other: usize| {
            let known = known[other].as_ref().filter(|known| other != number && known.open >= DETOUR_OPEN)?;
            (!known.stops.iter().any(blocks_both)).then(|| known.cost_m())
        };
        let [start, end] = self.edges[number].ends;
        self.ways_m(start, Some(end), cost_m)[end]
    }

    fn edge(&self, edge: &Edge, outlook: &Outlook<'_>, travel: Travel, way_m: f64) -> Option<EdgeOutlook> {
        let arrival_s = travel.departure_s + way_m / travel.speed_m_s;
        let at_s = |way_m: f64| arrival_s + way_m / travel.speed_m_s;
        let line = edge.ends.map(|node| self.nodes[node]);
        let stops = outlook.stops(line, travel.radius_m, at_s)?;
        let stops: Vec<_> = stops.into_iter().map(|stop| (stop, outlook.waiting(&stop))).collect();
        let open = 1.0 - stops.iter().fold(0.0, |most, (stop, _)| stop.blocked.max(most));
        let (position, id, length_m) = (edge.position, edge.id, self.length_m(edge.ends));
        let mut edge =
            EdgeOutlook { position, id, length_m, arrival_s, open, stops, ..EdgeOutlook::default() };
        edge.set_detour(f64::INFINITY, travel.speed_m_s);
        Some(edge)
    }

    /// The GeoJSON with the probability that each edge is open, at the time of arrival, in its metadata, and with its
    /// [cost](EdgeOutlook::cost_m). Other edges stay as they are.
    pub fn with(mut self, edges: &[EdgeOutlook]) -> Value {
        for edge in edges {
            let properties = &mut self.content["features"][edge.position]["properties"];
            if !properties["metadata"].is_object() {
                properties["metadata"] = Value::Object(Map::new());
            }
            properties["metadata"]["open_probability"] = json!(edge.open);
            properties["metadata"]["arrival_s"] = json!(edge.arrival_s);
            if let Some(patience_s) = edge.patience_s {
                // JSON has no infinite numbers: they become null.
                properties["metadata"]["patience_s"] = json!(patience_s);
                properties["metadata"]["detour_s"] = json!(edge.detour_s);
            }
            properties["cost"] = json!(edge.cost_m());
            properties["overridable"] = json!(false); // or the scorers of edges would replace the cost
        }
        self.content
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::watched;
    use interfaces::GridFrame;
    use mapper::Mapper;

    fn node(id: u64, x: f64, y: f64) -> Value {
        json!({"type": "Feature", "properties": {"id": id, "frame": "map"},
            "geometry": {"type": "Point", "coordinates": [x, y]}})
    }

    fn edge(id: u64, startid: u64, endid: u64) -> Value {
        json!({"type": "Feature", "geometry": {"type": "MultiLineString"},
            "properties": {"id": id, "startid": startid, "endid": endid, "cost": 0.0, "overridable": true}})
    }

    fn graph(features: Vec<Value>) -> Result<RouteGraph, RouteGraphError> {
        RouteGraph::of(json!({"type": "FeatureCollection", "features": features}))
    }

    #[test]
    fn ways_are_the_shortest_ones_along_the_edges() {
        let nodes = [node(0, 0.0, 0.0), node(1, 3.0, 0.0), node(2, 3.0, 4.0), node(7, 9.0, 9.0)];
        let edges = [edge(10, 0, 1), edge(11, 1, 2), edge(12, 0, 2), edge(13, 7, 0)];
        let graph = graph([&nodes[..], &edges].concat()).unwrap();
        let length_m = |edge: usize| Some(graph.length_m(graph.edges[edge].ends));
        assert_eq!(
            graph.ways_m(0, None, length_m),
            [0.0, 3.0, 5.0, f64::INFINITY],
            "an edge has one direction"
        );
        assert_eq!(graph.ways_m(0, Some(1), length_m)[..2], [0.0, 3.0]);
        assert_eq!(graph.ways_m(0, None, |edge| length_m(edge).filter(|_| edge != 2))[2], 7.0);
    }

    #[test]
    fn other_graphs_are_refused_with_a_sentence() {
        let refused = |features| graph(features).err().unwrap().to_string();
        let cases = [
            (vec![node(0, 0.0, 0.0)], "it has no edge, a feature with the geometry MultiLineString"),
            (vec![node(0, 0.0, 0.0), edge(1, 0, 5)], "feature 1 joins node 5, which is not in the graph"),
            (vec![json!({"properties": {}})], "feature 0 has no number `properties.id`"),
            (vec![node(0, 0.0, 0.0), node(0, 1.0, 0.0)], "node 0 is there twice"),
            (
                vec![node(0, 0.0, 0.0), node(4, 0.0, -2e8)],
                "node 4 is at [0, -200000000]: coordinates must be from -1000000 to 1000000 m",
            ),
            (
                vec![json!({"properties": {"id": 1}, "geometry": {"type": "Polygon"}})],
                "feature 0 is a Polygon: nodes are Point, edges MultiLineString",
            ),
        ];
        for (features, expected) in cases {
            assert_eq!(refused(features), expected);
        }
    }

    /// Two rooms of 3 m, seen once per second: a wall with a door (y from 1.0 to 1.5 m) and a passage (from 3.5 to 4.1 m), which changes as
    /// `passage` says. The door is closed for 20 s, and open for 20 s.
    fn rooms(passage: impl Fn(u32) -> bool) -> Mapper {
        let frame = GridFrame::new(Point2::origin(), 0.1, 60, 45).unwrap();
        watched(frame, 620, |cell, time| match (cell.x, cell.y) {
            (30, 10..15) => (time / 20).is_multiple_of(2),
            (30, 35..41) => passage(time),
            (x, y) => x == 30 || [0, 59].contains(&x) || [0, 44].contains(&y),
        })
    }

    /// Through the door, around through the passage, through the door once more, and through the wall.
    fn of_rooms() -> RouteGraph {
        let nodes =
            [(0, 2.0, 1.2), (1, 4.0, 1.2), (2, 2.0, 3.8), (3, 4.0, 3.8), (4, 2.0, 2.5), (5, 4.0, 2.5)];
        let edges = [(0, 1), (0, 2), (2, 3), (3, 1), (0, 1), (4, 5), (4, 2), (3, 5)];
        let nodes = nodes.map(|(id, x, y)| node(id, x, y));
        let edges = (10..).zip(edges).map(|(id, (start, end))| edge(id, start, end)).collect();
        graph([nodes.to_vec(), edges].concat()).unwrap()
    }

    fn asked(mapper: &Mapper, graph: &RouteGraph, speed_m_s: f64) -> Vec<EdgeOutlook> {
        let outlook = Outlook::live(mapper);
        let travel = Travel { departure_s: outlook.now_s(), speed_m_s, radius_m: 0.1 };
        graph.outlook(&outlook, travel, None).unwrap()
    }

    #[test]
    fn a_closed_door_costs_the_wait_or_the_way_round_whichever_is_less() {
        let (mapper, graph) = (rooms(|_| false), of_rooms());
        // 5.2 m more around: a second at 5 m/s, and nearly two minutes at 0.05 m/s. The door is closed for about 20 s.
        let [fast, slow] = [5.0, 0.05].map(|speed_m_s| asked(&mapper, &graph, speed_m_s));
        assert!((fast[0].detour_s - 1.04).abs() < 1e-6, "not over the same door: {:?}", fast[0]);
        assert!(fast[0].is_closed() && fast[0].patience_s == Some(0.0), "{:?}", fast[0]);
        assert!((fast[0].cost_m() - 7.2).abs() < 0.2, "{:?}", fast[0]);
        assert!(!slow[0].is_closed() && slow[0].patience_s > Some(20.0), "{:?}", slow[0]);
        assert!((2.2..3.5).contains(&slow[0].cost_m()), "2 m, and at most 1 m for 20 s: {:?}", slow[0]);
        for edges in [&fast, &slow] {
            assert_eq!([1, 2, 3].map(|edge| (edges[edge].open, edges[edge].is_closed())), [(1.0, false); 3]);
            let wall = &edges[5];
            assert!(wall.is_closed() && wall.patience_s.is_none(), "{wall:?}");
            assert!(wall.cost_m() >= 1.3 + 2.0 + 1.3, "no less than the real way: {wall:?}");
        }
    }

    #[test]
    fn what_is_probably_closed_is_no_way_round() {
        let graph = of_rooms();
        // A passage that changes as the door does, and one that people pass all the time.
        for passage in [|time: u32| (time / 20).is_multiple_of(2), |time: u32| !time.is_multiple_of(3)] {
            let edges = asked(&rooms(passage), &graph, 0.5);
            assert!(edges[2].open < 0.5, "{:?}", edges[2]);
            let door = &edges[0];
            assert!(door.detour_s == f64::INFINITY && door.patience_s == Some(f64::INFINITY), "{door:?}");
            assert!(
                !door.is_closed() && (7.0..30.0).contains(&door.cost_m()),
                "2 m, and 10 m for 20 s: {door:?}"
            );
        }
        // Where nothing is known of how long it is blocked, the edge is closed.
        let edges = asked(&rooms(|time| time > 617), &graph, 5.0);
        assert!(edges[2].is_closed() && edges[2].patience_s.is_none(), "{:?}", edges[2]);
    }

    /// By the times of arrival on the ways of the least expected time: around, not through the door.
    #[test]
    fn the_way_of_the_least_expected_time_is_not_the_shortest_one() {
        let (mapper, graph) = (rooms(|_| false), of_rooms());
        let outlook = Outlook::live(&mapper);
        let travel = Travel { departure_s: outlook.now_s(), speed_m_s: 0.5, radius_m: 0.1 };
        let edges = graph.outlook(&outlook, travel, Some(0)).unwrap();
        assert!(edges.iter().all(|edge| ![15, 16].contains(&edge.id)), "{edges:?}");
        let from_3 = edges.iter().find(|edge| edge.id == 13).unwrap();
        assert!((from_3.arrival_s - travel.departure_s - 9.2).abs() < 1e-6, "{from_3:?}");
        let missing = graph.outlook(&outlook, travel, Some(9)).unwrap_err();
        assert_eq!(missing.to_string(), "--from 9: the graph has no such node");
    }
}
