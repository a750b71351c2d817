#!/usr/bin/env bash
# Packages: apache-arrow 21.2.0, parquet-wasm 0.8.0, hyparquet 1.33.0 (npm)
#
# Expected: a bench file holds `time` as timestamp[us], `hold` as duration[us] and the kPa, sampled
#   at 2 kHz. The columns carry their unit, so a reader in a browser should give both in one unit,
#   and 0.5 ms between samples.
# Seen: apache-arrow gives `time` as a number of milliseconds, whatever unit its type names, and
#   `hold` as a BigInt of its own unit: the same 0.5 ms reads 0.5 in one column and 500n in the
#   other. hyparquet gives `time` as a Date, which holds whole milliseconds: the fraction is cut,
#   and every time occurs twice. Its `hold` is 500n with no unit anywhere in the Parquet schema:
#   Parquet has no duration, and the unit stands only in the Arrow schema that is stored beside it.
# Why it matters: a rate from neighbouring times is infinite at every second sample, or a time
#   constant is off by 1000, although file, types and values are right. Store seconds as float64
#   with the unit in the name, or compare one known interval through each reader.
set -euo pipefail

dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
cat >package.json <<'JSON'
{
  "private": true,
  "dependencies": { "apache-arrow": "21.2.0", "parquet-wasm": "0.8.0", "hyparquet": "1.33.0" }
}
JSON
npm install --silent --no-audit --no-fund

cat >times.mjs <<'JS'
import { createRequire } from 'node:module';
import * as arrow from 'apache-arrow';
import { parquetMetadata, parquetReadObjects } from 'hyparquet';
const wasm = createRequire(import.meta.url)('parquet-wasm/node');

const STEP = 500n; // us, 2 kHz
const start = 1_700_000_000_000_000n; // us since 1970
const rows = [0n, 1n, 2n, 3n, 4n, 5n];
const column = (type, data) => new arrow.Vector([arrow.makeData({ type, data })]);
const written = new arrow.Table({
  time: column(new arrow.TimestampMicrosecond(), BigInt64Array.from(rows, (i) => start + i * STEP)),
  hold: column(new arrow.DurationMicrosecond(), BigInt64Array.from(rows, (i) => i * STEP)),
  kpa: column(new arrow.Float64(), Float64Array.from(rows, (i) => 10 + Number(i))),
});
const file = wasm.writeParquet(wasm.Table.fromIPCStream(arrow.tableToIPC(written, 'stream')));

// Reader 1: parquet-wasm and apache-arrow.
const table = arrow.tableFromIPC(wasm.readParquet(file).intoIPCStream());
const [time, hold] = [table.getChild('time'), table.getChild('hold')];
const arrowTimes = rows.map((i) => time.get(Number(i)) - time.get(0));
const arrowHolds = rows.map((i) => hold.get(Number(i)));
console.log(`apache-arrow  time  ${time.type}: ${arrowTimes.join(' ')}`);
console.log(`apache-arrow  hold  ${hold.type}: ${arrowHolds.map((v) => `${v}n`).join(' ')}`);

// Reader 2: hyparquet.
const bytes = file.buffer.slice(file.byteOffset, file.byteOffset + file.byteLength);
const objects = await parquetReadObjects({ file: bytes });
const hyparquetTimes = objects.map((r) => r.time - objects[0].time);
const hyparquetHolds = objects.map((r) => r.hold);
const schema = Object.fromEntries(parquetMetadata(bytes).schema.map((s) => [s.name, s]));
console.log(`hyparquet     time  ${schema.time.logical_type.unit}: ${hyparquetTimes.join(' ')}`);
console.log(`hyparquet     hold  ${schema.hold.logical_type?.type ?? 'no logical type'}: `
  + hyparquetHolds.map((v) => `${v}n`).join(' '));

const same = (a, b) => a.length === b.length && a.every((v, i) => v === b[i]);
const raw = rows.map((i) => i * STEP);
const ok = same(arrowTimes, [0, 0.5, 1, 1.5, 2, 2.5]) && same(arrowHolds, raw)
  && String(time.type) === 'Timestamp<MICROSECOND>' && String(hold.type) === 'Duration<MICROSECOND>'
  && same(hyparquetTimes, [0, 0, 1, 1, 2, 2]) && same(hyparquetHolds, raw)
  && schema.time.logical_type.unit === 'MICROS' && schema.hold.logical_type === undefined
  && schema.hold.converted_type === undefined && objects[5].kpa === 15;
console.log(ok ? 'as described: one interval, three values' : 'behaviour changed');
process.exit(ok ? 0 : 1);
JS
node times.mjs
