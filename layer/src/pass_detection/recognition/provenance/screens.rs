//! The roles of a frame's passes: cameras have that of their group, full-screen passes that of the content which they read.

use super::group::Group;
use super::{Kind, Known, Node, Origins, Provenance, Role, Sources, area};
use crate::pass_detection::recognition::candidate;
use crate::pass_detection::{Event, ImageDescription, ImageKey, Pass, Unmatched};
use smallvec::SmallVec;

impl Provenance {
    pub(super) fn set_roles(&mut self, events: &[Event], known: &Known<'_>) {
        for (index, event) in events.iter().enumerate() {
            let Event::Pass(pass) = event else { continue };
            let role = match self.nodes[index].kind {
                Kind::Camera => self.groups.all[self.nodes[index].group].role(),
                Kind::Screen { .. } => self.role_of_screen(index, pass, events, known),
                Kind::Transfer | Kind::Other => Role::Unknown,
            };
            let is_guess = role == Role::Eye
                && known.looks(pass, candidate::LEAST) == Err(Unmatched::Small)
                && !self.is_proven(index, pass);
            self.nodes[index].role = if is_guess { Role::Unknown } else { role };
        }
    }

    /// The role of a full-screen pass that may be on the way to the picture.
    fn role_of_screen(&self, index: usize, pass: &Pass, events: &[Event], known: &Known<'_>) -> Role {
        if let Some(camera) = self.camera_over(index, pass, events) {
            return self.role_under(camera, (index, pass), events, known);
        }
        let is_eye = |group: usize| self.groups.all[group].role() == Role::Eye;
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
        let shows = |drawn: SmallVec<[ImageKey; 8]>| drawn.is_empty() || !is_g_buffer(&drawn, events, known);
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

    /// The camera of the scene that draws on where a pass has drawn.
    fn camera_over(&self, index: usize, pass: &Pass, events: &[Event]) -> Option<usize> {
        let target = pass.colors.first()?.image;
        let is_over = |(later, node): &(usize, &Node)| {
            let is_on = |pass: &Pass| pass.colors.first().is_some_and(|first| first.image == target);
            node.kind == Kind::Camera && matches!(&events[*later], Event::Pass(pass) if is_on(pass))
        };
        let (later, node) = self.nodes.iter().enumerate().skip(index + 1).find(is_over)?;
        let clears = matches!(&events[later], Event::Pass(pass) if pass.facts.clears_depth);
        let is_eye = self.groups.all[node.group].role() == Role::Eye;
        (is_eye && !clears).then_some(node.group)
    }

    /// The role of a full-screen pass on whose target a camera of the scene draws on. It shades the scene from a G-buffer, or draws its sky; or it
    /// shows a picture of the scene, as image effects between opaque and transparent draws do.
    fn role_under(
        &self,
        camera: usize,
        (index, pass): (usize, &Pass),
        events: &[Event],
        known: &Known<'_>,
    ) -> Role {
        let Some(draws) = &pass.draws else { return Role::Eye };
        let [quads, meshes] = [&draws.read_by_quads, &draws.read_by_meshes];
        let reads = || quads.images.iter().chain(&meshes.images).copied();
        let drawn: SmallVec<[ImageKey; 8]> =
            reads().filter(|image| self.is_drawn_by(*image, &[camera], events)).collect();
        let shows = match drawn.is_empty() {
            false => !is_g_buffer(&drawn, events, known) && !are_of_one_pass(&drawn, events),
            true if quads.may_read_more || meshes.may_read_more => {
                !self.may_shade((index, pass), events, known, true)
            }
            true => reads().any(|image| {
                let is_colour = |image: ImageDescription| candidate::holds_colours(image.format);
                known.is_picture(image, pass) && known.memory.description(image).is_some_and(is_colour)
            }),
        };
        if shows { Role::FullScreen } else { Role::Eye }
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
        let may_be_eye = |group: &Group| {
            group.role() == Role::Eye || group.looks_like_eye(candidate::LEAST, events, known)
        };
        let is_off_screen = |group: &Group| !group.is_direct && group.passes[0] < index && may_be_eye(group);
        let reads = || pass.draws.iter().flat_map(|draws| [&draws.read_by_quads, &draws.read_by_meshes]);
        let images: SmallVec<[ImageKey; 16]> =
            reads().flat_map(|reads| reads.images.iter().copied()).collect();
        // A single colour image, written by compute, is a picture; several images, or identities, may be a G-buffer.
        let shows_one =
            || !reads().any(|reads| reads.may_read_more) && !known.is_shading(images.iter().copied());
        let writes_picture = self.nodes[index].writes_picture;
        // The last pass shows the scene also if its reads are not followed; beside fewer cameras than eyes it may be the scene, such as a film.
        let shows_picture = writes_picture && self.has_eyes;
        if !(has_unknown || shows_picture || (writes_picture && shows_one()))
            || !self.groups.all.iter().any(is_off_screen)
        {
            return Role::Unknown;
        }
        if !has_unknown && !images.is_empty() && is_g_buffer(&images, events, known) {
            return Role::Unknown;
        }
        let is_other = |group: &Group| {
            group.role() != Role::Eye && group.looks_like_eye(candidate::LEAST, events, known)
        };
        let is_alone = || !self.groups.all.iter().any(is_other);
        let shades = has_unknown
            && !shows_one()
            && self.may_shade((index, pass), events, known, false)
            && (writes_picture || is_alone());
        if shades { Role::Eye } else { Role::FullScreen }
    }

    /// Whether a full-screen pass with unknown reads may shade the scene: it is the first after the G-buffer of an eye, and no camera of an eye
    /// has drawn lit colours since then. Under a camera that draws on, passes between to images without colours do not count: occlusion.
    fn may_shade(
        &self,
        (index, pass): (usize, &Pass),
        events: &[Event],
        known: &Known<'_>,
        is_under: bool,
    ) -> bool {
        let (mut passes_between, mut buffers) = (0, 0);
        for (earlier, event) in events[..index].iter().enumerate().rev() {
            let Event::Pass(other) = event else { continue };
            match self.nodes[earlier].kind {
                Kind::Camera => {
                    let is_eye = self.groups.all[self.nodes[earlier].group].role() == Role::Eye;
                    if !is_eye || other.colors.is_empty() {
                        continue;
                    }
                    // A thin G-buffer has colours and normals of two components, as a picture with velocities has.
                    let is_thin = is_under && other.colors.len() > 1;
                    let is_buffer =
                        is_thin || known.is_shading(other.colors.iter().map(|target| target.image));
                    if buffers == 0 && !is_buffer {
                        return false;
                    }
                    buffers += usize::from(is_buffer);
                }
                Kind::Screen { .. } if buffers > 0 => break,
                Kind::Screen { .. } => {
                    let holds_colours = |image| {
                        known
                            .memory
                            .description(image)
                            .is_none_or(|image| candidate::holds_colours(image.format))
                    };
                    let is_mask =
                        is_under && !other.colors.first().is_some_and(|first| holds_colours(first.image));
                    passes_between += usize::from(area(other) == area(pass) && !is_mask);
                }
                Kind::Transfer | Kind::Other => {}
            }
        }
        passes_between < buffers
    }
}

/// Whether images may be a G-buffer: no colours, numbers of triangles beside colours of other cameras, or at least two colour targets of one
/// pass. Colours of several passes are composed: translucency in an image of its own, a history, outlines.
fn is_g_buffer(images: &[ImageKey], events: &[Event], known: &Known<'_>) -> bool {
    let format = |image: &ImageKey| known.memory.description(*image).map(|image| image.format);
    let holds_colours = |image: &&ImageKey| format(image).is_some_and(candidate::holds_colours);
    let colours: SmallVec<[ImageKey; 8]> = images.iter().filter(holds_colours).copied().collect();
    // Numbers of objects beside the picture that was drawn with them are for outlines.
    let is_numbered = |image: &ImageKey| {
        format(image).is_some_and(candidate::holds_identities)
            && !colours.iter().any(|colour| are_of_one_pass(&[*image, *colour], events))
    };
    colours.is_empty() || images.iter().any(is_numbered) || are_of_one_pass(&colours, events)
}

/// Whether one pass draws, or resolves to, at least two of these images.
fn are_of_one_pass(images: &[ImageKey], events: &[Event]) -> bool {
    events.iter().any(|event| match event {
        Event::Transfer(_) => false,
        Event::Pass(pass) => [&pass.colors[..], &pass.resolves[..]].iter().any(|targets| {
            let is_drawn = |image: &&ImageKey| targets.iter().any(|target| target.image == **image);
            images.iter().filter(is_drawn).count() > 1
        }),
    })
}
