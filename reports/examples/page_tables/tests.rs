use super::*;

/// The tables with numbers that no program makes: their runs take hours, need an idle machine or recorded logs, or are still to be
/// kept as rows. A page can have fewer of them, and not more.
const BY_HAND: [(&str, usize); 15] = [
    ("clusters.md", 2),
    ("compatibility.md", 1),
    ("flicker.md", 1),
    ("houses.md", 2),
    ("localization.md", 3),
    ("loops.md", 4),
    ("performance.md", 7),
    ("python.md", 6),
    ("results.md", 1),
    ("robots.md", 3),
    ("state.md", 2),
    ("strategies.md", 4),
    ("things.md", 2),
    ("trajectories.md", 3),
    ("worlds.md", 1),
];

fn pages() -> Vec<(String, String)> {
    let folder = std::fs::read_dir(root().join("docs")).unwrap();
    let mut names: Vec<String> =
        folder.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.retain(|name| name.ends_with(".md"));
    names.sort();
    names
        .into_iter()
        .map(|name| (name.clone(), std::fs::read_to_string(root().join("docs").join(name)).unwrap()))
        .collect()
}

#[test]
fn the_pages_have_what_their_files_say() {
    let mut tables = 0;
    for (name, page) in pages() {
        tables += page.matches("<!-- rows ").count();
        let made = rewritten(&page).unwrap_or_else(|why| panic!("docs/{name}: {why}"));
        assert!(made == page, "cargo run -p curious-reports --example page_tables -- docs/{name}");
    }
    assert!(tables >= 7, "{tables}");
}

/// A program of a crate without the reports prints its rows: with other columns, they are older than the program.
#[test]
fn printed_rows_have_the_columns_of_their_program() {
    // A long literal has line ends with a backslash.
    let in_one_line = |source: &str| source.split("\\\n").map(str::trim_start).collect::<String>();
    for (file, separator, program) in [
        ("fast_changes.csv", ",", include_str!("../../../mapper/examples/fast_cells.rs")),
        ("missed_changes.csv", ",", include_str!("../../../evaluation/examples/every_change.rs")),
        ("predicted_rates.csv", ",", include_str!("../../../evaluation/examples/predicted_rates.rs")),
        ("scan_filter.md#Scan filter", " | ", include_str!("../../../evaluation/examples/veils.rs")),
        ("no_return.md#Beams without a return", " | ", include_str!("../../../evaluation/examples/glass.rs")),
    ] {
        let columns = read(&format!("docs/results/{file}")).unwrap()[0].columns.join(separator);
        assert!(in_one_line(program).contains(&columns), "{file}: {columns}");
    }
    // These rows are those of another study.
    let [own, other] = ["patrols_loss.csv", "patrols.csv"]
        .map(|file| read(&format!("docs/results/{file}")).unwrap()[0].columns.clone());
    assert_eq!(own, other);
}

/// The number of tables with numbers of results outside of generated tables.
fn by_hand(page: &str) -> usize {
    let mut outside = String::new();
    let mut rest = page;
    while let Some((before, after)) = rest.split_once("\n<!-- ") {
        outside += before;
        let is_table = ["rows ", "results_table ", "patrols ", "physics_patrols ", "intrinsic_motivation "]
            .iter()
            .any(|name| after.starts_with(name));
        rest = if is_table { after.split_once("<!-- end -->").map_or("", |(_, after)| after) } else { after };
    }
    outside += rest;
    let lines: Vec<&str> = outside.lines().collect();
    let tables = lines.split(|line| !line.starts_with('|')).filter(|table| table.len() > 2);
    let is_number = |cell: &str| {
        let plain = cell.trim().trim_matches('*').trim_start_matches(['×', '−', '+', '<']).trim();
        plain.starts_with(|letter: char| letter.is_ascii_digit())
            && plain.contains(|letter: char| letter.is_ascii_digit())
    };
    let has_results = |table: &&[&str]| {
        let cells = table[2..].iter().flat_map(|line| line.trim_matches('|').split('|').skip(1));
        let (numbers, all) =
            cells.fold((0, 0), |(numbers, all), cell| (numbers + usize::from(is_number(cell)), all + 1));
        3 * numbers > all
    };
    tables.filter(has_results).count()
}

#[test]
fn no_page_has_more_tables_by_hand() {
    for (name, page) in pages() {
        let known = BY_HAND.iter().find(|(known, _)| *known == name).map_or(0, |(_, count)| *count);
        let found = by_hand(&page);
        assert!(
            found <= known,
            "docs/{name} has {found} tables by hand, not {known}: keep the rows in docs/results, and let page_tables make the table"
        );
    }
}

#[test]
fn tables_by_hand_are_found() {
    let table = "\n| a | b |\n|---|---|\n| x | 1.5 |\n| y | **2** |\n";
    assert_eq!(by_hand(&format!("text\n{table}\ntext\n{table}")), 2);
    assert_eq!(by_hand(&format!("text\n<!-- rows a.csv -->\n{table}\n<!-- end -->\n")), 0);
    assert_eq!(by_hand("\n| a | b |\n|---|---|\n| x | words |\n"), 0);
}
