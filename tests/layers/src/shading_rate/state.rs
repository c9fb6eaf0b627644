//! State of a device's objects.

use super::capture::Captures;
use super::findings::Findings;
use super::framebuffer::Framebuffer;
use super::image::{Image, View};
use super::pipeline::Pipeline;
use super::recording::Recording;
use super::render_pass::RenderPass;
use super::submit::InFlight;
use ash::vk;
use std::collections::{HashMap, VecDeque};
use std::sync::Arc;

pub(super) struct State {
    pub findings: Findings,
    pub images: HashMap<vk::Image, Image>,
    pub views: HashMap<vk::ImageView, View>,
    pub render_passes: HashMap<vk::RenderPass, Arc<RenderPass>>,
    pub framebuffers: HashMap<vk::Framebuffer, Arc<Framebuffer>>,
    pub pipelines: HashMap<vk::Pipeline, Arc<Pipeline>>,
    pub pools: HashMap<vk::CommandPool, Vec<vk::CommandBuffer>>,
    pub recordings: HashMap<vk::CommandBuffer, Recording>,
    pub captures: Captures,
    pub fences: Vec<vk::Fence>,
    pub in_flight: VecDeque<InFlight>,
    pub passes_executed: u64,
}

impl State {
    pub fn new(findings: Findings, memory: vk::PhysicalDeviceMemoryProperties) -> Self {
        Self {
            findings,
            images: HashMap::new(),
            views: HashMap::new(),
            render_passes: HashMap::new(),
            framebuffers: HashMap::new(),
            pipelines: HashMap::new(),
            pools: HashMap::new(),
            recordings: HashMap::new(),
            captures: Captures::new(memory),
            fences: Vec::new(),
            in_flight: VecDeque::new(),
            passes_executed: 0,
        }
    }
}
