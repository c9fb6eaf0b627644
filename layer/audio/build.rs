//! Links the library so that it is never unloaded: threads of a capture may still run in it after its last handle is closed.

fn main() {
    println!("cargo::rustc-link-arg-cdylib=-Wl,-z,nodelete");
}
