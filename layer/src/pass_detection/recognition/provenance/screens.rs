//! The roles of a frame's passes: cameras have that of their group, full-screen passes that of the content which they read.

use super::group::Group;
use super::{Kind, Known, Origins, Provenance, Role, Sources, area};
use crate::pass_detection::{Event, ImageKey, Pass};
use smallvec::SmallVec;

impl Provenance {
    pub(super) fn set_roles(&mut self, events: &[Event], known: &Known<'_>) {
        for (index, event) in events.iter().enumerate() {
            let Event::Pass(pass) = event else { continue };
            self.nodes[index].role = match self.nodes[index].kind {
                Kind::Camera => self.groups.all[self.nodes[index].group].role(),
                Kind::Screen { .. } => self.role_of_screen(index, pass, events, known),
                Kind::Transfer | Kind::Other => Role::Unknown,
            };
        }
    }

    /// The role of a full-screen pass that may be on the way to the picture.
    fn role_of_screen(&self, index: usize, pass: &Pass, events: &[Event], known: &Known<'_>) -> Role {
        let is_eye = |group: usize| self.groups.all[group].role() == Role::Eye;
        // A camera of the scene draws on: the target is the scene, shaded by this pass.
        let target = pass.colors.first().map(|target| target.image);
        for (later, node) in self.nodes.iter().enumerate().skip(index + 1) {
            let Event::Pass(other) = &events[later] else { continue };
            if target.is_none() || other.colors.first().map(|first| first.image) != target {
                continue;
            }
            match node.kind {
                Kind::Camera if !other.facts.clears_depth && is_eye(node.group) => return Role::Eye,
                Kind::Camera => break,
                _ => {}
            }
        }
        let Some(draws) = pass.draws.as_ref().filter(|draws| draws.quads + draws.meshes > 0) else {
            return Role::Unknown;
        };
        let no_sources = Sources::new();
        let (sources, has_unknown) = match &self.nodes[index].origins {
            Origins::Known { sources, has_unknown } => (sources, *has_unknown),
            Origins::Unasked | Origins::Open => (&no_sources, draws.read_by_quads.may_read_more),
        };
        if sources.is_empty() && has_unknown {
            return self.role_of_unknown(index, pass, events, known);
        }
        if sources.is_empty() || !sources.iter().all(|source| is_eye(*source)) {
            return Role::Unknown;
        }
        let reads = draws.read_by_quads.images.iter().chain(&draws.read_by_meshes.images);
        let drawn: SmallVec<[ImageKey; 8]> =
            reads.copied().filter(|image| self.is_drawn_by(*image, sources, events)).collect();
        match !drawn.is_empty() && known.is_shading(drawn.into_iter()) {
            true => Role::Eye,
            false => Role::FullScreen,
        }
    }

    /// The role of a full-screen pass with unknown reads.
    fn role_of_unknown(&self, index: usize, pass: &Pass, events: &[Event], known: &Known<'_>) -> Role {
        let is_off_screen = |group: &Group| group.role() == Role::Eye && !group.is_direct;
        if !self.groups.all.iter().any(|group| is_off_screen(group) && group.passes[0] < index) {
            return Role::Unknown;
        }
        let is_other = |group: &Group| group.role() != Role::Eye && group.looks_like_eye(events, known);
        let is_alone = || !self.groups.all.iter().any(is_other);
        let shades =
            self.may_shade(index, pass, events, known) && (self.nodes[index].writes_picture || is_alone());
        if shades { Role::Eye } else { Role::FullScreen }
    }

    /// Whether a full-screen pass with unknown reads may shade the scene: it is the first after the G-buffer of an eye.
    fn may_shade(&self, index: usize, pass: &Pass, events: &[Event], known: &Known<'_>) -> bool {
        let (mut passes_between, mut buffers) = (0, 0);
        for (earlier, event) in events[..index].iter().enumerate().rev() {
            let Event::Pass(other) = event else { continue };
            match self.nodes[earlier].kind {
                Kind::Camera => {
                    let is_eye = self.groups.all[self.nodes[earlier].group].role() == Role::Eye;
                    let colors = || other.colors.iter().map(|target| target.image);
                    buffers += usize::from(is_eye && !other.colors.is_empty() && known.is_shading(colors()));
                }
                Kind::Screen { .. } if buffers > 0 => break,
                Kind::Screen { .. } => {
                    passes_between += usize::from(area(other) == area(pass));
                }
                Kind::Transfer | Kind::Other => {}
            }
        }
        passes_between < buffers
    }
}
