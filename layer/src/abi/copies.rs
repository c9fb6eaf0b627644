//! Copies of structures that the application passes, to be amended and passed down in their place.

use ash::vk::{self, TaggedStructure};
use smallvec::SmallVec;
use std::borrow::Cow;
use std::ffi::c_void;
use std::mem::MaybeUninit;
use std::ptr::copy_nonoverlapping;

/// Room for [`Copies`] on the stack, in words of 8 bytes, to which all structures of Vulkan are aligned.
pub type Room<const WORDS: usize> = [MaybeUninit<u64>; WORDS];

/// Room that has nothing in it.
pub const fn room<const WORDS: usize>() -> Room<WORDS> {
    [const { MaybeUninit::uninit() }; WORDS]
}

/// Copies of structures, as pointers that are valid as long as this is: on the stack as far as there is room, else on
/// the heap.
pub struct Copies<'a> {
    room: &'a mut [MaybeUninit<u64>],
    beyond: Vec<Box<[MaybeUninit<u64>]>>,
    amended_in_place: SmallVec<[Original; 1]>,
}

/// The content of a structure of the application before it was amended in place.
struct Original {
    structure: *mut u8,
    saved: *const u8,
    size: usize,
}

impl<'a> Copies<'a> {
    /// Copies that go to `room` first.
    pub fn new(room: &'a mut [MaybeUninit<u64>]) -> Self {
        Self { room, beyond: Vec::new(), amended_in_place: SmallVec::new() }
    }

    /// Copies a value.
    pub fn one<T: Copy>(&mut self, value: T) -> *mut T {
        self.many([value].into_iter())
    }

    /// Copies values, one behind the other; a pointer that is aligned, but to nothing, where there is none.
    pub fn many<T: Copy>(&mut self, values: impl ExactSizeIterator<Item = T>) -> *mut T {
        const { assert!(align_of::<T>() <= align_of::<u64>()) };
        let count = values.len();
        let first: *mut T = self.words((count * size_of::<T>()).div_ceil(size_of::<u64>())).cast();
        for (index, value) in values.take(count).enumerate() {
            // SAFETY: `words` made room for so many values, aligned as every T here is.
            unsafe { first.add(index).write(value) };
        }
        first
    }

    fn words(&mut self, count: usize) -> *mut MaybeUninit<u64> {
        if count <= self.room.len() {
            let (taken, rest) = std::mem::take(&mut self.room).split_at_mut(count);
            self.room = rest;
            return taken.as_mut_ptr();
        }
        let mut new = vec![MaybeUninit::uninit(); count].into_boxed_slice();
        let first = new.as_mut_ptr();
        self.beyond.push(new);
        first
    }

    /// The chain with its first structure of type `T` as `amend` makes it; the chain itself where it has none.
    ///
    /// That structure and those before it are copied, those behind it stay. Where one before it is of a type whose
    /// size is not known here, the application's own structure is amended, until `self` is dropped.
    ///
    /// # Safety
    ///
    /// `first` is null or starts a valid chain, which outlives `self`.
    pub unsafe fn amend<T: TaggedStructure + Copy>(
        &mut self,
        first: *const c_void,
        amend: impl FnOnce(&mut T),
    ) -> *const c_void {
        // SAFETY: the chain is valid, as `# Safety` demands.
        let Some((before, found)) = (unsafe { split_at::<T>(first) }) else { return first };
        if before.iter().any(|structure| size_of_structure(structure.s_type).is_none()) {
            let structure = found.cast_mut();
            // SAFETY: a valid T of the application's, which no other code uses during the call that it was passed to.
            unsafe {
                let saved = self.one(*structure);
                self.amended_in_place.push(Original {
                    structure: structure.cast(),
                    saved: saved.cast_const().cast(),
                    size: size_of::<T>(),
                });
                amend(&mut *structure);
            }
            return first;
        }
        // SAFETY: copies of valid structures with the sizes that belong to their types; each begins with its type
        // and the pointer to the next.
        unsafe {
            let amended = self.one(*found);
            amend(&mut *amended);
            let mut next: *const c_void = amended.cast_const().cast();
            for structure in before.iter().rev() {
                let size = size_of_structure(structure.s_type).unwrap_or_default();
                let copy = self.words(size.div_ceil(size_of::<u64>())).cast::<u8>();
                copy_nonoverlapping(std::ptr::from_ref(*structure).cast(), copy, size);
                (*copy.cast::<vk::BaseInStructure<'_>>()).p_next = next.cast();
                next = copy.cast_const().cast();
            }
            next
        }
    }
}

impl Drop for Copies<'_> {
    fn drop(&mut self) {
        // The last first: chains may share a structure, which was amended for each.
        for Original { structure, saved, size } in self.amended_in_place.drain(..).rev() {
            // SAFETY: `amend` was promised that the structure outlives this; `saved` holds as many bytes of it.
            unsafe { copy_nonoverlapping(saved, structure, size) };
        }
    }
}

/// The structures before the first one of type `T`, and that one.
///
/// # Safety
///
/// `first` is null or starts a valid chain, which lives for `'c`.
unsafe fn split_at<'c, T: TaggedStructure>(
    first: *const c_void,
) -> Option<(SmallVec<[&'c vk::BaseInStructure<'c>; 8]>, *const T)> {
    let mut before = SmallVec::new();
    let mut at: *const vk::BaseInStructure<'c> = first.cast();
    // SAFETY: null, or the next structure of a valid chain, as `# Safety` demands.
    while let Some(structure) = unsafe { at.as_ref() } {
        if structure.s_type == T::STRUCTURE_TYPE {
            return Some((before, at.cast()));
        }
        before.push(structure);
        at = structure.p_next;
    }
    None
}

/// The first structure of type `T` in a chain.
///
/// # Safety
///
/// `first` is null or starts a valid chain, which lives for `'c`.
pub unsafe fn find<'c, T: TaggedStructure>(first: *const c_void) -> Option<&'c T> {
    let mut at: *const vk::BaseInStructure<'c> = first.cast();
    // SAFETY: null, or the next structure of a valid chain, as `# Safety` demands; its type names the structure.
    unsafe {
        while let Some(structure) = at.as_ref() {
            if structure.s_type == T::STRUCTURE_TYPE {
                return at.cast::<T>().as_ref();
            }
            at = structure.p_next;
        }
    }
    None
}

/// The words of an application's SPIR-V, of `size` bytes: a copy where the code is not aligned to words. The
/// specification demands alignment (VUID-VkShaderModuleCreateInfo-pCode-08740, VUID-VkShaderCreateInfoEXT-pCode-08493),
/// but drivers take code without it, and so do applications.
///
/// # Safety
///
/// `code` points to that many bytes, which live for `'c`; or it is null.
pub unsafe fn words<'c>(code: *const c_void, size: usize) -> Cow<'c, [u32]> {
    if code.is_null() {
        return Cow::Borrowed(&[]);
    }
    let (first, count) = (code.cast::<u32>(), size / size_of::<u32>());
    // SAFETY: the bytes are there, as `# Safety` demands; words are borrowed only where they are aligned.
    unsafe {
        if first.is_aligned() {
            return Cow::Borrowed(std::slice::from_raw_parts(first, count));
        }
        Cow::Owned((0..count).map(|index| first.add(index).read_unaligned()).collect())
    }
}

/// The elements of an array of the application's.
///
/// # Safety
///
/// `first` points to that many valid elements, which live for `'c`; or it is null, or there are none.
pub unsafe fn slice<'c, T>(first: *const T, count: u32) -> &'c [T] {
    if first.is_null() || count == 0 {
        return &[];
    }
    // SAFETY: so many elements are there, as `# Safety` demands.
    unsafe { std::slice::from_raw_parts(first, count as usize) }
}

macro_rules! sizes {
    ($($structure:ident,)*) => {
        /// The size of a structure that can be in one of the chains that are amended.
        fn size_of_structure(s_type: vk::StructureType) -> Option<usize> {
            Some(match s_type {
                $(<vk::$structure<'_> as TaggedStructure>::STRUCTURE_TYPE => size_of::<vk::$structure<'_>>(),)*
                _ => return None,
            })
        }
    };
}

// Structures that extend VkGraphicsPipelineCreateInfo, VkSubpassDescription2, VkRenderPassBeginInfo, VkRenderingInfo, VkFramebufferCreateInfo and
// VkCommandBufferInheritanceInfo, as the registry of Vulkan 1.3.281 has them.
sizes! {
    AttachmentSampleCountInfoAMD,
    CommandBufferInheritanceConditionalRenderingInfoEXT,
    CommandBufferInheritanceRenderPassTransformInfoQCOM,
    CommandBufferInheritanceRenderingInfo,
    CommandBufferInheritanceViewportScissorInfoNV,
    DeviceGroupRenderPassBeginInfo,
    FragmentShadingRateAttachmentInfoKHR,
    FramebufferAttachmentsCreateInfo,
    GraphicsPipelineLibraryCreateInfoEXT,
    GraphicsPipelineShaderGroupsCreateInfoNV,
    MultisampledRenderToSingleSampledInfoEXT,
    MultiviewPerViewAttributesInfoNVX,
    MultiviewPerViewRenderAreasRenderPassBeginInfoQCOM,
    PipelineCompilerControlCreateInfoAMD,
    PipelineCreateFlags2CreateInfoKHR,
    PipelineCreationFeedbackCreateInfo,
    PipelineDiscardRectangleStateCreateInfoEXT,
    PipelineFragmentShadingRateEnumStateCreateInfoNV,
    PipelineFragmentShadingRateStateCreateInfoKHR,
    PipelineLibraryCreateInfoKHR,
    PipelineRenderingCreateInfo,
    PipelineRepresentativeFragmentTestStateCreateInfoNV,
    PipelineRobustnessCreateInfoEXT,
    RenderPassAttachmentBeginInfo,
    RenderPassCreationControlEXT,
    RenderPassSampleLocationsBeginInfoEXT,
    RenderPassStripeBeginInfoARM,
    RenderPassSubpassFeedbackCreateInfoEXT,
    RenderPassTransformBeginInfoQCOM,
    RenderingAttachmentLocationInfoKHR,
    RenderingFragmentDensityMapAttachmentInfoEXT,
    RenderingFragmentShadingRateAttachmentInfoKHR,
    RenderingInputAttachmentIndexInfoKHR,
    SubpassDescriptionDepthStencilResolve,
}

#[cfg(test)]
mod tests;
