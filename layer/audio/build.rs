//! Never unloaded: threads of a capture may still be in it when nobody holds it any more.

fn main() {
    println!("cargo::rustc-link-arg-cdylib=-Wl,-z,nodelete");
}
