#!/usr/bin/env bash
# Makes the rows of tables of docs/localization.md anew: docs/results/localization_TABLE.csv.
#
#     cargo build --example drift && docs/results/localization.sh houses house carried carried_closed shelves
#
# Each table takes some minutes of CPU time.
set -euo pipefail
cd "$(dirname "$0")/../.."

# VARIANT OPTION…: a row
row() {
  local variant=$1
  shift
  target/debug/examples/drift row=1 "table=$table" "variant=$variant" "$@" | tail -n "$lines" >> "$new"
  lines=1
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

carried() {
  local runs=(seed=1000 minutes=4)
  row "the odometry jumps by up to 1 m and 60° (\`jump_m=1 jump_deg=60\`)" "${runs[@]}" trials=10 jump_m=1 jump_deg=60
  row "up to 3 m and 180° (\`jump_m=3 jump_deg=180\`)" "${runs[@]}" trials=5 jump_m=3 jump_deg=180
  row "the robot is carried, up to 1 m and 60° (\`carried_m=1 carried_deg=60\`)" "${runs[@]}" trials=10 carried_m=1 carried_deg=60
  row "the robot is carried, up to 3 m and 180° (\`carried_m=3 carried_deg=180\`)" "${runs[@]}" trials=5 carried_m=3 carried_deg=180
}

carried_closed() {
  local half=(closed=1 trials=8 beams=180 fov_deg=180) carried=(carried_m=1 carried_deg=60)
  row "\`seed=1400 generate=1400 trials=12 minutes=8 closed=1 carried_m=1 carried_deg=60\`" \
    seed=1400 generate=1400 trials=12 minutes=8 closed=1 "${carried[@]}"
  row "the same with 180 beams over 180° (\`seed=1420 generate=1420 trials=8 beams=180 fov_deg=180\`)" \
    seed=1420 generate=1420 minutes=8 "${half[@]}" "${carried[@]}"
  row "180 beams over 180°, not carried (\`seed=1440 generate=1440 trials=8 minutes=10 closed=1 beams=180 fov_deg=180\`)" \
    seed=1440 generate=1440 minutes=10 "${half[@]}"
}

shelves() {
  local runs=(minutes=4 shelves=1)
  row "1000 to 1009" seed=1000 trials=10 "${runs[@]}"
  row "1000 to 1004, at rest while they shift (\`trials=5 rest=1\`)" seed=1000 trials=5 "${runs[@]}" rest=1
  row "1020 to 1024 (\`seed=1020 generate=1020 trials=5\`)" seed=1020 generate=1020 trials=5 "${runs[@]}"
}

for table in "$@"; do
  new=$(mktemp)
  echo "# $(git show -s --format='commit %h of %cs'), docs/results/localization.sh $table" > "$new"
  lines=2 # the first row has the names of the columns
  "$table"
  mv "$new" "docs/results/localization_$table.csv"
done
