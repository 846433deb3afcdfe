//! A route, and a graph of routes, at the times of arrival.

use anyhow::{Context, anyhow, bail, ensure};
use nalgebra::Point2;
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::path::Path;
use survey::Forecast;

/// P(open) in the cost of an edge is at least this: a way that is probably blocked costs much, and not infinitely much.
const MIN_OPEN: f64 = 0.01;

/// How a body travels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Travel {
    /// When it departs, s.
    pub(crate) departure_s: f64,
    pub(crate) speed_m_s: f64,
    pub(crate) radius_m: f64,
}

/// A point of a route.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Stop {
    pub(crate) x_m: f64,
    pub(crate) y_m: f64,
    /// The time of arrival, s.
    pub(crate) time_s: f64,
    /// The probability that the way to it is blocked then; `null` if it was never seen.
    pub(crate) blocked: Option<f64>,
}

/// The points of the route in a file: a line for each, with x and y (m), or with time (s), x and y, as in a TUM trajectory.
pub(crate) fn route(path: &Path, forecast: &Forecast, travel: Travel) -> anyhow::Result<Vec<Stop>> {
    let text =
        std::fs::read_to_string(path).with_context(|| format!("{}: cannot read it", path.display()))?;
    let mut points: Vec<(Option<f64>, Point2<f64>)> = Vec::new();
    for (number, line) in (1..).zip(text.lines().map(str::trim)) {
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let values = line.split([',', ' ', '\t', ';']).filter(|word| !word.is_empty());
        let numbers: Result<Vec<f64>, _> = values.map(str::parse::<f64>).collect();
        match numbers.as_deref() {
            Ok([x, y]) => points.push((None, Point2::new(*x, *y))),
            Ok([time_s, x, y, ..]) => points.push((Some(*time_s), Point2::new(*x, *y))),
            Err(_) if points.is_empty() => {} // the names of the columns
            _ => bail!("{}, line {number}: a point is `x y` or `time x y`, as in 1.5 2.0", path.display()),
        }
        let last = points.last().map(|(_, at)| at.coords.norm());
        ensure!(
            last.is_none_or(f64::is_finite),
            "{}, line {number}: coordinates must be finite numbers",
            path.display()
        );
    }
    ensure!(points.len() >= 2, "{}: a route needs at least two points", path.display());
    let (begin_s, mut before, mut time_s) = (points[0].0, points[0].1, travel.departure_s);
    let stops = points.into_iter().map(|(own_s, at)| {
        let from_s = time_s;
        let length_m = (at - before).norm();
        time_s = match own_s.zip(begin_s) {
            Some((own_s, begin_s)) => travel.departure_s + own_s - begin_s,
            None => time_s + length_m / travel.speed_m_s,
        };
        let arrival_s = |way_m: f64| from_s + (time_s - from_s) * way_m / length_m.max(1e-9);
        let blocked = forecast.stopped([before, at], travel.radius_m, arrival_s);
        before = at;
        Stop { x_m: at.x, y_m: at.y, time_s, blocked }
    });
    Ok(stops.collect())
}

/// A graph of routes in the GeoJSON of `nav2_route`, whose edges say with which probability they are open.
pub(crate) struct Graph {
    content: Value,
    nodes: BTreeMap<u64, Point2<f64>>,
    /// The edges: their positions in the features, and where they start and end.
    edges: Vec<(usize, [u64; 2])>,
}

impl Graph {
    pub(crate) fn read(path: &Path) -> anyhow::Result<Self> {
        let name = path.display();
        let text = std::fs::read_to_string(path).with_context(|| format!("{name}: cannot read it"))?;
        let content: Value =
            serde_json::from_str(&text).map_err(|why| anyhow!("{name}: this is not GeoJSON: {why}"))?;
        Self::of(content).with_context(|| format!("{name}: this is no graph of nav2_route"))
    }

    fn of(content: Value) -> anyhow::Result<Self> {
        let features = content["features"].as_array().context("it has no list `features`")?;
        let (mut nodes, mut edges) = (BTreeMap::new(), Vec::new());
        for (number, feature) in features.iter().enumerate() {
            let properties = &feature["properties"];
            let id = |key: &str| {
                properties[key]
                    .as_u64()
                    .with_context(|| format!("feature {number} has no number `properties.{key}`"))
            };
            let own = id("id")?;
            match feature["geometry"]["type"].as_str() {
                Some("Point") => {
                    let at = &feature["geometry"]["coordinates"];
                    let (x, y) = at[0].as_f64().zip(at[1].as_f64()).with_context(|| {
                        format!("node {own} needs `geometry.coordinates` of two numbers, as [1.5, 2.0]")
                    })?;
                    ensure!(nodes.insert(own, Point2::new(x, y)).is_none(), "node {own} is there twice");
                }
                Some("MultiLineString") => edges.push((number, [id("startid")?, id("endid")?])),
                other => bail!(
                    "feature {number} is a {}: nodes are Point, edges MultiLineString",
                    other.unwrap_or("thing without `geometry.type`")
                ),
            }
        }
        for (number, ends) in &edges {
            if let Some(end) = ends.iter().find(|end| !nodes.contains_key(end)) {
                bail!("feature {number} joins node {end}, which is not in the graph");
            }
        }
        ensure!(!edges.is_empty(), "it has no edge, a feature with the geometry MultiLineString");
        Ok(Self { content, nodes, edges })
    }

    /// The length of an edge, m.
    fn length_m(&self, [start, end]: [u64; 2]) -> f64 {
        (self.nodes[&end] - self.nodes[&start]).norm()
    }

    /// The shortest ways to the nodes, m; without a node to start from, the body is everywhere at once.
    fn ways_m(&self, from: Option<u64>) -> anyhow::Result<BTreeMap<u64, f64>> {
        let Some(from) = from else { return Ok(self.nodes.keys().map(|node| (*node, 0.0)).collect()) };
        ensure!(self.nodes.contains_key(&from), "--from {from}: the graph has no such node");
        let mut ways_m = BTreeMap::from([(from, 0.0)]);
        // As often as there are nodes at most (Bellman and Ford): route graphs are small.
        for _ in 0..self.nodes.len() {
            let mut is_done = true;
            for (_, ends) in &self.edges {
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

    /// The graph with the probability that each edge is open, at the time of arrival, in its metadata, and with a cost: its
    /// length divided by this probability. Edges that were never seen, and those that cannot be reached, stay as they are.
    pub(crate) fn predicted(
        mut self,
        forecast: &Forecast,
        travel: Travel,
        from: Option<u64>,
    ) -> anyhow::Result<Value> {
        let ways_m = self.ways_m(from)?;
        for (number, ends) in self.edges.clone() {
            let Some(way_m) = ways_m.get(&ends[0]) else { continue };
            let arrival_s = travel.departure_s + way_m / travel.speed_m_s;
            let at_s = |way_m: f64| arrival_s + way_m / travel.speed_m_s;
            let line = ends.map(|node| self.nodes[&node]);
            let Some(blocked) = forecast.stopped(line, travel.radius_m, at_s) else { continue };
            let (open, length_m) = (1.0 - blocked, self.length_m(ends));
            let properties = &mut self.content["features"][number]["properties"];
            if !properties["metadata"].is_object() {
                properties["metadata"] = Value::Object(Map::new());
            }
            properties["metadata"]["open_probability"] = json!(open);
            properties["metadata"]["arrival_s"] = json!(arrival_s);
            properties["cost"] = json!(length_m / open.max(MIN_OPEN));
            properties["overridable"] = json!(false); // or the scorers of edges would replace the cost
        }
        Ok(self.content)
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

    fn graph(features: Vec<Value>) -> anyhow::Result<Graph> {
        Graph::of(json!({"type": "FeatureCollection", "features": features}))
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
                vec![json!({"properties": {"id": 1}, "geometry": {"type": "Polygon"}})],
                "feature 0 is a Polygon: nodes are Point, edges MultiLineString",
            ),
        ];
        for (features, expected) in cases {
            assert_eq!(refused(features), expected);
        }
    }
}
