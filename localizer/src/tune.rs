//! TEMPORARY
use std::sync::LazyLock;
fn get(name: &str, default: f64) -> f64 {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default)
}
pub static FULL: LazyLock<f64> = LazyLock::new(|| get("FULL", 0.04));
pub static RAMP: LazyLock<f64> = LazyLock::new(|| get("RAMP", 50.0));
pub static FROZEN: LazyLock<f64> = LazyLock::new(|| get("FROZEN", 400.0));
pub static REACH: LazyLock<f64> = LazyLock::new(|| get("REACH", 0.2));
pub static MODEL: LazyLock<f64> = LazyLock::new(|| get("MODEL", 1.0));
pub static SURFSTD: LazyLock<f64> = LazyLock::new(|| get("SURFSTD", 0.003));
pub static RMS: LazyLock<f64> = LazyLock::new(|| get("RMS", 1.3));
pub static HALF: LazyLock<f64> = LazyLock::new(|| get("HALF", 0.0));
pub static ALONG: LazyLock<f64> = LazyLock::new(|| get("ALONG", 1.0));
pub static SAME: LazyLock<f64> = LazyLock::new(|| get("SAME", 0.8));
pub static PRIOR: LazyLock<f64> = LazyLock::new(|| get("PRIOR", 1.5));
pub static CAL: LazyLock<f64> = LazyLock::new(|| get("CAL", 1.0));
