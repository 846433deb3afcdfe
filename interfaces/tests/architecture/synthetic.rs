//! Tests of these tests, on small crates with and without a circle.

use crate::circle::circles;
use crate::modules::Modules;

/// The circles of a crate in one text, one per line.
fn found(text: &str) -> String {
    let circles = circles(&Modules::parse(text));
    circles.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

#[track_caller]
fn finds(text: &str, expected: &str) {
    assert_eq!(found(text), expected, "{text}");
}

#[track_caller]
fn no_circle(text: &str) {
    finds(text, "");
}

#[test]
fn circles_are_found() {
    // Two modules that use each other.
    finds(
        "mod a { use crate::b::B; pub struct A(B); } mod b { pub struct B(Box<super::a::A>); }",
        "krate: a b",
    );
    // A circle of three.
    finds(
        "mod a { use crate::b::B; pub struct A(B); } mod b { use crate::c::C; pub struct B(C); }
        mod c { pub fn c() { crate::a::A::new(); } pub struct C; } mod d { use crate::a::A; }",
        "krate: a b c",
    );
    // Two circles at two levels.
    finds(
        "mod a { pub mod x { use super::y::Y; pub struct X; } pub mod y { use super::x::X; pub struct Y; } }
        mod b { use crate::c::C; pub struct B; } mod c { use crate::b::B; pub struct C; }",
        "krate: b c\nkrate::a: x y",
    );
    // What is deep inside counts for the siblings above.
    finds(
        "mod a { pub mod x { pub struct X(crate::b::y::Y); } }
        mod b { pub mod y { pub struct Y; } pub mod z { use crate::a::x::X; } }",
        "krate: a b",
    );
    // A re-export counts for the module that defines.
    finds(
        "pub use a::A; pub use b::B;
        mod a { use crate::B; pub struct A; } mod b { use super::A; pub struct B; }",
        "krate: a b",
    );
    // A re-export by star or under another name.
    finds(
        "pub use a::*; pub use b::B as Bee;
        mod a { use super::*; pub fn a() -> Bee { todo() } } mod b { pub struct B; fn b() { crate::a(); } }",
        "krate: a b",
    );
    // A function with the name of its module.
    for re_export in ["pub use a::a;", "pub use a::*;"] {
        let text = "mod a { use crate::b::B; pub fn a() {} } mod b { pub struct B; fn b() { crate::a(); } }";
        finds(&format!("{re_export} {text}"), "krate: a b");
    }
}

#[test]
fn what_is_no_circle_is_not_found() {
    // A use in one direction is no circle.
    no_circle("mod a { use crate::b::B; pub struct A(B); } mod b { pub struct B; }");
    // The facade `f` only passes `C` on, so that `a` uses `c`.
    no_circle(
        "mod a { use crate::f::C; pub struct A; } mod c { pub struct C; } mod f { pub use crate::c::C; use crate::a::A; }",
    );
    // The same without a use of what the star brings.
    no_circle(
        "pub use a::*; pub use b::B as Bee;
        mod a { use super::*; pub fn a() {} } mod b { pub struct B; fn b() { crate::a(); } }",
    );
    // Stars in a ring end.
    no_circle("mod a { pub use crate::b::*; fn f() { nothing(); } } mod b { pub use crate::a::*; }");
    // A module and what it contains may use each other.
    no_circle(
        "mod a { pub use x::X; pub struct A; pub mod x { pub struct X(super::A, crate::Root); } } struct Root(a::A);",
    );
    // Tests are left out.
    no_circle(
        "mod a { #[cfg(test)] use crate::b::B; pub struct A; #[cfg(test)] mod tests { use crate::b::B; }
            #[test] fn test() { crate::b::B; } impl A { #[cfg(test)] fn a() { crate::b::B; } } }
        mod b { use crate::a::A; pub struct B; }",
    );
    // Names of fields, methods and lifetimes are no uses.
    no_circle(
        "mod a { use crate::b::*; fn a<'b>(x: X) { println!(\"{}\", x.b.b()); x.b(); x.b; x.c.d } }
        mod b { use crate::a; pub fn b() { a::a(); } }",
    );
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
