//! Exact checks on a finished map.
