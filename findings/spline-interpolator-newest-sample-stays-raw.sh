#!/usr/bin/env bash
# Package: spline-interpolator 1.0.0 (npm)
#
# Expected: new SplineInterpolator(x, y, lambda) is a smoothing spline for lambda below 1 (the
#   default of 1 goes through every point). One continuous curve, so its value at the last x is the
#   limit from the left, as at every other x.
# Seen: interpolate(x) returns the last sample itself, unsmoothed, when x is exactly the last x.
#   Just before it, and just after it, the curve is smooth, with a jump between. The first x and all
#   inner ones are right, so the two ends of a symmetric window differ.
# Why it matters: a live reading smooths a window and shows its value at the newest time: exactly
#   the one point that is not smoothed. The noise is that of the raw signal, bit for bit, for every
#   lambda, while the plot of the same window looks smooth. Evaluate a hair before the last x.
set -euo pipefail

dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
echo '{ "private": true, "dependencies": { "spline-interpolator": "1.0.0" } }' >package.json
npm install --silent --no-audit --no-fund

cat >newest.cjs <<'JS'
const SplineInterpolator = require('spline-interpolator');

// Windows of 40 samples, one a second, of a constant 10 kPa with a uniform noise of +-0.5 kPa.
let state = 1;
const noise = () => {
  state = (state * 48271) % 2147483647; // the minimal standard generator of Park and Miller
  return state / 2147483647 - 0.5;
};
const WINDOWS = 500;
const x = Array.from({ length: 40 }, (_, i) => i);
const last = x.length - 1;
const hair = 1e-9;
const places = { first: 0, middle: 20, 'before last': last - hair, last, 'after last': last + hair };
const spread = (v) => Math.sqrt(v.reduce((sum, one) => sum + (one - 10) ** 2, 0) / v.length);

let ok = true;
console.log(`lambda   raw    ${Object.keys(places).join('  ')}   (standard deviation, kPa)`);
for (const lambda of [1, 0.5, 0.1, 0.01]) {
  const raw = [];
  const seen = Object.fromEntries(Object.keys(places).map((name) => [name, []]));
  for (let window = 0; window < WINDOWS; window += 1) {
    const y = x.map(() => 10 + noise());
    const spline = new SplineInterpolator(x, y, lambda);
    raw.push(y[last]);
    for (const [name, at] of Object.entries(places)) seen[name].push(spline.interpolate(at));
  }
  const of = Object.fromEntries(Object.entries(seen).map(([name, v]) => [name, spread(v)]));
  console.log(String(lambda).padEnd(7), spread(raw).toFixed(3), '',
    Object.entries(of).map(([name, v]) => v.toFixed(3).padStart(name.length)).join('  '));
  ok &&= seen.last.every((v, i) => v === raw[i]);
  const sides = of['after last'] / of['before last'];
  ok &&= Math.abs(sides - 1) < 1e-6 && Math.abs(of.first / of['before last'] - 1) < 0.15;
  ok &&= lambda === 1 ? Math.abs(sides * of['before last'] / of.last - 1) < 1e-6
    : of['before last'] < 0.9 * of.last && of.middle < of['before last'];
}
console.log(ok ? 'as described: the newest sample is not smoothed' : 'behaviour changed');
process.exit(ok ? 0 : 1);
JS
node newest.cjs
