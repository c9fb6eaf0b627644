//! The roles of the last frames, for frames of the same structure: most frames of an application do the same as the one before.

use super::{Findings, Kind, Known, Node, Role, area};
use crate::pass_detection::{Event, ImageKey, Reads, Target};
use rustc_hash::FxHashMap;

/// Structures that are remembered: a mirror or a shadow map may be drawn in every second or third frame.
const MOST: usize = 4;

/// The last structures. Kept from frame to frame for its memory.
#[derive(Debug, Default)]
pub(super) struct Remembered {
    entries: Vec<Entry>,
    structure: Structure,
}

/// A frame.
#[derive(Debug, Default)]
struct Entry {
    words: Vec<u64>,
    roles: Vec<Role>,
    told: Findings,
}

/// All of a frame's events that roles depend on, as plain words: frames with the same words have the same roles. Images are numbered as
/// they first occur, so that swapchain images in turn, and recreated images, compare equal.
#[derive(Debug, Default)]
struct Structure {
    words: Vec<u64>,
    numbers: FxHashMap<ImageKey, u32>,
}

impl Remembered {
    /// Looks a frame up, whose nodes have their kinds: its roles, event by event, and its other findings. Where it is not there,
    /// [`Self::remember`] puts it there.
    pub(super) fn look_up(
        &mut self,
        events: &[Event],
        nodes: &[Node],
        known: &Known<'_>,
        is_apart: bool,
    ) -> Option<(&[Role], Findings)> {
        self.structure.take(events, nodes, known, is_apart);
        let index = self.entries.iter().position(|entry| entry.words == self.structure.words)?;
        // The newest is first.
        self.entries[..=index].rotate_right(1);
        let entry = &self.entries[0];
        Some((&entry.roles, entry.told))
    }

    /// Remembers the frame that was looked up last; the oldest goes.
    pub(super) fn remember(&mut self, roles: impl Iterator<Item = Role>, told: Findings) {
        let mut entry =
            if self.entries.len() < MOST { Entry::default() } else { self.entries.pop().unwrap_or_default() };
        std::mem::swap(&mut entry.words, &mut self.structure.words);
        entry.roles.clear();
        entry.roles.extend(roles);
        entry.told = told;
        self.entries.insert(0, entry);
    }
}

impl Structure {
    fn take(&mut self, events: &[Event], nodes: &[Node], known: &Known<'_>, is_apart: bool) {
        self.words.clear();
        self.numbers.clear();
        self.words.push(u64::from(is_apart) | u64::from(known.are_pictures_computed) << 1);
        for (picture, is_filled) in known.swapchains.pictures() {
            let [_, _, width, height] = picture.rect.map(f32::to_bits);
            self.words.extend([two(width, height), u64::from(is_filled)]);
        }
        for (event, node) in events.iter().zip(nodes) {
            match event {
                Event::Transfer(transfer) => {
                    self.words.push(u64::MAX);
                    self.image(transfer.from.image, known);
                    self.image(transfer.to.image, known);
                }
                Event::Pass(pass) => {
                    let flags = [
                        node.writes_picture,
                        pass.facts.clears_depth,
                        pass.facts.loads_color,
                        pass.draws.is_some(),
                        pass.depth.is_some(),
                    ];
                    let flags = flags.into_iter().fold(0, |flags, flag| flags << 1 | u64::from(flag));
                    let counts = two(pass.colors.len() as u32, pass.resolves.len() as u32);
                    let [width, height] = area(pass);
                    self.words.extend([flags << 8 | code(node.kind), counts, two(width, height)]);
                    self.words.push(pass.view_mask.into());
                    for target in pass.colors.iter().chain(&pass.resolves).chain(&pass.depth) {
                        self.target(target, known);
                    }
                    if let Some(draws) = &pass.draws {
                        self.reads(&draws.read_by_quads, known);
                        self.reads(&draws.read_by_meshes, known);
                    }
                }
            }
        }
    }

    fn target(&mut self, target: &Target, known: &Known<'_>) {
        self.image(target.image, known);
        self.words.extend([two(target.level, target.base_layer), target.layers.into()]);
    }

    fn reads(&mut self, reads: &Reads, known: &Known<'_>) {
        self.words.push((reads.images.len() as u64) << 1 | u64::from(reads.may_read_more));
        reads.images.iter().for_each(|image| self.image(*image, known));
    }

    /// The number of an image, and where it is a new one, all that is known of it.
    fn image(&mut self, image: ImageKey, known: &Known<'_>) {
        let next = self.numbers.len() as u32;
        let number = *self.numbers.entry(image).or_insert(next);
        self.words.push(number.into());
        if number != next {
            return;
        }
        let Some(described) = known.memory.description(image) else { return self.words.push(u64::MAX) };
        let flags = [
            known.memory.is_placed(known.frame, image),
            known.memory.is_drawn(image),
            known.swapchains.shown_of(Some(described)).is_some(),
        ];
        let flags = flags.into_iter().fold(0, |flags, flag| flags << 1 | u32::from(flag));
        let [width, height] = described.extent;
        self.words.extend([two(described.format.as_raw().cast_unsigned(), flags), two(width, height)]);
    }
}

/// Two numbers in one word.
fn two(first: u32, second: u32) -> u64 {
    u64::from(first) << 32 | u64::from(second)
}

fn code(kind: Kind) -> u64 {
    match kind {
        Kind::Camera => 0,
        Kind::Screen { reads_by_meshes: false } => 1,
        Kind::Screen { reads_by_meshes: true } => 2,
        Kind::Transfer => 3,
        Kind::Other => 4,
    }
}
