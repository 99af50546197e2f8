//! Films in files.
