//! Invalid and unsupported parts of files, and that all of them are reported.

use super::{good, load_one, one, read, table};
use std::path::Path;
use worldfile::Findings;

fn messages(cases: &[(&str, &str)]) -> String {
    cases.iter().map(|(case, text)| format!("# {case}\n\n{}\n\n", one(text).1)).collect()
}

fn compare(group: &str, cases: &[(&str, &str)]) {
    insta::with_settings!({ omit_expression => true }, { insta::assert_snapshot!(group, messages(cases)) });
}

#[test]
fn syntax() {
    compare(
        "syntax",
        &[
            ("an open bracket", "model( size [1 1 1]\nname \"a\""),
            ("an open list", "model( size [1 1 1\n)"),
            ("a closed bracket", "model( ) )"),
            ("no value", "model( size )"),
            ("a word as a value", "model( size large )"),
            ("an open text", "name \"a\nmodel( )"),
            ("a strange character", "model( size = 3 )"),
            ("no number", "model( size [1.2.3 1 1] )"),
            ("a definition without a body", "define a model"),
            ("a definition of nothing", "define ( )"),
            ("a definition of itself", "define a b( )\ndefine b a( )\na( )"),
            ("an include without a file", "include lab.inc"),
            ("an include that is not there", "include \"lab.inc\""),
            (
                "no include, and what does not follow from it",
                "include \"lab.inc\"\nrover( )\nmodel( size 1 )\ninclude rover.inc\nmodel( name 3 rover( ) )",
            ),
        ],
    );
}

#[test]
fn values() {
    compare(
        "values",
        &[
            ("an unknown kind", "sofa( )"),
            ("an old pose", "model( pose [1 2 90] )"),
            ("a short pose", "model( pose [1 2] )"),
            ("a wrong size", "model( size [1 0 1] )"),
            ("a text for a number", "model( size \"large\" )"),
            ("an absurd number", "model( pose [1e300 0 0 0] )"),
            ("no drive", "position( drive \"legs\" )"),
            ("no picture", "model( bitmap \"q.png\" )"),
            ("not a picture", "model( bitmap \"x.world\" )"),
            ("a block without points", "model( block( point[0] [0 0] ) )"),
            ("a block with too few points", "model( block( points 3 point[0] [0 0] point[1] [1 1] ) )"),
            ("blocks on a line", "model( block( points 3 point[0] [0 0] point[1] [1 0] point[2] [2 0] ) )"),
            ("no laser at all", "position( laser( range_min 3 range_max 2 ) )"),
            ("bounds that forbid to stand", "position( velocity_bounds [1 2 0 0 0 0 -90 90] )"),
            ("odometry", "position( localization \"odom\" odom_error [0.1 0.1 0.1] )"),
            ("a unit", "unit_length \"inch\""),
            ("several at once", "model( size 1 )\nmodel( name 3 )\nposition( drive 4 )"),
        ],
    );
}

#[test]
fn what_is_not_here_is_named() {
    compare(
        "what_is_not_here",
        &[
            (
                "things",
                "window( size [1 2] )\nmodel( camera( range [0 8] ) blobfinder( ) )\nposition( gripper( ) )\nlaser( )",
            ),
            ("nothing", "define a model( )"),
            (
                "what changes nothing",
                "threads 2\nspeedup 3\nmodel( color \"blurple\" )\nmodel( color \"red\" pose [1 0 0 0] )
model( color \"red\" pose [2 0 0 0] )\nmodel( color \"red\" pose [3 0 0 0] mass 3 )\nwindow( size [1 2] )",
            ),
            ("old keys", "model( size3 [1 1 1] )"),
            (
                "keys",
                "resolution 0.02\nmodel( gui_nose 1 joules 10 friction 0.1 bitmap_resolution 3 mass 3 )",
            ),
            ("ghosts", "model( obstacle_return 0 )\nmodel( ranger_return -1 )\nmodel( laser_return 0 )"),
            ("a fast start", "position( velocity [1 0 0 0] ctrl \"wander\" localization_origin [1 0 0 0] )"),
            (
                "drifting",
                "position( localization \"odom\" )\nposition( localization \"odom\" odom_error [0.1 0.1 0 0.1] )",
            ),
            (
                "sensors",
                "position( ranger( sensor( samples 1 ) ) ranger( ) laser( noise [0.1 0.1 1] fov 360 ) )",
            ),
            (
                "drifting sideways",
                "position( drive \"omni\" localization \"odom\" odom_error [0.1 0.1 0 0] )
position( pose [2 0 0 0] drive \"omni\" localization \"odom\" odom_error [0.1 0.3 0 0] )",
            ),
            ("bumpers", "position( bumper( bcount 1 bpose[0] [0 0 0 0] blength 0.1 ) )"),
            (
                "tags",
                "model( fiducial_return 1 )\nposition( pose [1 0 0 0] fiducial( range_max 8 ) )\nfiducial( )",
            ),
            (
                "outlines",
                "position( origin [1 0 0 0] )\nposition( pose [1 0 0 0] model( pose [0.1 0.1 0 0] ) )",
            ),
            ("robots on things", "model( position( ) )\nposition( position( drive \"omni\" ) )"),
            ("names", "model( name \"a\" )\nmodel( name \"a\" )"),
            (
                "a block on a bitmap",
                "model( bitmap \"p.png\" boundary 1 block( color \"red\" points 3 point[0] [0 0] point[1] [1 0] point[2] [0 1] ) )",
            ),
            ("a boundary of nothing", "model( boundary 1 )"),
            ("defined twice", "define a model( )\ndefine a model( )\na( )"),
            ("old rangers", "position( ranger( scount 2 spose[0] [0 0 0] sview [0 1 2] ) )"),
        ],
    );
}

#[test]
fn what_the_physics_cannot_do_is_said_at_its_line() {
    let cases = [
        ("a car", "position( size [0.4 0.4 1] drive \"car\" laser( ) )"),
        ("one way faster", "position( size [0.4 0.4 1] velocity_bounds [-1 0.5 0 0 0 0 -90 45] laser( ) )"),
        ("too fast", "position( size [4 4 1] velocity_bounds [-9 9 0 0 0 0 -90 90] laser( ) )"),
        ("light as air", "position( size [0.4 0.4 1] mass 0 laser( ) )"),
        ("no laser", "position( size [0.4 0.4 1] )"),
        ("two lasers", "position( size [0.4 0.4 1] laser( ) laser( ) )"),
        ("a laser on a stick", "position( size [0.4 0.4 1] laser( pose [1 0 0 0] ) )"),
        ("in a wall", "model( name \"rock\" pose [0.3 0 0 0] )\nposition( size [0.4 0.4 1] laser( ) )"),
        (
            "in each other",
            "position( name \"a\" size [0.4 0.4 1] laser( ) )\nposition( name \"b\" pose [0.3 0 0 0] size [0.4 0.4 1] laser( ) )",
        ),
        ("too large", "model( pose [2000 0 0 0] )\nposition( size [0.4 0.4 1] laser( ) )"),
        (
            "every figure out of range",
            "position( size [0.4 0.4 1] laser( ) localization \"odom\" odom_error [0.6 0 0 -0.7]
velocity_bounds [-1 1 0 0 0 0 -7200 7200]\nacceleration_bounds [0 0 0 0 0 0 0 0] )
position( pose [3 0 0 0] size [0.4 0.4 1] laser( )\nacceleration_bounds [-200 200 0 0 0 0 -90 90]
drive \"omni\" mass 0 )\nposition( pose [6 0 0 0] size [1 1 1] laser( ) drive \"car\"\nwheelbase 0.005 )",
        ),
        (
            "walls too thin and too thick",
            "model( size [4 0.0005 1] )\nmodel( size [300 200 1] pose [0 300 0 10] )
model( size [300 200 1] pose [0 600 0 90] )",
        ),
    ];
    let messages: String =
        cases.iter().map(|(case, text)| format!("# {case}\n\n{}\n\n", load_one(text).1)).collect();
    insta::with_settings!({ omit_expression => true }, { insta::assert_snapshot!(messages) });
}

#[test]
fn texts_that_are_not_printable_are_refused() {
    let (world, findings) = one("model( name \"a\u{1b}[2J\" )\nmodel( bitmap \"\u{9b}.png\" )");
    assert!(world.is_none());
    let whats: Vec<&str> = findings.iter().map(|finding| finding.what.as_str()).collect();
    assert_eq!(whats, ["name", "bitmap"].map(|key| format!("`{key}` has a character that is not printable")));
    assert!(findings.to_string().lines().all(|line| !line.chars().any(char::is_control)), "{findings}");
}

#[test]
fn files_that_include_themselves() {
    let b = "\ninclude \"./a.world\"\n".as_bytes();
    let files = table(&[("a.world", b"model( )\ninclude \"b.inc\"\n"), ("b.inc", b)]);
    let (world, findings) = read(Path::new("a.world"), &files);
    assert!(world.is_none());
    insta::assert_snapshot!(findings, @r#"
    error: `a.world` includes itself
     --> b.inc:2:10
      |
    2 | include "./a.world"
      |          ^^^^^^^^^ this leads back here
      |
      = help: leave one of the includes out
    "#);
}

#[test]
fn endless_growth_is_cut_short() {
    // 2²⁵ models.
    let doubling: String =
        (1..=25).map(|i| format!("define a{i} model( a{0}( ) a{0}( ) )\n", i - 1)).collect();
    let first = |findings: Findings| findings.iter().next().unwrap().what.clone();
    let (_, findings) = one(&format!("define a0 model( )\n{doubling}a25( )"));
    assert_eq!(first(findings), "too many things");
    // A file that is included again and again, but not by itself.
    let many = "include \"b.inc\"\n".repeat(5000);
    let mut files = table(&[("a.world", many.as_bytes()), ("b.inc", &[b'#'; 100_000])]);
    let (_, findings) = read(Path::new("a.world"), &files);
    assert!(first(findings).contains("it has more than"));
    // A chain of files.
    for i in 0..50 {
        files.insert(format!("{i}.inc").into(), format!("include \"{}.inc\"", i + 1).into_bytes());
    }
    let (_, findings) = read(Path::new("0.inc"), &files);
    assert_eq!(first(findings), "too many includes in each other");
    // Brackets.
    let (_, findings) = one(&"model( ".repeat(100_000));
    assert_eq!(first(findings), "too many brackets in each other");
    // A picture that is used often: many pixels, though it is decoded once.
    let rows = (0..2000).flat_map(|y| if y % 500 == 0 { [0xff; 250] } else { [0; 250] });
    let picture: Vec<u8> = b"P4 2000 2000\n".iter().copied().chain(rows).collect();
    let text = "model( bitmap \"p.pbm\" )\n".repeat(20_000);
    let files = table(&[("x.world", text.as_bytes()), ("p.pbm", &picture)]);
    let (_, findings) = read(Path::new("x.world"), &files);
    assert!(findings.iter().any(|finding| finding.what.contains("pixels together")), "{findings}");
}

#[test]
fn latin_1_files_are_read() {
    let files = table(&[("a.world", b"# Andr\xe9\nmodel( name \"caf\xe9\" )")]);
    let (world, _) = read(Path::new("a.world"), &files);
    assert_eq!(world.unwrap().walls[0].name, "café");
}

#[test]
fn exponents_and_lists_over_lines() {
    assert_eq!(good("model( size [ 1e-1 # wide\n 2 3 ] )").walls[0].rectangles[0].half_m.x, 0.05);
}
