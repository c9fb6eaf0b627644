//! Caps of the sphere of directions.

use super::eccentricity;
use glam::Vec3;

/// All directions within an angle of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cap {
    /// The direction in the middle, of unit length.
    pub centre: Vec3,
    /// The angle, radians, 0..=pi.
    pub radius: f32,
}

impl Cap {
    /// The smallest cap that holds this one and `direction`, which is of unit length.
    pub fn including(self, direction: Vec3) -> Self {
        let away = eccentricity(self.centre, direction);
        if away <= self.radius {
            return self;
        }
        // From this cap's far edge to the direction, along the great circle through both.
        let centre = turned(self.centre, direction, (away - self.radius) / 2.0);
        Self { centre, radius: (away + self.radius) / 2.0 }
    }

    /// A smaller cap that still holds `direction` (of unit length), if this one does: no direction is farther from
    /// the new cap than it was from this one by more than `angle` (radians, at least 0). In the end, only `direction`
    /// is left.
    pub fn contracted_to(self, direction: Vec3, angle: f32) -> Self {
        let away = eccentricity(self.centre, direction);
        // The radius shrinks by `angle` less the move of the centre, and the direction stays inside.
        let towards = ((angle - (self.radius - away)) / 2.0).clamp(0.0, away.min(angle));
        let radius = (self.radius - (angle - towards)).max(away - towards).max(0.0);
        Self { centre: turned(self.centre, direction, towards), radius }
    }

    /// The middle of this cap, turned towards a direction (of unit length) by at most `angle` (radians, at least 0), and no farther than it.
    pub fn turned_towards(self, direction: Vec3, angle: f32) -> Vec3 {
        let away = eccentricity(self.centre, direction);
        if away <= angle { direction } else { turned(self.centre, direction, angle) }
    }
}

/// `from` turned by `angle` towards `to`; both are of unit length. Opposite ones have no way between that is shorter
/// than others: any is taken.
fn turned(from: Vec3, to: Vec3, angle: f32) -> Vec3 {
    let sideways = (to - from * from.dot(to)).try_normalize();
    let sideways = sideways.unwrap_or_else(|| from.any_orthonormal_vector());
    (from * angle.cos() + sideways * angle.sin()).normalize_or(from)
}

#[cfg(test)]
mod tests;
