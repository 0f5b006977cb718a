//! Pitches of forms.

use cylindroid::Error;

use crate::error::Result;

/// Any number or infinite.
pub(super) fn check_pitch(h: f64) -> Result<()> {
    if h.is_nan() {
        return Err(Error::NotFinite { what: "pitch h".into(), value: h }.into());
    }
    Ok(())
}
