//! Buttons, profiles and priorities.

use super::{SUCCESS, empty_frame};
use crate::application::{Application, call, structure};
use openxr_sys as xr;

const SIMPLE: &str = "/interaction_profiles/khr/simple_controller";
const SELECT: &str = "/user/hand/right/input/select/click";

pub fn select() {
    let app = Application::running();
    let set = app.action_set("play");
    let action = app.action(set, "press", xr::ActionType::BOOLEAN_INPUT);
    assert_eq!(app.suggest(SIMPLE, &[(action, SELECT)]), SUCCESS);
    assert_eq!(app.attach(&[set]), SUCCESS);
    // Not focused before the first frame.
    assert_eq!(app.sync(&[set]), xr::Result::SESSION_NOT_FOCUSED);
    let read = || {
        empty_frame(&app);
        assert_eq!(app.sync(&[set]), SUCCESS);
        let state = app.boolean(action).unwrap();
        (
            bool::from(state.is_active),
            bool::from(state.current_state),
            bool::from(state.changed_since_last_sync),
        )
    };
    let (first, second, third) = (read(), read(), read());
    assert_eq!([first, second, third], [(true, false, false), (true, true, true), (true, true, false)]);

    while let Some(event) = app.poll() {
        if event.ty == xr::EventDataInteractionProfileChanged::TYPE {
            let mut state = structure!(InteractionProfileState {});
            let hand = app.path("/user/hand/right");
            assert_eq!(call!(app, GetCurrentInteractionProfile(app.session, hand, &mut state)), SUCCESS);
            assert_eq!(state.interaction_profile, app.path(SIMPLE));
            return;
        }
    }
    panic!("no event tells of the interaction profile");
}

pub fn priority() {
    let app = Application::running();
    let make = |name: &str, priority| {
        let info = structure!(ActionSetCreateInfo {
            action_set_name: crate::application::name(name),
            localized_action_set_name: crate::application::name(name),
            priority: priority,
        });
        let mut set = xr::ActionSet::default();
        assert_eq!(call!(app, CreateActionSet(app.instance, &info, &mut set)), SUCCESS);
        (set, app.action(set, "press", xr::ActionType::BOOLEAN_INPUT))
    };
    let ((game, play), (menu, choose)) = (make("game", 0), make("menu", 1));
    assert_eq!(app.suggest(SIMPLE, &[(play, SELECT), (choose, SELECT)]), SUCCESS);
    assert_eq!(app.attach(&[game, menu]), SUCCESS);
    empty_frame(&app);
    let active = |sets: &[xr::ActionSet]| {
        assert_eq!(app.sync(sets), SUCCESS);
        [play, choose].map(|action| bool::from(app.boolean(action).unwrap().is_active))
    };
    assert_eq!(
        [active(&[game, menu]), active(&[game]), active(&[])],
        [[false, true], [true, false], [false, false]]
    );
}
