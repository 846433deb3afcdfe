#!/usr/bin/env bash
# Makes the rows of tables of docs/localization.md anew: docs/results/localization_TABLE.csv.
#
#     cargo build --example drift && docs/results/localization.sh houses house
#
# Each table takes some minutes of CPU time.
set -euo pipefail
cd "$(dirname "$0")/../.."

# VARIANT OPTION…: a row
row() {
  local variant=$1
  shift
  target/debug/examples/drift "rows=$new" "table=$table" "variant=$variant" "$@" > /dev/null
}

houses() {
  local runs=(seed=1000 trials=4 minutes=4)
  row "360 beams" "${runs[@]}"
  row "odometry alone (\`odometry-only\`)" "${runs[@]}" odometry-only=1
  row "720 beams" "${runs[@]}" beams=720
  row "720 beams, scan time 0.1 s (\`sweep=0.1\`)" "${runs[@]}" beams=720 sweep=0.1
  row "360 beams, scan time 0.1 s" "${runs[@]}" sweep=0.1
  row "180 beams (\`beams=180\`)" "${runs[@]}" beams=180
  row "field of view of 180° (\`fov_deg=180\`)" "${runs[@]}" fov_deg=180
  row "5 % of the beams missing (\`dropout=0.05\`)" "${runs[@]}" dropout=0.05
  row "3 cm of range noise (\`noise=0.03\`)" "${runs[@]}" noise=0.03
  row "nothing moves (\`still\`)" "${runs[@]}" still=1
  row "nothing moves, 720 beams" "${runs[@]}" still=1 beams=720
}

house() {
  local runs=(world=worlds/house.toml closed=1 minutes=20 trials=3)
  row "720 beams, seeds 0 to 2" "${runs[@]}" seed=0 beams=720
  row "360 beams, seeds 0 to 2" "${runs[@]}" seed=0
  row "720 beams, scan time 0.1 s, seeds 1 to 3" "${runs[@]}" seed=1 beams=720 sweep=0.1
}

for table in "$@"; do
  new=$(mktemp)
  echo "# $(git show -s --format='commit %h of %cs'), docs/results/localization.sh $table" > "$new"
  "$table"
  mv "$new" "docs/results/localization_$table.csv"
done
