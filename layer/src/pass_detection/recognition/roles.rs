//! Roles of the passes that drew one image: an image of a pool serves a mirror first and an eye later, and of a pair of images one has the
//! scene and the other its tone-mapped copy, in turns from frame to frame.

use super::HOLD;
use super::provenance::Role;
use smallvec::SmallVec;

/// Passes that draw an image in a frame, of which roles are kept.
const MOST: usize = 8;

/// Number of frames in which an image that also was a texture must be drawn in the same order, before its passes are distinguished by that.
const STEADY: u64 = 4;

/// Roles of the passes of an image. Passes with depth shade, and passes without mostly pass a picture on, so that each kind has a sequence.
#[derive(Debug, Default)]
pub(super) struct Roles {
    without_depth: Sequence,
    with_depth: Sequence,
    /// Number of the last frame in which a pass belonged to no eye.
    textured_at: Option<u64>,
}

/// Roles of the passes of an image that all have depth, or all have none, frame by frame.
#[derive(Debug, Default)]
struct Sequence {
    /// Roles in the newest frame with evidence.
    newest: SmallVec<[Role; MOST]>,
    /// Roles in the frame with evidence before that.
    before: SmallVec<[Role; MOST]>,
    /// The frame of `newest`.
    at: u64,
    /// First frame since which the roles are the same.
    same_since: u64,
}

impl Roles {
    /// The next pass in this frame, with depth or without.
    pub(super) fn add(&mut self, frame: u64, has_depth: bool, role: Role) {
        match has_depth {
            true => self.with_depth.add(frame, role),
            false => self.without_depth.add(frame, role),
        }
        if matches!(role, Role::Texture | Role::Ambiguous) {
            self.textured_at = Some(frame);
        }
    }

    /// The last frame with evidence.
    pub(super) fn at(&self) -> u64 {
        self.with_depth.at.max(self.without_depth.at)
    }

    /// Role of pass number `ordinal`, from 0, among the passes with depth, or without. That number is asked for only where it matters: to
    /// count the passes before takes longer than all else.
    pub(super) fn of(&self, frame: u64, has_depth: bool, ordinal: impl FnOnce() -> usize) -> Role {
        let was_textured = self.textured_at.is_some_and(|at| frame < at + HOLD);
        match has_depth {
            true => self.with_depth.of(frame, ordinal, was_textured),
            false => self.without_depth.of(frame, ordinal, was_textured),
        }
    }
}

impl Sequence {
    fn add(&mut self, frame: u64, role: Role) {
        if self.at != frame {
            if self.newest != self.before {
                self.same_since = self.at;
            }
            std::mem::swap(&mut self.newest, &mut self.before);
            self.newest.clear();
            self.at = frame;
        }
        if self.newest.len() < MOST {
            self.newest.push(role);
        }
    }

    fn of(&self, frame: u64, ordinal: impl FnOnce() -> usize, was_textured: bool) -> Role {
        let Some(last) = self.newest.last() else { return Role::Unknown };
        let is_one = self.newest.iter().all(|other| other == last);
        let ordinal = if is_one { 0 } else { ordinal() };
        let role = *self.newest.get(ordinal).unwrap_or(last);
        let is_steady = self.newest == self.before && frame >= self.same_since + STEADY;
        let is_eye = matches!(role, Role::Eye | Role::FullScreen);
        match is_eye && was_textured && !is_steady {
            true => Role::Ambiguous,
            false if !is_one && ordinal >= self.newest.len() => Role::Unknown,
            false => role,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(frames: &[&[Role]]) -> Roles {
        let mut roles = Roles::default();
        for (frame, passes) in (1..).zip(frames) {
            passes.iter().for_each(|role| roles.add(frame, true, *role));
        }
        roles
    }

    #[test]
    fn passes_are_told_apart_by_their_order_once_it_is_steady() {
        let pooled: &[Role] = &[Role::Texture, Role::Eye, Role::Eye];
        let young = after(&[pooled; 2]);
        assert_eq!([0, 1].map(|ordinal| young.of(3, true, || ordinal)), [Role::Texture, Role::Ambiguous]);
        let steady = after(&[pooled; 8]);
        assert_eq!(
            [0, 1, 2].map(|ordinal| steady.of(9, true, || ordinal)),
            [Role::Texture, Role::Eye, Role::Eye]
        );
        assert_eq!(steady.of(9, true, || 3), Role::Unknown);
    }

    #[test]
    fn a_mirror_that_comes_and_goes_leaves_nothing_certain() {
        let frames: Vec<&[Role]> = (0..20)
            .map(|frame| if frame % 3 == 0 { &[Role::Texture, Role::Eye][..] } else { &[Role::Eye] })
            .collect();
        for count in 4..20 {
            assert_ne!(after(&frames[..count]).of(count as u64 + 1, true, || 0), Role::Eye, "{count}");
        }
    }

    #[test]
    fn an_image_of_eyes_alone_is_so_at_once() {
        assert_eq!(after(&[&[Role::Eye]]).of(2, true, || 0), Role::Eye);
        assert_eq!(after(&[&[Role::Eye]]).of(2, true, || 3), Role::Eye);
        assert_eq!(Roles::default().of(1, true, || 0), Role::Unknown);
    }

    #[test]
    fn of_a_pair_of_images_one_has_the_scene_and_then_its_copy() {
        let mut roles = Roles::default();
        for frame in 1..10 {
            let is_scene = frame % 2 == 0;
            roles.add(frame, is_scene, if is_scene { Role::Eye } else { Role::FullScreen });
            if frame > 2 {
                assert_eq!(roles.of(frame + 1, true, || 0), Role::Eye);
                assert_eq!(roles.of(frame + 1, false, || 0), Role::FullScreen);
            }
        }
    }
}
