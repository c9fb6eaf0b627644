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
        if sources.is_empty() {
            return self.role_of_unknown((index, pass), has_unknown, events, known);
        }
        let reads = draws.read_by_quads.images.iter().chain(&draws.read_by_meshes.images);
        let drawn_by = |sources: &Sources| -> SmallVec<[ImageKey; 8]> {
            reads.clone().copied().filter(|image| self.is_drawn_by(*image, sources, events)).collect()
        };
        let shows = |drawn: SmallVec<[ImageKey; 8]>| drawn.is_empty() || !known.is_shading(drawn.into_iter());
        if sources.iter().all(|source| is_eye(*source)) {
            return if shows(drawn_by(sources)) { Role::FullScreen } else { Role::Eye };
        }
        // The picture of a camera that may be the scene's, or a mirror.
        let is_ambiguous = |source: &usize| {
            let group = &self.groups.all[*source];
            group.role() == Role::Ambiguous && !group.is_direct
        };
        let ambiguous: Sources = sources.iter().copied().filter(is_ambiguous).collect();
        let drawn = drawn_by(&ambiguous);
        if !drawn.is_empty() && shows(drawn) { Role::FullScreen } else { Role::Unknown }
    }

    /// The role of a full-screen pass without known sources. After cameras of a possible scene, it shades the scene if its unknown reads may include
    /// a G-buffer; otherwise it shows the scene, or draws over it.
    fn role_of_unknown(
        &self,
        (index, pass): (usize, &Pass),
        has_unknown: bool,
        events: &[Event],
        known: &Known<'_>,
    ) -> Role {
        let may_be_eye = |group: &Group| group.role() == Role::Eye || group.looks_like_eye(events, known);
        let is_off_screen = |group: &Group| !group.is_direct && group.passes[0] < index && may_be_eye(group);
        // A single colour image, written by compute, is a picture; several images, or identities, may be a G-buffer.
        let shows_one = || {
            let draws = pass.draws.iter();
            let reads =
                draws.flat_map(|draws| draws.read_by_quads.images.iter().chain(&draws.read_by_meshes.images));
            self.nodes[index].writes_picture && !known.is_shading(reads.copied())
        };
        if !(has_unknown || shows_one()) || !self.groups.all.iter().any(is_off_screen) {
            return Role::Unknown;
        }
        let is_other = |group: &Group| group.role() != Role::Eye && group.looks_like_eye(events, known);
        let is_alone = || !self.groups.all.iter().any(is_other);
        let shades = has_unknown
            && self.may_shade(index, pass, events, known)
            && (self.nodes[index].writes_picture || is_alone());
        if shades { Role::Eye } else { Role::FullScreen }
    }

    /// Whether a full-screen pass with unknown reads may shade the scene: it is the first after the G-buffer of an eye, and no camera of an eye
    /// has drawn lit colours since then.
    fn may_shade(&self, index: usize, pass: &Pass, events: &[Event], known: &Known<'_>) -> bool {
        let (mut passes_between, mut buffers) = (0, 0);
        for (earlier, event) in events[..index].iter().enumerate().rev() {
            let Event::Pass(other) = event else { continue };
            match self.nodes[earlier].kind {
                Kind::Camera => {
                    let is_eye = self.groups.all[self.nodes[earlier].group].role() == Role::Eye;
                    let colors = || other.colors.iter().map(|target| target.image);
                    if is_eye && buffers == 0 && !other.colors.is_empty() && !known.is_shading(colors()) {
                        return false;
                    }
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
