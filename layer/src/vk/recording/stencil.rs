//! Whether draws of a pass write stencil, where commands set that instead of pipelines, as translators of Direct3D do.
//!
//! State counts if something is drawn with it. Draws are too many to look at each: when state is about to change, the counts of the pass show
//! whether it drew.

use super::{Buffer, Recorded, draws, with_buffer};
use crate::backend::mask::PipelineFacts;
use ash::vk;

/// Stencil tests that commands have set, and which draws were looked at.
#[derive(Debug, Clone, Copy, Default)]
pub struct StencilTests {
    /// Whether there are any; None before it was set.
    is_on: Option<bool>,
    /// Whether they keep the stencil value: of front faces and of back faces.
    keep: [Option<bool>; 2],
    /// Draws of the pass that were looked at.
    draws: u32,
}

impl StencilTests {
    /// A pass begins.
    pub fn pass_begins(&mut self) {
        self.draws = 0;
    }

    /// Whether a draw with this pipeline may write stencil.
    fn writes(&self, pipeline: &PipelineFacts) -> bool {
        let is_off = pipeline.dynamic_stencil.test && self.is_on == Some(false);
        let keeps = pipeline.dynamic_stencil.op && self.keep == [Some(true); 2];
        pipeline.write_stencil && !is_off && !keeps
    }

    fn set_op(&mut self, faces: vk::StencilFaceFlags, ops: [vk::StencilOp; 3]) {
        let keeps = ops.iter().all(|op| *op == vk::StencilOp::KEEP);
        for (kept, face) in
            self.keep.iter_mut().zip([vk::StencilFaceFlags::FRONT, vk::StencilFaceFlags::BACK])
        {
            if faces.contains(face) {
                *kept = Some(keeps);
            }
        }
    }
}

impl Recorded {
    /// Checks the state of stencil tests before it changes or the pass ends; `draws` counts the draws of the pass so far.
    pub(super) fn look_at_stencil(&mut self, draws: u32) {
        if self.stencil.draws != draws {
            self.stencil.draws = draws;
            self.within.writes_stencil |= self.stencil.writes(&self.pipeline);
        }
    }
}

/// The state of stencil tests is about to change, or the pass to end.
pub fn changes(of: &Buffer, handle: vk::CommandBuffer) {
    let draws = draws::counted(of, handle);
    of.recorded().look_at_stencil(draws);
}

/// `vkCmdSetStencilTestEnable`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn set_test(handle: vk::CommandBuffer, is_on: vk::Bool32) {
    hook!(
        "vkCmdSetStencilTestEnable",
        with_buffer,
        cmd_set_stencil_test_enable(handle, is_on),
        |known, next| {
            if let Some(known) = &known {
                changes(known, handle);
                known.recorded().stencil.is_on = Some(is_on == vk::TRUE);
            }
            next();
        }
    );
}

/// `vkCmdSetStencilOp`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn set_op(
    handle: vk::CommandBuffer,
    faces: vk::StencilFaceFlags,
    fail: vk::StencilOp,
    pass: vk::StencilOp,
    depth_fail: vk::StencilOp,
    compare: vk::CompareOp,
) {
    hook!(
        "vkCmdSetStencilOp",
        with_buffer,
        cmd_set_stencil_op(handle, faces, fail, pass, depth_fail, compare),
        |known, next| {
            if let Some(known) = &known {
                changes(known, handle);
                known.recorded().stencil.set_op(faces, [fail, pass, depth_fail]);
            }
            next();
        }
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::mask::DynamicStencil;

    const DYNAMIC: PipelineFacts = PipelineFacts {
        write_stencil: true,
        are_unknown: false,
        have_side_effects: false,
        dynamic_stencil: DynamicStencil { test: true, op: true },
        ..PipelineFacts::UNKNOWN
    };
    const BOTH: vk::StencilFaceFlags = vk::StencilFaceFlags::FRONT_AND_BACK;

    #[test]
    fn stencil_is_written_unless_commands_keep_it() {
        let mut tests = StencilTests::default();
        assert!(tests.writes(&DYNAMIC), "nothing was set");
        tests.is_on = Some(false);
        assert!(!tests.writes(&DYNAMIC));
        let fixed = PipelineFacts { dynamic_stencil: DynamicStencil::default(), ..DYNAMIC };
        assert!(tests.writes(&fixed), "that is the pipeline's own");
        tests.is_on = Some(true);
        assert!(tests.writes(&DYNAMIC));
        tests.set_op(vk::StencilFaceFlags::FRONT, [vk::StencilOp::KEEP; 3]);
        assert!(tests.writes(&DYNAMIC), "back faces may");
        tests.set_op(BOTH, [vk::StencilOp::KEEP; 3]);
        assert!(!tests.writes(&DYNAMIC));
        tests.set_op(BOTH, [vk::StencilOp::KEEP, vk::StencilOp::REPLACE, vk::StencilOp::KEEP]);
        assert!(tests.writes(&DYNAMIC));
    }

    /// A translator of Direct3D binds a pipeline while the state of an earlier pass is still set, then sets its own.
    #[test]
    fn state_that_nothing_is_drawn_with_does_not_count() {
        let mut recorded = Recorded::default();
        recorded.begin(None, None, None);
        recorded.use_pipeline(DYNAMIC);
        recorded.look_at_stencil(0);
        recorded.stencil.is_on = Some(false);
        recorded.look_at_stencil(7);
        assert!(!recorded.pipelines().write_stencil);
        recorded.stencil.is_on = Some(true);
        recorded.look_at_stencil(7);
        assert!(!recorded.pipelines().write_stencil);
        recorded.look_at_stencil(8);
        assert!(recorded.pipelines().write_stencil);
        recorded.begin(None, None, None);
        assert!(!recorded.pipelines().write_stencil, "another pass");
    }
}
