use super::*;
use proptest::prelude::*;
use std::ptr::{from_ref, null};

type Rendering<'a> = vk::PipelineRenderingCreateInfo<'a>;
type Flags2<'a> = vk::PipelineCreateFlags2CreateInfoKHR<'a>;
type Rate<'a> = vk::PipelineFragmentShadingRateStateCreateInfoKHR<'a>;

/// The chain's types, and the view masks in it.
fn content(mut at: *const c_void) -> Vec<(vk::StructureType, u32)> {
    let mut found = Vec::new();
    // SAFETY: the tests build valid chains.
    unsafe {
        while let Some(structure) = at.cast::<vk::BaseInStructure<'_>>().as_ref() {
            let mask = if structure.s_type == Rendering::STRUCTURE_TYPE {
                (*at.cast::<Rendering<'_>>()).view_mask
            } else {
                0
            };
            found.push((structure.s_type, mask));
            at = structure.p_next.cast();
        }
    }
    found
}

proptest! {
    /// With any structures before and behind, and with any amount of room.
    #[test]
    fn one_structure_of_a_chain_is_another(before in 0usize..4, behind in 0usize..3, words in 0usize..40) {
        let mut structures = vec![Rate::default(); before + behind];
        let mut rendering = Rendering::default().view_mask(1);
        let mut next: *const c_void = null();
        for (index, structure) in structures.iter_mut().enumerate().rev() {
            if index + 1 == before {
                rendering.p_next = next;
                next = from_ref(&rendering).cast();
            }
            structure.p_next = next;
            next = from_ref(structure).cast();
        }
        if before == 0 {
            rendering.p_next = next;
            next = from_ref(&rendering).cast();
        }
        let was = content(next);
        let mut room = room::<40>();
        let mut copies = Copies::new(&mut room[..words]);
        // SAFETY: a valid chain that lives to the end of the test.
        let amended = unsafe { copies.amend::<Rendering<'_>>(next, |rendering| rendering.view_mask = 6) };
        let expected: Vec<_> = was.iter().map(|&(s_type, mask)| (s_type, mask * 6)).collect();
        prop_assert_eq!(content(amended), expected);
        prop_assert_eq!(content(next), was);
    }
}

#[test]
fn behind_an_unknown_structure_the_applications_own_is_amended_for_the_time_of_the_call() {
    let mut rendering = Rendering::default().view_mask(1);
    let unknown = vk::BaseInStructure {
        s_type: vk::StructureType::from_raw(1_999_999_999),
        p_next: (&raw mut rendering).cast(),
        ..Default::default()
    };
    let first = from_ref(&unknown).cast();
    let was = content(first);
    let mut room = room::<8>();
    let mut copies = Copies::new(&mut room);
    // SAFETY: a valid chain; nothing refers to `rendering` while it is amended.
    let amended = unsafe { copies.amend::<Rendering<'_>>(first, |rendering| rendering.view_mask = 6) };
    assert_eq!(amended, first);
    assert_eq!(content(first)[1].1, 6);
    // Another structure of the call may have the same chain.
    // SAFETY: as above.
    unsafe { copies.amend::<Rendering<'_>>(first, |rendering| rendering.view_mask = 7) };
    assert_eq!(content(first)[1].1, 7);
    drop(copies);
    assert_eq!(content(first), was);
}

#[test]
fn a_chain_without_the_structure_stays() {
    let flags = Flags2::default();
    let mut room = room::<8>();
    let mut copies = Copies::new(&mut room);
    for first in [null(), from_ref(&flags).cast()] {
        // SAFETY: a valid chain.
        assert_eq!(unsafe { copies.amend::<Rendering<'_>>(first, |_| unreachable!()) }, first);
    }
}

#[test]
fn values_are_copied_one_behind_the_other() {
    let mut room = room::<3>();
    let mut copies = Copies::new(&mut room);
    let (some, more) = (copies.many([1u32, 2, 3].into_iter()), copies.many(4u32..9));
    // SAFETY: so many were copied.
    unsafe {
        assert_eq!(slice(some, 3), [1, 2, 3]);
        assert_eq!(slice(more, 5), [4, 5, 6, 7, 8]);
    }
    assert_eq!(copies.beyond.len(), 1, "three words do not fit into the one that is left");
}
