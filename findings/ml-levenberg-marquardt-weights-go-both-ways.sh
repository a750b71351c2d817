#!/usr/bin/env bash
# Packages: ml-levenberg-marquardt 5.1.0 and 5.0.1, ml-matrix 6.15.1 (npm)
#
# Expected: `weights` of levenbergMarquardt sets how much each point counts; one number is a weight
#   for every point. A common factor of all residuals moves no minimum, so a fit of exact data
#   returns the same parameters for every such number, as release 5.0.1 does.
# Seen: release 5.1.0 returns the right parameters for weights = 1 alone. With 1.5 the time constant
#   of 20 comes back as 39, with 3 as 752158, with 0.1 the start values hardly move; no error is
#   raised. The step is built from two methods of ml-matrix that take the same array as `scale`:
#   mmulByTranspose(scale), new in 5.1.0, multiplies by it, scale('row', { scale }) divides by it.
#   So the matrix of the step carries w^-2 and its right-hand side w^2; they agree at w = 1.
# Why it matters: a calibration with 1/sigma weights returns an ordinary-looking curve, or the guess
#   it started from, and only `iterations` at its limit gives it away. Tests without weights pass in
#   both releases. Divide data and model by sigma oneself, or stay on 5.0.1.
set -euo pipefail

dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
cat >package.json <<'JSON'
{
  "private": true,
  "dependencies": {
    "v5.0": "npm:ml-levenberg-marquardt@5.0.1",
    "v5.1": "npm:ml-levenberg-marquardt@5.1.0",
    "ml-matrix": "6.15.1"
  }
}
JSON
npm install --silent --no-audit --no-fund

cat >fit.mjs <<'JS'
import { levenbergMarquardt as before } from 'v5.0';
import { levenbergMarquardt as now } from 'v5.1';
import { Matrix } from 'ml-matrix';

// Force over pressure in kPa, rising towards 3 N with a constant of 20 kPa: exact, without noise.
const model = ([limit, constant]) => (p) => limit * (1 - Math.exp(-p / constant));
const x = [0, 5, 10, 20, 30, 40, 50, 60];
const y = x.map(model([3, 20]));
const options = { initialValues: [2, 10], maxIterations: 200 };
const show = (r) => `${r.parameterValues.map((v) => v.toFixed(3)).join(', ')} (${r.iterations})`;
const right = ({ parameterValues: [a, b] }) =>
  Math.abs(a / 3 - 1) < 0.01 && Math.abs(b / 20 - 1) < 0.02;

let ok = true;
console.log('weights   5.0.1: limit, constant (iterations)   5.1.0');
for (const weights of [0.1, 1, 1.5, 3, 10]) {
  const old = before({ x, y }, model, { ...options, weights });
  const got = now({ x, y }, model, { ...options, weights });
  console.log(String(weights).padEnd(9), show(old).padEnd(37), show(got));
  ok &&= right(old) && right(got) === (weights === 1);
}

// Points with their own weights, 1/sigma of 0.02 N below 10 kPa and 0.1 N above.
const weights = x.map((p) => 1 / (p < 10 ? 0.02 : 0.1));
const old = before({ x, y }, model, { ...options, weights });
const got = now({ x, y }, model, { ...options, weights });
console.log('1/sigma  ', show(old).padEnd(37), show(got));
ok &&= right(old) && !right(got) && got.iterations === options.maxIterations;

// The two methods of ml-matrix with one array: J diag(s) J^T, and a column scaled by row.
const s = [4];
const product = new Matrix([[1]]).mmulByTranspose(s).get(0, 0);
const quotient = new Matrix([[1]]).scale('row', { scale: s }).get(0, 0);
console.log(`scale = ${s}: mmulByTranspose gives ${product}, scale('row') gives ${quotient}`);
ok &&= product === 4 && quotient === 0.25;

console.log(ok ? 'as described: weights other than 1 spoil the fit' : 'behaviour changed');
process.exit(ok ? 0 : 1);
JS
node fit.mjs
