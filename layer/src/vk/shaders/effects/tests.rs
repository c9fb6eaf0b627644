use super::*;
use crate::vk::shaders::spirv::MAGIC;
use proptest::prelude::*;

/// Instructions of a module, each an operation and its operands.
pub type Code = Vec<(u32, Vec<u32>)>;

pub fn assemble(code: &Code) -> Vec<u32> {
    let mut words = vec![MAGIC, 0x0001_0500, 0, 100, 0];
    for (op, operands) in code {
        words.push((operands.len() as u32 + 1) << 16 | op);
        words.extend(operands);
    }
    words
}

const MAIN: u32 = 1;
const HELPER: u32 = 2;
const OUT: u32 = 10;
const IN: u32 = 11;
const BUFFER: u32 = 12;
const INT: u32 = 20;
const VECTOR: u32 = 21;
const FLOAT: u32 = 22;
const NAME: u32 = u32::from_le_bytes(*b"main");

/// A fragment shader that writes a float, with `more` ahead of its functions, and those functions' bodies.
fn shader(
    interface: &[u32],
    more: &[(u32, &[u32])],
    main: &[(u32, &[u32])],
    helper: &[(u32, &[u32])],
) -> Vec<u32> {
    let owned = |(op, operands): &(u32, &[u32])| (*op, operands.to_vec());
    let mut entry = vec![MODEL_FRAGMENT, MAIN, NAME, 0];
    entry.extend(interface);
    let mut code: Code = vec![(op::ENTRY_POINT, entry), (op::EXECUTION_MODE, vec![MAIN, 7])];
    code.push((op::TYPE_INT, vec![INT, 32, 0]));
    code.push((22, vec![FLOAT, 32]));
    code.push((op::TYPE_VECTOR, vec![VECTOR, INT, 4]));
    code.extend(more.iter().map(owned));
    for (id, body) in [(MAIN, main), (HELPER, helper)] {
        code.push((op::FUNCTION, vec![30, id, 0, 31]));
        code.extend(body.iter().map(owned));
        code.push((op::FUNCTION_END, vec![]));
    }
    assemble(&code)
}

/// A fragment shader without effects, named `main`.
pub fn plain_shader() -> Vec<u32> {
    shader(&[], &[], &[], &[])
}

/// A fragment shader that writes to an image, and discards or not.
pub fn storing_shader(discards: bool) -> Vec<u32> {
    let store = [(op::IMAGE_WRITE, &[1u32, 2, 3][..])];
    let discard = [store[0], (op::KILL, &[])];
    shader(&[], &[], if discards { &discard } else { &store }, &[])
}

fn effects(words: &[u32]) -> Effects {
    FragmentShaders::read(words).unwrap().effects("main")
}

/// A variable of a storage class and type, by its pointer type.
fn variable(id: u32, class: u32, of: u32) -> [(u32, Vec<u32>); 2] {
    let pointer = id + 100;
    [(op::TYPE_POINTER, vec![pointer, class, of]), (op::VARIABLE, vec![pointer, id, class])]
}

fn with_variable(id: u32, class: u32, of: u32, built_in: Option<u32>) -> Effects {
    let [pointer, variable] = variable(id, class, of);
    let mut more: Vec<(u32, &[u32])> = Vec::new();
    let decoration = [id, decoration::BUILT_IN, built_in.unwrap_or(0)];
    if built_in.is_some() {
        more.push((op::DECORATE, &decoration));
    }
    more.push((pointer.0, &pointer.1));
    more.push((variable.0, &variable.1));
    effects(&shader(&[id], &more, &[], &[]))
}

#[test]
fn a_plain_shader_has_no_effects() {
    assert_eq!(with_variable(OUT, class::OUTPUT, FLOAT, None), Effects::default());
}

#[test]
fn integer_outputs_are_identifiers_unless_they_are_built_in() {
    for of in [INT, VECTOR] {
        assert!(with_variable(OUT, class::OUTPUT, of, None).writes_integers);
    }
    assert!(!with_variable(IN, class::INPUT, INT, None).writes_integers, "flat inputs");
    let mask = with_variable(OUT, class::OUTPUT, INT, Some(built_in::SAMPLE_MASK));
    assert_eq!(mask, Effects { uses_sample_mask: true, ..Effects::default() });
}

#[test]
fn shaders_of_samples_are_seen() {
    for built_in in [built_in::SAMPLE_ID, built_in::SAMPLE_POSITION] {
        assert!(with_variable(IN, class::INPUT, INT, Some(built_in)).per_sample);
    }
    let [pointer, input] = variable(IN, class::INPUT, FLOAT);
    let sample: (u32, &[u32]) = (op::DECORATE, &[IN, decoration::SAMPLE]);
    let more = [sample, (pointer.0, &pointer.1), (input.0, &input.1)];
    assert!(effects(&shader(&[IN], &more, &[], &[])).per_sample);
    assert!(
        effects(&shader(&[], &[(op::MEMBER_DECORATE, &[40, 0, decoration::SAMPLE])], &[], &[])).per_sample
    );
}

#[test]
fn modes_say_depth_stencil_and_interlock() {
    for mode in [MODE_DEPTH_REPLACING, MODE_STENCIL_REF_REPLACING] {
        let words = shader(&[], &[(op::EXECUTION_MODE, &[MAIN, mode])], &[], &[]);
        assert_eq!(effects(&words), Effects { writes_depth_stencil: true, ..Effects::default() });
    }
    for mode in MODES_INTERLOCK {
        assert!(effects(&shader(&[], &[(op::EXECUTION_MODE, &[MAIN, mode])], &[], &[])).interlocks);
    }
    assert!(effects(&shader(&[], &[], &[(op::BEGIN_INTERLOCK, &[])], &[])).interlocks);
}

/// A store through an access chain into a variable of a storage class.
fn stores_into(class: u32) -> bool {
    let [pointer, variable] = variable(BUFFER, class, FLOAT);
    let more = [(pointer.0, &pointer.1[..]), (variable.0, &variable.1[..])];
    let chain: (u32, &[u32]) = (op::ACCESS_CHAIN, &[BUFFER + 100, 50, BUFFER, 51]);
    effects(&shader(&[], &more, &[chain, (op::STORE, &[50, 52])], &[])).stores
}

#[test]
fn stores_count_where_others_can_see_them() {
    for class in [class::OUTPUT, class::PRIVATE, class::FUNCTION] {
        assert!(!stores_into(class), "{class}");
    }
    // Uniform (with BufferBlock), StorageBuffer, PhysicalStorageBuffer.
    for class in [2, 12, 5349] {
        assert!(stores_into(class), "{class}");
    }
    assert!(effects(&shader(&[], &[], &[(op::STORE, &[99, 98])], &[])).stores, "a pointer of unknown origin");
}

#[test]
fn images_and_atomics_count_and_reading_does_not() {
    for op in [99, 228, 229, 230, 232, 234, 242, 318, 319, 5614, 5615, 6035] {
        assert!(effects(&shader(&[], &[], &[(op, &[1, 2, 3, 4, 5, 6])], &[])).stores, "{op}");
    }
    // OpImageRead, OpAtomicLoad, OpLoad.
    for op in [98, 227, 61] {
        assert!(!effects(&shader(&[], &[], &[(op, &[1, 2, 3, 4, 5])], &[])).stores, "{op}");
    }
}

#[test]
fn a_function_counts_where_it_is_called() {
    let write: (u32, &[u32]) = (op::IMAGE_WRITE, &[1, 2, 3]);
    let call: (u32, &[u32]) = (op::FUNCTION_CALL, &[30, 60, HELPER]);
    let recursive: (u32, &[u32]) = (op::FUNCTION_CALL, &[30, 61, MAIN]);
    assert!(effects(&shader(&[], &[], &[call], &[write, recursive])).stores);
    assert!(!effects(&shader(&[], &[], &[], &[write])).stores);
}

/// OpKill, OpTerminateInvocation, OpDemoteToHelperInvocation.
#[test]
fn every_way_to_discard_is_seen_where_it_is_reached() {
    for op in [252, 4416, 5380] {
        let kill: (u32, &[u32]) = (op, &[]);
        let discards = Effects { discards: true, ..Effects::default() };
        assert_eq!(effects(&shader(&[], &[], &[kill], &[])), discards, "{op}");
        let call: (u32, &[u32]) = (op::FUNCTION_CALL, &[30, 60, HELPER]);
        assert_eq!(effects(&shader(&[], &[], &[call], &[kill])), discards, "{op}, called");
        assert_eq!(effects(&shader(&[], &[], &[], &[kill])), Effects::default(), "{op}, not called");
    }
    // OpReturn, OpUnreachable.
    for op in [253, 255] {
        assert!(!effects(&shader(&[], &[], &[(op, &[])], &[])).discards, "{op}");
    }
}

#[test]
fn bits_give_the_same_effects() {
    for bits in 0..=0x7f {
        assert_eq!(Effects::from_bits(bits).map(Effects::to_bits), Some(bits));
    }
    assert_eq!(Effects::from_bits(0x80), None);
}

#[test]
fn unknown_code_has_all_effects() {
    let shaders = FragmentShaders::read(&shader(&[], &[], &[], &[])).unwrap();
    assert_eq!(shaders.effects("other"), Effects::UNKNOWN);
    assert_eq!(FragmentShaders::read(&[]), None);
    assert_eq!(FragmentShaders::read(&[7, 0, 0, 0, 0]), None);
    assert_eq!(FragmentShaders::read(&[MAGIC, 0, 0, 0, 0, 0]), None, "an instruction without length");
}

proptest! {
    /// Applications pass anything: reading ends, and never panics.
    #[test]
    fn any_words_can_be_read(body in prop::collection::vec((0u32..8, prop_oneof![0u32..330, any::<u32>()]), 0..60)) {
        let mut words = vec![MAGIC, 0, 0, 0, 0];
        words.extend(body.iter().map(|(length, op)| length << 16 | op & 0xffff));
        let _ = FragmentShaders::read(&words).map(|shaders| shaders.effects("main"));
    }
}
