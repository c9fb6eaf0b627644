//! A program that draws with rate attachments, in each form that there is, rightly or with one thing broken.

mod commands;
mod compute;
mod objects;
mod pipelines;
mod setup;

use setup::Setup;

/// The variable with the form.
pub const FORM_VARIABLE: &str = "PARAFOVEA_TEST_FORM";
/// The variable with the name of the violation; without it, there is none.
pub const BROKEN_VARIABLE: &str = "PARAFOVEA_TEST_BROKEN";

/// The program's setting.
#[derive(Clone)]
pub struct Plan {
    form: String,
    broken: String,
}

impl Plan {
    fn of_environment() -> Self {
        let value = |name| std::env::var(name).unwrap_or_default();
        Self { form: value(FORM_VARIABLE), broken: value(BROKEN_VARIABLE) }
    }

    /// Whether the form's name contains this part.
    fn is(&self, part: &str) -> bool {
        self.form.contains(part)
    }

    fn breaks(&self, what: &str) -> bool {
        self.broken == what
    }

    /// The value where nothing is broken, or the other.
    fn unless<T>(&self, what: &str, right: T, wrong: T) -> T {
        if self.breaks(what) { wrong } else { right }
    }
}

#[test]
#[ignore = "started by other tests"]
fn rates() {
    let plan = Plan::of_environment();
    let Some(setup) = Setup::new(plan.clone()) else { return };
    if plan.is("objects") {
        objects::create(&setup);
    } else {
        println!("result {}", commands::frames(&setup));
    }
}
