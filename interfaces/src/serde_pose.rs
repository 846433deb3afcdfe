//! Poses in serde structs, bit for bit: `#[serde(with = "interfaces::serde_pose")]`. A pose is an array of four
//! numbers: x and y (m), and the cosine and the sine of the heading.

use nalgebra::{Isometry2, Translation2, UnitComplex};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Writes a pose.
///
/// # Errors
///
/// The errors of the serializer.
pub fn serialize<S: Serializer>(pose: &Isometry2<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    let (at, rotation) = (pose.translation.vector, pose.rotation);
    [at.x, at.y, rotation.re, rotation.im].serialize(serializer)
}

/// Reads a pose.
///
/// # Errors
///
/// The errors of the deserializer.
pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Isometry2<f64>, D::Error> {
    let [x_m, y_m, cos, sin] = <[f64; 4]>::deserialize(deserializer)?;
    let rotation = UnitComplex::from_cos_sin_unchecked(cos, sin);
    Ok(Isometry2::from_parts(Translation2::new(x_m, y_m), rotation))
}
