//! Cameras that are the scene because no other one can be.

use super::group::Group;
use super::{Known, Provenance, Sources, area};
use crate::pass_detection::recognition::candidate;
use crate::pass_detection::{Draws, Event, Pass};

impl Provenance {
    /// Finds out whether all cameras that may be the scene have one shape.
    ///
    /// A target of a third of the picture's sides may be the scene ahead of an upscaler, but just as well a reflection, a page of an interface, or
    /// particles. Of several such shapes, none is taken for its size.
    pub(super) fn find_sole(&mut self, events: &[Event], known: &Known<'_>) {
        let found: Sources = (0..self.groups.all.len())
            .filter(|index| self.may_be_scene(&self.groups.all[*index], events, known))
            .collect();
        let shape = |index: &usize| self.groups.all[*index].shape();
        if found.iter().any(|index| shape(index) != shape(&found[0])) {
            return;
        }
        for index in found {
            self.groups.all[index].is_sole = true;
        }
    }

    /// Whether a camera may be the scene by its size, whatever its format, and as far as no other one samples it.
    fn may_be_scene(&self, group: &Group, events: &[Event], known: &Known<'_>) -> bool {
        let has_colours =
            |index: &usize| matches!(&events[*index], Event::Pass(pass) if !pass.colors.is_empty());
        let writes_picture = |index: &usize| self.nodes[*index].writes_picture;
        group.has_depth
            && !group.is_sampled
            && group.passes.iter().any(has_colours)
            && (group.passes.iter().any(writes_picture) || candidate::fits(group.area, known.swapchains))
    }

    /// Whether a pass smaller than half of the picture is known to be the scene: of a camera that is, or of the same size, as lighting is.
    pub(super) fn is_proven(&self, index: usize, pass: &Pass) -> bool {
        let is_this = |group: &Group| group.passes.contains(&index) || group.area == area(pass);
        self.groups.all.iter().any(|group| group.is_proven && is_this(group))
    }

    /// Finds the cameras of a reader that may show anything: all cameras before it that look like an eye, if they are no more than eyes.
    /// Returns their number.
    pub(super) fn find_only(
        &mut self,
        reader: usize,
        events: &[Event],
        known: &Known<'_>,
        is_apart: bool,
    ) -> usize {
        let is_before = |group: &Group| (group.passes[0] < reader) != is_apart;
        let looking = |least: f32| -> Sources {
            let may_be = |group: &Group| {
                let is_found = group.is_eye || (is_before(group) && !group.is_sampled);
                is_found && group.looks_like_eye(least, events, known)
            };
            (0..self.groups.all.len()).filter(|index| may_be(&self.groups.all[*index])).collect()
        };
        let mut found = looking(candidate::LEAST);
        // Compute that writes the picture, such as an upscaler, can only have read the sole cameras.
        let is_computed = events.get(reader).is_none_or(may_be_computed);
        let is_small = found.is_empty() && is_computed;
        if is_small {
            found = looking(candidate::LEAST_PROVEN);
            found.retain(|index| self.groups.all[*index].is_sole);
        }
        let has_depth = found.iter().any(|index| self.groups.all[*index].has_depth);
        found.retain(|index| self.groups.all[*index].has_depth == has_depth);
        let Some(first) = found.first().map(|index| self.groups.all[*index].shape()) else { return 0 };
        let eyes = if first.holds_both(known) { 1 } else { known.swapchains.count_pictures().clamp(1, 2) };
        self.has_eyes = found.len() >= eyes;
        // Where the reads are known, one camera for two eyes is a shadow map or a panel, beside pictures that no event names.
        let is_known = is_computed && !matches!(events.get(reader), Some(Event::Transfer(_)));
        // Of another shape, a camera with a depth of its own may be the scene that an upscaler reads; particles share the depth of the scene.
        let clears_depth =
            |index: &usize| matches!(&events[*index], Event::Pass(pass) if pass.facts.clears_depth);
        let is_rival = |group: &Group| {
            (is_apart || is_before(group))
                && group.shape() != first
                && group.passes.iter().any(clears_depth)
                && self.may_be_scene(group, events, known)
        };
        let is_unique = !self.groups.all.iter().any(is_rival)
            && found.len() <= eyes
            && (self.has_eyes || !(is_known || is_small))
            && found.iter().all(|index| self.groups.all[*index].shape() == first);
        for index in &found {
            let group = &mut self.groups.all[*index];
            group.is_ambiguous |= !is_unique && !group.is_eye;
            group.is_eye |= is_unique;
            group.is_proven |= is_unique && is_small;
        }
        found.len()
    }
}

/// Whether an event with unknown origins reads known images: then it shows content that no event draws.
fn may_be_computed(event: &Event) -> bool {
    let may_read_more =
        |draws: &Draws| [&draws.read_by_quads, &draws.read_by_meshes].iter().any(|reads| reads.may_read_more);
    match event {
        Event::Transfer(_) => true,
        Event::Pass(pass) => pass.draws.as_ref().is_some_and(|draws| !may_read_more(draws)),
    }
}
