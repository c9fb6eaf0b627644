//! The state of the process: every object behind one lock, and the way each call takes through it.

use crate::abi::pointers::{In, Valid};
use crate::abi::structures::Structure;
use crate::actions::{Action, ActionSet};
use crate::clock::{self, Clock};
use crate::debug_utils::{self, Messenger};
use crate::fault::{Fault, Outcome, result_name, structure_name};
use crate::handles::{Serial, Table};
use crate::injected::{InjectedFault, InjectedFaults};
use crate::instance::Instance;
use crate::record::INJECTED;
use crate::recorder::Recorder;
use crate::scenario::{Answer, Scenario};
use crate::session::Session;
use crate::spaces::Space;
use crate::swapchain::Swapchain;
use crate::turns::Turns;
use openxr_sys as xr;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// Everything that calls read or change.
pub(crate) struct Runtime {
    pub scenario: Scenario,
    /// Reason why the scenario file cannot be used: no instance is made then.
    pub broken: Option<String>,
    pub clock: Clock,
    pub recorder: Recorder,
    /// Socket that gives frames their turn; None if frames take no turns.
    pub turns: Option<Arc<Turns>>,
    /// Frames that the process ended.
    pub frames: u64,
    pub serial: Serial,
    pub instances: Table<xr::Instance, Instance>,
    pub messengers: Table<xr::DebugUtilsMessengerEXT, Messenger>,
    pub sessions: Table<xr::Session, Session>,
    pub spaces: Table<xr::Space, Space>,
    pub swapchains: Table<xr::Swapchain, Swapchain>,
    pub action_sets: Table<xr::ActionSet, ActionSet>,
    pub actions: Table<xr::Action, Action>,
    /// The function that runs.
    call: &'static str,
    /// Its answer.
    pub answer: Answer,
    /// Counts of the calls that could have had each of the scenario's faults.
    injected: InjectedFaults,
}

static RUNTIME: LazyLock<Mutex<Runtime>> = LazyLock::new(|| Mutex::new(Runtime::from_environment()));

/// Runs a call: alone, with its fault recorded and reported to the debug messengers. A panic of ours is
/// `XR_ERROR_RUNTIME_FAILURE`.
pub(crate) fn call(name: &'static str, body: impl FnOnce(&mut Runtime) -> Outcome) -> xr::Result {
    let run = || {
        let mut runtime = RUNTIME.lock().unwrap_or_else(PoisonError::into_inner);
        let InjectedFault { result, answer, late } = runtime.next_fault(name);
        if !late.is_zero() {
            // Only this call is late.
            drop(runtime);
            std::thread::sleep(late);
            runtime = RUNTIME.lock().unwrap_or_else(PoisonError::into_inner);
        }
        runtime.call = name;
        runtime.answer = answer;
        if let Some(result) = result.filter(|&result| result != xr::Result::SESSION_LOSS_PENDING) {
            return (result, None);
        }
        match body(&mut runtime).map(|done| result.unwrap_or(done)) {
            Ok(result) => (result, None),
            Err(fault) => {
                runtime.recorder.error(name, &fault);
                (fault.result, Some((runtime.messengers_for_errors(), fault)))
            }
        }
    };
    match catch_unwind(AssertUnwindSafe(run)) {
        Ok((result, None)) => result,
        Ok((result, Some((messengers, fault)))) => {
            // The lock is free again: a messenger may call back.
            debug_utils::tell(&messengers, name, &result_name(result), &fault);
            result
        }
        Err(_) => xr::Result::ERROR_RUNTIME_FAILURE,
    }
}

/// Socket that gives frames their turn; None if frames take no turns.
pub(crate) fn turns() -> Option<Arc<Turns>> {
    RUNTIME.lock().unwrap_or_else(PoisonError::into_inner).turns.clone()
}

/// Whether a frame of the session is in progress.
pub(crate) fn is_in_frame(session: xr::Session) -> bool {
    let runtime = RUNTIME.lock().unwrap_or_else(PoisonError::into_inner);
    runtime.sessions.get(session).is_ok_and(|session| session.frames.is_in_frame())
}

/// The scenario's deviations from the specification.
pub(crate) fn quirks() -> crate::scenario::Quirks {
    RUNTIME.lock().unwrap_or_else(PoisonError::into_inner).scenario.quirks.clone()
}

impl Runtime {
    fn from_environment() -> Self {
        let file = std::env::var_os(crate::SCENARIO_VARIABLE);
        let loaded = file.map(|file| Scenario::load(file.as_ref())).transpose();
        let (scenario, broken) = match loaded {
            Ok(scenario) => (scenario, None),
            Err(error) => (None, Some(error.to_string())),
        };
        let recorded = scenario.as_ref().filter(|scenario| scenario.output.record);
        let recorder = recorded.map(|scenario| Recorder::create(&scenario.output.dir)).transpose();
        let (recorder, broken) = match recorder {
            Ok(recorder) => (recorder.unwrap_or_default(), broken),
            Err(error) => (Recorder::default(), broken.or(Some(format!("output.dir: {error}")))),
        };
        let socket = scenario.as_ref().map(|scenario| scenario.clock.turns.clone()).unwrap_or_default();
        let turns = (!socket.as_os_str().is_empty()).then(|| Turns::connect(&socket)).transpose();
        let (turns, broken) = match turns {
            Ok(turns) => (turns.map(Arc::new), broken),
            Err(error) => (None, broken.or(Some(format!("clock.turns: {}: {error}", socket.display())))),
        };
        if let Some(reason) = &broken {
            eprintln!("parafovea mock runtime: {reason}");
        }
        let scenario = scenario.unwrap_or_default();
        Self {
            broken,
            clock: Clock::new(&scenario.clock),
            recorder,
            turns,
            frames: 0,
            scenario,
            serial: Serial::default(),
            instances: Table::new("XrInstance"),
            messengers: Table::new("XrDebugUtilsMessengerEXT"),
            sessions: Table::new("XrSession"),
            spaces: Table::new("XrSpace"),
            swapchains: Table::new("XrSwapchain"),
            action_sets: Table::new("XrActionSet"),
            actions: Table::new("XrAction"),
            call: "",
            answer: Answer::Usual,
            injected: InjectedFaults::default(),
        }
    }

    /// The scenario's fault of a call.
    fn next_fault(&mut self, call: &str) -> InjectedFault {
        let happening = self.injected.next(&self.scenario.fault, call, self.frames);
        if happening != InjectedFault::default() {
            self.recorder.warning(call, INJECTED.to_owned());
        }
        happening
    }

    /// A structure parameter. Unknown structures in its chain are skipped, with a warning in the record.
    pub fn read<'a, T: Structure>(&mut self, parameter: &'a In<T>) -> Result<Valid<'a, T>, Fault> {
        let structure = parameter.get()?;
        for ty in structure.unexpected() {
            let message =
                format!("{} does not extend {}: skipped", structure_name(ty), structure_name(T::TYPE));
            self.recorder.warning(self.call, message);
        }
        Ok(structure)
    }

    /// As [`Self::read`], where NULL is allowed.
    pub fn read_optional<'a, T: Structure>(
        &mut self,
        parameter: &'a In<T>,
    ) -> Result<Option<Valid<'a, T>>, Fault> {
        if parameter.is_null() { Ok(None) } else { self.read(parameter).map(Some) }
    }

    /// The scenario, or why there is none.
    pub fn usable_scenario(&self) -> Result<&Scenario, Fault> {
        match &self.broken {
            None => Ok(&self.scenario),
            Some(reason) => Err(Fault::runtime(reason.clone())),
        }
    }

    /// Now, on the runtime's clock.
    pub fn now(&self) -> i64 {
        self.clock.now(clock::monotonic_ns())
    }

    /// The session and its instance.
    pub fn session_and_instance(&self, session: xr::Session) -> Result<(&Session, &Instance), Fault> {
        let session = self.sessions.get(session)?;
        Ok((session, self.instances.get(session.instance)?))
    }

    fn messengers_for_errors(&self) -> Vec<Messenger> {
        self.messengers
            .iter()
            .map(|(_, messenger)| messenger.clone())
            .filter(Messenger::wants_errors)
            .collect()
    }
}
