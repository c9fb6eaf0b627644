//! Interaction profiles and their components (OpenXR, "Interaction Profile Paths").

/// The user path of eye trackers (`XR_EXT_eye_gaze_interaction`).
pub(super) const EYES: &str = "/user/eyes_ext";

const HANDS: [&str; 2] = ["/user/hand/left", "/user/hand/right"];

/// An interaction profile.
pub(super) struct Profile {
    pub path: &'static str,
    /// An extension that the profile needs.
    pub needs: Option<&'static str>,
    users: &'static [&'static str],
    /// Components of every user path.
    common: &'static [&'static str],
    /// Components of the first user path only.
    first: &'static [&'static str],
    /// Components of the second user path only.
    second: &'static [&'static str],
}

impl Profile {
    const fn hands(path: &'static str, common: &'static [&'static str]) -> Self {
        Self { path, needs: None, users: &HANDS, common, first: &[], second: &[] }
    }

    /// Whether the profile is about a user path.
    pub fn has_user(&self, user: &str) -> bool {
        self.users.contains(&user)
    }

    /// The user path of a binding path of this profile. A binding may end before the last name, as `trigger` for
    /// `trigger/value`: the runtime then chooses the component.
    pub fn user_of(&self, binding: &str) -> Option<&'static str> {
        let sides = [self.first, self.second];
        self.users.iter().zip(0..).find_map(|(user, side)| {
            let rest = binding.strip_prefix(user)?.strip_prefix('/')?;
            let own: &[&str] = if self.users.len() == 2 { sides[side] } else { &[] };
            let fits = |component: &&str| {
                component.strip_prefix(rest).is_some_and(|end| {
                    end.is_empty()
                        || (end.starts_with('/') && end.matches('/').count() == 1 && rest.contains("/"))
                })
            };
            self.common.iter().chain(own).any(fits).then_some(*user)
        })
    }
}

/// The profiles, the preferred first: a hand holds the first that the application suggests bindings for.
pub(super) const PROFILES: [Profile; 10] = [
    Profile::hands(
        "/interaction_profiles/khr/simple_controller",
        &["input/select/click", "input/menu/click", "input/grip/pose", "input/aim/pose", "output/haptic"],
    ),
    Profile {
        first: &["input/x/click", "input/x/touch", "input/y/click", "input/y/touch", "input/menu/click"],
        second: &["input/a/click", "input/a/touch", "input/b/click", "input/b/touch", "input/system/click"],
        ..Profile::hands(
            "/interaction_profiles/oculus/touch_controller",
            &[
                "input/squeeze/value",
                "input/trigger/value",
                "input/trigger/touch",
                "input/thumbstick",
                "input/thumbstick/x",
                "input/thumbstick/y",
                "input/thumbstick/click",
                "input/thumbstick/touch",
                "input/thumbrest/touch",
                "input/grip/pose",
                "input/aim/pose",
                "output/haptic",
            ],
        )
    },
    Profile::hands(
        "/interaction_profiles/valve/index_controller",
        &[
            "input/system/click",
            "input/system/touch",
            "input/a/click",
            "input/a/touch",
            "input/b/click",
            "input/b/touch",
            "input/squeeze/value",
            "input/squeeze/force",
            "input/trigger/click",
            "input/trigger/value",
            "input/trigger/touch",
            "input/thumbstick",
            "input/thumbstick/x",
            "input/thumbstick/y",
            "input/thumbstick/click",
            "input/thumbstick/touch",
            "input/trackpad",
            "input/trackpad/x",
            "input/trackpad/y",
            "input/trackpad/force",
            "input/trackpad/touch",
            "input/grip/pose",
            "input/aim/pose",
            "output/haptic",
        ],
    ),
    Profile::hands(
        "/interaction_profiles/htc/vive_controller",
        &[
            "input/system/click",
            "input/squeeze/click",
            "input/menu/click",
            "input/trigger/click",
            "input/trigger/value",
            "input/trackpad",
            "input/trackpad/x",
            "input/trackpad/y",
            "input/trackpad/click",
            "input/trackpad/touch",
            "input/grip/pose",
            "input/aim/pose",
            "output/haptic",
        ],
    ),
    Profile::hands(
        "/interaction_profiles/microsoft/motion_controller",
        &[
            "input/menu/click",
            "input/squeeze/click",
            "input/trigger/value",
            "input/thumbstick",
            "input/thumbstick/x",
            "input/thumbstick/y",
            "input/thumbstick/click",
            "input/trackpad",
            "input/trackpad/x",
            "input/trackpad/y",
            "input/trackpad/click",
            "input/trackpad/touch",
            "input/grip/pose",
            "input/aim/pose",
            "output/haptic",
        ],
    ),
    Profile::hands(
        "/interaction_profiles/google/daydream_controller",
        &[
            "input/select/click",
            "input/trackpad",
            "input/trackpad/x",
            "input/trackpad/y",
            "input/trackpad/click",
            "input/trackpad/touch",
            "input/grip/pose",
            "input/aim/pose",
        ],
    ),
    Profile::hands(
        "/interaction_profiles/oculus/go_controller",
        &[
            "input/system/click",
            "input/trigger/click",
            "input/back/click",
            "input/trackpad",
            "input/trackpad/x",
            "input/trackpad/y",
            "input/trackpad/click",
            "input/trackpad/touch",
            "input/grip/pose",
            "input/aim/pose",
        ],
    ),
    Profile {
        path: "/interaction_profiles/htc/vive_pro",
        needs: None,
        users: &["/user/head"],
        common: &[
            "input/system/click",
            "input/volume_up/click",
            "input/volume_down/click",
            "input/mute_mic/click",
        ],
        first: &[],
        second: &[],
    },
    Profile {
        path: "/interaction_profiles/microsoft/xbox_controller",
        needs: None,
        users: &["/user/gamepad"],
        common: &[
            "input/menu/click",
            "input/view/click",
            "input/a/click",
            "input/b/click",
            "input/x/click",
            "input/y/click",
            "input/dpad_down/click",
            "input/dpad_right/click",
            "input/dpad_up/click",
            "input/dpad_left/click",
            "input/shoulder_left/click",
            "input/shoulder_right/click",
            "input/thumbstick_left/click",
            "input/thumbstick_right/click",
            "input/trigger_left/value",
            "input/trigger_right/value",
            "input/thumbstick_left",
            "input/thumbstick_left/x",
            "input/thumbstick_left/y",
            "input/thumbstick_right",
            "input/thumbstick_right/x",
            "input/thumbstick_right/y",
            "output/haptic_left",
            "output/haptic_right",
            "output/haptic_left_trigger",
            "output/haptic_right_trigger",
        ],
        first: &[],
        second: &[],
    },
    Profile {
        path: "/interaction_profiles/ext/eye_gaze_interaction",
        needs: Some("XR_EXT_eye_gaze_interaction"),
        users: &[EYES],
        common: &["input/gaze_ext/pose"],
        first: &[],
        second: &[],
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bindings_are_components_or_their_parents_on_the_right_side() {
        let touch = &PROFILES[1];
        let user = |end: &str| touch.user_of(end);
        assert_eq!(user("/user/hand/left/input/trigger/value"), Some("/user/hand/left"));
        assert_eq!(user("/user/hand/right/input/trigger"), Some("/user/hand/right"));
        assert_eq!(user("/user/hand/left/input/x/click"), Some("/user/hand/left"));
        assert_eq!(user("/user/hand/right/input/x/click"), None);
        assert_eq!(user("/user/hand/left/input"), None);
        assert_eq!(user("/user/hand/left/input/trig"), None);
        assert_eq!(user("/user/head/input/trigger"), None);
    }
}
