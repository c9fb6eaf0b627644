//! Memory for copies of an application's structures.

use ash::vk;
use std::ffi::c_void;
use std::mem::MaybeUninit;
use std::ptr;

/// Copies that stay where they are as long as this is.
#[derive(Default)]
pub struct Arena(Vec<Box<[MaybeUninit<u64>]>>);

/// The structures of a chain.
///
/// # Safety
///
/// `first` is null or starts a valid chain, which lives for `'c`.
pub unsafe fn chain<'c>(first: *const c_void) -> impl Iterator<Item = &'c vk::BaseInStructure<'c>> {
    // SAFETY: the chain is valid, as `# Safety` demands; each of its structures begins so.
    std::iter::successors(unsafe { first.cast::<vk::BaseInStructure<'c>>().as_ref() }, |at| unsafe {
        at.p_next.as_ref()
    })
}

/// A structure that points to nothing but its chain.
///
/// # Safety
///
/// Every pointer of a valid value is `p_next`, with which it begins behind its type.
pub unsafe trait Plain: Copy {}

// SAFETY: their fields are numbers but for the chain.
unsafe impl Plain for vk::PipelineInputAssemblyStateCreateInfo<'_> {}
// SAFETY: as above.
unsafe impl Plain for vk::PipelineTessellationStateCreateInfo<'_> {}
// SAFETY: as above.
unsafe impl Plain for vk::PipelineRasterizationStateCreateInfo<'_> {}
// SAFETY: as above.
unsafe impl Plain for vk::PipelineDepthStencilStateCreateInfo<'_> {}

/// The size of a structure that extends the state of a pipeline, and points to nothing but its chain.
fn size_of_state(s_type: vk::StructureType) -> Option<usize> {
    use vk::StructureType as Type;
    Some(match s_type {
        Type::PIPELINE_RASTERIZATION_DEPTH_CLIP_STATE_CREATE_INFO_EXT => {
            size_of::<vk::PipelineRasterizationDepthClipStateCreateInfoEXT<'_>>()
        }
        Type::PIPELINE_RASTERIZATION_CONSERVATIVE_STATE_CREATE_INFO_EXT => {
            size_of::<vk::PipelineRasterizationConservativeStateCreateInfoEXT<'_>>()
        }
        Type::PIPELINE_RASTERIZATION_LINE_STATE_CREATE_INFO_KHR => {
            size_of::<vk::PipelineRasterizationLineStateCreateInfoKHR<'_>>()
        }
        Type::PIPELINE_RASTERIZATION_PROVOKING_VERTEX_STATE_CREATE_INFO_EXT => {
            size_of::<vk::PipelineRasterizationProvokingVertexStateCreateInfoEXT<'_>>()
        }
        Type::PIPELINE_TESSELLATION_DOMAIN_ORIGIN_STATE_CREATE_INFO => {
            size_of::<vk::PipelineTessellationDomainOriginStateCreateInfo<'_>>()
        }
        Type::PIPELINE_VIEWPORT_DEPTH_CLIP_CONTROL_CREATE_INFO_EXT => {
            size_of::<vk::PipelineViewportDepthClipControlCreateInfoEXT<'_>>()
        }
        _ => return None,
    })
}

impl Arena {
    /// Copies values, one behind the other; null where there are none.
    pub fn many<T: Copy>(&mut self, values: &[T]) -> *const T {
        const { assert!(align_of::<T>() <= align_of::<u64>()) };
        if values.is_empty() {
            return ptr::null();
        }
        let mut new = vec![MaybeUninit::uninit(); size_of_val(values).div_ceil(size_of::<u64>())];
        // SAFETY: the new memory has room for them, and is aligned as every T here is.
        unsafe { ptr::copy_nonoverlapping(values.as_ptr(), new.as_mut_ptr().cast::<T>(), values.len()) };
        self.0.push(new.into_boxed_slice());
        self.0.last().map_or(ptr::null(), |kept| kept.as_ptr().cast())
    }

    /// A copy of a chain of state; `None` if one of its structures is not known.
    ///
    /// # Safety
    ///
    /// As for [`chain`].
    unsafe fn chain(&mut self, first: *const c_void) -> Option<*const c_void> {
        let mut next: *const c_void = ptr::null();
        // SAFETY: the chain is valid, as `# Safety` demands; a structure of a type has the size of that type, and the copy begins with
        // type and chain, as it does.
        unsafe {
            for found in chain(first) {
                let size = size_of_state(found.s_type)?;
                let bytes = std::slice::from_raw_parts(ptr::from_ref(found).cast::<MaybeUninit<u8>>(), size);
                let copy = self.many(bytes).cast_mut().cast::<vk::BaseInStructure<'_>>();
                (*copy).p_next = next.cast();
                next = copy.cast_const().cast();
            }
        }
        Some(next)
    }

    /// A copy of plain state, null without any; `None` if its chain is not known.
    ///
    /// # Safety
    ///
    /// The structure and its chain are valid.
    pub unsafe fn plain<T: Plain>(&mut self, state: Option<&T>) -> Option<*const T> {
        let Some(state) = state else { return Some(ptr::null()) };
        // SAFETY: the chain is valid, as `# Safety` demands; a plain structure has no pointer but that to it.
        unsafe {
            let p_next = (*ptr::from_ref(state).cast::<vk::BaseInStructure<'_>>()).p_next;
            let p_next = self.chain(p_next.cast())?;
            let copy = self.many(&[*state]);
            (*copy.cast_mut().cast::<vk::BaseInStructure<'_>>()).p_next = p_next.cast();
            Some(copy)
        }
    }

    /// A copy of state with arrays.
    ///
    /// # Safety
    ///
    /// The structure, its arrays and its chain are valid.
    pub unsafe fn vertex_input(
        &mut self,
        state: Option<&vk::PipelineVertexInputStateCreateInfo<'_>>,
    ) -> Option<*const vk::PipelineVertexInputStateCreateInfo<'static>> {
        let Some(state) = state else { return Some(ptr::null()) };
        // SAFETY: arrays and chain are valid, as `# Safety` demands.
        unsafe {
            let copy = vk::PipelineVertexInputStateCreateInfo {
                p_next: self.chain(state.p_next)?,
                flags: state.flags,
                vertex_binding_description_count: state.vertex_binding_description_count,
                p_vertex_binding_descriptions: self
                    .array(state.p_vertex_binding_descriptions, state.vertex_binding_description_count),
                vertex_attribute_description_count: state.vertex_attribute_description_count,
                p_vertex_attribute_descriptions: self
                    .array(state.p_vertex_attribute_descriptions, state.vertex_attribute_description_count),
                ..Default::default()
            };
            Some(self.many(&[copy]))
        }
    }

    /// As [`Self::vertex_input`]; rectangles that are dynamic may be anything.
    ///
    /// # Safety
    ///
    /// As for [`Self::vertex_input`].
    pub unsafe fn viewport(
        &mut self,
        state: Option<&vk::PipelineViewportStateCreateInfo<'_>>,
        dynamic: &[vk::DynamicState],
    ) -> Option<*const vk::PipelineViewportStateCreateInfo<'static>> {
        let Some(state) = state else { return Some(ptr::null()) };
        let is_dynamic = |wanted: [vk::DynamicState; 2]| wanted.iter().any(|state| dynamic.contains(state));
        let viewports = !is_dynamic([vk::DynamicState::VIEWPORT, vk::DynamicState::VIEWPORT_WITH_COUNT]);
        let scissors = !is_dynamic([vk::DynamicState::SCISSOR, vk::DynamicState::SCISSOR_WITH_COUNT]);
        let counted = |is_fixed, count| if is_fixed { count } else { 0 };
        // SAFETY: arrays that are not dynamic have so many elements, and the chain is valid, as `# Safety` demands.
        let copy = unsafe {
            vk::PipelineViewportStateCreateInfo {
                p_next: self.chain(state.p_next)?,
                flags: state.flags,
                viewport_count: state.viewport_count,
                p_viewports: self.array(state.p_viewports, counted(viewports, state.viewport_count)),
                scissor_count: state.scissor_count,
                p_scissors: self.array(state.p_scissors, counted(scissors, state.scissor_count)),
                ..Default::default()
            }
        };
        Some(self.many(&[copy]))
    }

    /// As [`Self::vertex_input`].
    ///
    /// # Safety
    ///
    /// As for [`Self::vertex_input`].
    pub unsafe fn multisample(
        &mut self,
        state: Option<&vk::PipelineMultisampleStateCreateInfo<'_>>,
    ) -> Option<*const vk::PipelineMultisampleStateCreateInfo<'static>> {
        let Some(state) = state else { return Some(ptr::null()) };
        // SAFETY: arrays and chain are valid, as `# Safety` demands; a mask has a bit for each sample, in words of 32.
        unsafe {
            let words = state.rasterization_samples.as_raw().div_ceil(32);
            let copy = vk::PipelineMultisampleStateCreateInfo {
                p_next: self.chain(state.p_next)?,
                flags: state.flags,
                rasterization_samples: state.rasterization_samples,
                sample_shading_enable: state.sample_shading_enable,
                min_sample_shading: state.min_sample_shading,
                p_sample_mask: self.array(state.p_sample_mask, words),
                alpha_to_coverage_enable: state.alpha_to_coverage_enable,
                alpha_to_one_enable: state.alpha_to_one_enable,
                ..Default::default()
            };
            Some(self.many(&[copy]))
        }
    }

    /// As [`Self::vertex_input`].
    ///
    /// # Safety
    ///
    /// As for [`Self::vertex_input`].
    pub unsafe fn color_blend(
        &mut self,
        state: Option<&vk::PipelineColorBlendStateCreateInfo<'_>>,
    ) -> Option<*const vk::PipelineColorBlendStateCreateInfo<'static>> {
        let Some(state) = state else { return Some(ptr::null()) };
        // SAFETY: arrays and chain are valid, as `# Safety` demands.
        unsafe {
            let copy = vk::PipelineColorBlendStateCreateInfo {
                p_next: self.chain(state.p_next)?,
                flags: state.flags,
                logic_op_enable: state.logic_op_enable,
                logic_op: state.logic_op,
                attachment_count: state.attachment_count,
                p_attachments: self.array(state.p_attachments, state.attachment_count),
                blend_constants: state.blend_constants,
                ..Default::default()
            };
            Some(self.many(&[copy]))
        }
    }

    /// As [`Self::vertex_input`].
    ///
    /// # Safety
    ///
    /// As for [`Self::vertex_input`].
    pub unsafe fn dynamic(
        &mut self,
        state: Option<&vk::PipelineDynamicStateCreateInfo<'_>>,
    ) -> Option<*const vk::PipelineDynamicStateCreateInfo<'static>> {
        let Some(state) = state else { return Some(ptr::null()) };
        // SAFETY: arrays and chain are valid, as `# Safety` demands.
        unsafe {
            let copy = vk::PipelineDynamicStateCreateInfo {
                p_next: self.chain(state.p_next)?,
                flags: state.flags,
                dynamic_state_count: state.dynamic_state_count,
                p_dynamic_states: self.array(state.p_dynamic_states, state.dynamic_state_count),
                ..Default::default()
            };
            Some(self.many(&[copy]))
        }
    }

    /// # Safety
    ///
    /// As for [`super::slice`].
    unsafe fn array<T: Copy>(&mut self, first: *const T, count: u32) -> *const T {
        // SAFETY: so many elements are there, as `# Safety` demands.
        self.many(unsafe { super::slice(first, count) })
    }
}
