//! What the node asks of others: Nav2's action NavigateToPose, and the service of `nav2_route` that closes edges and adjusts their
//! costs.

use super::{WAIT, profile};
use crate::link::Navigation;
use crate::message::{DynamicEdges, PoseStamped, Quality};
use ros2_client::action::{ActionClient, ActionClientQosPolicies, GoalId, GoalStatusEnum};
use ros2_client::qos::WhenFull;
use ros2_client::{
    ActionTypeName, Client, Message, Name, Node, RmwRequestId, ServiceMapping, ServiceTypeName,
};
use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

/// Nav2 and `nav2_route` answer at once, or they are not there.
const PATIENCE: Duration = Duration::from_secs(3);

/// The goal of `nav2_msgs/action/NavigateToPose`.
#[derive(Clone, Debug, Deserialize, Serialize)]
struct Goal {
    pose: PoseStamped,
    /// Empty: the one that Nav2 has.
    behavior_tree: String,
}

/// The result and the feedback: they differ between distributions of ROS, and nothing of them is used.
#[derive(Clone, Debug, Deserialize, Serialize)]
struct Any {}

/// A yes or no in a message.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
struct Flag(bool);

impl Message for Flag {}
impl Message for Goal {}
impl Message for Any {}
impl Message for DynamicEdges {}

/// What happens to the goal.
#[derive(Clone, Debug)]
enum State {
    Idle,
    /// The goal was sent.
    Sent {
        request: RmwRequestId,
        goal: GoalId,
        since: Instant,
    },
    /// Nav2 drives there, and will send a result.
    Accepted {
        result: RmwRequestId,
        goal: GoalId,
    },
    /// The goal could not be sent.
    Failed,
}

/// A client of the action.
pub(super) struct Navigator {
    client: ActionClient<Goal, Any, Any>,
    state: State,
}

impl Navigator {
    pub(super) fn new(node: &mut Node, name: &str, mapping: ServiceMapping) -> anyhow::Result<Self> {
        let service = profile(&Quality::DEFAULT, WhenFull::Wait(WAIT));
        let policies = ActionClientQosPolicies {
            goal_service: service.clone(),
            result_service: service.clone(),
            cancel_service: service.clone(),
            feedback_subscription: service,
            status_subscription: profile(&Quality::LATCHED, WhenFull::Fail),
        };
        let kind = ActionTypeName::new("nav2_msgs", "NavigateToPose");
        let client = node.create_action_client(mapping, &Name::parse(name)?, &kind, policies)?;
        Ok(Self { client, state: State::Idle })
    }

    /// Whether an answer is expected.
    pub(super) fn is_busy(&self) -> bool {
        !matches!(self.state, State::Idle)
    }

    /// Sends a goal; Nav2 replaces an earlier one.
    pub(super) fn send(&mut self, pose: PoseStamped) {
        let goal = Goal { pose, behavior_tree: String::new() };
        self.state = match self.client.send_goal(goal) {
            Ok((request, goal)) => State::Sent { request, goal, since: Instant::now() },
            Err(_) => State::Failed,
        };
    }

    /// Cancels the goal, if there is one.
    pub(super) fn cancel(&mut self) {
        if let State::Sent { goal, .. } | State::Accepted { goal, .. } = self.state {
            // Without an answer, there is nothing to cancel.
            self.client.cancel_goal(goal).ok();
        }
        self.state = State::Idle;
    }

    /// What has happened to the goal since the last call.
    pub(super) fn poll(&mut self) -> Option<Navigation> {
        let (next, news) = match self.state.clone() {
            State::Idle => return None,
            State::Failed => (State::Idle, Navigation::Refused),
            State::Sent { request, goal, since } => match self.client.receive_goal_response(request) {
                Ok(Some(answer)) if answer.accepted => match self.client.request_result(goal) {
                    Ok(result) => (State::Accepted { result, goal }, Navigation::Accepted),
                    Err(_) => (State::Idle, Navigation::Refused),
                },
                Ok(None) if since.elapsed() < PATIENCE => return None,
                _ => (State::Idle, Navigation::Refused),
            },
            State::Accepted { result, .. } => match self.client.receive_result(result) {
                Ok(Some((GoalStatusEnum::Succeeded, _))) => (State::Idle, Navigation::Reached),
                Ok(None) => return None,
                _ => (State::Idle, Navigation::GivenUp),
            },
        };
        self.state = next;
        Some(news)
    }
}

/// A client of the service.
pub(super) struct EdgesClient {
    client: Client<DynamicEdges, Flag>,
    asked: Option<(Option<RmwRequestId>, Instant)>,
}

impl EdgesClient {
    pub(super) fn new(node: &mut Node, name: &str, mapping: ServiceMapping) -> anyhow::Result<Self> {
        let quality = profile(&Quality::DEFAULT, WhenFull::Wait(WAIT));
        let kind = ServiceTypeName::new("nav2_msgs", "DynamicEdges");
        let client = node.create_client(mapping, &Name::parse(name)?, &kind, quality.clone(), quality)?;
        Ok(Self { client, asked: None })
    }

    /// Whether an answer is expected.
    pub(super) fn is_busy(&self) -> bool {
        self.asked.is_some()
    }

    /// Sends a request; an earlier one is forgotten, but for how long there was no answer.
    pub(super) fn send(&mut self, edges: DynamicEdges) {
        let since = self.asked.map_or_else(Instant::now, |(_, since)| since);
        self.asked = Some((self.client.send_request(edges).ok(), since));
    }

    /// Whether the edges are adjusted; `None` while nothing was asked, or an answer can still come.
    pub(super) fn poll(&mut self) -> Option<bool> {
        let (asked, since) = self.asked?;
        while let Ok(Some((answered, Flag(is_done)))) = self.client.receive_response() {
            if Some(answered) == asked {
                self.asked = None;
                return Some(is_done);
            }
        }
        if asked.is_some() && since.elapsed() < PATIENCE {
            return None;
        }
        self.asked = None;
        Some(false)
    }
}
