use super::*;
use std::ffi::{c_char, c_void};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};

/// # Safety
///
/// As the call.
unsafe extern "system" fn no_instance_function(_: vk::Instance, _: *const c_char) -> vk::PFN_vkVoidFunction {
    None
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn no_device_function(_: vk::Device, _: *const c_char) -> vk::PFN_vkVoidFunction {
    None
}

/// # Safety
///
/// As the call.
unsafe extern "system" fn set_loader_data(_: vk::Device, _: *mut c_void) -> vk::Result {
    vk::Result::SUCCESS
}

/// A device of its own: no compiler is shared with other tests.
fn device() -> DeviceRecord {
    static NEXT: AtomicU32 = AtomicU32::new(0x1000);
    DeviceRecord {
        instance: vk::Instance::null(),
        physical_device: vk::PhysicalDevice::null(),
        device: vk::Handle::from_raw(NEXT.fetch_add(1, Ordering::Relaxed).into()),
        api_version: vk::API_VERSION_1_0,
        next_get_instance_proc_addr: no_instance_function,
        next_get_device_proc_addr: no_device_function,
        set_device_loader_data: set_loader_data,
        queue_submit: None,
        arming: crate::config::Arming::Rates as u32,
        submits_late: 0,
    }
}

fn compiler(record: &DeviceRecord) -> Arc<Compiler> {
    // SAFETY: without functions nothing of the device is called.
    unsafe { Compiler::of(record) }
}

/// Waits until the thread has nothing more to do.
fn wait(compiler: &Compiler) {
    while compiler.work.queue().is_working {
        sleep(Duration::from_millis(1));
    }
}

/// Something that is being made until the sender sends.
fn slow(compiler: &Arc<Compiler>) -> (Later<u32>, Sender<()>) {
    let (go_on, when): (Sender<()>, Receiver<()>) = channel();
    let (begun, has_begun) = channel();
    let later = compiler.ask("a test goes without", move |_| {
        begun.send(()).unwrap();
        when.recv().unwrap();
        Ok(1)
    });
    has_begun.recv().unwrap();
    (later, go_on)
}

#[test]
fn all_is_made_by_another_thread_and_a_failure_is_its_own() {
    let compiler = compiler(&device());
    let own = current().id();
    let first = compiler.ask("a test goes without", move |_| Ok(current().id() != own));
    let failed = compiler.ask("a test goes without", |_| Err::<u32, _>(GpuError::Invalid("a test's")));
    let panics = compiler.ask("a test goes without", |_| -> Result<u32, _> { panic!("a test's") });
    wait(&compiler);
    // The thread is started again.
    let last = compiler.ask("a test goes without", |_| Ok(7));
    wait(&compiler);
    assert_eq!(first.get().map(|made| **made), Some(true));
    assert_eq!((failed.get(), panics.get()), (None, None));
    assert_eq!(last.get().map(|made| **made), Some(7));
}

#[test]
fn asking_waits_for_nothing() {
    let compiler = compiler(&device());
    let (slow, go_on) = slow(&compiler);
    let behind = compiler.ask("a test goes without", |_| Ok(2));
    assert_eq!((slow.get(), behind.get()), (None, None));
    go_on.send(()).unwrap();
    wait(&compiler);
    assert_eq!([slow.get(), behind.get()].map(|made| made.map(|made| **made)), [Some(1), Some(2)]);
}

#[test]
fn a_device_that_ends_waits_for_what_is_being_made_and_makes_no_more() {
    let record = device();
    let compiler = compiler(&record);
    let (first, go_on) = slow(&compiler);
    let owned = Arc::new(());
    let held = Arc::clone(&owned);
    let behind = compiler.ask("a test goes without", move |_| Ok(held));
    let has_ended = Arc::new(AtomicBool::new(false));
    let ending = {
        let has_ended = Arc::clone(&has_ended);
        std::thread::spawn(move || {
            Compiler::end_on(record.device);
            has_ended.store(true, Ordering::SeqCst);
        })
    };
    while !compiler.work.compilation.has_ended() {
        sleep(Duration::from_millis(1));
    }
    assert!(!has_ended.load(Ordering::SeqCst), "the thread still works");
    assert_eq!(compiler.work.compilation.cache(), Err(GpuError::Abandoned));
    go_on.send(()).unwrap();
    ending.join().unwrap();
    assert_eq!(first.get().map(|made| **made), Some(1));
    assert_eq!(compiler.ask("a test goes without", |_| Ok(3)).get(), None);
    assert!(behind.get().is_none());
    drop(behind);
    assert_eq!(Arc::strong_count(&owned), 1, "what was to make it is gone");
    // The handle of a device may come again.
    assert!(!Arc::ptr_eq(&compiler, &tests::compiler(&record)));
}

#[test]
fn abandoned_requests_are_not_compiled() {
    let compiler = compiler(&device());
    let (slow, go_on) = slow(&compiler);
    let is_made = Arc::new(AtomicBool::new(false));
    let unwanted = {
        let is_made = Arc::clone(&is_made);
        compiler.ask("a test goes without", move |_| Ok(is_made.swap(true, Ordering::SeqCst)))
    };
    drop(unwanted);
    assert_eq!(Arc::strong_count(&is_made), 1);
    let dropping = std::thread::spawn(move || drop(slow));
    assert!(!dropping.is_finished());
    go_on.send(()).unwrap();
    dropping.join().unwrap();
    wait(&compiler);
    assert!(!is_made.load(Ordering::SeqCst));
}

#[test]
fn both_halves_have_one_compiler_of_a_device() {
    let (one, other) = (device(), device());
    let compilers = [&one, &one, &other].map(compiler);
    assert!(Arc::ptr_eq(&compilers[0], &compilers[1]));
    assert!(!Arc::ptr_eq(&compilers[0], &compilers[2]));
}

#[test]
fn a_compiler_of_tools_makes_all_at_once() {
    // SAFETY: without functions nothing of the device is called.
    let compiler = unsafe { Compiler::at_once(&device()) };
    let own = current().id();
    let made = compiler.ask("a test goes without", move |_| Ok(current().id() == own));
    assert_eq!(made.get().map(|made| **made), Some(true));
}
