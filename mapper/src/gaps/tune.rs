pub(crate) fn get(name: &str, default: f64) -> f64 {
    std::env::var(name).map_or(default, |v| v.parse().unwrap())
}
macro_rules! tunable {
    ($($name:ident = $default:expr;)*) => { $(pub(crate) static $name: std::sync::LazyLock<f64> = std::sync::LazyLock::new(|| get(stringify!($name), $default));)* };
}
tunable! {
    KAPPA = 8.0;
    NU = 3.0;
    POWER = 2.0;
    RCUT = 0.2;
    RSPAN = 0.5;
    RADIUS = 1.0;
    DIFFUSE = 0.0;
    RPRIOR = 4.0;
    REG = -1.0;
    PRIOR = 0.2;
    INFER = 0.0;
}
