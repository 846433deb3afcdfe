pub(crate) fn get(name: &str, default: f64) -> f64 {
    std::env::var(name).map_or(default, |v| v.parse().unwrap())
}
macro_rules! tunable {
    ($($name:ident = $default:expr;)*) => { $(pub(crate) static $name: std::sync::LazyLock<f64> = std::sync::LazyLock::new(|| get(stringify!($name), $default));)* };
}
tunable! {
    KAPPA = 4.0;
    NU = 3.0;
    POWER = 2.0;
    RCUT = 0.4;
    RPRIOR = 8.0;
    REG = -1.0;
    PRIOR = 0.5;
    RADIUS = 1.0;
}
