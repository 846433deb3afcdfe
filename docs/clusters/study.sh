#!/usr/bin/env bash
# One shard of one of the three experiments of the large study (docs/clusters.md):
#
#     docs/clusters/study.sh grid-5000 3/97       # also grid-20000 and houses; 1/97 to 97/97
#
# The folder is study/grid-5000 and so on. More arguments go to the program, as --threads 1 --quiet.
set -euo pipefail
study=$1 shard=$2
shift 2
programs=${PROGRAMS:-$(dirname "$0")/../../target/debug}
common=(--seed 20000 --trials 1 --estimator paper --estimator two-state-gaps)
for strategy in curious recency poisson coin information-gain; do
  common+=(--strategy "$strategy")
done
case $study in
  grid-5000) run=(grid_world --generate 1000 --steps 5000) ;;
  grid-20000) run=(grid_world --generate 200 --steps 20000) ;;
  houses) run=(house_trials --generate 200 --duration 20m --unseen-first) ;;
  *) echo "grid-5000, grid-20000 or houses, not $study" >&2 && exit 2 ;;
esac
exec "$programs/${run[0]}" "${run[@]:1}" "${common[@]}" --shard "$shard" --out "study/$study" "$@"
