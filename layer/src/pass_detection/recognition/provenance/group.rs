//! Cameras: passes that share their depth, or their target.

use super::{Known, Role};
use crate::pass_detection::recognition::candidate;
use crate::pass_detection::{Event, ImageKey, Pass, Reads, Target};
use smallvec::SmallVec;

/// The cameras of a frame.
#[derive(Debug, Default)]
pub(super) struct Groups {
    pub(super) all: Vec<Group>,
    /// The newest group that draws each depth.
    depths: Vec<(Target, usize)>,
    /// The newest group that draws each colour target.
    colors: Vec<(Target, usize)>,
}

/// One camera.
#[derive(Clone, Debug)]
pub(super) struct Group {
    /// Its passes, first to last.
    pub(super) passes: SmallVec<[usize; 16]>,
    /// Size of their render area, pixels.
    pub(super) area: [u32; 2],
    layers: u32,
    pub(super) has_depth: bool,
    /// Another camera samples it.
    pub(super) is_sampled: bool,
    /// Its content becomes the picture.
    pub(super) is_eye: bool,
    /// That is known, and not only likely from its looks.
    pub(super) is_proven: bool,
    /// No camera of another shape can be the scene.
    pub(super) is_sole: bool,
    /// It draws the picture itself.
    pub(super) is_direct: bool,
    /// It, or another.
    pub(super) is_ambiguous: bool,
}

/// The properties that cameras of both eyes share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shape {
    area: [u32; 2],
    layers: u32,
    has_depth: bool,
}

impl Shape {
    /// Whether it has both eyes, in layers or beside each other.
    pub(super) fn holds_both(&self, known: &Known<'_>) -> bool {
        let [width, height] = self.area.map(|side| side as f32);
        self.layers == 2 || candidate::is_double_wide([width, height], known.swapchains)
    }
}

impl Groups {
    pub(super) fn clear(&mut self) {
        self.all.clear();
        self.depths.clear();
        self.colors.clear();
    }

    /// The camera whose depth this is.
    pub(super) fn of_depth(&self, depth: &Target) -> Option<usize> {
        self.depths.iter().rev().find(|(known, _)| known == depth).map(|(_, group)| *group)
    }

    /// A pass without draws clears its depth: no camera goes on with that.
    pub(super) fn leave_depth(&mut self, pass: &Pass) {
        self.depths.retain(|(known, _)| Some(*known) != pass.depth);
    }

    /// Adds a pass to the camera that it goes on with, or to one of its own.
    ///
    /// A pass that clears depth but loads the picture draws over it, as cockpits and tools in hand are drawn. Images of a pool are loaded too, by
    /// Direct3D's rules, but are read before another camera draws to them; with unknown reads, which compute's may be too, none is over another.
    pub(super) fn join(&mut self, index: usize, pass: &Pass, events: &[Event]) -> usize {
        let color = pass.colors.first().copied();
        let by_depth =
            pass.depth.filter(|_| !pass.facts.clears_depth).and_then(|depth| self.of_depth(&depth));
        let by_color = || {
            let color = color?;
            let (_, group) = *self.colors.iter().rev().find(|(known, _)| *known == color)?;
            let last = *self.all[group].passes.last()?;
            let is_over = || {
                let is_left = |event: &Event| reads(event, color.image) || clears(event, color.image);
                let may_read_more = |reads: &Reads| reads.may_read_more;
                let is_known = pass.draws.as_ref().is_some_and(|draws| {
                    !may_read_more(&draws.read_by_quads) && !may_read_more(&draws.read_by_meshes)
                });
                pass.facts.loads_color
                    && is_known
                    && !reads(&events[last], color.image)
                    && !events[last + 1..index].iter().any(is_left)
            };
            (pass.depth.is_none() || is_over()).then_some(group)
        };
        let group = by_depth.or_else(by_color).unwrap_or_else(|| {
            self.all.push(Group {
                passes: SmallVec::new(),
                area: [pass.area[2], pass.area[3]],
                layers: layers(pass),
                has_depth: pass.depth.is_some(),
                is_sampled: false,
                is_eye: false,
                is_proven: false,
                is_sole: false,
                is_direct: false,
                is_ambiguous: false,
            });
            self.all.len() - 1
        });
        self.all[group].passes.push(index);
        self.all[group].has_depth |= pass.depth.is_some();
        for (list, target) in [(&mut self.depths, pass.depth), (&mut self.colors, color)] {
            let Some(target) = target else { continue };
            match list.iter_mut().find(|(known, _)| *known == target) {
                Some((_, newest)) => *newest = group,
                None => list.push((target, group)),
            }
        }
        group
    }
}

/// Whether an event may read an image, or passes its content on at its end.
fn reads(event: &Event, image: ImageKey) -> bool {
    match event {
        Event::Transfer(transfer) => transfer.from.image == image,
        Event::Pass(pass) if pass.colors.iter().any(|target| target.image == image) => {
            !pass.resolves.is_empty()
        }
        Event::Pass(pass) => pass.draws.as_ref().is_none_or(|draws| {
            let may_read = |reads: &Reads| reads.may_read_more || reads.images.contains(&image);
            may_read(&draws.read_by_quads) || may_read(&draws.read_by_meshes)
        }),
    }
}

/// Whether an event replaces the content of an image.
fn clears(event: &Event, image: ImageKey) -> bool {
    match event {
        Event::Transfer(transfer) => transfer.to.image == image,
        Event::Pass(pass) => {
            !pass.facts.loads_color && pass.colors.first().is_some_and(|first| first.image == image)
        }
    }
}

impl Group {
    pub(super) fn shape(&self) -> Shape {
        Shape { area: self.area, layers: self.layers, has_depth: self.has_depth }
    }

    /// Whether a pass of it looks like one that draws an eye, with this least side in sides of the picture.
    pub(super) fn looks_like_eye(&self, least: f32, events: &[Event], known: &Known<'_>) -> bool {
        self.passes
            .iter()
            .any(|index| matches!(&events[*index], Event::Pass(pass) if known.looks(pass, least).is_ok()))
    }

    pub(super) fn role(&self) -> Role {
        match (self.is_eye, self.is_sampled, self.is_ambiguous) {
            (true, _, _) if self.is_direct => Role::Eye,
            (_, true, false) if !self.is_eye => Role::Texture,
            (_, true, _) | (_, _, true) => Role::Ambiguous,
            (true, false, false) => Role::Eye,
            (false, false, false) => Role::Unknown,
        }
    }
}

/// Views of multiview, else layers.
fn layers(pass: &Pass) -> u32 {
    match pass.view_mask {
        0 => pass.colors.first().or(pass.depth.as_ref()).map_or(1, |target| target.layers),
        mask => u32::BITS - mask.leading_zeros(),
    }
}
