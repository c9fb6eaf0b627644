use super::*;
use crate::pass_detection::Unmasked;
use parafovea_core::mask::NoNearValue;

const ONE: vk::SampleCountFlags = vk::SampleCountFlags::TYPE_1;
const FOUR: vk::SampleCountFlags = vk::SampleCountFlags::TYPE_4;

/// Depth of a plain forward pass.
pub fn depth() -> DepthFacts {
    DepthFacts {
        format: vk::Format::D32_SFLOAT,
        samples: ONE,
        usage: vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT,
        clear: 1.0,
        is_loaded: false,
        is_loadable: true,
        is_covered: false,
        is_read_within: false,
        stores_stencil: false,
        is_loaded_later: false,
        is_submitted: false,
        is_separate: false,
        is_writable: true,
        is_readable: true,
    }
}

/// Colour of a plain forward pass.
pub fn color() -> ColorFacts {
    ColorFacts { format: vk::Format::R8G8B8A8_SRGB, samples: ONE, is_stored: true, is_fillable: true }
}

/// A plain forward pass, changed by `change`.
fn judged(
    change: impl FnOnce(&mut PassFacts, &mut DepthFacts, &mut ColorFacts, &mut PipelineFacts),
) -> Result<Eligible, Unmasked> {
    let mut pass = PassFacts { clears_depth: true, ..PassFacts::default() };
    let (mut depth, mut color) = (depth(), color());
    let mut pipelines = PipelineFacts::default();
    pipelines.directions.see(vk::CompareOp::LESS);
    change(&mut pass, &mut depth, &mut color, &mut pipelines);
    eligible(&MaskFacts { pass, depth: Some(depth), colors: &[color], pipelines, prefers_return: false })
}

fn refused(
    change: impl FnOnce(&mut PassFacts, &mut DepthFacts, &mut ColorFacts, &mut PipelineFacts),
) -> Unmasked {
    judged(change).unwrap_err()
}

const FORWARD: Eligible = Eligible {
    depths: TemplateDepths { shaded: 1.0, skipped: 0.0 },
    format: DepthFormat::Float32,
    drawn: None,
    work: DepthWork { covers: false, fills: false },
};

/// Depth that is needed after the pass.
const FILLED: Eligible = Eligible { work: DepthWork { covers: false, fills: true }, ..FORWARD };

#[test]
fn a_forward_pass_is_eligible() {
    assert_eq!(judged(|_, _, _, _| ()), Ok(FORWARD));
}

#[test]
fn reversed_depth_is_eligible() {
    let reversed = judged(|_, depth, _, pipelines| {
        depth.clear = 0.0;
        pipelines.directions = Directions::default();
        pipelines.directions.see(vk::CompareOp::GREATER_OR_EQUAL);
        pipelines.directions.see(vk::CompareOp::EQUAL);
    });
    assert_eq!(reversed.map(|found| found.depths), Ok(TemplateDepths { shaded: 0.0, skipped: 1.0 }));
}

#[test]
fn samples_that_are_resolved_and_not_stored_are_no_obstacle() {
    let resolved =
        ColorFacts { format: vk::Format::R8G8B8A8_SRGB, samples: ONE, is_stored: true, is_fillable: true };
    let drawn = ColorFacts { samples: FOUR, is_stored: false, is_fillable: false, ..resolved };
    assert_eq!(of_colors(&[drawn, resolved]), Ok(()));
}

#[test]
fn stored_depth_that_nobody_can_read_is_no_obstacle() {
    assert_eq!(judged(|pass, _, _, _| pass.stores_depth = true), Ok(FORWARD));
    assert_eq!(
        judged(|_, depth, _, _| depth.usage |= vk::ImageUsageFlags::SAMPLED),
        Ok(FORWARD),
        "not stored"
    );
    assert_eq!(judged(|_, depth, _, _| depth.is_loaded_later = true), Ok(FORWARD), "not stored");
}

#[test]
fn no_depth() {
    let color =
        ColorFacts { format: vk::Format::R8G8B8A8_SRGB, samples: ONE, is_stored: true, is_fillable: true };
    let (pass, pipelines) = (PassFacts::default(), PipelineFacts::default());
    let facts = MaskFacts { pass, depth: None, colors: &[color], pipelines, prefers_return: false };
    assert_eq!(eligible(&facts), Err(Unmasked::NoDepth));
}

#[test]
fn loaded_depth_is_covered() {
    let loaded = |change: fn(&mut DepthFacts)| {
        judged(|pass, depth, _, _| {
            pass.clears_depth = false;
            depth.is_loaded = true;
            change(depth);
        })
    };
    let covered = Eligible { work: DepthWork { covers: true, fills: false }, ..FORWARD };
    assert_eq!(loaded(|_| ()), Ok(covered));
    assert_eq!(loaded(|depth| depth.is_loaded = false), Err(Unmasked::DepthUndefined));
    assert_eq!(loaded(|depth| depth.samples = FOUR), Err(Unmasked::DepthLoaded));
    let drawn = Some((vk::Format::D32_SFLOAT, FOUR));
    let goes_on = loaded(|depth| (depth.samples, depth.is_covered) = (FOUR, true));
    assert_eq!(goes_on, Ok(Eligible { drawn, ..covered }));
    assert_eq!(loaded(|depth| depth.clear = f32::NAN), Err(Unmasked::DepthUncleared));
    assert_eq!(loaded(|depth| depth.is_read_within = true), Err(Unmasked::DepthReadWithin));
    assert_eq!(loaded(|depth| depth.is_readable = false), Err(Unmasked::NotReadable));
}

#[test]
fn unknown_depth_formats() {
    let format = vk::Format::S8_UINT;
    assert_eq!(refused(|_, depth, _, _| depth.format = format), Unmasked::DepthFormat(format));
}

#[test]
fn depth_with_several_samples_is_drawn() {
    let judged = judged(|_, depth, _, _| depth.samples = FOUR);
    assert_eq!(judged, Ok(Eligible { drawn: Some((vk::Format::D32_SFLOAT, FOUR)), ..FORWARD }));
}

#[test]
fn transient_depth() {
    let transient = vk::ImageUsageFlags::TRANSIENT_ATTACHMENT;
    assert_eq!(refused(|_, depth, _, _| depth.usage |= transient), Unmasked::Transient);
}

#[test]
fn stored_depth_that_is_needed_is_filled() {
    let needed: [fn(&mut DepthFacts); 5] = [
        |depth| depth.usage |= vk::ImageUsageFlags::SAMPLED,
        |depth| depth.usage |= vk::ImageUsageFlags::TRANSFER_SRC,
        |depth| depth.usage |= vk::ImageUsageFlags::INPUT_ATTACHMENT,
        |depth| depth.is_loaded_later = true,
        |depth| depth.is_submitted = true,
    ];
    for need in needed {
        let stored = |change: fn(&mut DepthFacts)| {
            judged(|pass, depth, _, _| {
                pass.stores_depth = true;
                need(depth);
                change(depth);
            })
        };
        assert_eq!(stored(|_| ()), Ok(FILLED));
        let drawn = Some((vk::Format::D32_SFLOAT, FOUR));
        assert_eq!(stored(|depth| depth.samples = FOUR), Ok(Eligible { drawn, ..FILLED }));
        assert_eq!(stored(|depth| depth.is_readable = false), Err(Unmasked::NotReadable));
    }
}

#[test]
fn resolved_depth() {
    assert_eq!(refused(|pass, _, _, _| pass.resolves_depth = true), Unmasked::DepthResolved);
}

#[test]
fn depth_cleared_in_the_pass() {
    assert_eq!(refused(|pass, _, _, _| pass.clears_depth_later = true), Unmasked::DepthClearedLater);
}

#[test]
fn loaded_and_stored_stencil() {
    assert_eq!(judged(|pass, _, _, _| pass.loads_stencil = true), Ok(FORWARD));
    let several = |pass: &mut PassFacts, depth: &mut DepthFacts, _: &mut _, _: &mut _| {
        pass.loads_stencil = true;
        depth.samples = FOUR;
    };
    assert_eq!(refused(several), Unmasked::StencilLoaded);
    assert_eq!(judged(|_, depth, _, _| depth.stores_stencil = true), Ok(FORWARD), "not written");
    let written = |_: &mut _, depth: &mut DepthFacts, _: &mut _, pipelines: &mut PipelineFacts| {
        depth.stores_stencil = true;
        pipelines.write_stencil = true;
    };
    assert_eq!(refused(written), Unmasked::StencilStored);
}

#[test]
fn queries() {
    assert_eq!(refused(|pass, _, _, _| pass.is_queried = true), Unmasked::Queried);
}

#[test]
fn side_effects() {
    assert_eq!(refused(|_, _, _, pipelines| pipelines.have_side_effects = true), Unmasked::SideEffects);
    assert_eq!(
        refused(|_, _, _, pipelines| pipelines.see(PipelineFacts::UNKNOWN)),
        Unmasked::UnknownPipelines
    );
}

#[test]
fn rates_of_the_application() {
    assert_eq!(refused(|pass, _, _, _| pass.has_own_rates = true), Unmasked::OwnRates);
}

#[test]
fn suspended_rendering() {
    assert_eq!(refused(|pass, _, _, _| pass.is_suspended = true), Unmasked::Suspended);
}

#[test]
fn nothing_stored() {
    assert_eq!(refused(|_, _, color, _| color.is_stored = false), Unmasked::NothingStored);
}

#[test]
fn integer_colours() {
    let format = vk::Format::R32_UINT;
    assert_eq!(refused(|_, _, color, _| color.format = format), Unmasked::ColorFormat(format));
}

/// Motion, masks and indices beside colour, as engines draw them; not alone, and not in a format of no known size.
#[test]
fn other_targets_beside_colour() {
    let beside = |format, samples| of_colors(&[color(), ColorFacts { format, samples, ..color() }]);
    for format in [vk::Format::R16G16_SFLOAT, vk::Format::R8_UNORM, vk::Format::R32_UINT] {
        assert_eq!(beside(format, ONE), Ok(()));
        let alone = ColorFacts { format, ..color() };
        assert_eq!(of_colors(&[alone; 2]), Err(Unmasked::ColorFormat(format)));
        let unstored = ColorFacts { is_stored: false, ..color() };
        assert_eq!(of_colors(&[unstored, alone]), Err(Unmasked::ColorFormat(format)));
        let unfillable = ColorFacts { is_fillable: false, ..alone };
        assert_eq!(of_colors(&[color(), unfillable]), Err(Unmasked::NotFillable));
    }
    let others =
        [(vk::Format::R16G16_SFLOAT, FOUR), (vk::Format::R32_UINT, FOUR), (vk::Format::R64_SFLOAT, ONE)];
    for (format, samples) in others {
        assert_eq!(beside(format, samples), Err(Unmasked::ColorFormat(format)));
    }
}

#[test]
fn stored_samples() {
    assert_eq!(judged(|_, _, color, _| color.samples = FOUR), Ok(FORWARD));
    assert_eq!(
        refused(|_, _, color, _| (color.samples, color.is_fillable) = (FOUR, false)),
        Unmasked::NotFillable
    );
}

#[test]
fn a_depth_prepass_has_nothing_to_fill_but_depth() {
    let prepass = judged(|pass, depth, _, _| (pass.stores_depth, depth.is_loaded_later) = (true, true));
    let pass = PassFacts { clears_depth: true, stores_depth: true, ..PassFacts::default() };
    let mut facts = None;
    let _ = judged(|_, depth, _, pipelines| facts = Some((*depth, *pipelines)));
    let (depth, pipelines) = facts.unwrap();
    let depth = DepthFacts { is_loaded_later: true, ..depth };
    let without_color =
        eligible(&MaskFacts { pass, depth: Some(depth), colors: &[], pipelines, prefers_return: false });
    assert_eq!((without_color, without_color.map(|found| found.work.fills)), (prepass, Ok(true)));
}

#[test]
fn images_that_cannot_be_filled() {
    assert_eq!(refused(|_, _, color, _| color.is_fillable = false), Unmasked::NotFillable);
}

#[test]
fn uncertain_directions() {
    let reason = refused(|_, depth, _, pipelines| {
        depth.clear = 0.5;
        pipelines.directions.see(vk::CompareOp::GREATER);
    });
    assert_eq!(reason, Unmasked::Near(NoNearValue::Direction(0.5)));
    assert_eq!(
        reason.to_string(),
        "depth is cleared to 0.5, and the direction of its depth tests is uncertain"
    );
}
