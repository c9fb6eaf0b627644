//! The profile's rules on passes.

use super::Parts;
use crate::pass_detection::{Event, Eyes, ImageDescription, ImageKey, Orientation, Part, Pass, Unmatched};
use parafovea_manifest::options::{PassKind, PassRule, PassRules, WayUp};

/// The verdict of the first rule that fits `pass`, which comes after `earlier` in its frame; `None` where none fits.
pub(super) fn judge(
    rules: &PassRules,
    pass: &Pass,
    earlier: &[Event],
    description: impl Fn(ImageKey) -> Option<ImageDescription> + Copy,
) -> Option<Result<Parts, Unmatched>> {
    let fits = |rule: &&PassRule| {
        rule_fits(rule, pass, description)
            && rule.ordinal.is_none_or(|ordinal| {
                let before = earlier.iter().filter(
                    |event| matches!(event, Event::Pass(other) if rule_fits(rule, other, description)),
                );
                before.count() + 1 == ordinal as usize
            })
    };
    let rule = rules.iter().find(fits)?;
    let orientation = match rule.way_up {
        Some(WayUp::Upright) => Orientation::Upright,
        Some(WayUp::Flipped) => Orientation::UpsideDown,
        None => Orientation::Unknown,
    };
    let part = |eyes, layer, x, width| Part { eyes, layer, rect: [x, 0.0, width, 1.0], orientation };
    let whole = |eyes| {
        let layers = pass.colors.first().map_or(1, |target| target.layers).min(2);
        Ok((0..layers).map(|layer| part(eyes, layer, 0.0, 1.0)).collect())
    };
    Some(match rule.kind {
        PassKind::Exclude => Err(Unmatched::Excluded),
        PassKind::Left => whole(Eyes::Left),
        PassKind::Right => whole(Eyes::Right),
        PassKind::Either => whole(Eyes::Finer),
        PassKind::DoubleWide => {
            Ok([part(Eyes::Left, 0, 0.0, 0.5), part(Eyes::Right, 0, 0.5, 0.5)].into_iter().collect())
        }
        PassKind::Array => {
            Ok([part(Eyes::Left, 0, 0.0, 1.0), part(Eyes::Right, 1, 0.0, 1.0)].into_iter().collect())
        }
    })
}

/// Whether a colour target of the pass has the rule's format and size.
fn rule_fits(
    rule: &PassRule,
    pass: &Pass,
    description: impl Fn(ImageKey) -> Option<ImageDescription>,
) -> bool {
    pass.colors.iter().filter_map(|target| description(target.image)).any(|image| {
        rule.format.is_none_or(|format| format.value() == image.format.as_raw())
            && rule.extent.is_none_or(|extent| extent == image.extent)
    })
}
