//! Conformance of estimates: no level and no budget excludes what the exact query finds.

mod levels;
mod observe;
