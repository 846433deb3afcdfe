#!/usr/bin/env bash
# Writes docs/results/localization.csv and docs/results/drifting_house.csv anew: the rows of the tables of docs/localization.md. About
# half an hour of CPU time.
#
#     cargo build --bin four_rooms --example drift --example page_tables && docs/results/localization.sh
set -euo pipefail
cd "$(dirname "$0")/../.."
programs=target/debug
rows=docs/results/localization.csv
commit=$(git show -s --format='commit %h of %cs')
new=$(mktemp -d)
echo "# $commit, docs/results/localization.sh" > "$new/rows.csv"

# TABLE VARIANT OPTION…: a row
run() {
  local table=$1 variant=$2
  shift 2
  "$programs/examples/drift" "rows=$new/rows.csv" "table=$table" "variant=$variant" "$@" > /dev/null
}

houses=(seed=1000 trials=4 minutes=4)
run houses "360 beams" "${houses[@]}"
run houses "odometry alone (\`odometry-only\`)" "${houses[@]}" odometry-only=1
run houses "720 beams" "${houses[@]}" beams=720
run houses "720 beams, scan time 0.1 s (\`sweep=0.1\`)" "${houses[@]}" beams=720 sweep=0.1
run houses "360 beams, scan time 0.1 s" "${houses[@]}" sweep=0.1
run houses "180 beams (\`beams=180\`)" "${houses[@]}" beams=180
run houses "field of view of 180° (\`fov_deg=180\`)" "${houses[@]}" fov_deg=180
run houses "5 % of the beams missing (\`dropout=0.05\`)" "${houses[@]}" dropout=0.05
run houses "3 cm of range noise (\`noise=0.03\`)" "${houses[@]}" noise=0.03
run houses "nothing moves (\`still\`)" "${houses[@]}" still=1
run houses "nothing moves, 720 beams" "${houses[@]}" still=1 beams=720

house=(world=worlds/house.toml closed=1)
run house "720 beams, seeds 0 to 2" "${house[@]}" minutes=20 seed=0 trials=3 beams=720
run house "360 beams, seeds 0 to 2" "${house[@]}" minutes=20 seed=0 trials=3
run house "720 beams, scan time 0.1 s, seeds 1 to 3" "${house[@]}" minutes=20 seed=1 trials=3 beams=720 sweep=0.1
run hour "seed 1" "${house[@]}" minutes=60 seed=1
run hour "seed 2" "${house[@]}" minutes=60 seed=2

run carried "the odometry jumps by up to 1 m and 60° (\`jump_m=1 jump_deg=60\`)" seed=1000 trials=10 minutes=4 jump_m=1 jump_deg=60
run carried "up to 3 m and 180° (\`jump_m=3 jump_deg=180\`)" seed=1000 trials=5 minutes=4 jump_m=3 jump_deg=180
run carried "the robot is carried, up to 1 m and 60°" seed=1000 trials=10 minutes=4 carried_m=1 carried_deg=60
run carried "the robot is carried, up to 3 m and 180°" seed=1000 trials=5 minutes=4 carried_m=3 carried_deg=180

carried=(closed=1 carried_m=1 carried_deg=60 minutes=8)
run closed "carried (\`seed=1400 generate=1400 trials=12 minutes=8 closed=1 carried_m=1 carried_deg=60\`)" seed=1400 generate=1400 trials=12 "${carried[@]}"
run closed "carried, 180 beams over 180° (\`seed=1420 generate=1420 trials=8 beams=180 fov_deg=180\`)" seed=1420 generate=1420 trials=8 beams=180 fov_deg=180 "${carried[@]}"
run closed "not carried, 180 beams over 180° (\`seed=1440 generate=1440 trials=8 minutes=10 closed=1 beams=180 fov_deg=180\`)" seed=1440 generate=1440 trials=8 minutes=10 closed=1 beams=180 fov_deg=180

run shelves "1000 to 1009" seed=1000 trials=10 minutes=4 shelves=1
run shelves "1000 to 1004, at rest while they shift (\`trials=5 rest=1\`)" seed=1000 trials=5 minutes=4 shelves=1 rest=1
run shelves "1020 to 1024 (\`seed=1020 generate=1020 trials=5\`)" seed=1020 generate=1020 trials=5 minutes=4 shelves=1
cp "$new/rows.csv" "$rows"

for pose in localized exact; do
  for seed in {0..9}; do
    "$programs/four_rooms" --world drifting_house --no-rrd --quiet --seed "$seed" --pose "$pose" --out "$new/$pose-$seed"
  done
done
pose=/pose/median_m,/pose/p95_m,/pose/max_m,/pose/heading_p95_deg,/pose/uncertain_s,/pose/lost_s,/pose/lock_ins,/pose/loops_closed
"$programs/examples/page_tables" --rows docs/results/drifting_house.csv --command "four_rooms --world drifting_house --seed N --pose POSE" \
  --keys "/pose/mode,/seed,$pose,/false_change_events,/false_map_changes,/coverage,/map_quality,/log_error" --summary "$new"/*/summary.json
rm -r "$new"
