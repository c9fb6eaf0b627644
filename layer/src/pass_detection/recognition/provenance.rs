//! Provenance: from the picture that is shown back to the passes that draw it.
//!
//! Content is followed, not looks: through full-screen passes to their reads, through transfers to their sources, to the cameras, passes
//! that draw many things. An image that a camera samples is a texture, regardless of its looks, and so are all images that only feed it. If
//! the reads are not known (descriptors that are not followed, compute), the eye's cameras must be the only possible ones: else none is
//! taken.

mod content;
mod feedback;
mod group;
mod kind;
mod known;
mod only;
mod remembered;
mod screens;

use super::candidate;
use super::feedback::{images_read, is_picture};
use crate::pass_detection::{Event, ImageKey, Pass, Reads};
use group::{Group, Groups};
pub(super) use kind::DrawsClass;
use kind::Kind;
pub(super) use known::Known;
use remembered::Remembered;
use smallvec::SmallVec;

/// The role of a pass, by the evidence of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub(super) enum Role {
    /// There is no evidence.
    #[default]
    Unknown,
    /// Its content becomes an eye buffer, and it shades.
    Eye,
    /// It passes the picture on: tone mapping, upscaling, a copy.
    FullScreen,
    /// The scene samples it.
    Texture,
    /// It or another may be the scene.
    Ambiguous,
}

/// So many events of a frame are followed: uploads by copies may be more, and then nothing is known.
const MOST_EVENTS: usize = 4096;

/// Looks at events of a frame; then nothing is known of it.
const MOST_STEPS: usize = 4_000_000;

/// Readers of readers.
const DEEPEST: usize = 24;

/// Groups of cameras that a picture may come from.
type Sources = SmallVec<[usize; 8]>;

/// The roles of a frame's passes. Kept from frame to frame for its memory.
#[derive(Debug, Default)]
pub(super) struct Provenance {
    nodes: Vec<Node>,
    groups: Groups,
    steps: usize,
    /// Doubtful reads on the followed path: the image has a writer later in the frame and one before the read.
    doubts: u32,
    /// Whether as many cameras as eyes may make the picture of an unknown reader.
    has_eyes: bool,
    remembered: Remembered,
}

/// One event.
#[derive(Clone, Debug)]
struct Node {
    kind: Kind,
    /// Of a camera.
    group: usize,
    writes_picture: bool,
    origins: Origins,
    /// Whether it is as large as an eye buffer, and reads its own output of the last frame.
    reads_itself: bool,
    role: Role,
}

/// The origins of a full-screen pass's content.
#[derive(Clone, Debug, Default, PartialEq)]
enum Origins {
    #[default]
    Unasked,
    /// Being worked out: it reads its own history.
    Open,
    Known {
        sources: Sources,
        /// Whether it may show more than that.
        has_unknown: bool,
    },
}

/// Findings of a frame besides roles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Findings {
    /// The last event that may read anything and makes the picture; the number of events for compute after all of them.
    pub(super) unknown_reader: Option<usize>,
    /// Number of cameras that it may read and that look like an eye.
    pub(super) candidates: usize,
    /// Whether the picture comes from cameras that do not draw it themselves, or may.
    pub(super) is_found: bool,
    /// Whether cameras draw it, and nothing else does.
    pub(super) is_direct: bool,
    /// Whether a pass on the way to it reads its own output of the last frame; or, with a swapchain as its direct target, the image so far.
    pub(super) has_feedback: bool,
    /// Whether the frame has more steps than are followed, so that it has no roles, and may have feedback.
    pub(super) is_too_long: bool,
}

impl Provenance {
    /// Finds the roles of a frame's passes for [`Self::role`]. If `is_apart`, passes after the last reader were submitted for the next
    /// frame: that reader shows the passes of the frame before.
    ///
    /// A frame of the structure of one of the last has its roles, and is not walked through.
    pub(super) fn learn(&mut self, events: &[Event], known: &Known<'_>, is_apart: bool) -> Findings {
        self.nodes.clear();
        self.groups.clear();
        (self.steps, self.doubts, self.has_eyes) = (0, 0, false);
        if events.len() > MOST_EVENTS {
            return Findings::default();
        }
        for event in events {
            let writes_picture = matches!(event, Event::Pass(pass) if known.writes_picture(pass));
            let node = Node {
                kind: Kind::Other,
                group: 0,
                writes_picture,
                origins: Origins::default(),
                reads_itself: false,
                role: Role::Unknown,
            };
            self.nodes.push(node);
        }
        self.group(events);
        let mut remembered = std::mem::take(&mut self.remembered);
        let told = match remembered.look_up(events, &self.nodes, known, is_apart) {
            Some((roles, told)) => {
                self.nodes.iter_mut().zip(roles).for_each(|(node, role)| node.role = *role);
                told
            }
            None => {
                let told = self.walk(events, known, is_apart);
                remembered.remember((0..events.len()).map(|index| self.role(index)), told);
                told
            }
        };
        self.remembered = remembered;
        told
    }

    /// Finds the roles of passes whose kinds are known.
    fn walk(&mut self, events: &[Event], known: &Known<'_>, is_apart: bool) -> Findings {
        self.find_sampled(events, known);
        self.find_sole(events, known);
        // Compute after all events, which may have read any of their images.
        let is_computed = known.are_pictures_computed && !self.nodes.iter().any(|node| node.writes_picture);
        let unknown_reader = self.find_eyes(events, known).or(is_computed.then_some(events.len()));
        let candidates = unknown_reader.map_or(0, |reader| self.find_only(reader, events, known, is_apart));
        if self.steps >= MOST_STEPS {
            self.nodes.clear();
            return Findings { is_too_long: true, ..Findings::default() };
        }
        self.set_roles(events, known);
        let groups = &self.groups.all;
        let is_found = groups.iter().any(|group| (group.is_eye && !group.is_direct) || group.is_ambiguous);
        let is_read = self.nodes.iter().any(|node| node.writes_picture && node.kind != Kind::Camera);
        let is_direct = groups.iter().any(|group| group.is_direct) && !is_read && unknown_reader.is_none();
        let has_feedback = self.has_feedback(events, known);
        Findings { unknown_reader, candidates, is_found, is_direct, has_feedback, is_too_long: false }
    }

    /// The role of the event of that number.
    pub(super) fn role(&self, index: usize) -> Role {
        self.nodes.get(index).map_or(Role::Unknown, |node| node.role)
    }

    /// Finds out which passes are cameras, and which of them are one.
    fn group(&mut self, events: &[Event]) {
        for (index, event) in events.iter().enumerate() {
            let Event::Pass(pass) = event else {
                self.nodes[index].kind = Kind::Transfer;
                continue;
            };
            let shares_depth = !pass.facts.clears_depth
                && pass.depth.is_some_and(|depth| self.groups.of_depth(&depth).is_some());
            let kind = Kind::new(pass, shares_depth, self.nodes[index].writes_picture);
            self.nodes[index].kind = kind;
            if kind == Kind::Camera {
                self.nodes[index].group = self.groups.join(index, pass, events);
            } else if kind == Kind::Other && pass.facts.clears_depth {
                // The next camera with that depth, which loads it, is another one.
                self.groups.leave_depth(pass);
            }
        }
    }

    /// Marks the groups that other cameras sample.
    fn find_sampled(&mut self, events: &[Event], known: &Known<'_>) {
        for (index, event) in events.iter().enumerate() {
            let Event::Pass(pass) = event else { continue };
            let Some(draws) = pass.draws.as_ref().filter(|_| self.nodes[index].kind == Kind::Camera) else {
                continue;
            };
            let own = self.nodes[index].group;
            // Panels of frosted glass, or drops on a visor: drawn over the picture, and made of it.
            let is_over = pass.facts.loads_color && !self.groups.all[own].has_depth;
            for reads in [&draws.read_by_meshes, &draws.read_by_quads] {
                for image in &reads.images {
                    let mut sources = Sources::new();
                    self.sources_of(*image, index, events, known, 0, &mut sources);
                    for source in sources.into_iter().filter(|source| *source != own) {
                        // A copy of the scene that both eyes make and read in turn.
                        let is_alike = self.groups.all[source].shape() == self.groups.all[own].shape();
                        let is_under = is_over && self.groups.all[source].has_depth;
                        if !(is_under || is_alike && self.feeds(own, *image, events)) {
                            self.groups.all[source].is_sampled = true;
                        }
                    }
                }
            }
        }
    }

    /// Whether a camera's picture is copied, or drawn by a full-screen pass, to an image.
    fn feeds(&self, group: usize, image: ImageKey, events: &[Event]) -> bool {
        events.iter().zip(&self.nodes).any(|(event, node)| match event {
            Event::Transfer(transfer) => {
                transfer.to.image == image && self.is_drawn_by(transfer.from.image, &[group], events)
            }
            Event::Pass(pass) => {
                let reads_it = || images_read(pass).any(|read| self.is_drawn_by(read, &[group], events));
                matches!(node.kind, Kind::Screen { .. }) && writes(pass, image) && reads_it()
            }
        })
    }

    /// Marks the groups that make the picture; the last event that makes it of anything.
    fn find_eyes(&mut self, events: &[Event], known: &Known<'_>) -> Option<usize> {
        let mut unknown_reader = None;
        for (index, event) in events.iter().enumerate() {
            match event {
                Event::Transfer(transfer) => {
                    let from = transfer.from.image;
                    if known.memory.is_placed(known.frame, from) && !known.memory.is_drawn(from) {
                        unknown_reader = Some(index);
                    }
                }
                Event::Pass(_) if !self.nodes[index].writes_picture => {}
                Event::Pass(pass) if self.nodes[index].kind == Kind::Camera => {
                    let group = &mut self.groups.all[self.nodes[index].group];
                    group.is_eye = true;
                    group.is_direct = true;
                    group.is_proven = true;
                    // Without draws that are followed, it may be a full-screen pass that loads depth.
                    if pass.draws.is_none() && !pass.facts.clears_depth {
                        unknown_reader = Some(index);
                    }
                }
                Event::Pass(pass) => {
                    let (sources, has_unknown) = self.origins(index, pass, events, known, 0);
                    let target = pass.colors.first().map(|target| target.image);
                    let is_over = target.is_some_and(|target| self.is_over(index, target, &sources, events));
                    if has_unknown {
                        unknown_reader = Some(index);
                    }
                    for source in sources {
                        let group = &mut self.groups.all[source];
                        group.is_ambiguous |= is_over && !group.is_eye;
                        group.is_eye |= !is_over;
                        group.is_proven |= !is_over && !has_unknown && group.is_sole;
                    }
                }
            }
        }
        let is_open = |group: &Group| !group.is_eye && !group.is_ambiguous;
        if unknown_reader.is_none()
            && self.groups.all.iter().all(is_open)
            && self.groups.all.iter().any(|group| group.looks_like_eye(candidate::LEAST, events, known))
        {
            // Nothing says where the picture comes from: compute or a copy made an image that the last pass reads.
            let is_last = |node: &Node| node.writes_picture && matches!(node.kind, Kind::Screen { .. });
            unknown_reader = self.nodes.iter().rposition(is_last);
        }
        unknown_reader
    }

    /// The groups of cameras that a full-screen pass shows, and whether there may be others.
    fn origins(
        &mut self,
        index: usize,
        pass: &Pass,
        events: &[Event],
        known: &Known<'_>,
        depth: usize,
    ) -> (Sources, bool) {
        match &self.nodes[index].origins {
            Origins::Known { sources, has_unknown } => return (sources.clone(), *has_unknown),
            Origins::Open => {
                let is_large = is_picture(area(pass), known.swapchains.least_picture());
                self.nodes[index].reads_itself |= self.doubts == 0 && is_large;
                return (Sources::new(), false);
            }
            Origins::Unasked if depth >= DEEPEST => return (Sources::new(), true),
            Origins::Unasked => {}
        }
        self.nodes[index].origins = Origins::Open;
        let Kind::Screen { reads_by_meshes } = self.nodes[index].kind else {
            return (Sources::new(), false);
        };
        let mut read: SmallVec<[ImageKey; Reads::MOST]> = SmallVec::new();
        let mut has_unknown = pass.draws.is_none();
        if let Some(draws) = &pass.draws {
            let by_meshes = Some(&draws.read_by_meshes).filter(|_| reads_by_meshes);
            for reads in std::iter::once(&draws.read_by_quads).chain(by_meshes) {
                has_unknown |= reads.may_read_more;
                read.extend(reads.images.iter().copied());
            }
        }
        let mut sources = Sources::new();
        let mut has_unknown_part = false;
        // Images of numbers and much smaller images (exposure, blurs) count only where the other images give no answer.
        for are_pictures in [true, false] {
            for image in read.iter().filter(|image| known.is_picture(**image, pass) == are_pictures) {
                let is_unknown = self.sources_of(*image, index, events, known, depth + 1, &mut sources);
                has_unknown |= is_unknown && known.extent(*image) == Some(area(pass));
                has_unknown_part |= is_unknown;
            }
            if !sources.is_empty() || has_unknown {
                break;
            }
        }
        self.select(&mut sources, &read, pass, events, known);
        has_unknown |= has_unknown_part && sources.is_empty();
        self.nodes[index].origins = Origins::Known { sources: sources.clone(), has_unknown };
        (sources, has_unknown)
    }

    /// Whether a full-screen pass draws over the picture of a camera that it does not read: fog, a flare. Its reads then are not the picture.
    fn is_over(&self, index: usize, image: ImageKey, sources: &Sources, events: &[Event]) -> bool {
        !sources.is_empty()
            && events[..index].iter().zip(&self.nodes).any(|(event, node)| {
                let is_other = node.kind == Kind::Camera && !sources.contains(&node.group);
                is_other && matches!(event, Event::Pass(pass) if writes(pass, image))
            })
    }

    /// Reduces the groups that a full-screen pass reads by these images to the one that it shows.
    fn select(
        &mut self,
        sources: &mut Sources,
        read: &[ImageKey],
        pass: &Pass,
        events: &[Event],
        known: &Known<'_>,
    ) {
        let groups = &self.groups.all;
        let prefer = |sources: &mut Sources, is_better: &dyn Fn(usize) -> bool| {
            if sources.len() > 1 && sources.iter().any(|source| is_better(*source)) {
                sources.retain(|source| is_better(*source));
            }
        };
        prefer(sources, &|group| !groups[group].is_sampled);
        prefer(sources, &|group| groups[group].has_depth);
        // Of another size may be the scene with an interface over it, but not where a G-buffer of this size is lit.
        let is_aligned = |group: usize| groups[group].area == area(pass);
        let is_lit = |group: usize| {
            let is_drawn = |image: &&ImageKey| self.is_drawn_by(**image, &[group], events);
            is_aligned(group) && read.iter().filter(is_drawn).count() > 1
        };
        let may_be_lit = sources.iter().any(|source| is_lit(*source));
        let looks = |group: usize, least: f32| groups[group].looks_like_eye(least, events, known);
        let is_like = |group: usize, least: f32| is_aligned(group) || (!may_be_lit && looks(group, least));
        let least = match sources.iter().any(|group| is_like(*group, candidate::LEAST)) {
            true => candidate::LEAST,
            false => candidate::LEAST_PROVEN,
        };
        prefer(sources, &|group| is_like(group, least));
        let target = pass.colors.first().map(|target| target.image);
        let draws_on = |index: &usize| matches!(&events[*index], Event::Pass(other) if other.colors.first().map(|first| first.image) == target);
        prefer(sources, &|group| groups[group].passes.iter().any(&draws_on));
        if sources.len() > 1 {
            for source in sources.drain(..) {
                self.groups.all[source].is_ambiguous = true;
            }
        }
    }

    /// Whether a camera of these groups draws an image.
    fn is_drawn_by(&self, image: ImageKey, groups: &[usize], events: &[Event]) -> bool {
        let draws = |index: &usize| matches!(&events[*index], Event::Pass(pass) if writes(pass, image));
        groups.iter().any(|group| self.groups.all[*group].passes.iter().any(&draws))
    }
}

/// Whether a pass draws an image, or resolves to it.
fn writes(pass: &Pass, image: ImageKey) -> bool {
    pass.colors.iter().chain(&pass.resolves).chain(&pass.depth).any(|target| target.image == image)
}

/// Size of a pass's render area.
fn area(pass: &Pass) -> [u32; 2] {
    [pass.area[2], pass.area[3]]
}

#[cfg(test)]
mod tests;
