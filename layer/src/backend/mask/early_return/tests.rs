use super::*;
use naga::back::spv;

/// A module of a vertex and two fragment shaders; only one has the fragment's position.
const SHADERS: &str = "
    @group(0) @binding(0) var picture: texture_2d<f32>;

    struct Pixel { @builtin(position) at: vec4f, @location(0) uv: vec2f }
    struct Colors { @location(0) albedo: vec4f, @location(1) id: u32 }

    @vertex fn corner(@builtin(vertex_index) i: u32) -> Pixel {
        let clip = vec2f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0);
        return Pixel(vec4f(clip, 0.5, 1.0), clip);
    }

    @fragment fn placed(pixel: Pixel) -> @location(0) vec4f {
        return textureLoad(picture, vec2i(pixel.at.xy), 0) + dpdx(pixel.uv.x);
    }

    @fragment fn two(@location(0) uv: vec2f) -> Colors {
        if uv.x < 0.0 {
            discard;
        }
        return Colors(uv.xyxy, 7u);
    }";

fn code(source: &str, lang_version: (u8, u8)) -> Vec<u32> {
    let module = naga::front::wgsl::parse_str(source).unwrap();
    let flags = naga::valid::ValidationFlags::all();
    let valid =
        naga::valid::Validator::new(flags, naga::valid::Capabilities::all()).validate(&module).unwrap();
    let options = spv::Options { lang_version, flags: spv::WriterFlags::empty(), ..Default::default() };
    spv::write_vec(&module, &valid, &options, None).unwrap()
}

fn wanted(entry: &str) -> EarlyReturn<'_> {
    EarlyReturn { entry, set: 3, by_view: false, has_whole_subgroups: false }
}

fn count(words: &[u32], op: u32) -> usize {
    Parsed::of(words).unwrap().instructions.iter().filter(|found| found.op == op).count()
}

#[test]
fn the_entry_point_is_ours_and_the_only_one() {
    let before = code(SHADERS, (1, 3));
    assert_eq!(count(&before, op::ENTRY_POINT), 3);
    for entry in ["placed", "two"] {
        let after = returning_early(&before, wanted(entry)).unwrap();
        let parsed = Parsed::of(&after).unwrap();
        assert_eq!(count(&after, op::ENTRY_POINT), 1);
        assert_eq!(count(&after, op::FUNCTION), count(&before, op::FUNCTION) + 1);
        let ours = Entry::of(&parsed, entry).unwrap();
        let was = Entry::of(&Parsed::of(&before).unwrap(), entry).unwrap();
        assert!(ours.function >= Parsed::of(&before).unwrap().bound && parsed.bound > ours.function);
        let calls = parsed.instructions.iter().filter(|found| found.op == op::FUNCTION_CALL);
        assert_eq!(calls.filter(|found| found.operands[2] == was.function).count(), 1);
        // Its execution modes are the shader's.
        let modes: Vec<_> =
            parsed.instructions.iter().filter(|found| found.op == op::EXECUTION_MODE).collect();
        assert!(!modes.is_empty() && modes.iter().all(|found| found.operands[0] == ours.function));
    }
}

#[test]
fn a_position_that_is_there_is_used_and_outputs_get_zeros() {
    let before = code(SHADERS, (1, 3));
    let interface = |words: &[u32], entry| Entry::of(&Parsed::of(words).unwrap(), entry).unwrap().interface;
    let placed = returning_early(&before, wanted("placed")).unwrap();
    assert_eq!(interface(&placed, "placed"), interface(&before, "placed"));
    let two = returning_early(&before, wanted("two")).unwrap();
    assert_eq!(interface(&two, "two").len(), interface(&before, "two").len() + 1);
    let zeros = |words: &[u32]| count(words, op::CONSTANT_NULL);
    assert_eq!((zeros(&placed) - zeros(&before), zeros(&two) - zeros(&before)), (1, 2));
}

#[test]
fn from_1_4_on_buffers_are_in_the_interface_too() {
    for (version, more) in [((1, 0), 0), ((1, 3), 0), ((1, 4), 2)] {
        let before = code(SHADERS, version);
        let after = returning_early(&before, wanted("placed")).unwrap();
        let interface = |words| Entry::of(&Parsed::of(words).unwrap(), "placed").unwrap().interface.len();
        assert_eq!(interface(&after), interface(&before) + more, "{version:?}");
    }
}

/// Qt's shaders of multiview passes, with a view in the vertex shader only.
#[test]
fn multiview_is_an_extension_before_1_3() {
    for (version, extensions) in [((1, 0), 1), ((1, 2), 1), ((1, 3), 0)] {
        let before = code(SHADERS, version);
        let after = returning_early(&before, EarlyReturn { by_view: true, ..wanted("two") }).unwrap();
        let parsed = Parsed::of(&after).unwrap();
        let capabilities = count(&after, op::CAPABILITY);
        assert_eq!(capabilities, count(&before, op::CAPABILITY) + 1);
        let (first, rest) = parsed.instructions.split_at(capabilities);
        assert!(first.iter().all(|found| found.op == op::CAPABILITY), "{version:?}");
        let named = |found: &Instruction<'_>| {
            found.op == op::EXTENSION && text(found.operands).unwrap().0 == MULTI_VIEW_EXTENSION.to_bytes()
        };
        assert_eq!(rest.iter().filter(|found| named(found)).count(), extensions, "{version:?}");
        assert_eq!(rest.iter().take(extensions).filter(|found| named(found)).count(), extensions, "first");
    }
}

#[test]
fn the_same_module_gives_the_same_code() {
    let before = code(SHADERS, (1, 3));
    let by_view = EarlyReturn { by_view: true, ..wanted("two") };
    assert_eq!(returning_early(&before, by_view), returning_early(&before, by_view));
    assert_ne!(returning_early(&before, by_view), returning_early(&before, wanted("two")));
}

#[test]
fn discards_are_seen() {
    assert!(discards(&code(SHADERS, (1, 3))));
    assert!(!discards(&code("@fragment fn plain() -> @location(0) vec4f { return vec4f(1.0); }", (1, 3))));
    assert!(discards(&[]), "nothing is known of that");
}

#[test]
fn unknown_modules_stay_unchanged() {
    let before = code(SHADERS, (1, 3));
    assert_eq!(returning_early(&before, wanted("corner")), Err(NoEarlyReturn::Unknown), "a vertex shader");
    assert_eq!(returning_early(&before, wanted("none")), Err(NoEarlyReturn::Unknown));
    assert_eq!(returning_early(&[], wanted("two")), Err(NoEarlyReturn::Unknown));
    for length in 0..before.len() {
        let _ = returning_early(&before[..length], wanted("two"));
    }
    // Groups is the capability of SPV_AMD_shader_ballot.
    for capability in [OVER_SUBGROUPS[1], 18] {
        let mut over_subgroups = before.clone();
        over_subgroups.splice(5..5, [2 << 16 | op::CAPABILITY, capability]);
        assert_eq!(returning_early(&over_subgroups, wanted("two")), Err(NoEarlyReturn::Subgroups));
        let whole = EarlyReturn { has_whole_subgroups: true, ..wanted("two") };
        assert!(returning_early(&over_subgroups, whole).is_ok());
    }
    let mut relaxed = before.clone();
    let parsed = Parsed::of(&before).unwrap();
    let first = parsed.instructions.iter().position(|found| found.op == op::DECORATE).unwrap();
    let at = 5 + parsed.instructions[..first].iter().map(|found| found.operands.len() + 1).sum::<usize>();
    let entry = Entry::of(&parsed, "placed").unwrap();
    let is_position = |id: &&u32| parsed.is_decorated(**id, &[decoration::BUILT_IN, built_in::FRAG_COORD]);
    let position = *entry.interface.iter().find(is_position).unwrap();
    relaxed.splice(at..at, [3 << 16 | op::DECORATE, position, decoration::RELAXED_PRECISION]);
    assert_eq!(returning_early(&relaxed, wanted("placed")), Err(NoEarlyReturn::Position));
}
