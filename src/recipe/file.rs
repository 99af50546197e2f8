//! The scene file (TOML).
