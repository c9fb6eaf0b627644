//! The shape of a hook of a function of armed devices.

use ash::vk;

/// The result of a hook where the layer below lacks the function. Hooks are given out only where it has it.
pub trait Missing {
    /// That result.
    const RESULT: Self;
}

impl Missing for () {
    const RESULT: Self = ();
}

impl Missing for vk::Result {
    const RESULT: Self = Self::ERROR_INITIALIZATION_FAILED;
}

/// The body of the hook of `$call`, whose arguments are `$object` and the others: runs `$body` under [`guard`](crate::abi::guard()) with
/// the object as `$find` knows it, and a closure that makes the call down with the application's own arguments. `$body` calls that once; a
/// hook that may amend the arguments takes the function of the layer below instead, with the `$answer` to be recorded.
///
/// The function around it is that of the call, so that the valid usage of the call holds for its arguments: `$object` is live.
macro_rules! hook {
    ($call:literal, $find:path, $field:ident($object:ident $(, $argument:ident)*), |$known:ident, $next:ident| $body:expr) => {
        hook!($call, $find, $field($object $(, $argument)*), |$known, function, answer| {
            // SAFETY: the next layer's function, with the application's own arguments.
            let $next = || answer.record(unsafe { function($object $(, $argument)*) });
            $body
        })
    };
    (
        $call:literal, $find:path, $field:ident($object:ident $(, $argument:ident)*),
        |$known:ident, $next:ident, $answer:ident| $body:expr
    ) => {{
        // SAFETY: the object is live, by the valid usage of the call.
        let find = || unsafe { $find($object, |next| next.$field) };
        $crate::abi::guard(
            $call,
            || match find() {
                // SAFETY: the next layer's function, with the application's own arguments.
                Some((_, next)) => unsafe { next($object $(, $argument)*) },
                None => $crate::vk::hook::Missing::RESULT,
            },
            |$answer| {
                let Some(($known, $next)) = find() else { return $crate::vk::hook::Missing::RESULT };
                $body
            },
        )
    }};
}
