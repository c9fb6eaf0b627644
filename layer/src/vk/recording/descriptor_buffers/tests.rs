//! The kept binds and offsets.

use super::bound::{PushBuffer, Usage2};
use super::*;
use ash::vk::Handle;

const COMPUTE: vk::PipelineBindPoint = vk::PipelineBindPoint::COMPUTE;
const GRAPHICS: vk::PipelineBindPoint = vk::PipelineBindPoint::GRAPHICS;

fn offsets(point: vk::PipelineBindPoint, first: u32, offsets: &[u64]) -> Call {
    let kind = CallKind::Offsets(offsets.iter().map(|_| 0).collect(), offsets.into());
    Call { point, layout: vk::PipelineLayout::from_raw(1), first, kind }
}

fn buffer(address: vk::DeviceAddress) -> BoundBuffer {
    BoundBuffer { address, usage: vk::BufferUsageFlags::empty(), usage2: None, push: None }
}

#[test]
fn offsets_are_kept_until_they_are_set_anew_or_other_buffers_are_bound() {
    let mut kept = BufferOffsets::default();
    let samplers =
        Call { point: GRAPHICS, layout: vk::PipelineLayout::null(), first: 3, kind: CallKind::Samplers };
    for call in [offsets(GRAPHICS, 0, &[64]), offsets(COMPUTE, 0, &[0]), samplers.clone()] {
        kept.set(call);
    }
    kept.set(offsets(GRAPHICS, 0, &[128, 256]));
    let expected = [offsets(COMPUTE, 0, &[0]), samplers.clone(), offsets(GRAPHICS, 0, &[128, 256])];
    assert_eq!(kept.calls.as_slice(), expected);
    kept.bind_buffers([Some(buffer(64))].into_iter());
    assert_eq!((kept.calls.as_slice(), kept.buffers.as_slice()), (&[samplers][..], &[buffer(64)][..]));
    assert!(kept.is_complete() && !kept.is_empty());
    kept.clear();
    assert!(kept.is_empty());
}

#[test]
fn sets_end_offsets_of_their_point_and_put_others_in_doubt() {
    let mut kept = BufferOffsets::default();
    kept.bind_sets(GRAPHICS);
    kept.set(offsets(COMPUTE, 0, &[0]));
    assert!(kept.is_complete(), "offsets after sets are in no doubt");
    kept.bind_sets(GRAPHICS);
    assert!(!kept.is_complete());
    kept.bind_sets(COMPUTE);
    assert!(kept.is_complete() && kept.is_empty());
    kept.set(offsets(COMPUTE, 0, &[0]));
    kept.bind_sets(GRAPHICS);
    kept.bind_buffers([Some(buffer(64))].into_iter());
    assert!(kept.is_complete() && !kept.is_empty(), "buffers alone are bound");
    kept.bind_sets(GRAPHICS);
    assert!(kept.is_complete() && kept.is_empty(), "nothing is set any more");
}

#[test]
fn buffers_with_unknown_extensions_cannot_be_bound_again() {
    let mut usage2 = Usage2::default().usage(vk::BufferUsageFlags2KHR::SAMPLER_DESCRIPTOR_BUFFER_EXT);
    let mut push = PushBuffer::default().buffer(vk::Buffer::from_raw(3));
    let known = vk::DescriptorBufferBindingInfoEXT::default().address(64);
    let expected = BoundBuffer { usage2: Some(usage2.usage), push: Some(push.buffer), ..buffer(64) };
    let known = known.push_next(&mut push).push_next(&mut usage2);
    // SAFETY: the chain is of local structures.
    assert_eq!(unsafe { BoundBuffer::read(&known) }, Some(expected));
    let other = vk::MemoryAllocateInfo::default();
    let unknown =
        vk::DescriptorBufferBindingInfoEXT { p_next: (&raw const other).cast_mut().cast(), ..known };
    // SAFETY: as above.
    let read = unsafe { BoundBuffer::read(&unknown) };
    let mut kept = BufferOffsets::default();
    kept.bind_buffers([read].into_iter());
    assert!(!kept.is_complete() && !kept.is_empty());
    kept.bind_buffers([Some(buffer(64))].into_iter());
    assert!(kept.is_complete(), "in their place");
}

#[test]
fn sets_and_offsets_end_heaps_and_secondary_command_buffers_do_not() {
    let with_data = || {
        let mut kept = BufferOffsets::default();
        kept.heaps().push(0, &[1; 4]);
        kept
    };
    let after = |change: fn(&mut BufferOffsets)| {
        let mut kept = with_data();
        change(&mut kept);
        kept.heaps.is_empty()
    };
    assert!(!with_data().is_empty() && with_data().is_complete());
    assert!(after(|kept| kept.bind_sets(COMPUTE)));
    assert!(after(|kept| kept.set(offsets(GRAPHICS, 0, &[0]))));
    assert!(after(|kept| kept.bind_buffers(std::iter::empty())));
    assert!(after(BufferOffsets::clear));
    assert!(!after(BufferOffsets::forget_offsets));
}

#[test]
fn stages_belong_to_bind_points() {
    use vk::ShaderStageFlags as Stages;
    assert_eq!(points(Stages::VERTEX | Stages::FRAGMENT).as_slice(), [GRAPHICS]);
    assert_eq!(points(Stages::COMPUTE | Stages::MESH_EXT).as_slice(), [COMPUTE, GRAPHICS]);
    assert_eq!(points(Stages::RAYGEN_KHR).as_slice(), [vk::PipelineBindPoint::RAY_TRACING_KHR]);
    assert_eq!(points(Stages::ALL).len(), 3);
}
