//! Roles of the passes that drew one image: an image of a pool serves a mirror first and an eye later.

use super::HOLD;
use super::provenance::Role;
use smallvec::SmallVec;

/// Passes that draw an image in a frame, of which roles are kept.
const MOST: usize = 8;

/// So many frames an image that also was a texture must be drawn in the same order, before its passes are told apart by that.
const STEADY: u64 = 4;

/// Roles of the passes of an image, frame by frame.
#[derive(Debug, Default)]
pub(super) struct Roles {
    /// Of the newest frame that told anything.
    newest: SmallVec<[Role; MOST]>,
    /// Of the frame before that.
    before: SmallVec<[Role; MOST]>,
    /// The frame of `newest`.
    at: u64,
    /// Since when frames told the same.
    same_since: u64,
    /// When a pass last was none of an eye.
    textured_at: Option<u64>,
}

impl Roles {
    /// The next pass in this frame.
    pub(super) fn add(&mut self, frame: u64, role: Role) {
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
        if matches!(role, Role::Texture | Role::Ambiguous) {
            self.textured_at = Some(frame);
        }
    }

    /// The last frame that told anything.
    pub(super) fn at(&self) -> u64 {
        self.at
    }

    /// Role of pass number `ordinal`, from 0.
    pub(super) fn of(&self, frame: u64, ordinal: usize) -> Role {
        let Some(last) = self.newest.last() else { return Role::Unknown };
        let role = *self.newest.get(ordinal).unwrap_or(last);
        let was_textured = self.textured_at.is_some_and(|at| frame < at + HOLD);
        let is_one = self.newest.iter().all(|other| *other == role);
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
            passes.iter().for_each(|role| roles.add(frame, *role));
        }
        roles
    }

    #[test]
    fn passes_are_told_apart_by_their_order_once_it_is_steady() {
        let pooled: &[Role] = &[Role::Texture, Role::Eye, Role::Eye];
        let young = after(&[pooled; 2]);
        assert_eq!([0, 1].map(|ordinal| young.of(3, ordinal)), [Role::Texture, Role::Ambiguous]);
        let steady = after(&[pooled; 8]);
        assert_eq!([0, 1, 2].map(|ordinal| steady.of(9, ordinal)), [Role::Texture, Role::Eye, Role::Eye]);
        assert_eq!(steady.of(9, 3), Role::Unknown);
    }

    #[test]
    fn a_mirror_that_comes_and_goes_leaves_nothing_certain() {
        let frames: Vec<&[Role]> = (0..20)
            .map(|frame| if frame % 3 == 0 { &[Role::Texture, Role::Eye][..] } else { &[Role::Eye] })
            .collect();
        for count in 4..20 {
            assert_ne!(after(&frames[..count]).of(count as u64 + 1, 0), Role::Eye, "{count}");
        }
    }

    #[test]
    fn an_image_of_eyes_alone_is_so_at_once() {
        assert_eq!(after(&[&[Role::Eye]]).of(2, 0), Role::Eye);
        assert_eq!(after(&[&[Role::Eye]]).of(2, 3), Role::Eye);
        assert_eq!(Roles::default().of(1, 0), Role::Unknown);
    }
}
