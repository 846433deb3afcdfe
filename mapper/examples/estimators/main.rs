mod blocks;
mod chains;
mod information;
mod robots;
mod score;

fn main() -> anyhow::Result<()> {
    let args: Vec<u64> = std::env::args().skip(1).map(|a| a.parse().unwrap()).collect();
    if args.len() > 2 {
        return chains::table(args[0] as usize, args[1]);
    }
    blocks::table(args[0], args[1])
}
