//! Tests of these tests, on small crates with and without a circle.

use crate::circle::circles;
use crate::modules::Modules;

/// The circles of a crate in one text, one per line.
fn found(text: &str) -> String {
    let circles = circles(&Modules::parse(text));
    circles.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

#[test]
fn two_modules_that_use_each_other() {
    let text = "mod a { use crate::b::B; pub struct A(B); } mod b { pub struct B(Box<super::a::A>); }";
    assert_eq!(found(text), "krate: a b");
}

#[test]
fn a_use_in_one_direction_is_no_circle() {
    let text = "mod a { use crate::b::B; pub struct A(B); } mod b { pub struct B; }";
    assert_eq!(found(text), "");
}

#[test]
fn a_circle_of_three() {
    let text = "mod a { use crate::b::B; pub struct A(B); } mod b { use crate::c::C; pub struct B(C); }
        mod c { pub fn c() { crate::a::A::new(); } pub struct C; } mod d { use crate::a::A; }";
    assert_eq!(found(text), "krate: a b c");
}

#[test]
fn two_circles_at_two_levels() {
    let text =
        "mod a { pub mod x { use super::y::Y; pub struct X; } pub mod y { use super::x::X; pub struct Y; } }
        mod b { use crate::c::C; pub struct B; } mod c { use crate::b::B; pub struct C; }";
    assert_eq!(found(text), "krate: b c\nkrate::a: x y");
}

#[test]
fn what_is_deep_inside_counts_for_the_siblings_above() {
    let text = "mod a { pub mod x { pub struct X(crate::b::y::Y); } }
        mod b { pub mod y { pub struct Y; } pub mod z { use crate::a::x::X; } }";
    assert_eq!(found(text), "krate: a b");
}

#[test]
fn a_re_export_counts_for_the_module_that_defines() {
    let text = "pub use a::A; pub use b::B;
        mod a { use crate::B; pub struct A; } mod b { use super::A; pub struct B; }";
    assert_eq!(found(text), "krate: a b");
    // The facade `f` only passes `C` on, so that `a` uses `c`.
    let text = "mod a { use crate::f::C; pub struct A; } mod c { pub struct C; } mod f { pub use crate::c::C; use crate::a::A; }";
    assert_eq!(found(text), "");
}

#[test]
fn a_re_export_by_star_or_under_another_name() {
    let text = "pub use a::*; pub use b::B as Bee;
        mod a { use super::*; pub fn a() -> Bee { todo() } } mod b { pub struct B; fn b() { crate::a(); } }";
    assert_eq!(found(text), "krate: a b");
    // The same without a use of what the star brings.
    let text = "pub use a::*; pub use b::B as Bee;
        mod a { use super::*; pub fn a() {} } mod b { pub struct B; fn b() { crate::a(); } }";
    assert_eq!(found(text), "");
}

#[test]
fn a_function_with_the_name_of_its_module() {
    for re_export in ["pub use a::a;", "pub use a::*;"] {
        let text = "mod a { use crate::b::B; pub fn a() {} } mod b { pub struct B; fn b() { crate::a(); } }";
        assert_eq!(found(&format!("{re_export} {text}")), "krate: a b", "{re_export}");
    }
}

#[test]
fn stars_in_a_ring_end() {
    let text = "mod a { pub use crate::b::*; fn f() { nothing(); } } mod b { pub use crate::a::*; }";
    assert_eq!(found(text), "");
}

#[test]
fn paths_in_code_in_macros_and_in_attributes() {
    let uses = [
        "fn b() { let a = super::a::A; }",
        "fn b() { format!(\"{}\", crate::a::A); }",
        "fn b() { crate::a::m!(); }",
        "fn b(a: impl crate::a::T) {}",
        "impl crate::a::T for Q {}",
        "type B = Vec<<crate::a::A as Iterator>::Item>;",
        "const B: u8 = { use crate::a::X; 1 };",
        "#[derive(crate::a::D)] struct B;",
        "struct B { #[serde(default = \"super::a::a\")] b: u8 }",
    ];
    for item in uses {
        let a = "pub struct A; pub trait T {} pub struct D; pub fn a() {} pub struct X; macro_rules! m { () => {} }";
        let text = format!("mod a {{ use crate::b::Q; {a} }} mod b {{ pub struct Q; {item} }}");
        assert_eq!(found(&text), "krate: a b", "{item}");
    }
}

#[test]
fn a_module_and_what_it_contains_may_use_each_other() {
    let text = "mod a { pub use x::X; pub struct A; pub mod x { pub struct X(super::A, crate::Root); } } struct Root(a::A);";
    assert_eq!(found(text), "");
}

#[test]
fn tests_are_left_out() {
    let text =
        "mod a { #[cfg(test)] use crate::b::B; pub struct A; #[cfg(test)] mod tests { use crate::b::B; }
            #[test] fn test() { crate::b::B; } impl A { #[cfg(test)] fn a() { crate::b::B; } } }
        mod b { use crate::a::A; pub struct B; }";
    assert_eq!(found(text), "");
}

#[test]
fn names_of_fields_methods_and_lifetimes_are_no_uses() {
    let text = "mod a { use crate::b::*; fn a<'b>(x: X) { println!(\"{}\", x.b.b()); x.b(); x.b; x.c.d } }
        mod b { use crate::a; pub fn b() { a::a(); } }";
    assert_eq!(found(text), "");
}

#[test]
fn modules_in_files() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let file = folder.path().join(name);
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        std::fs::write(file, text).unwrap();
    };
    write("lib.rs", "mod a; mod b; #[cfg(test)] mod tests;");
    write("a/mod.rs", "mod x; pub use x::X;");
    write("a/x.rs", "use crate::b::Y; pub struct X;");
    write("b.rs", "mod y; pub use y::Y;");
    write("b/y.rs", "use crate::a::X; pub struct Y;");
    let modules = Modules::read("krate", &folder.path().join("lib.rs"));
    let circles = circles(&modules);
    assert_eq!(circles.len(), 1);
    let explained =
        "krate: a b\n    a -> b: krate::a::x uses crate::b::Y\n    b -> a: krate::b::y uses crate::a::X\n";
    assert_eq!(circles[0].explained(), explained);
}
