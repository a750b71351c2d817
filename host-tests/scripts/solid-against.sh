#!/usr/bin/env bash
# The solid of this checkout against that of an earlier commit: CPU time of a state, mesh by mesh, in one run.
# Usage: host-tests/scripts/solid-against.sh COMMIT
set -euo pipefail
cd "$(dirname "$0")/../.."
commit=${1:?usage: solid-against.sh COMMIT}
before=target/solid-against
rm -rf "$before"
mkdir -p "$before"
git archive "$commit" | tar -x -C "$before"
# The same harness for both.
cp model-tables/compare/benches/solid.rs "$before/model-tables/compare/benches/"
grep -q 'name = "solid"' "$before/model-tables/compare/Cargo.toml" ||
    printf '\n[[bench]]\nname = "solid"\nharness = false\n' >> "$before/model-tables/compare/Cargo.toml"
run() { (cd "$1" && CARGO_TARGET_DIR="$2" cargo bench --quiet --package compare --bench solid); }
here=$PWD/target
run . "$here" > "$before/now.csv"
run "$before" "$here/solid-against/target" > "$before/then.csv"
run . "$here" > "$before/again.csv"
echo "mesh, ms a state now, then, ratio"
paste -d, "$before/now.csv" "$before/again.csv" "$before/then.csv" | tail -n +2 |
    awk -F, '{ now = $3 < $8 ? $3 : $8; printf "%s x %s, %s, %s, %.2f\n", $1, $2, now, $13, $13 / now }'
