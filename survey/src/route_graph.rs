//! A graph of routes in the GeoJSON of `nav2_route`, whose edges are open with a probability.

use crate::outlook::Outlook;
use interfaces::FARTHEST_M;
use nalgebra::Point2;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// P(open) in the cost of an edge is at least this: a way that is probably blocked costs much, and not infinitely much.
const MIN_OPEN: f64 = 0.01;

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
#[derive(Clone, Copy, Debug, PartialEq)]
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
}

impl EdgeOutlook {
    /// The length that costs as much as the edge and what a closed one costs, m: its length divided by P(open).
    pub fn cost_m(&self) -> f64 {
        self.length_m / self.open.max(MIN_OPEN)
    }
}

/// An edge: its position in the features, its number, and where it starts and ends.
#[derive(Clone, Copy, Debug)]
struct Edge {
    position: usize,
    id: u64,
    ends: [u64; 2],
}

/// A graph of routes.
#[derive(Clone, Debug)]
pub struct RouteGraph {
    content: Value,
    nodes: BTreeMap<u64, Point2<f64>>,
    edges: Vec<Edge>,
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
        let (mut nodes, mut edges) = (BTreeMap::new(), Vec::new());
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
                    if nodes.insert(own, Point2::new(x, y)).is_some() {
                        return error(format!("node {own} is there twice"));
                    }
                }
                Some("MultiLineString" | "LineString") => {
                    edges.push(Edge { position, id: own, ends: [id("startid")?, id("endid")?] });
                }
                other => {
                    return error(format!(
                        "feature {position} is a {}: nodes are Point, edges MultiLineString",
                        other.unwrap_or("thing without `geometry.type`")
                    ));
                }
            }
        }
        for Edge { position, ends, .. } in &edges {
            if let Some(end) = ends.iter().find(|end| !nodes.contains_key(end)) {
                return error(format!("feature {position} joins node {end}, which is not in the graph"));
            }
        }
        if edges.is_empty() {
            return error("it has no edge, a feature with the geometry MultiLineString");
        }
        Ok(Self { content, nodes, edges })
    }

    /// The numbers of the edges.
    pub fn edges(&self) -> impl Iterator<Item = u64> {
        self.edges.iter().map(|edge| edge.id)
    }

    /// The length of an edge, m.
    fn length_m(&self, [start, end]: [u64; 2]) -> f64 {
        (self.nodes[&end] - self.nodes[&start]).norm()
    }

    /// The shortest ways to the nodes, m; without a node to start from, the body is everywhere at once.
    fn ways_m(&self, from: Option<u64>) -> Result<BTreeMap<u64, f64>, RouteGraphError> {
        let Some(from) = from else { return Ok(self.nodes.keys().map(|node| (*node, 0.0)).collect()) };
        if !self.nodes.contains_key(&from) {
            return error(format!("--from {from}: the graph has no such node"));
        }
        let mut ways_m = BTreeMap::from([(from, 0.0)]);
        // As often as there are nodes at most (Bellman and Ford): route graphs are small.
        for _ in 0..self.nodes.len() {
            let mut is_done = true;
            for Edge { ends, .. } in &self.edges {
                let Some(start_m) = ways_m.get(&ends[0]) else { continue };
                let way_m = start_m + self.length_m(*ends);
                if ways_m.get(&ends[1]).is_none_or(|known_m| way_m < known_m - 1e-9) {
                    ways_m.insert(ends[1], way_m);
                    is_done = false;
                }
            }
            if is_done {
                break;
            }
        }
        Ok(ways_m)
    }

    /// The edges at the times of arrival. Edges that were never seen, and those that cannot be reached, are left out. Without a node to
    /// start from, every edge is met at the departure.
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
        let ways_m = self.ways_m(from)?;
        let of = |edge: &Edge| self.edge(edge, outlook, travel, *ways_m.get(&edge.ends[0])?);
        Ok(self.edges.iter().filter_map(of).collect())
    }

    /// The edge with a position among all edges, met at the departure; `None` if it was never seen, or if there is none.
    pub fn edge_outlook(&self, number: usize, outlook: &Outlook<'_>, travel: Travel) -> Option<EdgeOutlook> {
        self.edge(self.edges.get(number)?, outlook, travel, 0.0)
    }

    fn edge(&self, edge: &Edge, outlook: &Outlook<'_>, travel: Travel, way_m: f64) -> Option<EdgeOutlook> {
        let arrival_s = travel.departure_s + way_m / travel.speed_m_s;
        let at_s = |way_m: f64| arrival_s + way_m / travel.speed_m_s;
        let line = edge.ends.map(|node| self.nodes[&node]);
        let open = 1.0 - outlook.stopped(line, travel.radius_m, at_s)?;
        let (position, id, length_m) = (edge.position, edge.id, self.length_m(edge.ends));
        Some(EdgeOutlook { position, id, length_m, arrival_s, open })
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
            properties["cost"] = json!(edge.cost_m());
            properties["overridable"] = json!(false); // or the scorers of edges would replace the cost
        }
        self.content
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let ways_m = graph.ways_m(Some(0)).unwrap();
        assert_eq!(ways_m, BTreeMap::from([(0, 0.0), (1, 3.0), (2, 5.0)]), "an edge has one direction");
        assert_eq!(graph.ways_m(Some(3)).unwrap_err().to_string(), "--from 3: the graph has no such node");
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
}
