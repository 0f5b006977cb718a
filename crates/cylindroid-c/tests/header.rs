//! `include/cylindroid.h` is what the sources say.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // a test that fails

use std::path::Path;

#[test]
fn the_header_is_that_of_the_sources() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = here.join("include/cylindroid.h");
    let config = cbindgen::Config::from_file(here.join("cbindgen.toml")).unwrap();
    let mut builder = cbindgen::Builder::new().with_config(config);
    for source in ["status", "arguments", "mechanism", "state", "ik", "servo", "batch", "analysis"]
    {
        builder = builder.with_src(here.join(format!("src/{source}.rs")));
    }
    let mut text = Vec::new();
    builder.generate().unwrap().write(&mut text);
    let text = String::from_utf8(text).unwrap();
    if std::env::var_os("CYLINDROID_BLESS").is_some() {
        std::fs::write(&file, &text).unwrap();
    }
    let written = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(
        written == text,
        "the header is not that of the sources; write it: CYLINDROID_BLESS=1 cargo test -p \
         cylindroid-c --test header"
    );
}
