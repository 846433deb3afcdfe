mod blocks;
mod robots;
mod score;

fn main() -> anyhow::Result<()> {
    let args: Vec<u64> = std::env::args().skip(1).map(|a| a.parse().unwrap()).collect();
    blocks::table(args[0], args[1])
}
