//! Observations of a run of the application: the one JSON object that it prints.

use super::pattern::Figure;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A run of one case.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Report {
    /// Name of the case.
    pub case: String,
    /// Frames that xrEndFrame accepted.
    pub frames: u32,
    /// The calls that the case is about, in order.
    pub calls: Vec<Call>,
    /// Images of each swapchain, in order of creation.
    pub image_counts: Vec<u32>,
    /// Names of the events that the application received, in order.
    pub events: Vec<String>,
    /// Input calls of the application and their results, in order, with frames and events; only of the cases about input.
    pub trace: Vec<String>,
    /// Other observations of the case, by name.
    pub facts: BTreeMap<String, String>,
    /// Differences from the specification; empty in a good run.
    pub unexpected: Vec<String>,
    /// Layers of xrEndFrame, as drawn.
    pub pictures: Vec<Picture>,
}

/// One call and its result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Call {
    /// A call, and its situation.
    pub what: String,
    /// The result's name, such as `XR_ERROR_CALL_ORDER_INVALID`.
    pub result: String,
}

/// One sub-image of a frame that xrEndFrame accepted.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Picture {
    /// Number of the frame among those accepted, from 0.
    pub frame: u32,
    /// Number of the composition layer in the frame.
    pub layer: u32,
    /// Number of the view in the layer; 0 for a quad.
    pub view: u32,
    /// The drawn pattern.
    pub figure: Figure,
}

impl Report {
    /// Notes a call's result, and that it is unexpected unless it is one of `expected`.
    pub fn call(&mut self, what: &str, result: &str, expected: &[&str]) {
        self.calls.push(Call { what: what.to_owned(), result: result.to_owned() });
        if !expected.contains(&result) {
            let expected = expected.join(" or ");
            self.unexpected.push(format!("{what}: {result} instead of {expected}"));
        }
    }

    /// Notes an event.
    pub fn event(&mut self, event: String) {
        self.trace.push(format!("event: {event}"));
        self.events.push(event);
    }

    /// Records an observation, as unexpected unless it equals `expected`.
    pub fn fact(&mut self, name: &str, value: impl ToString, expected: impl ToString) {
        let (value, expected) = (value.to_string(), expected.to_string());
        if value != expected {
            self.unexpected.push(format!("{name}: {value} instead of {expected}"));
        }
        self.note(name, value);
    }

    /// Records an observation that the specification leaves open.
    pub fn note(&mut self, name: &str, value: impl ToString) {
        self.facts.insert(name.to_owned(), value.to_string());
    }
}
