use super::*;

/// Tables of results that no program makes: their runs take too long, or need an idle machine or recorded logs. The number of
/// tables of a page can only get smaller.
const BY_HAND: [(&str, usize); 0] = [];

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
    assert!(tables >= 10, "{tables}");
}

#[test]
fn summaries_still_have_every_value() {
    let schema = include_str!("../../../tests/schemas/four_rooms-2.txt");
    for key in read("docs/results/drifting_house.csv").unwrap()[0]
        .columns
        .iter()
        .filter(|column| column.starts_with('/'))
    {
        assert!(schema.lines().any(|line| line.split(' ').next() == Some(key)), "{key}");
    }
}

/// The number of tables with numbers of results outside of generated tables.
fn by_hand(page: &str) -> usize {
    let mut outside = String::new();
    let mut rest = page;
    while let Some((before, after)) = rest.split_once("\n<!-- ") {
        outside += before;
        let is_table = ["rows ", "results_table ", "patrols ", "physics_patrols "]
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
fn tables_by_hand_are_known() {
    let found: Vec<(String, usize)> = pages()
        .into_iter()
        .map(|(name, page)| (name, by_hand(&page)))
        .filter(|(_, count)| *count > 0)
        .collect();
    let known: Vec<(String, usize)> =
        BY_HAND.iter().map(|(name, count)| ((*name).to_owned(), *count)).collect();
    assert_eq!(
        found, known,
        "results of programs belong into docs/results, and their tables are made by page_tables"
    );
}
