//! Draw lists to images, headless.
