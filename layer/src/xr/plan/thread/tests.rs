use super::super::work::PlanInputs;
use super::*;
use crate::config::{Config, ConfigSnapshot};
use crate::inputs::gaze::Look;
use crate::planner::{ShownView, View};
use crate::xr::tests::fake::vulkan_half;
use crate::xr::vulkan_device::VulkanDevice;
use glam::{Quat, Vec3};
use parafovea_core::geometry::Fov;
use smallvec::{SmallVec, smallvec};
use std::time::Duration;

const FRAME_NS: i64 = 11_111_111;
const VIEW: View = View {
    orientation: Quat::IDENTITY,
    position: Vec3::ZERO,
    fov: Fov { left: -0.8, right: 0.8, up: 0.8, down: -0.8 },
};

fn thread() -> PlanThread {
    let device = VulkanDevice::of_table(vulkan_half::table(), vulkan_half::record());
    let thread = PlanThread::new(PlanWork::new(device));
    let shown = ShownView { view: VIEW, extent: [512; 2] };
    thread.work().planner().views.shown(Some(1), &[shown; 2]);
    thread
}

fn task(config: &Arc<ConfigSnapshot>, frame: i64, expected: SmallVec<[View; 4]>) -> FrameTask {
    let inputs = Some(PlanInputs { can_attenuate: true, head: Quat::IDENTITY, look: Look::NoTracker });
    FrameTask { config: Arc::clone(config), time_ns: frame * FRAME_NS, inputs, expected }
}

/// Frames from number `first` on, whose plans are needed after `pause`.
fn frames(thread: &PlanThread, first: i64, pause: Duration) {
    let config = Arc::new(ConfigSnapshot::of_tests(Config::default()));
    for frame in first..first + 40 {
        thread.work().planner().frame_begins(frame * FRAME_NS, 1);
        assert!(!thread.work().planner().is_planned(), "frame {frame}");
        thread.begin(task(&config, frame, smallvec![VIEW; 2]));
        std::thread::sleep(pause);
        assert!(thread.work().planner().is_planned(), "frame {frame}");
        thread.finish_sorting();
        assert!(matches!(*thread.shared.lock(), Stage::Idle), "frame {frame}");
    }
}

#[test]
fn each_frame_has_its_plan_whoever_makes_it() {
    let thread = thread();
    frames(&thread, 1, Duration::ZERO);
    frames(&thread, 101, Duration::from_micros(100));
    frames(&thread, 201, Duration::from_millis(1));
}

#[test]
fn several_threads_may_need_a_plan() {
    let thread = thread();
    let config = Arc::new(ConfigSnapshot::of_tests(Config::default()));
    for frame in 1..=40 {
        thread.work().planner().frame_begins(frame * FRAME_NS, 1);
        thread.begin(task(&config, frame, SmallVec::new()));
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| assert!(thread.work().planner().is_planned(), "frame {frame}"));
            }
        });
    }
}

#[test]
fn a_session_that_ended_plans_on_the_calling_thread() {
    let thread = thread();
    frames(&thread, 1, Duration::ZERO);
    thread.end();
    thread.end();
    let config = Arc::new(ConfigSnapshot::of_tests(Config::default()));
    thread.work().planner().frame_begins(41 * FRAME_NS, 1);
    thread.begin(task(&config, 41, SmallVec::new()));
    assert!(thread.shared.work.planner().is_planned());
}

#[test]
fn planning_that_failed_is_not_tried_again() {
    let thread = thread();
    let config = Arc::new(ConfigSnapshot::of_tests(Config::default()));
    thread.work().fail();
    thread.work().planner().frame_begins(FRAME_NS, 1);
    thread.begin(task(&config, 1, smallvec![VIEW; 2]));
    thread.finish_sorting();
    assert!(!thread.work().planner().is_planned());
}
